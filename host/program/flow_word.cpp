#include "host/program/flow_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "host/letter_case.hpp"

namespace lamplock::program_run {
namespace {

struct FlowName {
  std::string_view text;
  Flow flow;
};
/// A name that begins with another one comes before it.
constexpr FlowName flow_names[] = {
    {"endsub", Flow::endsub},       {"sub", Flow::sub},
    {"call", Flow::call},           {"return", Flow::returning},
    {"elseif", Flow::else_branch},  {"else", Flow::otherwise},
    {"endif", Flow::endif},         {"if", Flow::branch},
    {"endwhile", Flow::endwhile},   {"while", Flow::loop},
    {"do", Flow::do_loop},          {"endrepeat", Flow::endrepeat},
    {"repeat", Flow::repeat},       {"break", Flow::breaking},
    {"continue", Flow::continuing},
};

std::string in_lower_case_without_blanks(std::string_view line) {
  std::string text;
  for (const char c : line)
    if (static_cast<unsigned char>(c) > ' ') text += lower_case(c);
  return text;
}

std::size_t after_digits(std::string_view text, std::size_t from) {
  while (from < text.size() && text[from] >= '0' && text[from] <= '9') ++from;
  return from;
}

/// The place after the label that begins here; 0 if there is none.
std::size_t after_label(std::string_view text, std::size_t from) {
  if (from >= text.size()) return 0;
  if (text[from] == '<') {
    const std::size_t end = text.find('>', from);
    return end == std::string_view::npos ? 0 : end + 1;
  }
  if (text[from] == '[') {
    int open = 0;
    for (std::size_t i = from; i < text.size(); ++i) {
      if (text[i] == '[') ++open;
      if (text[i] == ']' && --open == 0) return i + 1;
    }
    return 0;
  }
  if (text[from] == '#') return after_label(text, from + 1);
  const std::size_t end = after_digits(text, from);
  return end == from ? 0 : end;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// `o1 if 1`: LinuxCNC needs the brackets, too.
FlowWordFault without_brackets(std::string_view name, Flow flow, std::string_view values) {
  constexpr Flow with_values[] = {Flow::call, Flow::endsub, Flow::returning,  Flow::branch,
                                  Flow::loop, Flow::repeat, Flow::else_branch};
  if (std::ranges::find(with_values, flow) == std::end(with_values))
    return {fmt::format("{} has no value", name), "remove what follows it"};
  return {fmt::format("the value '{}' of {} is not in square brackets", values, name),
          fmt::format("write '{} [{}]'", name, values)};
}

}  // namespace

std::optional<FlowWord> flow_word_of(std::string_view line, std::optional<FlowWordFault>& fault) {
  fault.reset();
  std::string text = in_lower_case_without_blanks(line);
  const std::size_t dropped = text.starts_with('/') ? 1 : 0;  // block delete is off
  text.erase(0, dropped);
  std::size_t at = 0;
  if (text.starts_with('n')) at = after_digits(text, 1);
  if (at >= text.size() || text[at] != 'o') return std::nullopt;
  const std::size_t begin = at + 1, end = after_label(text, begin);
  if (end == 0 || end == text.size()) return std::nullopt;
  FlowWord word;
  word.label = text.substr(begin, end - begin);
  word.label_at = begin + dropped;
  while (word.label.size() > 1 && word.label.front() == '0') word.label.erase(0, 1);
  const std::string_view rest = std::string_view(text).substr(end);
  if (!is_letter(rest.front())) return std::nullopt;
  for (const FlowName& name : flow_names) {
    if (!rest.starts_with(name.text)) continue;
    const std::string_view values = rest.substr(name.text.size());
    if (!values.empty() && values.front() != '[') {
      const bool is_function = values.find('[') != std::string_view::npos;
      if (is_letter(values.front()) && !is_function) break;  // another word
      fault = without_brackets(name.text, name.flow, values);
      return word;
    }
    word.flow = name.flow;
    word.arguments = values;
    word.arguments_at = end + name.text.size() + dropped;
    return word;
  }
  // Words of a block after a program number: O1000 G90.
  const bool is_block = rest.size() > 1 && !is_letter(rest[1]);
  if (is_block && word.label.front() != '<') return std::nullopt;
  fault = {fmt::format("'{}' is no O-word", rest),
           "use sub, call, return, if, elseif, else, while, do, repeat, break, continue or an end "
           "of them"};
  return word;
}

std::string_view name_of(Flow flow) {
  if (flow == Flow::do_while) return "while";
  for (const FlowName& name : flow_names)
    if (name.flow == flow) return name.text;
  return "";
}

}  // namespace lamplock::program_run
