#include "host/program/skipped_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "firmware/program/statement.hpp"
#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/machine_results.hpp"

namespace lamplock::program_run {
namespace {

using program::Motion;

/// Codes whose effect can be restored, or is over, or that have none on later lines. Not among
/// them: G10, G92 and G92.3 (offsets, which may depend on the place of the machine), G28.1 and
/// G30.1, probes, M66 (an input), user commands.
constexpr std::array known_g{
    0.,  1.,  2.,  3.,  4.,   5.,   5.1,  5.2,  5.3,  9.,   15., 17., 18., 19., 20.,  21.,
    28., 30., 40., 41., 41.1, 42.,  42.1, 43.,  43.1, 43.2, 49., 50., 53., 54., 54.1, 55.,
    56., 57., 58., 59., 59.1, 59.2, 59.3, 61.,  61.1, 64.,  68., 69., 73., 80., 81.,  82.,
    83., 85., 86., 89., 90.,  90.1, 91.,  91.1, 92.1, 92.2, 93., 94., 95., 97., 98.,  99.};
constexpr std::array known_m{0.,  1.,  2.,  3.,   4.,   5.,   6.,   7.,   8.,  9.,  30.,
                             48., 49., 60., 61.,  62.,  63.,  64.,  65.,  67., 68., 70.,
                             71., 72., 73., 117., 126., 127., 128., 130., 131.};
/// Codes that begin a motion of their own, or end the motion mode.
constexpr std::array motion_g{0.,   1.,  2.,  3.,  5.,  5.1, 5.2, 38.2, 38.3, 38.4,
                              38.5, 73., 80., 81., 82., 83., 85., 86.,  89.};
/// Codes whose axis words are no places of the motion mode.
constexpr std::array placeless_g{10., 28., 28.1, 30., 30.1, 43.1, 68., 92.};

constexpr std::size_t z_axis = 2;
constexpr std::string_view begin_here = "begin at this line or before it";

template <class Codes>
bool has_any(const std::vector<ProgramWord>& words, char letter, const Codes& codes) {
  return std::ranges::any_of(words, [&](const ProgramWord& word) {
    return word.letter == letter && std::ranges::count(codes, word.number().value_or(-1)) != 0;
  });
}

std::size_t axis_of(const ProgramWord& word) { return axis_letters.find(word.letter); }
bool is_axis(const ProgramWord& word) { return axis_of(word) != std::string_view::npos; }

/// The words of a line without the text of M117.
std::vector<ProgramWord> words_without_text(std::string_view line) {
  auto words = words_of(line);
  const auto text = std::ranges::find_if(words, [](const auto& word) { return word.is('M', 117); });
  if (text != words.end()) words.erase(text + 1, words.end());
  return words;
}

}  // namespace

SkippedLines::SkippedLines(const settings::Values& values, const std::string& file,
                           const std::optional<BoardState>& state)
    : file_(file),
      axes_(static_cast<std::size_t>(values.whole(settings::Id::axes))),
      knows_offsets_(state.has_value()),
      options_(program_options(values)),
      loaded_tool_(knows_tool(state)),
      tool_(state, parameters_) {
  if (state) begin_with(*state, interpreter_, parameters_);
}

void SkippedLines::refuse(std::size_t line, const std::string& what,
                          std::string_view remedy) const {
  throw Error(Exit::bad_input, fmt::format("{}:{}", file_, line), what, std::string(remedy));
}

void SkippedLines::pass(const link::ProgramLine& line) {
  const auto words = words_without_text(line.text);
  check(line, words);
  const program::State before = interpreter_.state();
  run(line);
  const auto plane = program::axes_of(before.modal.plane);
  const bool moves = std::ranges::any_of(words, [&plane](const ProgramWord& word) {
    return is_axis(word) && std::cmp_not_equal(axis_of(word), plane.normal);
  });
  is_beside_ = (before.modal.cutter != program::Cutter::off || is_beside_) && !moves;
  uses_rotation_ |= has_any(words, 'G', std::array{68., 69.});
  uses_overrides_ |= has_any(words, 'M', std::array{48., 49.});
  for (const ProgramWord& word : words)
    if (word.is('G', 92.1) || word.is('G', 92.2)) shift_ = trimmed(word.text);
  if (!tool_.pass(words, interpreter_.modal()))
    refuse(line.number, "--from cannot leave out an H with an expression", begin_here);
  note_places(line, words, before);
}

void SkippedLines::check(const link::ProgramLine& line, const Words& words) {
  if (line.text.starts_with('$'))
    refuse(line.number, "--from cannot leave a line for the board out", begin_here);
  for (const ProgramWord& word : words) {
    const bool may_be_left_out = word.letter == 'G'   ? has_any({word}, 'G', known_g)
                                 : word.letter == 'M' ? has_any({word}, 'M', known_m)
                                                      : true;
    if (!may_be_left_out)
      refuse(line.number, fmt::format("--from cannot leave '{}' out", trimmed(word.text)),
             begin_here);
  }
  if (const std::string_view result = result_in(line.text); !result.empty())
    refuse(line.number, fmt::format("{} is not known before the machine runs the program", result),
           begin_here);
  if (const std::string use = loaded_tool_.pass(line.text); !use.empty())
    refuse(line.number,
           fmt::format("{} needs the tool in the spindle, which the board does not report", use),
           unknown_tool_remedy);
}

void SkippedLines::run(const link::ProgramLine& line) {
  if (const program::Fault fault = interpreter_.run(line.text))
    refuse(line.number, link::error_text(static_cast<int>(fault.error)), "correct the line");
  for (program::Action action; interpreter_.next(action);) outputs_.pass(action);
}

void SkippedLines::note_places(const link::ProgramLine& line, const Words& words,
                               const program::State& before) {
  lose_unknown(words, before);
  if (has_any(words, 'G', std::array{28., 30., 53.})) return note_machine_place(words);
  if (has_any(words, 'G', placeless_g)) return;
  for (const ProgramWord& word : words) {
    if (!is_axis(word)) continue;
    const std::size_t axis = axis_of(word);
    if (interpreter_.modal().relative && !placed_[axis])
      refuse(line.number,
             fmt::format("moves {} by a distance, from an unknown position", word.letter),
             begin_here);
    placed_[axis] = true;
    lost_[axis] = false;
  }
}

/// G28, G30 and G53 end at a place of the machine, whose coordinates in the program need the
/// offsets.
void SkippedLines::note_machine_place(const Words& words) {
  const bool has_axes = std::ranges::any_of(words, is_axis);
  const bool moves_all = !has_axes && !has_any(words, 'G', std::array{53.});
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const bool moves = moves_all || std::ranges::any_of(words, [axis](const ProgramWord& word) {
                         return axis_of(word) == axis;
                       });
    if (!moves) continue;
    placed_[axis] = knows_offsets_;
    lost_[axis] = !knows_offsets_;
  }
  lose_turned(interpreter_.state());
}

/// A new offset changes the coordinates of the place where the machine is.
void SkippedLines::lose_unknown(const Words& words, const program::State& before) {
  const program::State& after = interpreter_.state();
  if (!(before.modal.rotation == after.modal.rotation) ||
      !(before.system_rotation == after.system_rotation)) {
    lose_turned(before);
    lose_turned(after);
  }
  if (knows_offsets_) return;
  if (has_any(words, 'G', std::array{43., 43.1, 43.2, 49.})) lose(z_axis);
  if (before.modal.system != after.modal.system || has_any(words, 'G', std::array{92.1, 92.2}))
    for (std::size_t axis = 0; axis < placed_.size(); ++axis) lose(axis);
}

/// Both coordinates in a rotated plane depend on both of the machine.
void SkippedLines::lose_turned(const program::State& state) {
  for (const auto& [first, second] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
    const bool is_turned =
        (state.modal.rotation.active() && state.modal.rotation.turns(first, second)) ||
        (state.system_rotation.active() && state.system_rotation.turns(first, second));
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    if (!is_turned || (placed_[a] && placed_[b])) continue;
    lose(a);
    lose(b);
  }
}

void SkippedLines::lose(std::size_t axis) {
  lost_[axis] = lost_[axis] || placed_[axis];
  placed_[axis] = false;
}

void SkippedLines::require_start(const std::vector<link::ProgramLine>& rest) const {
  const std::size_t first = rest.front().number;
  require_modes(first);
  for (std::size_t axis = 0; axis < lost_.size(); ++axis)
    if (lost_[axis])
      refuse(first,
             fmt::format("the position of {} before this line is not known", axis_letters[axis]),
             fmt::format("begin after an absolute move of {}, or before the last change of offsets",
                         axis_letters[axis]));
  if (tool_.has_length_of_operator(interpreter_.modal()))
    refuse(first, "the tool length after the M6 before this line is the operator's, not known here",
           "begin at or before this M6, or after a G43 or G49 that follows it");
  require_motion(rest);
}

/// Refuses to begin within what only its own begin can restore.
void SkippedLines::require_modes(std::size_t first) const {
  const program::Modal& modal = interpreter_.modal();
  if (modal.cutter != program::Cutter::off || is_beside_)
    refuse(first, "continues a path with cutter compensation",
           "begin at or before its G41 or G42, or after the first move in the plane that follows "
           "its G40");
  if (interpreter_.state().nurbs.count != 0)
    refuse(first, "is within a NURBS", "begin at or before its G5.2, or after its G5.3");
  if (modal.rotation.active())
    refuse(first, "is within a rotation", "begin at or before its G68, or after its G69");
  if (modal.beat_lock != program::BeatLock::off)
    refuse(first, "is within points on the beat", "begin at or before its M130, or after its M131");
  if (interpreter_.saved().valid)
    refuse(first, "may restore modes that a skipped line saved",
           "begin at or before its M70 or M73, or after an M71");
}

/// Refuses motions of the rest that need more than their code.
void SkippedLines::require_motion(const std::vector<link::ProgramLine>& rest) const {
  const Motion motion = interpreter_.modal().motion;
  const bool is_line = motion == Motion::line;
  if (motion == Motion::rapid || motion == Motion::none) return;
  if (is_line && !lacks_feed(interpreter_.modal())) return;
  for (const link::ProgramLine& line : rest) {
    const auto words = words_without_text(line.text);
    if (has_any(words, 'G', motion_g) || has_any(words, 'M', std::array{2., 30.})) return;
    const bool moves = std::ranges::any_of(words, [](const ProgramWord& word) {
      return is_axis(word) || word.letter == 'I' || word.letter == 'J' || word.letter == 'K';
    });
    if (moves && !has_any(words, 'G', placeless_g))
      refuse(line.number,
             is_line ? "continues G1, for which no feed is in force"
                     : "continues a curve or cycle of the lines before",
             "begin at a line with G0, G1, G2 or G3");
  }
}

}  // namespace lamplock::program_run
