#include "host/cutting/post_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::cutting {
namespace {

namespace fs = std::filesystem;

/// Of positions in mm. Arcs from coarser ones are not round; a board reads seven (docs/gcode.md).
constexpr int min_post_decimals = 2, max_post_decimals = 7;

class PostReader {
 public:
  explicit PostReader(fs::path file) : file_(std::move(file)) {}

  Post read(const toml::table& table) {
    for (const auto& [key, node] : table) read_key(key, node);
    for (const PostEvent needed :
         {PostEvent::rapid, PostEvent::line, PostEvent::arc_cw, PostEvent::arc_ccw})
      if (post_.of(needed).empty())
        lamplock::refuse(
            file_,
            fmt::format("[lines] has no '{}'", post_event_names[static_cast<std::size_t>(needed)]),
            "write the line for it");
    return std::move(post_);
  }

 private:
  [[noreturn]] void refuse(const toml::source_region& at, const std::string& what,
                           const std::string& remedy) const {
    lamplock::refuse(toml_location(file_, at), what, remedy);
  }

  void read_key(const toml::key& key, const toml::node& node) {
    const std::string_view name = key.str();
    const auto wrong = [&](const char* what, const char* remedy) {
      refuse(node.source(), fmt::format("'{}' must be {}", name, what), remedy);
    };
    if (name == "name" || name == "about") {
      if (!node.is_string()) wrong("a text", "write it in quotes");
      (name == "name" ? post_.name : post_.about) = node.as_string()->get();
    } else if (name == "machine") {
      const auto machine = std::find(machine_type_names.begin(), machine_type_names.end(),
                                     node.value_or(std::string_view{}));
      if (machine == machine_type_names.end())
        wrong("the type of a machine", "write laser, mill, knife or lathe, in quotes");
      post_.machine = static_cast<MachineType>(machine - machine_type_names.begin());
    } else if (name == "checked") {
      if (!node.is_boolean()) wrong("true or false", "write one of them, without quotes");
      post_.is_checked = node.as_boolean()->get();
    } else if (name == "decimals") {
      const auto decimals = node.is_integer() ? node.as_integer()->get() : -1;
      if (decimals < min_post_decimals || decimals > max_post_decimals)
        wrong("a whole number from 2 to 7", "give the digits after the point of positions");
      post_.decimals = static_cast<int>(decimals);
    } else if (name == "lines") {
      if (!node.is_table()) wrong("a table", "write [lines]");
      for (const auto& [event, lines] : *node.as_table()) read_event(event, lines);
    } else {
      const std::vector<std::string> known{"name",     "about",   "machine",
                                           "decimals", "checked", "lines"};
      refuse(key.source(), fmt::format("unknown key '{}'", name),
             did_you_mean(name, known, fmt::format("use {}", fmt::join(known, ", "))));
    }
  }

  void read_event(const toml::key& key, const toml::node& node) {
    const std::vector<std::string> names(post_event_names.begin(), post_event_names.end());
    const auto found = std::find(names.begin(), names.end(), key.str());
    if (found == names.end())
      refuse(key.source(), fmt::format("unknown key '{}' in [lines]", key.str()),
             did_you_mean(key.str(), names, fmt::format("use {}", fmt::join(names, ", "))));
    std::vector<std::string>& lines = post_.lines[static_cast<std::size_t>(found - names.begin())];
    if (const toml::array* list = node.as_array()) {
      for (const toml::node& one : *list) lines.push_back(line_of(one, *found));
    } else {
      lines.push_back(line_of(node, *found));
    }
  }

  std::string line_of(const toml::node& node, const std::string& name) const {
    const auto* text = node.as_string();
    if (text == nullptr)
      refuse(node.source(), fmt::format("'{}' must be a line or a list of lines", name),
             "write lines in quotes");
    const std::string fault = template_fault(text->get());
    if (!fault.empty())
      refuse(node.source(), fmt::format("'{}' is not valid: {}", name, fault),
             "correct the line; values are written {x}, parts that may be left out [ F{feed}]");
    return text->get();
  }

  fs::path file_;
  Post post_;
};

}  // namespace

std::vector<std::string> post_names() {
  std::vector<std::string> names;
  for (const PostText& post : post_texts()) names.emplace_back(post.name);
  return names;
}

Post post_of(const std::string& name_or_file) {
  if (lower_extension(name_or_file) == ".toml")
    return PostReader(name_or_file).read(read_toml(name_or_file));
  for (const PostText& post : post_texts())
    if (post.name == name_or_file)
      return PostReader(name_or_file).read(parse_toml(post.text, name_or_file));
  const std::vector<std::string> names = post_names();
  throw Error(Exit::bad_input, name_or_file, "there is no post-processor of this name",
              did_you_mean(name_or_file, names,
                           fmt::format("give {} or a file FILE.toml", fmt::join(names, ", "))));
}

}  // namespace lamplock::cutting
