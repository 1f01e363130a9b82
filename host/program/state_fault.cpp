#include "host/program/state_fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "firmware/program/modal.hpp"
#include "firmware/program/statement.hpp"
#include "host/link/program_lines.hpp"
#include "host/printable.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

using program::Motion;
using program::Plane;

constexpr double tenths_of_code = 10;

/// A line and the state before it.
class LineInState {
 public:
  LineInState(std::string_view line, std::string_view word, const program::Interpreter& interpreter)
      : line_(link::text_to_send(line)),
        words_(words_of(line_)),
        fault_words_(words_of(word)),
        word_(word),
        interpreter_(interpreter),
        state_(interpreter.state()) {}

  std::optional<LineFault> unsupported() const {
    if (fault_words_.empty()) return std::nullopt;
    const ProgramWord& word = fault_words_.front();
    if (word.letter == 'D' || word.letter == 'H') return negative_number(word);
    if (word.is('M', 72) && !interpreter_.saved().valid)
      return LineFault{fmt::format("{} restores a modal state, and no M70 has saved one", quoted()),
                       "write M70 where the state is to be saved"};
    if (state_.nurbs.count != 0 && (word.letter == 'G' || word.letter == 'M'))
      return LineFault{
          fmt::format("{} must not be within a NURBS, which lasts from G5.2 to G5.3", quoted()),
          "write G5.3 with the feed before it"};
    if (is_curve_in_xy() && plane() != Plane::xy)
      return LineFault{fmt::format("{}: curves of G5 to G5.3 are in the plane of G17", quoted()),
                       "write G17 before it"};
    if (is_cycle() && is_inverse_time())
      return LineFault{fmt::format("{}: a cycle has no time of its own, as G93 requires", quoted()),
                       "write G94 with a feed before it"};
    if (has('G', 10)) return of_offsets(word);
    return std::nullopt;
  }

  /// A cycle with a bottom above its retract level.
  std::optional<LineFault> bad_target() const {
    if (!is_cycle()) return std::nullopt;
    const char normal = axis_letters[program::axes_of(plane()).normal];
    const std::optional<double> bottom = level(normal, state_.cycle.depth_e7),
                                retract = level('R', state_.cycle.retract_e7);
    const std::string levels_remedy =
        fmt::format("R is the level at which the feed begins, and {} the bottom below it", normal);
    if (is_relative() && bottom && *bottom > 0)
      return LineFault{fmt::format("{}{} is above the retract level R: in G91 it counts from there",
                                   normal, *bottom),
                       fmt::format("write a negative {}", normal)};
    if (!is_relative() && bottom && retract && *bottom > *retract)
      return LineFault{fmt::format("the bottom of the hole, {}{}, is above the retract level R{}",
                                   normal, *bottom, *retract),
                       levels_remedy};
    if (bottom && retract) return std::nullopt;
    return LineFault{
        "the bottom of the hole is above the retract level R, or the place is too far away",
        levels_remedy};
  }

  /// What cutter compensation excludes, if it is not yet on, or if G93 is in the line.
  std::optional<LineFault> compensation() const {
    const bool is_on = state_.modal.cutter != program::Cutter::off;
    if (is_on && !has('G', 93)) return std::nullopt;
    if (is_inverse_time())
      return LineFault{
          "cutter compensation (G41, G42) is not possible with G93: its moves have no "
          "time of their own",
          is_on ? "write G40 before it" : "write G94 with a feed before it"};
    if (has('M', 130) || state_.modal.beat_lock != program::BeatLock::off)
      return LineFault{"cutter compensation (G41, G42) is not possible with points on the beat",
                       "write M131 before it"};
    return LineFault{
        fmt::format("{} is not possible in a line that begins cutter compensation", quoted()),
        "write G41 or G42 in the line of a G0 or G1 without it"};
  }

 private:
  std::string quoted() const { return fmt::format("'{}'", printable(word_)); }

  bool has(char letter, double number) const {
    return std::ranges::any_of(words_, [&](const ProgramWord& w) { return w.is(letter, number); });
  }

  const ProgramWord* word_of(char letter) const {
    const auto word =
        std::ranges::find_if(words_, [&](const ProgramWord& one) { return one.letter == letter; });
    return word == words_.end() ? nullptr : &*word;
  }

  Plane plane() const {
    if (has('G', 17)) return Plane::xy;
    if (has('G', 18)) return Plane::zx;
    return has('G', 19) ? Plane::yz : state_.modal.plane;
  }
  bool is_relative() const { return !has('G', 90) && (has('G', 91) || state_.modal.relative); }
  bool is_in_inches() const { return !has('G', 21) && (has('G', 20) || state_.modal.inches); }
  bool is_inverse_time() const {
    return has('G', 93) || (!has('G', 94) && !has('G', 95) &&
                            state_.modal.feed_mode == program::FeedMode::inverse_time);
  }

  /// The motion of the line: its own, or the one that is in force.
  Motion motion() const {
    constexpr double motions[] = {0,    1,    2,  3,  5,  5.1, 5.2, 38.2, 38.3,
                                  38.4, 38.5, 73, 81, 82, 83,  85,  86,   89};
    for (const double code : motions)
      if (has('G', code)) return static_cast<Motion>(std::lround(code * tenths_of_code));
    return has('G', 80) ? Motion::none : state_.modal.motion;
  }
  bool is_cycle() const { return motion() != Motion::none && program::is_cycle(motion()); }
  bool is_curve_in_xy() const {
    return motion() == Motion::spline || motion() == Motion::parabola || motion() == Motion::nurbs;
  }

  /// A level of a cycle in the unit of the line; nothing if it is an expression.
  std::optional<double> level(char letter, std::int64_t kept_e7) const {
    if (const ProgramWord* word = word_of(letter)) return word->number();
    const std::int64_t unit_e7 = is_in_inches() ? program::inch_e7 : program::one_e7;
    return static_cast<double>(kept_e7) / static_cast<double>(unit_e7);
  }

  std::optional<LineFault> negative_number(const ProgramWord& word) const {
    if (word.number().value_or(0) >= 0) return std::nullopt;
    const bool is_diameter = word.letter == 'D' && (has('G', 41.1) || has('G', 42.1));
    if (is_diameter)
      return LineFault{fmt::format("{}: a diameter must not be negative", quoted()),
                       "write it without its sign: G41.1 is left of the contour, G42.1 right"};
    return LineFault{fmt::format("{}: the number of a tool must not be negative", quoted()),
                     "write a number of the tool table, 0 or higher"};
  }

  std::optional<LineFault> of_offsets(const ProgramWord& word) const {
    if (word.letter == 'R')
      return LineFault{fmt::format("{}: only G10 L1, L10, L11 and L2 have an R word", quoted()),
                       "rotate the coordinate system with G10 L2 P R"};
    if (word.letter == 'L')
      return LineFault{fmt::format("{}: G10 has L1, L2, L10, L11 and L20", quoted()),
                       "correct the number"};
    return std::nullopt;
  }

  std::string line_;
  std::vector<ProgramWord> words_, fault_words_;
  std::string_view word_;
  const program::Interpreter& interpreter_;
  const program::State& state_;
};

}  // namespace

std::optional<LineFault> describe_state_fault(std::string_view line, std::string_view word,
                                              GcodeError error,
                                              const program::Interpreter& interpreter) {
  const LineInState seen(line, word, interpreter);
  if (error == GcodeError::unsupported) return seen.unsupported();
  if (error == GcodeError::compensation_on) return seen.compensation();
  return error == GcodeError::bad_target ? seen.bad_target() : std::nullopt;
}

}  // namespace lamplock::program_run
