#include "host/serve/shown_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/serve/shares.hpp"
#include "host/units.hpp"

namespace lamplock::serve {
namespace {

using geometry::Point;

/// Invisible where the whole path fills a view.
constexpr double first_tolerance = 1.0 / 16384;

double distance(const Point& a, const Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// Without those that are closer than this to the one kept before; the last one stays.
std::vector<PathPlace> thinned(const std::vector<PathPlace>& places, double tolerance_mm) {
  std::vector<PathPlace> kept;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (kept.empty() || i + 1 == places.size() ||
        distance(kept.back().place, places[i].place) >= tolerance_mm)
      kept.push_back(places[i]);
  return kept;
}

geometry::Bounds bounds_of(const std::vector<PathPlace>& places) {
  geometry::PointCloud points;
  points.reserve(places.size());
  for (const PathPlace& each : places) points.push_back(each.place);
  return geometry::bounds(points);
}

}  // namespace

std::vector<PathPlace> places_of(const program_run::ProgramRun& run,
                                 const std::vector<std::size_t>& sent) {
  const auto& pieces = run.pieces;
  if (pieces.empty()) return {};
  const bool has_power =
      std::any_of(pieces.begin(), pieces.end(), [](const auto& piece) { return piece.power > 0; });
  const auto point = [](const PerAxis<double>& at) { return Point{at[0], at[1], at[2]}; };
  const auto share = [&](std::size_t line) {
    const auto before = std::upper_bound(sent.begin(), sent.end(), line) - sent.begin();
    return sent.empty() ? 1 : static_cast<double>(before) / static_cast<double>(sent.size());
  };
  std::vector<PathPlace> places{{point(pieces.front().from)}};
  for (const auto& piece : pieces)
    places.push_back(
        {point(piece.to), share(piece.line), piece.rapid || (has_power && piece.power <= 0)});
  return places;
}

std::vector<PathPlace> places_of(const job::Job& rows) {
  const auto point = [&](const StepPosition& steps) {
    const auto mm = [&](int axis) {
      if (axis >= rows.header.axes) return 0.0;
      return steps[static_cast<std::size_t>(axis)] /
             in_units(rows.settings, settings::Id::steps_per_mm_x, axis);
    };
    return Point{mm(0), mm(1), mm(2)};
  };
  const auto& lines = rows.rows.lines;
  std::vector<PathPlace> places;
  for (std::size_t i = 0; i < lines.size(); ++i)
    places.push_back({point(lines[i].to.steps),
                      static_cast<double>(i + 1) / static_cast<double>(lines.size()),
                      !lines[i].to.light});
  return places;
}

ShownPath::ShownPath(std::vector<PathPlace> places)
    : places_(std::move(places)), bounds_(bounds_of(places_)) {
  const double size = distance(bounds_.low, bounds_.high);
  for (double tolerance = size * first_tolerance; places_.size() > max_shown; tolerance *= 2)
    places_ = thinned(places_, std::max(tolerance, 1e-6));
}

std::string ShownPath::bytes() const {
  const auto& [low, high] = bounds_;
  std::string bytes;
  bytes.reserve(places_.size() * bytes_per_place);
  for (const PathPlace& each : places_) {
    put_share(bytes, share_of(each.place.x, low.x, high.x));
    put_share(bytes, share_of(each.place.y, low.y, high.y));
    put_share(bytes, share_of(each.place.z, low.z, high.z));
    constexpr double full = 32767;
    const auto share = static_cast<unsigned>(std::lround(std::clamp(each.share, 0.0, 1.0) * full));
    put_16(bytes, share << 1 | (each.is_rapid ? 1u : 0u));
  }
  return bytes;
}

}  // namespace lamplock::serve
