#include "host/duration_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lamplock {
namespace {

constexpr double s_per_min = 60, hundredths_per_s = 100;

}  // namespace

std::string duration_text(double seconds) { return duration_text(seconds, seconds); }

std::string duration_text(double seconds, double longest) {
  // What would be rounded to 60.00 s is a minute.
  const double form = std::max(seconds, longest);
  if (std::round(form * hundredths_per_s) < s_per_min * hundredths_per_s)
    return fmt::format("{:.2f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
  const std::uint64_t hours = whole / 3600, minutes = whole / 60 % 60;
  if (std::llround(form) < 3600) return fmt::format("{} min {:02} s", minutes, whole % 60);
  return fmt::format("{} h {:02} min {:02} s", hours, minutes, whole % 60);
}

std::string whole_seconds_text(double seconds) {
  const double whole = std::ceil(seconds);
  return whole < s_per_min ? fmt::format("{:.0f} s", whole) : duration_text(whole);
}

}  // namespace lamplock
