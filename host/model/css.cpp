#include "host/model/css.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "host/letter_case.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

/// The text with spaces for comments and line ends.
std::string without_comments(std::string_view text) {
  std::string result;
  while (true) {
    const std::size_t begin = text.find("/*");
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const std::size_t end = text.find("*/", begin + 2);
    result += ' ';
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 2);
  }
  for (const std::string_view mark : {"<!--", "-->"}) {
    for (auto at = result.find(mark); at != std::string::npos; at = result.find(mark, at))
      std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(at), mark.size(), ' ');
  }
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c == '\n' || c == '\r' || c == '\f'; },
      ' ');
  return result;
}

/// The position of the first of `ends` outside of quotes and brackets; the size if there is none.
std::size_t find_outside(std::string_view text, std::string_view ends, std::size_t from = 0) {
  char quote = 0;
  int depth = 0;
  for (std::size_t i = from; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == '\\') ++i;
      if (c == quote) quote = 0;
    } else if (depth == 0 && ends.find(c) != std::string_view::npos) {
      return i;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '[') {
      ++depth;
    } else if ((c == ')' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return text.size();
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

std::string take_name(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_name_character);
  std::string name(text.begin(), end);
  text.remove_prefix(name.size());
  return name;
}

/// What can be done with a part of a selector, from the best to the worst: it applies, it never
/// does in a drawing at rest, it is valid but not understood, it voids its rule.
enum class Reading { fits, never, unknown, invalid };

/// True for text that an identifier may be, which does not begin with a digit.
bool is_identifier(std::string_view name) {
  if (name.starts_with('-')) name.remove_prefix(1);
  return !name.empty() && !(name.front() >= '0' && name.front() <= '9');
}

/// "[name]" or "[name=value]", the value with or without quotes.
Reading take_attribute(std::string_view& text, CssCompound& compound) {
  const std::size_t end = text.find(']');
  if (end == std::string_view::npos) return Reading::invalid;
  std::string_view inner = trimmed(text.substr(1, end - 1));
  text.remove_prefix(end + 1);
  CssCompound::Attribute attribute{take_name(inner), {}};
  inner = trimmed(inner);
  if (!is_identifier(attribute.name)) return Reading::invalid;
  if (inner.empty()) {
    compound.attributes.push_back(std::move(attribute));
    return Reading::fits;
  }
  if (!inner.starts_with('='))  // parts of values, namespaces
    return std::string_view("~|^$*").find(inner.front()) == std::string_view::npos
               ? Reading::invalid
               : Reading::unknown;
  inner = trimmed(inner.substr(1));
  if (inner.empty()) return Reading::invalid;
  const bool begins_quoted = inner.front() == '"' || inner.front() == '\'';
  const bool quoted = inner.size() >= 2 && begins_quoted && inner.back() == inner.front();
  if (begins_quoted && !quoted) return Reading::unknown;  // with a flag
  attribute.value = std::string(quoted ? inner.substr(1, inner.size() - 2) : inner);
  compound.attributes.push_back(std::move(attribute));
  return Reading::fits;
}

template <std::size_t size>
bool is_one_of(const std::array<std::string_view, size>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Pseudo-classes of an interaction, which a drawing at rest does not have.
constexpr std::array<std::string_view, 7> interactions{
    "hover", "active", "focus", "target", "focus-visible", "focus-within", "visited"};
constexpr std::array<std::string_view, 13> other_pseudo_classes{
    "first-child",  "last-child", "only-child", "first-of-type", "last-of-type",
    "only-of-type", "empty",      "link",       "any-link",      "enabled",
    "disabled",     "checked",    "scope"};
constexpr std::array<std::string_view, 10> functions{
    "not",  "is", "where", "has", "nth-child", "nth-last-child", "nth-of-type", "nth-last-of-type",
    "lang", "dir"};
/// Pseudo-elements are boxes of text, which drawings do not have.
constexpr std::array<std::string_view, 4> old_pseudo_elements{"before", "after", "first-line",
                                                              "first-letter"};
constexpr std::array<std::string_view, 5> other_pseudo_elements{"selection", "marker",
                                                                "placeholder", "backdrop", "cue"};

/// Reads the colon, the name and the arguments.
Reading take_pseudo_class(std::string_view& text, CssCompound& compound) {
  text.remove_prefix(1);
  const bool is_element = text.starts_with(':');
  if (is_element) text.remove_prefix(1);
  const std::string name = in_lower_case(take_name(text));
  if (text.starts_with('(')) {
    const std::size_t end = find_outside(text, ")", 1);
    if (end == text.size()) return Reading::invalid;
    text.remove_prefix(end + 1);
    return !is_element && is_one_of(functions, name) ? Reading::unknown : Reading::invalid;
  }
  if (is_one_of(old_pseudo_elements, name)) return Reading::never;
  if (is_element) {
    const bool is_known = is_one_of(other_pseudo_elements, name) || name.starts_with("-webkit-");
    return is_known ? Reading::never : Reading::invalid;
  }
  if (name == "root") {
    compound.is_root = true;
    return Reading::fits;
  }
  if (is_one_of(interactions, name)) return Reading::never;
  return is_one_of(other_pseudo_classes, name) ? Reading::unknown : Reading::invalid;
}

/// Reads a class, an id, an attribute or a pseudo-class from the front of `text`.
Reading take_condition(std::string_view& text, CssCompound& compound) {
  if (text.front() == '[') return take_attribute(text, compound);
  if (text.front() == ':') return take_pseudo_class(text, compound);
  auto& names = text.front() == '.' ? compound.classes : compound.ids;
  text.remove_prefix(1);
  if (text.starts_with('\\')) return Reading::unknown;
  names.push_back(take_name(text));
  return is_identifier(names.back()) ? Reading::fits : Reading::invalid;
}

/// Reads one compound from the front of `text`.
Reading take_compound(std::string_view& text, CssCompound& compound) {
  const std::size_t before = text.size();
  Reading reading = Reading::fits;
  if (text.starts_with('*')) {
    text.remove_prefix(1);
  } else {
    compound.element = take_name(text);
    if (!compound.element.empty() && !is_identifier(compound.element)) return Reading::invalid;
  }
  constexpr std::string_view begins = ".#[:";
  while (!text.empty() && begins.find(text.front()) != std::string_view::npos) {
    reading = std::max(reading, take_condition(text, compound));
    if (reading == Reading::invalid) return reading;
  }
  if (text.size() != before) return reading;
  // Namespaces, escapes and nesting are valid.
  return std::string_view("|\\&").find(text.front()) == std::string_view::npos ? Reading::invalid
                                                                               : Reading::unknown;
}

bool begins_with_combinator(std::string_view text) {
  return text.starts_with('>') || text.starts_with('+') || text.starts_with('~');
}

Reading read_selector(std::string_view text, CssSelector& selector) {
  constexpr std::size_t ids = 1'000'000, classes = 1000;
  // A compound for each level of a drawing is more than any drawing has.
  constexpr std::size_t max_compounds = 64;
  Reading reading = Reading::fits;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    CssCompound compound;
    if (begins_with_combinator(text)) {
      compound.is_child = text.starts_with('>');
      if (!compound.is_child) reading = std::max(reading, Reading::unknown);
      text = trimmed(text.substr(1));
      if (selector.compounds.empty() || text.empty() || begins_with_combinator(text))
        return Reading::invalid;
    }
    const std::size_t before = text.size();
    reading = std::max(reading, take_compound(text, compound));
    if (reading == Reading::invalid || text.size() == before) return reading;
    selector.specificity += ids * compound.ids.size() +
                            classes * (compound.classes.size() + compound.attributes.size() +
                                       (compound.is_root ? 1 : 0)) +
                            (compound.element.empty() ? 0 : 1);
    selector.compounds.push_back(std::move(compound));
    if (selector.compounds.size() > max_compounds) return Reading::unknown;
  }
  return selector.compounds.empty() ? Reading::invalid : reading;
}

/// The end of a block that begins before `from`: the place of its closing brace.
std::size_t end_of_block(std::string_view text, std::size_t from) {
  int depth = 1;
  for (std::size_t at = find_outside(text, "{}", from); at < text.size();
       at = find_outside(text, "{}", at + 1)) {
    depth += text[at] == '{' ? 1 : -1;
    if (depth == 0) return at;
  }
  return text.size();
}

/// The declarations of a rule without the rules nested in it, which are counted as unread.
std::string without_nested_rules(std::string_view content, StyleSheet& sheet) {
  std::string own;
  while (!content.empty()) {
    const std::size_t end = find_outside(content, "{;");
    if (end == content.size() || content[end] == ';') {
      own.append(content.substr(0, end)).append(";");
      content.remove_prefix(std::min(end + 1, content.size()));
      continue;
    }
    sheet.leave_out(content.substr(0, end));
    const std::size_t close = end_of_block(content, end + 1);
    content.remove_prefix(std::min(close + 1, content.size()));
  }
  return own;
}

void read_rule(std::string_view selectors, std::string_view content, StyleSheet& sheet) {
  sheet.declarations.push_back(css_declarations(without_nested_rules(content, sheet)));
  std::vector<CssSelector> read;
  std::vector<std::string_view> unknown;
  while (true) {
    const std::size_t end = find_outside(selectors, ",");
    CssSelector selector;
    selector.declarations = sheet.declarations.size() - 1;
    const Reading reading = read_selector(selectors.substr(0, end), selector);
    if (reading == Reading::invalid) {  // it voids the whole rule
      sheet.leave_out(selectors.substr(0, end));
      return;
    }
    if (reading == Reading::fits) read.push_back(std::move(selector));
    if (reading == Reading::unknown) unknown.push_back(selectors.substr(0, end));
    if (end == selectors.size()) break;
    selectors.remove_prefix(end + 1);
  }
  for (const std::string_view one : unknown) sheet.leave_out(one);
  std::move(read.begin(), read.end(), std::back_inserter(sheet.selectors));
}

/// Rules at the beginning of a sheet that show and hide nothing by themselves.
bool is_harmless(std::string_view name) {
  constexpr std::array<std::string_view, 12> names{
      "@font-face", "@keyframes",     "@-webkit-keyframes",   "@-moz-keyframes",      "@page",
      "@property",  "@counter-style", "@font-feature-values", "@font-palette-values", "@charset",
      "@namespace", "@color-profile"};
  return is_one_of(names, name);
}

/// The name of a rule that begins with @, in lower case.
std::string at_name(std::string_view head) {
  const auto* const end =
      std::find_if_not(head.begin() + 1, head.end(), [](char c) { return is_name_character(c); });
  return in_lower_case(head.substr(0, static_cast<std::size_t>(end - head.begin())));
}

void read_rules(std::string_view text, StyleSheet& sheet, int depth) {
  constexpr int max_depth = 8;  // of nested @media
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::size_t end = find_outside(text, "{;");
    const std::string_view head = trimmed(text.substr(0, end));
    if (end == text.size() || text[end] == ';') {
      // A layer without rules only orders others, which are counted.
      if (head.starts_with('@') && !is_harmless(at_name(head)) && at_name(head) != "@layer")
        sheet.leave_out(head);
      text.remove_prefix(std::min(end + 1, text.size()));
      continue;
    }
    const std::size_t close = end_of_block(text, end + 1);
    const std::string_view content = text.substr(end + 1, close - end - 1);
    text.remove_prefix(std::min(close + 1, text.size()));
    if (!head.starts_with('@')) {
      read_rule(head, content, sheet);
    } else if (constexpr std::string_view media = "@media";
               at_name(head) == media && depth < max_depth &&
               is_for_screens(head.substr(media.size()))) {
      read_rules(content, sheet, depth + 1);
    } else if (!is_harmless(at_name(head))) {
      sheet.leave_out(head);
    }
  }
}

/// One query without the conditions in brackets, which depend on the screen.
bool is_screen_query(std::string_view query) {
  const std::string plain = in_lower_case(trimmed(query));
  std::string_view name = plain;
  const bool is_negated = name.starts_with("not ");
  if (is_negated) name.remove_prefix(std::string_view("not ").size());
  if (name.starts_with("only ")) name.remove_prefix(std::string_view("only ").size());
  name = trimmed(name);
  const bool is_known = !name.empty() && std::all_of(name.begin(), name.end(), is_name_character);
  return is_known && (name == "all" || name == "screen") != is_negated;
}

}  // namespace

void StyleSheet::leave_out(std::string_view rule) {
  if (unread++ == 0) first_unread = trimmed(rule);
}

bool is_for_screens(std::string_view media) {
  media = trimmed(media);
  if (media.empty()) return true;
  while (true) {
    const std::size_t end = find_outside(media, ",");
    if (is_screen_query(media.substr(0, end))) return true;
    if (end == media.size()) return false;
    media.remove_prefix(end + 1);
  }
}

std::vector<CssDeclaration> css_declarations(std::string_view text) {
  const std::string plain = without_comments(text);
  std::vector<CssDeclaration> declarations;
  for (std::string_view rest = plain; !rest.empty();) {
    const std::size_t end = find_outside(rest, ";");
    const std::string_view declaration = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t colon = declaration.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view name = trimmed(declaration.substr(0, colon));
    CssDeclaration one{name.starts_with("--") ? std::string(name) : in_lower_case(name), {}};
    std::string_view value = trimmed(declaration.substr(colon + 1));
    const std::size_t mark = value.rfind('!');
    if (mark != std::string_view::npos &&
        in_lower_case(trimmed(value.substr(mark + 1))) == "important") {
      one.important = true;
      value = trimmed(value.substr(0, mark));
    }
    one.value = value;
    if (!one.name.empty() && !one.value.empty()) declarations.push_back(std::move(one));
  }
  return declarations;
}

void read_css(std::string_view text, StyleSheet& sheet) {
  const std::string plain = without_comments(text);
  read_rules(plain, sheet, 0);
}

}  // namespace lamplock::model
