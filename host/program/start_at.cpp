#include "host/program/start_at.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "firmware/program/interpreter.hpp"
#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/mode_words.hpp"
#include "host/program/program_words.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {
namespace {

using program::FeedMode;
using program::Motion;
using program::PathMode;
using program::Plane;
using program::Spindle;

/// Codes whose effect the preamble can reproduce, or that have no effect on later lines.
constexpr std::array known_g{0.,   1.,   2.,   3.,   4.,   5.,  5.1, 9.,  17., 18., 19.,
                             20.,  21.,  40.,  41.1, 42.1, 54., 55., 56., 57., 58., 59.,
                             59.1, 59.2, 59.3, 61.,  61.1, 64., 73., 80., 81., 82., 83.,
                             90.,  90.1, 91.,  91.1, 93.,  94., 95., 98., 99.};
constexpr std::array known_m{0., 1., 3., 4., 5., 6., 7., 8., 9., 60.};

/// The skipped lines: their modal state, and the axes whose position they define.
class Skipped {
 public:
  Skipped(const settings::Values& values, const std::string& file,
          const std::optional<BoardState>& state)
      : file_(file), options_(program_options(values)), interpreter_(parameters_, options_) {
    if (state) begin_with(*state, interpreter_, parameters_);
  }

  void pass(const link::ProgramLine& line) {
    const auto words = words_of(line.text);
    check(line, words);
    const bool was_beside = interpreter_.modal().cutter != program::Cutter::off;
    if (const program::Fault fault = interpreter_.run(line.text))
      refuse(line.number, link::error_text(static_cast<int>(fault.error)), "correct the line");
    for (program::Action action; interpreter_.next(action);) {
    }
    const bool moves = std::any_of(words.begin(), words.end(), [](const ProgramWord& word) {
      return axis_letters.find(word.letter) != std::string_view::npos;
    });
    is_beside_ = (was_beside || is_beside_) && !moves;
    for (const ProgramWord& word : words) note_axis(line, word);
  }

  /// Refuses motions of the first line that need more than their code.
  void require_motion(const link::ProgramLine& first) const {
    if (interpreter_.modal().cutter != program::Cutter::off || is_beside_)
      refuse(first.number, "continues a path with cutter compensation",
             "begin at or before its G41 or G42, or after the first move that follows its G40");
    const Motion motion = interpreter_.modal().motion;
    if (motion == Motion::rapid || motion == Motion::line || motion == Motion::none) return;
    for (const ProgramWord& word : words_of(first.text))
      if (word.is('G', 0) || word.is('G', 1) || word.is('G', 2) || word.is('G', 3)) return;
    refuse(first.number, "continues a curve or cycle of the lines before",
           "begin at a line with G0, G1, G2 or G3");
  }

  std::vector<std::string> preamble() const {
    std::vector<std::string> lines{"M5", "G21 G90 G94 G80" + codes()};
    add_parameters(lines);
    for (const std::string_view axes : {"XYA", "Z"})
      if (const std::string place = place_of(axes); !place.empty()) lines.push_back("G0" + place);
    add_modes(lines);
    add_spindle(lines);
    return lines;
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& what,
                           const std::string& remedy) const {
    throw Error(Exit::bad_input, fmt::format("{}:{}", file_, line), what, remedy);
  }

  void check(const link::ProgramLine& line, const std::vector<ProgramWord>& words) const {
    const auto known = [](const auto& codes, const ProgramWord& word) {
      return std::find(codes.begin(), codes.end(), word.number().value_or(-1)) != codes.end();
    };
    for (const ProgramWord& word : words) {
      const bool may_be_left_out = word.letter == 'G'   ? known(known_g, word)
                                   : word.letter == 'M' ? known(known_m, word)
                                                        : true;
      if (!may_be_left_out)
        refuse(line.number, fmt::format("--from cannot leave '{}' out", trimmed(word.text)),
               "begin at this line or before it");
    }
    if (line.text.starts_with('$'))
      refuse(line.number, "--from cannot leave a line for the board out",
             "begin at this line or before it");
  }

  void note_axis(const link::ProgramLine& line, const ProgramWord& word) {
    const auto axis = axis_letters.find(word.letter);
    if (axis == std::string_view::npos || placed_[axis]) return;
    if (interpreter_.modal().relative)
      refuse(line.number,
             fmt::format("moves {} by a distance, from an unknown position", word.letter),
             "begin at this line or before it");
    placed_[axis] = true;
  }

  /// Positions in millimetres as in the program; the board adds its offsets and rotation.
  std::string place_of(std::string_view axes) const {
    std::string text;
    for (const char letter : axes) {
      const auto axis = axis_letters.find(letter);
      if (axis == std::string_view::npos || !placed_[axis]) continue;
      const double mm = static_cast<double>(interpreter_.programmed_e7()[axis] -
                                            interpreter_.work_offset_e7()[axis]) /
                        static_cast<double>(program::one_e7);
      text += fmt::format(" {}{:.7f}", letter, mm);
    }
    return text;
  }

  /// Words that every grbl supports, and others if the program has used them.
  std::string codes() const {
    const program::Modal& modal = interpreter_.modal();
    return plane_and_system(modal) + path_words(modal);
  }

  /// Parameters that the skipped lines have set.
  void add_parameters(std::vector<std::string>& lines) const {
    const program::Variables& variables = interpreter_.variables();
    for (std::uint32_t i = 0; i < variables.size(); ++i) {
      const std::int64_t e9 = variables.value_at(i);
      const std::string value =
          fmt::format("{}{}.{:09}", e9 < 0 ? "-" : "", std::abs(e9 / program::one_e9),
                      std::abs(e9 % program::one_e9));
      const std::uint32_t number = variables.number(i);
      lines.push_back(number != 0 ? fmt::format("#{}={}", number, value)
                                  : fmt::format("#<{}>={}", variables.name(i), value));
    }
  }

  /// Added after the approach, because they change the meaning of its words.
  void add_modes(std::vector<std::string>& lines) const {
    const program::Modal& modal = interpreter_.modal();
    if (const std::string feed = feed_words(modal); !feed.empty()) lines.push_back(feed);
    std::string modes;
    if (modal.inches) modes += " G20";
    if (modal.relative) modes += " G91";
    if (modal.centres_absolute) modes += " G90.1";
    if (modal.retract_to_r) modes += " G99";
    if (!modes.empty()) lines.push_back(modes.substr(1));
    if (modal.mist) lines.emplace_back("M7");
    if (modal.flood) lines.emplace_back("M8");
  }

  /// The last line, because a laser with constant power is on as soon as it is switched on.
  void add_spindle(std::vector<std::string>& lines) const {
    const program::Modal& modal = interpreter_.modal();
    std::string text;
    if (modal.motion == Motion::rapid) text += " G0";
    if (modal.motion == Motion::line) text += " G1";
    if (modal.speed_milli != 0) text += fmt::format(" {}", speed_word(modal));
    if (modal.spindle != Spindle::off) text += modal.spindle == Spindle::constant ? " M3" : " M4";
    if (!text.empty()) lines.push_back(text.substr(1));
  }

  const std::string& file_;
  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_;
  std::array<bool, max_axes> placed_{};
  bool is_beside_ = false;  ///< after G40 there was no move: the tool is beside the contour
};

}  // namespace

std::vector<link::ProgramLine> start_at(const std::vector<link::ProgramLine>& lines,
                                        std::size_t first, const settings::Values& values,
                                        const std::string& file,
                                        const std::optional<BoardState>& state) {
  const auto begin = std::find_if(lines.begin(), lines.end(),
                                  [first](const auto& line) { return line.number >= first; });
  if (begin == lines.end())
    throw Error(Exit::bad_input, fmt::format("--from {}", first),
                fmt::format("{} has no line at or after this number", file),
                "give the number of one of its lines");
  if (begin == lines.begin()) return lines;
  Skipped skipped(values, file, state);
  std::for_each(lines.begin(), begin, [&](const link::ProgramLine& line) { skipped.pass(line); });
  skipped.require_motion(*begin);
  std::vector<link::ProgramLine> rest;
  for (std::string& text : skipped.preamble()) rest.push_back({begin->number, std::move(text)});
  rest.insert(rest.end(), begin, lines.end());
  // The probe log that was opened before is open. No probe can have been skipped.
  std::vector<std::string> logs;
  std::for_each(lines.begin(), begin, [&](const link::ProgramLine& line) {
    logs.insert(logs.end(), line.logs.begin(), line.logs.end());
  });
  rest.front().logs.insert(rest.front().logs.begin(), logs.begin(), logs.end());
  return rest;
}

}  // namespace lamplock::program_run
