#include "host/program/mode_words.hpp"

#include <fmt/format.h>

namespace lamplock::program_run {

using program::FeedMode;
using program::Modal;
using program::PathMode;

namespace {

constexpr double um_per_mm = 1e3, nm_per_mm = 1e6, milli = 1e3;

}  // namespace

std::string plane_and_system(const Modal& modal) {
  constexpr int first_of_grbl = 54, systems_of_grbl = 6;
  const std::string plane = fmt::format(" G{}", static_cast<int>(modal.plane) / 10);
  return modal.system < systems_of_grbl
             ? fmt::format("{} G{}", plane, first_of_grbl + modal.system)
             : fmt::format("{} G59.{}", plane, modal.system - systems_of_grbl + 1);
}

std::string path_words(const Modal& modal) {
  if (modal.path == PathMode::stop) return " G61.1";
  if (modal.path == PathMode::blend) return fmt::format(" G64 P{:.3f}", modal.blend_um / um_per_mm);
  return {};
}

std::string feed_words(const Modal& modal) {
  switch (modal.feed_mode) {
    case FeedMode::inverse_time:
      return "G93";
    case FeedMode::per_turn:
      return fmt::format("G95 F{:.6f}", modal.feed / nm_per_mm);
    case FeedMode::per_minute:
      break;
  }
  return modal.feed == 0 ? "" : fmt::format("F{:.3f}", modal.feed / um_per_mm);
}

std::string speed_word(const Modal& modal) {
  return fmt::format("S{:.3f}", modal.speed_milli / milli);
}

}  // namespace lamplock::program_run
