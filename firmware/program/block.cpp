#include "firmware/program/block.hpp"

#include "firmware/program/power_list.hpp"

namespace lamplock::program {
namespace {

struct Code {
  std::uint16_t code;
  Group group;
  AxisUse use = AxisUse::none;
};

/// G codes times ten, in order.
constexpr Code g_codes[] = {
    Code{0, Group::motion, AxisUse::motion},
    Code{10, Group::motion, AxisUse::motion},
    Code{20, Group::motion, AxisUse::motion},
    Code{30, Group::motion, AxisUse::motion},
    Code{40, Group::once},
    Code{50, Group::motion, AxisUse::motion},
    Code{51, Group::motion, AxisUse::motion},
    Code{52, Group::motion, AxisUse::motion},
    Code{53, Group::motion},
    Code{90, Group::exact_stop},
    Code{100, Group::once, AxisUse::data},
    Code{170, Group::plane},
    Code{180, Group::plane},
    Code{190, Group::plane},
    Code{200, Group::units},
    Code{210, Group::units},
    Code{280, Group::once, AxisUse::data},
    Code{281, Group::once},
    Code{300, Group::once, AxisUse::data},
    Code{301, Group::once},
    Code{382, Group::motion, AxisUse::motion},
    Code{383, Group::motion, AxisUse::motion},
    Code{384, Group::motion, AxisUse::motion},
    Code{385, Group::motion, AxisUse::motion},
    Code{400, Group::cutter},
    Code{410, Group::cutter},
    Code{411, Group::cutter},
    Code{420, Group::cutter},
    Code{421, Group::cutter},
    Code{430, Group::tool_length},
    Code{431, Group::tool_length, AxisUse::tool_length},
    Code{432, Group::tool_length, AxisUse::tool_length},
    Code{490, Group::tool_length},
    Code{530, Group::once},
    Code{540, Group::system},
    Code{541, Group::system},
    Code{550, Group::system},
    Code{560, Group::system},
    Code{570, Group::system},
    Code{580, Group::system},
    Code{590, Group::system},
    Code{591, Group::system},
    Code{592, Group::system},
    Code{593, Group::system},
    Code{610, Group::path},
    Code{611, Group::path},
    Code{640, Group::path},
    Code{680, Group::rotation, AxisUse::rotation},
    Code{690, Group::rotation},
    Code{730, Group::motion, AxisUse::motion},
    Code{800, Group::motion},
    Code{810, Group::motion, AxisUse::motion},
    Code{820, Group::motion, AxisUse::motion},
    Code{830, Group::motion, AxisUse::motion},
    Code{850, Group::motion, AxisUse::motion},
    Code{860, Group::motion, AxisUse::motion},
    Code{890, Group::motion, AxisUse::motion},
    Code{900, Group::distance},
    Code{901, Group::arc_distance},
    Code{910, Group::distance},
    Code{911, Group::arc_distance},
    Code{920, Group::once, AxisUse::data},
    Code{921, Group::once},
    Code{922, Group::once},
    Code{923, Group::once},
    Code{930, Group::feed_mode},
    Code{940, Group::feed_mode},
    Code{950, Group::feed_mode},
    Code{980, Group::retract},
    Code{990, Group::retract},
};

constexpr Code m_codes[] = {
    Code{0, Group::stopping},    Code{1, Group::stopping},  Code{2, Group::stopping},
    Code{3, Group::spindle},     Code{4, Group::spindle},   Code{5, Group::spindle},
    Code{6, Group::tool_change}, Code{7, Group::coolant},   Code{8, Group::coolant},
    Code{9, Group::coolant},     Code{30, Group::stopping}, Code{48, Group::overrides},
    Code{49, Group::overrides},  Code{60, Group::stopping}, Code{61, Group::tool_change},
    Code{62, Group::io},         Code{63, Group::io},       Code{64, Group::io},
    Code{65, Group::io},         Code{66, Group::io},       Code{67, Group::io},
    Code{68, Group::io},         Code{70, Group::saving},   Code{71, Group::saving},
    Code{72, Group::saving},     Code{73, Group::saving},   Code{126, Group::pulses},
    Code{127, Group::pulses},    Code{128, Group::pulses},  Code{130, Group::beat_lock},
    Code{131, Group::beat_lock},
};

constexpr std::uint16_t no_motion = 800;
constexpr std::uint32_t max_code = 999;
constexpr std::int64_t one_million = 1'000'000;

template <std::size_t size>
const Code* find(const Code (&table)[size], std::uint32_t code) {
  std::size_t low = 0, high = size;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (table[middle].code < code)
      low = middle + 1;
    else
      high = middle;
  }
  return low < size && table[low].code == code ? &table[low] : nullptr;
}

/// G code times ten; more than max_code if there is no such code.
std::uint32_t tenfold(const Word& word) {
  constexpr std::uint32_t none = max_code + 1;
  if (word.mantissa < 0 || word.mantissa > std::int64_t{max_code} * one_million) return none;
  auto mantissa = static_cast<std::uint32_t>(word.mantissa);
  if (word.decimals == 0) return mantissa <= max_code ? mantissa * 10 : none;
  for (int i = word.decimals; i > 1; --i) {
    if (mantissa % 10 != 0) return none;
    mantissa /= 10;
  }
  return mantissa;
}

/// Axis of a letter; -1 if there is none.
constexpr int axis_of(char letter) {
  if (letter == 'A') return 3;
  return letter >= 'X' ? letter - 'X' : -1;
}
static_assert(axis_letters[index(axis_of('A'))] == 'A' && axis_letters[index(axis_of('Z'))] == 'Z');

/// Groups that a jog may set, besides G53.
constexpr bool may_jog(const Code& code) {
  return code.group == Group::units || code.group == Group::distance || code.code == 530;
}

}  // namespace

[[gnu::hot]] Fault Block::read(std::string_view line, int axes, Expressions& expressions,
                               bool jog) {
  WordReader reader(line);
  Word word;
  for (;;) {
    if (const Fault fault = reader.next(word)) {
      if (jog) return fault;
      if (const Fault other = read_other(line, fault, word, reader, expressions)) return other;
      if (word.letter == 0) continue;
    } else if (word.letter == 0) {
      if (reader.has_message()) ignored_ |= message_bit;
      return ignored_ == 0 ? Fault{} : check_ignored();
    }
    if (const Fault fault = add(word, axes, jog)) {
      if (!ignore_word(word, line, jog)) return fault;
      if (ignores(Ignored::m117)) return check_ignored();
    }
    if (word.letter != 'S') continue;
    if (const char next = reader.peek(); next != ':' && next != '*') continue;
    if (const Fault fault = add_powers(line, word, reader)) return fault;
  }
}

/// Reads what is not a word with a plain number: a word with an expression; an assignment or a
/// program number, with letter 0. O-words are an error of their own.
Fault Block::read_other(std::string_view line, const Fault& fault, Word& word, WordReader& reader,
                        Expressions& expressions) {
  if (is_o_word(line, word))
    return {GcodeError::o_word, word.letter == 'O' ? word.column : program_number_};
  if (fault.error == GcodeError::bad_number) {
    std::uint16_t index = word.column;
    if (!expressions.begins_at(line, index)) return fault;
    if (const Fault other = expressions.read_word(line, index, word)) return other;
    reader.go_to(index);
    return {};
  }
  if (ignore_program_number(reader)) return {};
  if (reader.peek() != '#') return fault;
  std::uint16_t index = reader.place();
  const Fault other = expressions.read_assignment(line, index);
  reader.go_to(index);
  return other;
}

/// O100 sub, O<name> call: letters follow an O word, or a name or an expression its letter.
bool Block::is_o_word(std::string_view line, const Word& word) const {
  if (word.letter == 0) return false;
  WordReader reader(line);
  reader.go_to(word.column);
  const char next = reader.peek();
  if (word.letter == 'O') return next == '<' || next == '#' || next == '[';
  const bool is_letter = (next >= 'A' && next <= 'Z') || (next >= 'a' && next <= 'z');
  return program_number_ != 0 && is_letter;
}

/// Whether the program works without a word that the machine does not know; then it is noted.
bool Block::ignore_word(const Word& word, std::string_view line, bool jog) {
  if (jog || word.mantissa < 0) return false;
  constexpr std::string_view message = "117";
  switch (word.letter) {
    case 'O':
      ignore(Ignored::program_number);
      program_number_ = word.column;
      return true;
    case 'D':
      ignore(Ignored::d);
      d_word_ = word;
      return true;
    case 'H':
      ignore(Ignored::h);
      h_word_ = word;
      return true;
    case 'M': {
      // The text of a message is not read; its first letters may look like digits of the code.
      std::string_view text = line;
      text.remove_prefix(word.column);
      if (!text.starts_with(message)) return false;
      if (text.size() > message.size() && text[message.size()] != ' ') return false;
      ignore(Ignored::m117);
      return true;
    }
    case 'G':
      break;
    default:
      return false;
  }
  const std::uint32_t code = tenfold(word);
  if (code != 150 && code != 500 && code != 970) return false;
  ignore(code == 150 ? Ignored::g15 : code == 500 ? Ignored::g50 : Ignored::g97);
  return true;
}

/// ":1000" is a program number, as O1000 is.
bool Block::ignore_program_number(WordReader& reader) {
  Word number;
  if (words_ != 0 || groups_ != 0 || ignored_ != 0) return false;
  if (!reader.take(':') || !reader.number(number)) return false;
  ignore(Ignored::program_number);
  return true;
}

/// With axes G50 is no end of scaling but a shift of coordinates, with S a limit of a lathe's
/// spindle: neither may be ignored.
Fault Block::check_ignored() const {
  if (ignores(Ignored::g50) && (axes_ != 0 || has('S')))
    return {GcodeError::unsupported, has('S') ? word('S').column : axis_column(axes_)};
  return {};
}

/// The S word was the first number of a list: the reader continues after it.
Fault Block::add_powers(std::string_view line, const Word& word, WordReader& reader) {
  line.remove_prefix(word.column);
  PowerList list(line);
  for (PowerRun run;; pieces_ += run.pieces, last_power_milli_ = run.speed_milli) {
    if (const GcodeError error = list.next(run); error != GcodeError::none)
      return {error, word.column};
    if (run.pieces == 0) break;
    if (pieces_ + run.pieces > PowerList::max_pieces)
      return {GcodeError::out_of_range, word.column};
  }
  if (list.size() > PowerList::max_characters) return {GcodeError::line_too_long, word.column};
  powers_ = {line.data(), list.size()};
  reader.go_to(static_cast<std::uint16_t>(word.column + list.size()));
  return {};
}

[[gnu::hot]] Fault Block::add(const Word& word, int axes, bool jog) {
  if (word.letter == 'G') return add_g(word, jog);
  if (word.letter != 'M') return add_value(word, axes, jog);
  return jog ? Fault{GcodeError::bad_jog_word, word.column} : add_m(word);
}

[[gnu::hot]] Fault Block::add_g(const Word& word, bool jog) {
  // The first of the table are G0 to G3, those of nearly all lines.
  constexpr std::uint32_t first_codes = 4;
  static_assert(g_codes[first_codes - 1].code == 10 * (first_codes - 1));
  const bool is_first =
      word.decimals == 0 && static_cast<std::uint64_t>(word.mantissa) < first_codes;
  const Code* const code =
      is_first ? &g_codes[static_cast<std::uint32_t>(word.mantissa)] : find(g_codes, tenfold(word));
  if (code == nullptr) return {GcodeError::unsupported, word.column};
  if (jog && !may_jog(*code)) return {GcodeError::bad_jog_word, word.column};
  return add_code(code->group, code->code, code->use, word.column);
}

Fault Block::add_m(const Word& word) {
  std::uint32_t number = 0;
  const GcodeError error = whole(word, number);
  if (error == GcodeError::not_integer) return {error, word.column};
  const Code* const code = error == GcodeError::none ? find(m_codes, number) : nullptr;
  if (code == nullptr) return {GcodeError::unsupported, word.column};
  return add_code(code->group, code->code, code->use, word.column);
}

/// A motion may be beside G80, as in the first lines of many programs: G80 then has no effect.
bool Block::replaces_no_motion(Group group, std::uint16_t code) const {
  return group == Group::motion && this->code(group) == no_motion && code != no_motion;
}

[[gnu::hot]] Fault Block::add_code(Group group, std::uint16_t code, AxisUse use,
                                   std::uint16_t column) {
  if (has(group) && !replaces_no_motion(group, code)) {
    const bool beside_motion =
        group == Group::motion && code == no_motion && this->code(group) != no_motion;
    return beside_motion ? Fault{} : Fault{GcodeError::modal_conflict, column};
  }
  if (use != AxisUse::none) {
    if (axis_use_ != AxisUse::none) return {GcodeError::axis_conflict, column};
    axis_use_ = use;
  }
  groups_ |= 1u << static_cast<int>(group);
  codes_[static_cast<std::size_t>(group)] = code;
  columns_[static_cast<std::size_t>(group)] = column;
  return {};
}

[[gnu::hot]] Fault Block::add_value(const Word& word, int axes, bool jog) {
  const char letter = word.letter;
  if (slot(letter) == no_slot) return {GcodeError::unsupported, word.column};
  const int axis = axis_of(letter);
  const bool is_axis = axis >= 0;
  if (axis >= axes) return {GcodeError::unsupported, word.column};
  if (jog && !is_axis && letter != 'F' && letter != 'N')
    return {GcodeError::bad_jog_word, word.column};
  if (has(letter)) return {GcodeError::word_repeated, word.column};
  const bool never_negative = letter == 'F' || letter == 'N' || letter == 'S' || letter == 'T';
  if (never_negative && word.mantissa < 0) return {GcodeError::negative_value, word.column};
  words_ |= bit(letter);
  unused_ |= bit(letter);
  if (is_axis) axes_ |= 1u << axis;
  // By members: a call that copies 16 bytes takes four times as long.
  Word& value = values_[slot(letter)];
  value.mantissa = word.mantissa;
  value.column = word.column;
  value.letter = letter;
  value.decimals = word.decimals;
  return {};
}

std::uint16_t Block::first_code() const {
  std::uint16_t first = no_code;
  for (std::size_t i = 0; i < groups; ++i)
    if ((groups_ >> i & 1u) != 0 && columns_[i] < first) first = columns_[i];
  return first;
}

std::uint16_t Block::axis_column(std::uint32_t axes) const {
  std::uint16_t first = no_code;
  for (int i = 0; i < max_axes; ++i)
    if ((axes_ & axes & 1u << i) != 0 && axis(i).column < first) first = axis(i).column;
  return first;
}

[[gnu::hot]] void Block::take_axes() {
  for (const char letter : axis_letters) unused_ &= ~bit(letter);
}

[[gnu::hot]] bool Block::take(char letter) {
  const bool fresh = (unused_ & bit(letter)) != 0;
  unused_ &= ~bit(letter);
  return fresh;
}

[[gnu::hot]] std::uint16_t Block::first_unused() const {
  if (unused_ == 0) return 0;
  std::uint16_t first = no_code;
  for (std::size_t i = 0; i < values_.size(); ++i)
    if ((unused_ >> i & 1u) != 0 && values_[i].column < first) first = values_[i].column;
  return first;
}

}  // namespace lamplock::program
