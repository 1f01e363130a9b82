#include "host/toml_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "host/file.hpp"

namespace lamplock {
namespace {

/// A part of a description by the library, and what it means to a user.
struct Wording {
  std::string_view part, plain;
};
/// The first part that is found counts.
constexpr std::array wordings{
    Wording{"saw ','", "a ',' follows the value"},
    Wording{"expected value,", "a value is missing"},
    Wording{"expected a comment or whitespace", "more text follows the value"},
    Wording{"expected '='", "there is no '=' after the name"},
    Wording{"expected value-terminator", "the value is not a number"},
    Wording{"could not determine value type", "the value is neither a number nor a text in quotes"},
    Wording{"expected 'true'", "the value is neither a number nor a text in quotes"},
    Wording{"expected 'false'", "the value is neither a number nor a text in quotes"},
    Wording{"unescaped control characters",
            "a text has no quote at its end, or has a control character"},
    Wording{"table header: expected ']'", "the ']' of a section is missing"},
    Wording{"expected keys, tables", "the name before '=' is missing"},
    Wording{"not representable in 64 bits", "a number is too large"},
    Wording{"leading zeroes", "a number begins with 0"},
    Wording{"invalid utf-8", "is not valid UTF-8"},
    Wording{"unknown escape sequence", "a text has a single backslash; write two for one"},
    Wording{"end-of-file", "the file ends in the middle of a value"},
    Wording{"inline table", "a '}' is missing"},
};

std::string plain_text(std::string_view description) {
  constexpr std::string_view redefined = "cannot redefine existing ";
  if (const auto at = description.find(redefined); at != std::string_view::npos) {
    const auto name = description.find('\'', at);
    if (name != std::string_view::npos)
      return fmt::format("{} is given twice", description.substr(name));
  }
  for (const Wording& wording : wordings)
    if (description.find(wording.part) != std::string_view::npos) return std::string(wording.plain);
  return fmt::format("is not valid TOML ({})", description);
}

}  // namespace

std::string toml_location(const std::filesystem::path& file, const toml::source_region& source) {
  return fmt::format("{}:{}", file.string(), source.begin.line);
}

void refuse_toml(const std::filesystem::path& file, const toml::parse_error& error) {
  refuse(toml_location(file, error.source()), plain_text(error.description()),
         "correct the line: NAME = VALUE, texts in quotes, numbers with a decimal point");
}

toml::table read_toml(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    refuse_toml(file, error);
  }
}

}  // namespace lamplock
