#include "host/toml_file.hpp"

#include <fmt/format.h>

#include "host/file.hpp"

namespace lamplock {

std::string toml_location(const std::filesystem::path& file, const toml::source_region& source) {
  return fmt::format("{}:{}", file.string(), source.begin.line);
}

toml::table read_toml(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    refuse(toml_location(file, error.source()), std::string(error.description()),
           "correct the line");
  }
}

}  // namespace lamplock
