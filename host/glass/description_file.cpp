#include "host/glass/description_file.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/section_file.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::glass {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view object_section = "object";

void read_objects(const toml::node& node, Description& description, const fs::path& file) {
  const toml::array* list = node.as_array();
  if (list == nullptr || !list->is_array_of_tables())
    refuse(toml_location(file, node.source()), "'object' must be a list of tables",
           "write [[object]]");
  for (const toml::node& one : *list) {
    Object object;
    read_section(*one.as_table(), "[[object]]", parameters(object), file);
    if (object.file.empty())
      refuse(toml_location(file, one.source()), "an object has no file", "write file = \"NAME\"");
    description.objects.push_back(std::move(object));
  }
}

/// The parameters of a section, by its name; empty if the name is unknown.
std::optional<std::vector<Parameter>> section_named(Description& d, std::string_view name) {
  if (name == "machine") return parameters(d.machine);
  if (name == "glass") return parameters(d.glass);
  if (name == "order") return parameters(d.order);
  if (name == "pause") return parameters(d.pause);
  if (name == "output") return parameters(d.output);
  return std::nullopt;
}

std::vector<std::string> section_names() {
  return {"machine", "glass", std::string(object_section), "order", "pause", "output"};
}

/// The lines of a section whose values are not the defaults.
template <class Section>
std::string section_text(std::string_view heading, Section section, const fs::path& folder) {
  Section untouched;
  const std::string lines = section_lines(parameters(section), parameters(untouched), folder);
  return lines.empty() ? "" : fmt::format("\n{}\n{}", heading, lines);
}

}  // namespace

bool is_description(const fs::path& file) { return lower_extension(file) == ".toml"; }

Description read_description(const fs::path& file) {
  const toml::table table = read_toml(file);
  Description description;
  for (const auto& [key, node] : table) {
    const std::string_view name = key.str();
    if (name == object_section) {
      read_objects(node, description, file);
      continue;
    }
    const auto section = section_named(description, name);
    if (!section || !node.is_table())
      refuse(toml_location(file, key.source()), fmt::format("unknown section or key '{}'", name),
             did_you_mean(name, section_names(),
                          "use [machine], [glass], [[object]], [order], [pause] and [output]"));
    read_section(*node.as_table(), fmt::format("[{}]", name), *section, file);
  }
  if (description.objects.empty())
    refuse(file, "it has no object", "write [[object]] and file = \"NAME\"");
  return description;
}

std::string to_text(const Description& description, const fs::path& folder) {
  std::string text = "# What is engraved where, and how: lamplock engrave THIS\n";
  text += section_text("[machine]", description.machine, folder);
  text += section_text("[glass]", description.glass, folder);
  for (const Object& object : description.objects)
    text += section_text("[[object]]", object, folder);
  text += section_text("[order]", description.order, folder);
  text += section_text("[pause]", description.pause, folder);
  text += section_text("[output]", description.output, folder);
  return text;
}

}  // namespace lamplock::glass
