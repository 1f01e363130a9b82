#include "host/pendant/read_key_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "host/error.hpp"
#include "host/pendant/terminal_keys.hpp"
#include "host/printable.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::pendant {
namespace {

/// Names of keys of pendants.
std::vector<std::string> key_names() {
  std::vector<std::string> names;
  for (auto key = static_cast<std::size_t>(Key::none) + 1;
       key < static_cast<std::size_t>(Key::count); ++key)
    if (const auto name = key_name(static_cast<Key>(key)); !name.empty()) names.emplace_back(name);
  return names;
}

constexpr double max_step_mm = 100, max_feed_mm_min = 1e6;
constexpr std::size_t max_steps = 16, max_macro_lines = 100;

/// Reads one table [pendant].
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  KeyMap read(const toml::table& table) {
    // Macros come first: keys may be bound to macros that follow later in the file.
    if (const toml::node* node = table.get("macros")) each(*node, "macros", &Reader::read_macro);
    for (const auto& [key, node] : table) read_key(key, node);
    return map_;
  }

 private:
  using Take = void (Reader::*)(const toml::key&, const toml::node&);

  [[noreturn]] void fail(const toml::source_region& at, const std::string& what,
                         const std::string& remedy) const {
    throw Error(Exit::bad_input, where(at), what, remedy);
  }
  std::string where(const toml::source_region& at) const { return toml_location(file_, at); }

  void read_key(const toml::key& key, const toml::node& node) {
    const std::string_view name = key.str();
    if (name == "macros") return;
    if (name == "keys") return each(node, name, &Reader::bind_key);
    if (name == "keyboard") return each(node, name, &Reader::bind_keyboard);
    if (name == "steps") return read_steps(key, node);
    if (name == "feed") {
      map_.feed_mm_min = number(key, node, max_feed_mm_min);
    } else if (name == "safe_z") {
      map_.safe_z_mm = any_number(key, node);
    } else if (name == "hb04_keys") {
      map_.hb04_keys = static_cast<int>(any_number(key, node));
      if (map_.hb04_keys != 16 && map_.hb04_keys != 18)
        fail(key.source(), "'hb04_keys' is neither 16 nor 18",
             "write the number of keys of the pendant");
    } else {
      fail(
          key.source(), fmt::format("unknown key '{}' in [pendant]", printable(name)),
          did_you_mean(name, {"keys", "keyboard", "macros", "steps", "feed", "safe_z", "hb04_keys"},
                       "use keys, keyboard, macros, steps, feed, safe_z or hb04_keys"));
    }
  }

  void each(const toml::node& node, std::string_view name, Take take) {
    const toml::table* table = node.as_table();
    if (table == nullptr)
      fail(node.source(), fmt::format("'{}' must be a table", name),
           fmt::format("write [pendant.{}]", name));
    for (const auto& [key, value] : *table) (this->*take)(key, value);
  }

  void bind_key(const toml::key& key, const toml::node& node) {
    const auto known = key_named(key.str());
    if (!known)
      fail(key.source(), fmt::format("no pendant has a key '{}'", printable(key.str())),
           did_you_mean(key.str(), key_names(),
                        "use a name from docs/pendants.md, such as safe-z, macro-1, button-1"));
    map_.keys[*known] = binding(key, node);
  }

  void bind_keyboard(const toml::key& key, const toml::node& node) {
    const std::string name(key.str());
    if (!is_keyboard_name(name))
      fail(key.source(), fmt::format("a keyboard has no key '{}'", printable(name)),
           did_you_mean(
               name, keyboard_names(),
               "use one character, or a name from docs/pendants.md, such as page-up, f1, ctrl-x"));
    map_.keyboard[name] = binding(key, node);
  }

  Binding binding(const toml::key& key, const toml::node& node) const {
    const auto name = node.value<std::string>();
    if (!name) fail(key.source(), fmt::format("'{}' must be a text", key.str()), "use quotes");
    if (const auto action = action_named(*name)) return {*action, {}};
    for (std::size_t i = 0; i < map_.macros.size(); ++i)
      if (map_.macros[i].name == *name) return {Action::none, i};
    fail(key.source(), fmt::format("there is no action and no macro '{}'", *name),
         did_you_mean(*name, action_and_macro_names(),
                      "see docs/pendants.md for actions, and [pendant.macros] for macros"));
  }

  std::vector<std::string> action_and_macro_names() const {
    std::vector<std::string> names;
    for (const ActionRow& row : action_rows()) names.emplace_back(row.name);
    for (const Macro& macro : map_.macros) names.push_back(macro.name);
    return names;
  }

  void read_macro(const toml::key& key, const toml::node& node) {
    const toml::table* table = node.as_table();
    const toml::array* lines = table == nullptr ? nullptr : (*table)["lines"].as_array();
    Macro macro{std::string(key.str()), {}, false};
    if (action_named(macro.name))
      fail(key.source(), fmt::format("'{}' is the name of an action", macro.name),
           "choose another name for the macro");
    if (lines == nullptr || lines->empty() || lines->size() > max_macro_lines)
      fail(key.source(), fmt::format("macro '{}' needs lines", macro.name),
           "write lines = [\"G91 G38.2 Z-20 F100\"]");
    for (const auto& [name, value] : *table)
      if (name == "laser" && value.is_boolean())
        macro.laser = *value.value<bool>();
      else if (name != "lines")
        fail(name.source(), fmt::format("a macro has no key '{}'", name.str()),
             "use lines, and laser = true or false");
    macro.lines.reserve(lines->size());
    for (const toml::node& line : *lines) {
      const auto text = line.value<std::string>();
      if (!text) fail(line.source(), "a line of a macro must be a text", "use quotes");
      macro.lines.push_back(macro_line(*text, macro.laser, where(line.source())));
    }
    map_.macros.push_back(std::move(macro));
  }

  void read_steps(const toml::key& key, const toml::node& node) {
    const toml::array* values = node.as_array();
    if (values == nullptr || values->empty() || values->size() > max_steps)
      fail(key.source(), fmt::format("'steps' must be an array of 1 to {} numbers", max_steps),
           "write steps = [0.01, 0.1, 1]");
    map_.steps_mm.clear();
    for (const toml::node& value : *values)
      map_.steps_mm.push_back(number(key, value, max_step_mm));
    std::sort(map_.steps_mm.begin(), map_.steps_mm.end());
  }

  double any_number(const toml::key& key, const toml::node& node) const {
    const auto value = node.value<double>();
    if (!value || !node.is_number() || !std::isfinite(*value) ||
        std::fabs(*value) > max_feed_mm_min)
      fail(node.source(), fmt::format("'{}' must be a number", key.str()),
           "write it without quotes");
    return *value;
  }
  /// A number above 0 that a line of G-code can express.
  double number(const toml::key& key, const toml::node& node, double greatest) const {
    constexpr double least = 0.001;
    const double value = any_number(key, node);
    if (value < least || value > greatest)
      fail(node.source(), fmt::format("'{}' = {} is out of range", key.str(), value),
           fmt::format("use {}..{:.0f}", least, greatest));
    return value;
  }

  const std::filesystem::path& file_;
  KeyMap map_ = default_key_map();
};

}  // namespace

KeyMap read_key_map(const std::filesystem::path& file) {
  const toml::table table = read_toml(file);
  const toml::node* node = table.get("pendant");
  if (node == nullptr) return default_key_map();
  if (node->as_table() == nullptr)
    throw Error(Exit::bad_input, toml_location(file, node->source()), "'pendant' must be a table",
                "write [pendant]");
  return Reader(file).read(*node->as_table());
}

}  // namespace lamplock::pendant
