#include "host/model/xml_entities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "host/model/file_position.hpp"
#include "host/model/utf8.hpp"

namespace lamplock::model {
namespace {

/// An entity of a drawing has a level or two; text and references beyond these bounds are those of
/// a file that is made to exhaust the memory or the time.
constexpr std::size_t max_levels = 16;
constexpr std::size_t max_added_bytes = 32U << 20U;
constexpr std::size_t max_references = 1'000'000;

constexpr std::string_view xml_blanks = " \t\r\n";

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == ':' || c == '-' || c == '.' || static_cast<unsigned char>(c) >= 0x80;
}

std::string_view take_name(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_name_character);
  const std::string_view name = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(name.size());
  return name;
}

bool skip_blanks(std::string_view& text) {
  const std::size_t count = std::min(text.find_first_not_of(xml_blanks), text.size());
  text.remove_prefix(count);
  return count > 0;
}

/// The size of the markup at the front of a text that ends with `end`; all of it without an end.
std::size_t size_until(std::string_view text, std::string_view end) {
  const std::size_t at = text.find(end);
  return at == std::string_view::npos ? text.size() : at + end.size();
}

/// A string in quotes at the front of a text; empty and nothing taken without one.
std::string_view take_quoted(std::string_view& text) {
  if (text.empty() || (text.front() != '"' && text.front() != '\'')) return {};
  const std::size_t end = text.find(text.front(), 1);
  if (end == std::string_view::npos) return {};
  const std::string_view inner = text.substr(1, end - 1);
  text.remove_prefix(end + 1);
  return inner;
}

/// Skips a string in quotes or a character.
void skip_one(std::string_view& text) {
  const std::size_t before = text.size();
  take_quoted(text);
  if (text.size() == before) text.remove_prefix(1);
}

/// Comments, processing instructions and CDATA, in which nothing is a reference.
std::size_t size_of_plain_markup(std::string_view text) {
  if (text.starts_with("<!--")) return size_until(text, "-->");
  if (text.starts_with("<?")) return size_until(text, "?>");
  if (text.starts_with("<![CDATA[")) return size_until(text, "]]>");
  return 0;
}

bool is_predefined(std::string_view name) {
  constexpr std::array<std::string_view, 5> names{"amp", "lt", "gt", "quot", "apos"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The value of an entity with the characters for its character references. Line ends become
/// blanks: the lines of the text remain those of the file.
std::string value_of(std::string_view quoted) {
  std::string value;
  while (!quoted.empty()) {
    constexpr std::size_t max_size = 12;  // "&#x0010FFFF;"
    const std::size_t end = quoted.substr(0, max_size).find(';');
    if (quoted.starts_with("&#") && end != std::string_view::npos) {
      value += character_reference(quoted.substr(2, end - 2));
      quoted.remove_prefix(end + 1);
      continue;
    }
    const bool is_line_end = quoted.front() == '\n' || quoted.front() == '\r';
    value += is_line_end ? ' ' : quoted.front();
    quoted.remove_prefix(1);
  }
  return value;
}

struct Entity {
  std::string value;
  bool is_external = false;
};

class Expansion {
 public:
  Expansion(const std::filesystem::path& file, std::string_view text) : file_(file), all_(text) {}

  ExpandedXml expand() && {
    std::string_view rest = all_;
    copy_prolog(rest);
    append_content(rest, 0);
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(std::string_view name, const std::string& what) const {
    FilePosition{file_, all_, offset_}.refuse(fmt::format("the entity '{:.40}' {}", name, what),
                                              "export the drawing without entities");
  }

  [[noreturn]] void refuse_size(std::string_view name) const {
    refuse(name, fmt::format("expands to more than {} MB of text", max_added_bytes >> 20U));
  }

  /// Copies what is before the root element and reads its declarations.
  void copy_prolog(std::string_view& rest) {
    const std::string_view whole = rest;
    while (!rest.empty()) {
      skip_blanks(rest);
      if (const std::size_t size = size_of_plain_markup(rest); size > 0) {
        rest.remove_prefix(size);
      } else if (rest.starts_with("<!DOCTYPE")) {
        read_doctype(rest);
        break;
      } else {
        break;
      }
    }
    result_.text = whole.substr(0, whole.size() - rest.size());
  }

  void read_doctype(std::string_view& rest) {
    while (!rest.empty() && rest.front() != '>') {
      if (rest.front() == '[') {
        rest.remove_prefix(1);
        read_declarations(rest, 0);
      } else {
        skip_one(rest);
      }
    }
    if (!rest.empty()) rest.remove_prefix(1);
  }

  /// Declarations up to and with "]", or those of a parameter entity.
  void read_declarations(std::string_view& rest, std::size_t level) {
    while (!rest.empty() && rest.front() != ']') {
      if (const std::size_t size = size_of_plain_markup(rest); size > 0) {
        rest.remove_prefix(size);
      } else if (rest.starts_with("<!ENTITY")) {
        rest.remove_prefix(std::string_view("<!ENTITY").size());
        read_entity(rest);
      } else if (rest.starts_with("<!")) {
        skip_declaration(rest);
      } else if (rest.front() == '%') {
        rest.remove_prefix(1);
        include(take_name(rest), level);
      } else {
        rest.remove_prefix(1);
      }
    }
    if (!rest.empty()) rest.remove_prefix(1);
  }

  static void skip_declaration(std::string_view& rest) {
    while (!rest.empty() && rest.front() != '>') skip_one(rest);
  }

  /// The first declaration of a name counts.
  void read_entity(std::string_view& rest) {
    skip_blanks(rest);
    const bool is_parameter = rest.starts_with('%');
    if (is_parameter) rest.remove_prefix(1);
    skip_blanks(rest);
    const std::string name(take_name(rest));
    skip_blanks(rest);
    Entity entity;
    entity.is_external = rest.starts_with("SYSTEM") || rest.starts_with("PUBLIC");
    if (!entity.is_external) entity.value = value_of(take_quoted(rest));
    skip_declaration(rest);
    if (name.empty() || (!is_parameter && is_predefined(name))) return;
    (is_parameter ? parameters_ : general_).try_emplace(name, std::move(entity));
  }

  /// Reads the declarations of a parameter entity.
  void include(std::string_view name, std::size_t level) {
    const auto found = parameters_.find(std::string(name));
    if (found == parameters_.end()) return;
    spend(name, level);
    if (found->second.is_external) {
      ++result_.external;
      return;
    }
    const std::string value = found->second.value;
    included_bytes_ += value.size();
    if (included_bytes_ > max_added_bytes) refuse_size(name);
    std::string_view declarations = value;
    while (!declarations.empty()) read_declarations(declarations, level + 1);
  }

  void spend(std::string_view name, std::size_t level) {
    if (level >= max_levels)
      refuse(name,
             fmt::format("refers to itself or to more than {} levels of entities", max_levels));
    if (++references_ > max_references)
      refuse(named_in_file(name, level),
             fmt::format("expands to more than {} references", max_references));
  }

  /// The place of errors is the reference of the file, not that of a replacement text.
  void note_place(std::string_view rest, std::size_t level) {
    if (level == 0) offset_ = static_cast<std::size_t>(rest.data() - all_.data());
  }

  /// The entity of that reference.
  std::string_view named_in_file(std::string_view name, std::size_t level) const {
    if (level == 0) return name;
    std::string_view reference = all_.substr(offset_ + 1);
    return take_name(reference);
  }

  /// Text and elements.
  void append_content(std::string_view rest, std::size_t level) {
    while (!rest.empty()) {
      const std::size_t plain = std::min(rest.find_first_of("<&"), rest.size());
      take(rest, plain);
      if (rest.empty()) return;
      if (const std::size_t size = size_of_plain_markup(rest); size > 0)
        take(rest, size);
      else if (rest.front() == '<')
        append_tag(rest, level);
      else
        append_reference(rest, level, false);
    }
  }

  void append_tag(std::string_view& rest, std::size_t level) {
    while (!rest.empty() && rest.front() != '>') {
      take(rest, std::min(rest.find_first_of("\"'>"), rest.size()));
      if (rest.empty() || rest.front() == '>') break;
      const std::size_t size = size_until(rest.substr(1), rest.substr(0, 1)) + 1;
      const std::string_view value = rest.substr(0, size);
      append_attribute(value, level, false);
      rest.remove_prefix(size);
    }
    take(rest, std::min<std::size_t>(1, rest.size()));
  }

  /// The value of an attribute with its quotes, or a replacement text in it, in which quotes and
  /// "<" are characters as others.
  void append_attribute(std::string_view rest, std::size_t level, bool is_replacement) {
    while (!rest.empty()) {
      const std::size_t plain = std::min(rest.find_first_of("&\"'<"), rest.size());
      take(rest, plain);
      if (rest.empty()) return;
      const char c = rest.front();
      if (c == '&') {
        append_reference(rest, level, true);
      } else if (is_replacement) {
        result_.text += c == '"' ? "&quot;" : c == '<' ? "&lt;" : "&apos;";
        rest.remove_prefix(1);
      } else {
        take(rest, 1);
      }
    }
  }

  /// "&name;" at the front of a text; another "&" is copied.
  void append_reference(std::string_view& rest, std::size_t level, bool is_attribute) {
    note_place(rest, level);
    std::string_view after = rest.substr(1);
    const std::string name(take_name(after));
    if (name.empty() || !after.starts_with(';') || is_predefined(name)) return take(rest, 1);
    const auto found = general_.find(name);
    if (found == general_.end()) {
      ++result_.undeclared;
      return take(rest, name.size() + 2);
    }
    rest.remove_prefix(name.size() + 2);
    spend(name, level);
    if (found->second.is_external) {
      ++result_.external;
      return;
    }
    if (is_attribute)
      append_attribute(found->second.value, level + 1, true);
    else
      append_content(found->second.value, level + 1);
    if (result_.text.size() > all_.size() + max_added_bytes)
      refuse_size(named_in_file(name, level));
  }

  void take(std::string_view& rest, std::size_t size) {
    result_.text += rest.substr(0, size);
    rest.remove_prefix(size);
  }

  const std::filesystem::path& file_;
  std::string_view all_;
  std::size_t offset_ = 0;  ///< of errors
  std::unordered_map<std::string, Entity> general_, parameters_;
  std::size_t references_ = 0, included_bytes_ = 0;
  ExpandedXml result_;
};

}  // namespace

ExpandedXml expand_entities(const std::filesystem::path& file, std::string text) {
  if (text.find('&') == std::string::npos) return {std::move(text)};
  return Expansion(file, text).expand();
}

}  // namespace lamplock::model
