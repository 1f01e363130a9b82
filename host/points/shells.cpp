#include "host/points/shells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"
#include "host/geometry/vector.hpp"
#include "host/number_text.hpp"
#include "host/points/point_grid.hpp"

namespace lamplock::points {
namespace {

/// Neighbours on one shell count up to this many distances.
constexpr double reach_distances = 2;

class Spreader {
 public:
  Spreader(std::size_t count, const ShellOptions& options)
      : options_(options),
        reach_(reach_distances * options.distance_mm),
        placed_(count, reach_),
        members_(static_cast<std::size_t>(options.shells), 0) {
    result_.points.reserve(count);
    result_.shell.reserve(count);
  }

  void place(const geometry::Point& point, const geometry::Point& inward) {
    std::optional<std::size_t> best;
    double best_apart = 0;
    for (std::size_t shell = 0; shell < members_.size(); ++shell) {
      const double apart = apart_on(shell, moved(point, inward, shell));
      if (apart == 0) continue;
      // If neighbours do not decide, the shell with fewer points is better.
      const bool better =
          !best || apart > best_apart || (apart == best_apart && members_[shell] < members_[*best]);
      if (!better) continue;
      best = shell;
      best_apart = apart;
    }
    if (!best) {
      ++result_.removed;
      return;
    }
    ++members_[*best];
    result_.points.push_back(moved(point, inward, *best));
    result_.shell.push_back(static_cast<std::uint8_t>(*best));
    placed_.add(static_cast<std::uint32_t>(result_.points.size() - 1), result_.points.back());
  }

  Shells take() { return std::move(result_); }

 private:
  geometry::Point moved(const geometry::Point& point, const geometry::Point& inward,
                        std::size_t shell) const {
    const double depth = static_cast<double>(shell) * options_.shell_mm;
    return {point.x + depth * inward.x, point.y + depth * inward.y, point.z + depth * inward.z};
  }

  /// Square of the distance to the nearest point on that shell, at most that of the reach; 0 if
  /// any point is closer than the smallest distance.
  double apart_on(std::size_t shell, const geometry::Point& place) const {
    const double min_square = options_.distance_mm * options_.distance_mm;
    double apart = reach_ * reach_;
    const bool is_taken = placed_.any_near(place, [&](std::uint32_t i) {
      const double square = square_of_distance(place, result_.points[i]);
      if (result_.shell[i] == shell) apart = std::min(apart, square);
      return square < min_square;
    });
    return is_taken ? 0 : apart;
  }

  const ShellOptions& options_;
  double reach_;
  PointGrid placed_;
  std::vector<std::size_t> members_;  // of each shell
  Shells result_;
};

void require_valid(std::span<const geometry::Point> cloud, std::span<const geometry::Point> inward,
                   const ShellOptions& options) {
  geometry::require_positive(options.distance_mm, "shells", "distance");
  if (options.shells < 1 || options.shells > std::numeric_limits<std::uint8_t>::max()) {
    throw Error(Exit::bad_input, "shells", fmt::format("{} shells", options.shells),
                "give 1 to 255");
  }
  if (options.shells > 1)
    geometry::require_positive(options.shell_mm, "shells", "distance of shells");
  geometry::require_count(static_cast<double>(cloud.size()), "shells");
  if (!inward.empty() && inward.size() != cloud.size()) {
    throw Error(Exit::bad_input, "shells",
                fmt::format("{} for {}", count_text(inward.size(), "inward direction"),
                            count_text(cloud.size(), "point")),
                "give one for each point");
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (geometry::is_finite(cloud[i]) && (inward.empty() || geometry::is_finite(inward[i])))
      continue;
    throw Error(
        Exit::bad_input, "shells",
        fmt::format(
            "point {} has a coordinate or an inward direction that is not finite: ({}, {}, {})", i,
            cloud[i].x, cloud[i].y, cloud[i].z),
        "correct the model or the point list");
  }
}

}  // namespace

Shells spread_over_shells(std::span<const geometry::Point> cloud,
                          std::span<const geometry::Point> inward, const ShellOptions& options) {
  require_valid(cloud, inward, options);
  Spreader spreader(cloud.size(), options);
  constexpr geometry::Point down{0, 0, -1};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    spreader.place(cloud[i], inward.empty() ? down : inward[i]);
  }
  return spreader.take();
}

geometry::PointCloud compensate_depth(geometry::PointCloud cloud, const DepthOptions& options) {
  geometry::require_positive(options.full_depth_mm, "depth", "full depth");
  for (const double density : {options.density_at_face, options.density_at_depth}) {
    if (density >= 0 && density <= 1) continue;
    throw Error(Exit::bad_input, "depth", fmt::format("density {}", density), "give 0 to 1");
  }
  const geometry::Random seeds(options.seed);
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double depth =
        std::clamp((options.entry_z_mm - cloud[i].z) / options.full_depth_mm, 0.0, 1.0);
    const double density =
        options.density_at_face + depth * (options.density_at_depth - options.density_at_face);
    if (geometry::Random(seeds.fork(i)).uniform() < density) cloud[count++] = cloud[i];
  }
  cloud.resize(count);
  return cloud;
}

}  // namespace lamplock::points
