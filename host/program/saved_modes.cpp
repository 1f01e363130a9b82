#include "host/program/saved_modes.hpp"

#include <fmt/format.h>

#include "host/program/mode_words.hpp"

namespace lamplock::program_run {

using program::Modal;
using program::Spindle;

std::string lost_modes(const Modal& saved, const Modal& now) {
  std::string codes;
  if (!(saved.rotation == now.rotation)) codes += ", G68";
  if (saved.beat_lock != now.beat_lock) codes += ", M130";
  if (!(saved.pulses == now.pulses)) codes += ", M126";
  return codes.empty() ? codes : codes.substr(2);
}

std::vector<std::string> lines_to_restore(const Modal& saved, const Modal& now) {
  std::vector<std::string> lines{fmt::format("G21{}", plane_and_system(saved))};
  lines.front() += saved.path == program::PathMode::exact ? " G61" : path_words(saved);
  if (saved.feed_mode == program::FeedMode::per_minute) lines.front() += " G94";
  if (const std::string feed = feed_words(saved); !feed.empty()) lines.push_back(feed);
  lines.push_back(
      fmt::format("G{} G{} G{} G{}", saved.inches ? "20" : "21", saved.relative ? "91" : "90",
                  saved.centres_absolute ? "90.1" : "91.1", saved.retract_to_r ? "99" : "98"));
  if (saved.flood != now.flood || saved.mist != now.mist) {
    lines.emplace_back("M9");
    if (saved.mist) lines.emplace_back("M7");
    if (saved.flood) lines.emplace_back("M8");
  }
  if (saved.overrides_off != now.overrides_off)
    lines.emplace_back(saved.overrides_off ? "M49" : "M48");
  if (saved.spindle != now.spindle || saved.speed_milli != now.speed_milli)
    lines.push_back(fmt::format("{} {}", speed_word(saved),
                                saved.spindle == Spindle::off        ? "M5"
                                : saved.spindle == Spindle::constant ? "M3"
                                                                     : "M4"));
  return lines;
}

}  // namespace lamplock::program_run
