#include "host/program/process_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "firmware/program/message.hpp"
#include "host/letter_case.hpp"
#include "host/link/program_lines.hpp"
#include "host/printable.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/program_words.hpp"
#include "host/suggestion.hpp"
#include "host/text.hpp"
#include "host/units.hpp"

namespace lamplock::program_run {
namespace {

constexpr std::string_view family = "_material", separators = " \t";

/// A process parameter: its name, and the field of a setting that it needs.
struct NameRow {
  std::string_view name, field;
};
constexpr std::array name_rows{
    NameRow{"_material_feed", "feed_mm_min"},       NameRow{"_material_power", "power_w"},
    NameRow{"_material_watts", "power_w"},          NameRow{"_material_frequency", "frequency_hz"},
    NameRow{"_material_passes", "passes"},          NameRow{"_material_kerf", "kerf_mm"},
    NameRow{"_material_thickness", "thickness_mm"}, NameRow{"_material_air", "air"},
};

/// A process parameter in a line.
struct Reference {
  std::size_t begin = 0, end = 0;  ///< of `#<name>`, or of `EXISTS[#<name>]`
  std::size_t hash = 0;            ///< place of its #
  std::string name{};              ///< in lower case, without blanks
  bool exists = false, is_assigned = false, in_message = false;
  std::size_t comment = 0;  ///< begin of its message
};

std::string lower_without_blanks(std::string_view text) {
  std::string name;
  for (const char c : text)
    if (separators.find(c) == std::string_view::npos) name += lower_case(c);
  return name;
}

/// Index of the last character before this one that is no blank; npos if there is none.
std::size_t before(std::string_view line, std::size_t index) {
  return index == 0 ? std::string_view::npos : line.find_last_not_of(separators, index - 1);
}
char char_before(std::string_view line, std::size_t index) {
  const std::size_t at = before(line, index);
  return at == std::string_view::npos ? '\0' : line[at];
}
char char_from(std::string_view line, std::size_t index) {
  const std::size_t at = line.find_first_not_of(separators, index);
  return at == std::string_view::npos ? '\0' : line[at];
}

/// Makes `EXISTS[#<name>]` of a reference, if it is in one.
void take_exists(std::string_view line, Reference& reference) {
  constexpr std::string_view word = "[stsixe";
  if (char_from(line, reference.end) != ']') return;
  std::size_t at = reference.begin;
  for (const char c : word) {
    at = before(line, at);
    if (at == std::string_view::npos || lower_case(line[at]) != c) return;
  }
  reference.exists = true;
  reference.begin = at;
  reference.end = line.find(']', reference.end) + 1;
}

/// The reference whose # is here; nothing if another parameter is.
std::optional<Reference> reference_at(std::string_view line, std::size_t hash) {
  const std::size_t open = line.find_first_not_of(separators, hash + 1);
  if (open == std::string_view::npos || line[open] != '<') return std::nullopt;
  const std::size_t close = line.find('>', open);
  if (close == std::string_view::npos) return std::nullopt;
  Reference found{hash, close + 1, hash,
                  lower_without_blanks(line.substr(open + 1, close - open - 1))};
  const bool is_family = found.name == family || found.name.starts_with(std::string(family) + "_");
  if (!is_family) return std::nullopt;
  found.is_assigned = char_from(line, found.end) == '=' && char_before(line, hash) != '#';
  return found;
}

/// Whether a comment has values: DEBUG and PRINT.
bool shows_values(std::string_view comment) {
  const std::string begin = lower_without_blanks(comment.substr(0, comment.find(',') + 1));
  return begin == "debug," || begin == "print,";
}

/// Adds the references of the message between these indices.
void add_of_message(std::string_view line, std::size_t begin, std::size_t end,
                    std::vector<Reference>& found) {
  if (!shows_values(line.substr(begin + 1, end - begin - 1))) return;
  for (std::size_t i = line.find('#', begin); i < end; i = line.find('#', i + 1)) {
    auto one = reference_at(line, i);
    if (!one || one->end > end) continue;
    one->in_message = true;
    one->comment = begin;
    one->is_assigned = false;
    found.push_back(*one);
  }
}

std::vector<Reference> references_in(std::string_view line) {
  std::vector<Reference> found;
  if (line.find('<') == std::string_view::npos || trimmed(line).starts_with('$')) return found;
  for (std::size_t i = 0; i < line.size() && line[i] != ';'; ++i) {
    if (line[i] == '(') {
      const std::size_t end = std::min(line.find(')', i), line.size());
      add_of_message(line, i, end, found);
      i = end;
    } else if (line[i] == '#') {
      auto one = reference_at(line, i);
      if (!one) continue;
      i = one->end - 1;
      take_exists(line, *one);
      found.push_back(*one);
    }
  }
  return found;
}

template <class Refusal = ProgramError>
[[noreturn]] void refuse(std::string_view line, const Reference& reference, const LinePlace& place,
                         const std::string& what, const std::string& remedy) {
  const std::size_t own = reference.hash + 1, column = place.column ? place.column(own) : own;
  const std::size_t end = line.find('>', reference.hash) + 1;
  throw Refusal(
      ProgramPlace{place.file, place.line, column},
      fmt::format("'{}': {}", printable(line.substr(reference.hash, end - reference.hash)), what),
      remedy);
}

const NameRow& row_of(std::string_view line, const Reference& reference, const LinePlace& place) {
  const auto found = std::ranges::find(name_rows, reference.name, &NameRow::name);
  if (found != name_rows.end()) {
    if (reference.is_assigned)
      refuse(line, reference, place, "a process parameter cannot be assigned",
             "use a name that does not begin with _material");
    return *found;
  }
  std::vector<std::string> names;
  names.reserve(name_rows.size());
  for (const NameRow& row : name_rows) names.push_back(fmt::format("#<{}>", row.name));
  refuse(line, reference, place, "there is no such process parameter",
         did_you_mean(fmt::format("#<{}>", reference.name), names,
                      fmt::format("use one of {}", fmt::join(names, ", "))));
}

std::optional<double> value_of(const NameRow& row, const ProcessValues& values, bool inches,
                               double max_speed_s) {
  const double unit = inches ? mm_per_inch : 1;
  if (row.name == "_material_feed") return values.feed_mm_min / unit;
  if (row.name == "_material_power") return values.power_share * max_speed_s;
  if (row.name == "_material_watts") return values.power_w;
  if (row.name == "_material_frequency") return values.frequency_hz;
  if (row.name == "_material_passes") return values.passes;
  if (row.name == "_material_air") return values.air ? 1 : 0;
  std::optional<double> length =
      row.name == "_material_kerf" ? values.kerf_mm : values.thickness_mm;
  if (length) *length /= unit;
  return length;
}

[[noreturn]] void refuse_without_material(std::string_view line, const Reference& reference,
                                          const LinePlace& place) {
  refuse<NoMaterial>(line, reference, place, "no material is chosen",
                     "choose one (--material NAME); lamplock material list has the names");
}

/// A number of a word: seven decimals.
std::string number_text(double value) {
  std::string text = fmt::format("{:.7f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// The value as a message shows it at this place: by the formats before it in the comment.
std::string message_text(std::string_view comment_before, const std::string& number) {
  std::string text = "(PRINT,";
  for (const char c : comment_before.substr(comment_before.find(',') + 1))
    text += c == '#' || c == '(' ? '.' : c;
  program::Parameters parameters;
  const program::Options options;
  program::Interpreter interpreter(parameters, options);
  interpreter.run("#1=" + number);
  const auto shown = [&interpreter](const std::string& message) {
    TextLine line;
    std::string_view rest = message;
    interpreter.take_message(rest, line);
    return std::string(line.view());
  };
  const std::string before = shown(text + "|)"), after = shown(text + "|#1)");
  return after.substr(std::min(before.size(), after.size()));
}

/// The text that replaces a reference; brackets separate it from a digit beside it.
std::string text_for(std::string_view line, const Reference& reference, const std::string& number) {
  if (reference.in_message)
    return message_text(line.substr(reference.comment, reference.begin - reference.comment),
                        number);
  const auto joins = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  const bool is_apart =
      !joins(char_before(line, reference.begin)) && !joins(char_from(line, reference.end));
  std::string text = is_apart ? number : "[" + number + "]";
  text.resize(std::max(text.size(), reference.end - reference.begin), ' ');
  return text;
}

bool reads_by_exists(std::string_view program) {
  while (!program.empty())
    for (const Reference& reference : references_in(take_line(program)))
      if (reference.exists) return true;
  return false;
}

}  // namespace

bool has_process_values(std::string_view text) {
  while (!text.empty())
    if (!references_in(take_line(text)).empty()) return true;
  return false;
}

void check_process_values(std::string_view program, const std::string& file,
                          const ProcessValues* values) {
  program = without_byte_order_mark(program);
  const bool asks = has_flow(program) && reads_by_exists(program);
  for (std::size_t number = 1; !program.empty(); ++number) {
    const std::string_view line = take_line(program);
    for (const Reference& reference : references_in(line)) {
      (void)row_of(line, reference, {file, number});
      if (values == nullptr && !reference.exists && !asks)
        refuse_without_material(line, reference, {file, number});
    }
  }
}

std::string insert_process_values(std::string_view line, const ProcessValues* values, bool inches,
                                  double max_speed_s, const LinePlace& place) {
  const std::vector<Reference> references = references_in(line);
  std::string result;
  std::size_t copied = 0;
  for (const Reference& reference : references) {
    const NameRow& row = row_of(line, reference, place);
    if (values == nullptr && !reference.exists) refuse_without_material(line, reference, place);
    const auto value =
        values == nullptr ? std::nullopt : value_of(row, *values, inches, max_speed_s);
    if (!value && !reference.exists)
      refuse(line, reference, place,
             fmt::format("the material library has no {} for {}", row.field, values->title),
             row.name == "_material_thickness"
                 ? "add --thickness MM"
                 : fmt::format("add it: {} {}=VALUE", values->edit, row.field));
    result += line.substr(copied, reference.begin - copied);
    result +=
        text_for(line, reference, reference.exists ? (value ? "1" : "0") : number_text(*value));
    copied = reference.end;
  }
  return result += line.substr(copied);
}

bool is_in_inches(std::string_view line, bool inches_before) {
  constexpr int inch_code = 20, mm_code = 21;
  const std::string text = link::text_to_send(line);
  for (const ProgramWord& word : words_of(text)) {
    if (word.is('G', inch_code)) return true;
    if (word.is('G', mm_code)) return false;
  }
  return inches_before;
}

std::string with_process_values(std::string_view program, const std::string& file,
                                const ProcessValues* values, const settings::Values& settings,
                                const std::optional<BoardState>& state) {
  program::Parameters parameters;
  const program::Options options = program_options(settings);
  program::Interpreter interpreter(parameters, options);
  if (state) begin_with(*state, interpreter, parameters);
  const double max_speed_s = in_units(settings, settings::Id::max_spindle_speed);
  program = without_byte_order_mark(program);
  std::string result;
  for (std::size_t number = 1; !program.empty(); ++number) {
    const std::string_view line = take_line(program);
    const bool inches = is_in_inches(line, interpreter.modal().inches);
    const std::string text =
        insert_process_values(line, values, inches, max_speed_s, {file, number});
    // A line that the interpreter refuses is refused again when the program is checked or sent.
    if (!trimmed(text).starts_with('$') && !interpreter.run(text))
      for (program::Action action; interpreter.next(action);) continue;
    result += text + "\n";
  }
  return result;
}

}  // namespace lamplock::program_run
