#include "host/glass/section_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <variant>

#include "host/file.hpp"
#include "host/printable.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::glass {
namespace {

namespace fs = std::filesystem;

/// Names of keys, for the remedy of an error.
std::vector<std::string> keys_of(const std::vector<Parameter>& parameters) {
  std::vector<std::string> keys;
  keys.reserve(parameters.size());
  for (const Parameter& parameter : parameters) keys.push_back(parameter.key);
  return keys;
}

/// Reads the value of one parameter from the file.
class ValueReader {
 public:
  ValueReader(const Parameter& parameter, const toml::node& node, const fs::path& file)
      : parameter_(parameter), node_(node), file_(file) {}

  void read() const {
    std::visit([this](auto* place) { take(*place); }, parameter_.place);
  }

 private:
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const {
    lamplock::refuse(toml_location(file_, node_.source()),
                     fmt::format("'{}' {}", parameter_.key, what), remedy);
  }

  double number(const toml::node& node) const {
    const auto value = node.value<double>();
    if (!value || !node.is_number()) refuse("must be a number", "write it without quotes");
    if (parameter_.range.has(*value)) return *value;
    const std::string range = parameter_.range.text();
    refuse("is out of range", "give " + (range.empty() ? "a finite number" : range));
  }
  std::string text(const toml::node& node) const {
    const auto* value = node.as_string();
    if (value == nullptr) refuse("must be a text", "write it in quotes");
    const std::vector<std::string>& names = parameter_.names;
    if (!names.empty() && std::find(names.begin(), names.end(), value->get()) == names.end())
      refuse(fmt::format("cannot be '{}'", value->get()),
             did_you_mean(value->get(), names, fmt::format("give {}", fmt::join(names, ", "))));
    const std::string wrong = parameter_.check == nullptr ? "" : parameter_.check(value->get());
    if (!wrong.empty()) refuse("is not valid", wrong);
    if (!parameter_.is_file || value->get().empty()) return value->get();
    return (file_.parent_path() / value->get()).lexically_normal().string();
  }

  void take(double& value) const { value = number(node_); }
  void take(std::optional<double>& value) const { value = number(node_); }
  void take(int& value) const {
    if (!node_.is_integer()) refuse("must be a whole number", "write digits only");
    value = static_cast<int>(number(node_));
  }
  void take(std::optional<int>& value) const { take(value.emplace()); }
  void take(bool& value) const {
    const auto* flag = node_.as_boolean();
    if (flag == nullptr) refuse("must be true or false", "write one of them, without quotes");
    value = flag->get();
  }
  void take(std::optional<bool>& value) const { take(value.emplace()); }
  void take(std::string& value) const { value = text(node_); }
  void take(std::optional<std::string>& value) const { value = text(node_); }
  void take(std::optional<Triple>& value) const {
    const toml::array* list = node_.as_array();
    Triple three{};
    if (list == nullptr || list->size() != three.size())
      refuse("must be three numbers", fmt::format("write {} = [x, y, z]", parameter_.key));
    for (std::size_t i = 0; i < three.size(); ++i) three[i] = number(*list->get(i));
    value = three;
  }
  void take(std::vector<std::string>& value) const {
    const toml::array* list = node_.as_array();
    if (list == nullptr)
      refuse("must be a list of texts", fmt::format("write {} = [\"...\"]", parameter_.key));
    value.clear();
    for (const toml::node& one : *list) value.push_back(text(one));
  }

  const Parameter& parameter_;
  const toml::node& node_;
  const fs::path& file_;
};

}  // namespace

void read_section(const toml::table& table, std::string_view name,
                  const std::vector<Parameter>& known, const fs::path& file) {
  for (const auto& [key, node] : table) {
    const auto found = std::find_if(known.begin(), known.end(), [&key = key](const Parameter& p) {
      return p.key == key.str();
    });
    if (found == known.end())
      refuse(toml_location(file, key.source()),
             fmt::format("unknown key '{}' in {}", key.str(), name),
             did_you_mean(key.str(), keys_of(known),
                          fmt::format("use {}", fmt::join(keys_of(known), ", "))));
    ValueReader(*found, node, file).read();
  }
}

namespace {

/// TOML is UTF-8 (TOML 1.0.0, "Spec"): another name would be read back as a different one.
std::string quoted(const std::string& text) {
  if (!is_utf8(text))
    refuse(text, "is not UTF-8, which a description must be", "give the file another name");
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

/// The shortest digits that read back as the same number.
std::string text_of(double value) { return fmt::format("{}", value); }
std::string text_of(int value) { return fmt::format("{}", value); }
std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const std::string& value) { return quoted(value); }
std::string text_of(const Triple& three) { return fmt::format("[{}]", fmt::join(three, ", ")); }
std::string text_of(const std::vector<std::string>& list) {
  std::vector<std::string> texts;
  texts.reserve(list.size());
  for (const std::string& one : list) texts.push_back(quoted(one));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}
template <class Value>
std::string text_of(const std::optional<Value>& value) {
  return value ? text_of(*value) : "";
}

std::string value_text(const Parameter& parameter) {
  return std::visit([](const auto* place) { return text_of(*place); }, parameter.place);
}

/// A file's name relative to the folder of the description.
std::string file_text(const std::string& file, const fs::path& folder) {
  const fs::path from_there = fs::absolute(file).lexically_normal().lexically_relative(
      fs::absolute(folder).lexically_normal());
  return quoted(from_there.empty() ? fs::absolute(file).string() : from_there.string());
}

}  // namespace

std::string section_lines(const std::vector<Parameter>& said,
                          const std::vector<Parameter>& by_default, const fs::path& folder) {
  std::string lines;
  for (std::size_t i = 0; i < said.size(); ++i) {
    const std::string value = value_text(said[i]);
    if (value == value_text(by_default[i])) continue;
    const bool file = said[i].is_file;
    lines += fmt::format("{} = {}\n", said[i].key,
                         file ? file_text(*std::get<std::string*>(said[i].place), folder) : value);
  }
  return lines;
}

}  // namespace lamplock::glass
