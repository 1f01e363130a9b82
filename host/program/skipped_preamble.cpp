// The lines that restore what skipped lines have done, in the order in which a machine may run
// them: modes, tool and length at rest where the machine is, the dark approach, then what changes
// the meaning of its words, outputs, and the laser last.
#include <fmt/format.h>

#include <cstdlib>

#include "host/program/mode_words.hpp"
#include "host/program/skipped_lines.hpp"

namespace lamplock::program_run {

using program::Motion;
using program::Spindle;

std::vector<std::string> SkippedLines::preamble() const {
  const program::Modal& modal = interpreter_.modal();
  std::vector<std::string> lines{
      "M5", fmt::format("G21 G90 G94 G80{}{}", plane_and_system(modal), path_words(modal))};
  // Words that grbl lacks only if the program has used them.
  if (uses_rotation_) lines.emplace_back("G69");
  if (!shift_.empty()) lines.push_back(shift_);
  if (uses_overrides_) lines.emplace_back(modal.overrides_off ? "M49" : "M48");
  add_parameters(lines);
  tool_.add_lines(lines, modal);
  for (const std::string_view axes : {"XYA", "Z"})
    if (const std::string place = place_of(axes); !place.empty()) lines.push_back("G0" + place);
  add_modes(lines);
  outputs_.add_lines(lines);
  add_spindle(lines);
  return lines;
}

/// Positions in millimetres as in the program; the board adds its offsets and rotation.
std::string SkippedLines::place_of(std::string_view axes) const {
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

/// Parameters that the skipped lines have set.
void SkippedLines::add_parameters(std::vector<std::string>& lines) const {
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
void SkippedLines::add_modes(std::vector<std::string>& lines) const {
  const program::Modal& modal = interpreter_.modal();
  if (const std::string feed = feed_words(modal); !feed.empty()) lines.push_back(feed);
  add_pulses(lines);
  std::string modes;
  if (modal.inches) modes += " G20";
  if (modal.relative) modes += " G91";
  if (modal.centres_absolute) modes += " G90.1";
  if (modal.retract_to_r) modes += " G99";
  if (!modes.empty()) lines.push_back(modes.substr(1));
  if (modal.mist) lines.emplace_back("M7");
  if (modal.flood) lines.emplace_back("M8");
}

/// M126 to M128, in millimetres.
void SkippedLines::add_pulses(std::vector<std::string>& lines) const {
  using program::Pulses;
  constexpr double milli = 1e3, ns_per_us = 1e3;
  const Pulses& pulses = interpreter_.modal().pulses;
  if (pulses.milli_per_mm != Pulses::as_set)
    lines.push_back(fmt::format("M127 P{:.3f}", pulses.milli_per_mm / milli));
  if (pulses.length_ns != Pulses::as_set)
    lines.push_back(fmt::format("M128 P{:.3f}", pulses.length_ns / ns_per_us));
  if (pulses.on != Pulses::Switch::as_set)
    lines.emplace_back(pulses.on == Pulses::Switch::on ? "M126 P1" : "M126 P0");
}

/// The last line, because a laser with constant power is on as soon as it is switched on.
void SkippedLines::add_spindle(std::vector<std::string>& lines) const {
  const program::Modal& modal = interpreter_.modal();
  std::string text;
  if (modal.motion == Motion::rapid) text += " G0";
  // The line would be refused without a feed, as M2 may leave G1: then a motion needs its code.
  if (modal.motion == Motion::line) text += lacks_feed(modal) ? " G80" : " G1";
  if (modal.speed_milli != 0) text += fmt::format(" {}", speed_word(modal));
  if (modal.spindle != Spindle::off) text += modal.spindle == Spindle::constant ? " M3" : " M4";
  if (!text.empty()) lines.push_back(text.substr(1));
}

}  // namespace lamplock::program_run
