#include "host/cutting/tabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

constexpr const char* tab_place = "tabs";
// Rounding of lengths along a contour.
constexpr double tab_slack_mm = 1e-9;
constexpr int max_tabs = 10'000;

/// Where the middle of a tab may be, mm along the contour.
struct Stretch {
  double begin, end;
};

bool is_corner(const Edge& before, const Edge& after) {
  const Vec in = direction_at(before, 1), out = direction_at(after, 0);
  const double turn = std::abs(std::atan2(cross(in, out), dot(in, out)));
  return turn > min_corner_deg * std::numbers::pi / 180;
}

void require_options(const TabOptions& options) {
  geometry::require_positive(options.width_mm, tab_place, "width");
  if (options.count < 0 || options.count > max_tabs)
    throw Error(Exit::bad_input, tab_place, fmt::format("{} tabs on one contour", options.count),
                fmt::format("use 0 to {} tabs", max_tabs));
  if (!(options.power >= 0 && options.power <= 1))
    throw Error(Exit::bad_input, tab_place, fmt::format("the power in tabs is {:g}", options.power),
                "give the part of the power of the cut, 0 to 1");
  if (!(options.kerf_mm >= 0) || !std::isfinite(options.kerf_mm))
    throw Error(Exit::bad_input, tab_place, "the kerf is negative or no number",
                "use 0 or more mm");
  if (!(options.corner_distance_mm >= 0) || !std::isfinite(options.corner_distance_mm))
    throw Error(Exit::bad_input, tab_place, "the distance from corners is negative or no number",
                "use 0 or more mm");
}

/// An arc round a corner, for example that of a beam round the corner of a part.
bool is_round_corner(const Edge& edge, const TabOptions& options) {
  return !edge.is_line() && std::abs(edge.sweep) > min_corner_deg * std::numbers::pi / 180 &&
         radius_of(edge) <= options.kerf_mm / 2 + tab_slack_mm;
}

/// Between corners, begin and end of the contour.
std::vector<Stretch> stretches_of(const Contour& contour, const TabOptions& options,
                                  double skipped_mm) {
  // Tabs at both sides of the begin are a way apart, too.
  const double half = way_mm(options) / 2, away = options.corner_distance_mm + half;
  const double away_from_ends = std::max(options.corner_distance_mm, half) + half;
  const double last = length_of(contour) - away_from_ends;
  std::vector<Stretch> stretches;
  double along = 0, begin = skipped_mm + away_from_ends;
  // A corner is a place, or an arc as long as `length`.
  const auto end_at_corner = [&](double at, double length) {
    const double end = std::min(at - away, last);
    if (end >= begin - tab_slack_mm) stretches.push_back({begin, std::max(begin, end)});
    begin = std::max(begin, at + length + away);
  };
  for (std::size_t i = 0; i < contour.edges.size(); ++i) {
    const Edge& edge = contour.edges[i];
    const double length = length_of(edge);
    const bool is_last = i + 1 == contour.edges.size();
    if (is_round_corner(edge, options)) end_at_corner(along, length);
    along += length;
    if (!is_last && is_corner(edge, contour.edges[i + 1])) end_at_corner(along, 0);
  }
  end_at_corner(last + away, 0);  // the end of the contour
  return stretches;
}

/// The first place of a stretch at or after `at`; none after the last one.
std::optional<double> at_or_after(const std::vector<Stretch>& stretches, double at) {
  for (const Stretch& one : stretches) {
    if (one.end >= at - tab_slack_mm) return std::clamp(at, one.begin, one.end);
  }
  return std::nullopt;
}

std::optional<double> at_or_before(const std::vector<Stretch>& stretches, double at) {
  for (auto one = stretches.rbegin(); one != stretches.rend(); ++one) {
    if (one->begin <= at + tab_slack_mm) return std::clamp(at, one->begin, one->end);
  }
  return std::nullopt;
}

}  // namespace

std::vector<Tab> tabs_of(const Contour& contour, const TabOptions& options, double skipped_mm) {
  if (options.count == 0) return {};
  require_options(options);
  const double length = length_of(contour);
  const std::vector<Stretch> stretches = stretches_of(contour, options, skipped_mm);
  const auto refuse = [&] {
    const Vec& at = contour.edges.front().from;
    throw Error(
        Exit::bad_input, tab_place,
        fmt::format(
            "{} tabs of {:g} mm do not fit between the corners of the contour of "
            "{:.3f} mm at ({:.3f}, {:.3f}){}",
            options.count, options.width_mm, length, at.x, at.y,
            options.kerf_mm > 0 ? fmt::format(", with a kerf of {:g} mm", options.kerf_mm) : ""),
        "use fewer or narrower tabs, or less distance from corners");
  };
  // Middles of neighbours; the latest places from which all that follow still fit.
  const double half = way_mm(options) / 2, step = 4 * half;
  const auto count = static_cast<std::size_t>(options.count);
  std::vector<double> latest(count);
  for (std::size_t i = count; i-- > 0;) {
    const auto place = at_or_before(stretches, i + 1 == count ? length : latest[i + 1] - step);
    if (!place) refuse();
    latest[i] = *place;
  }
  std::vector<Tab> tabs;
  double earliest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double even = length * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double aim = std::clamp(even, std::min(earliest, latest[i]), latest[i]);
    const auto after = at_or_after(stretches, aim), before = at_or_before(stretches, aim);
    double middle = latest[i];
    if (after && *after <= latest[i] + tab_slack_mm) middle = *after;
    if (before && *before >= earliest - tab_slack_mm && aim - *before < std::abs(middle - aim))
      middle = *before;
    if (middle < earliest - tab_slack_mm) refuse();
    tabs.push_back({middle - half, middle + half});
    earliest = middle + step;
  }
  return tabs;
}

}  // namespace lamplock::cutting
