#include "host/toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

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
    Wording{"unknown escape sequence", "a text has a single backslash; write two for one"},
    Wording{"end-of-file", "the file ends in the middle of a value"},
    Wording{"inline table", "a '}' is missing"},
    Wording{"is_bare_key_character", "the name before '=' or in the [ ] of a section is missing"},
    Wording{"is_value_terminator", "a value is missing"},
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

/// The first line, from 1, that the parser cannot pass without one of its assertions. A part of the
/// text that ends before that line is valid or refused as incomplete.
std::size_t line_of_assertion(std::string_view text) {
  std::vector<std::size_t> ends;
  for (auto at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
    ends.push_back(at + 1);
  const auto passes = [&](std::size_t end) {
    try {
      (void)toml::parse(text.substr(0, end));
    } catch (const TomlAssertion&) {
      return false;
    } catch (const toml::parse_error&) {
    }
    return true;
  };
  return static_cast<std::size_t>(std::ranges::partition_point(ends, passes) - ends.begin()) + 1;
}

constexpr const char* remedy =
    "correct the line: NAME = VALUE, texts in quotes, numbers with a decimal point";

[[noreturn]] void refuse_part(const std::string& where, std::string_view description) {
  // Pictures, models and other binary files have bytes that no text has.
  if (description.find("invalid utf-8") != std::string_view::npos)
    refuse(where, "is not text in UTF-8", "give a text file of the form NAME = VALUE (TOML)");
  refuse(where, plain_text(description), remedy);
}

}  // namespace

std::string toml_location(const std::filesystem::path& file, const toml::source_region& source) {
  return fmt::format("{}:{}", file.string(), source.begin.line);
}

toml::table parse_toml(std::string_view text, const std::filesystem::path& file) {
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    refuse_part(toml_location(file, error.source()), error.description());
  } catch (const TomlAssertion& assertion) {
    refuse_part(fmt::format("{}:{}", file.string(), line_of_assertion(text)), assertion.what());
  }
}

toml::table read_toml(const std::filesystem::path& file) {
  return parse_toml(read_text_file(file), file);
}

}  // namespace lamplock
