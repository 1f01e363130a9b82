#include "host/run/ordering.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/order/shadow.hpp"
#include "host/run/frontend.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using geometry::PointCloud;
using order::Ordering;
using settings::Id;

std::string_view text_of(Ordering ordering) {
  switch (ordering) {
    case Ordering::given:
      return "as given";
    case Ordering::layers:
      return "by layers";
    case Ordering::serpentine:
      return "back and forth in layers";
    case Ordering::nearest:
      return "nearest point of the layer";
    case Ordering::cone:
      return "by the cone rule";
    case Ordering::best:
      return "for the fewest beats";
  }
  return "unknown";
}

Ordering order_named(const std::string& name) {
  if (const auto ordering = order::ordering_named(name)) return *ordering;
  throw Error(Exit::bad_input, "--order", fmt::format("'{}' is not known", name),
              "see lamplock order --help");
}

double way_mm(const PointCloud& cloud) {
  double way = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i)
    way += std::hypot(cloud[i].x - cloud[i - 1].x, cloud[i].y - cloud[i - 1].y,
                      cloud[i].z - cloud[i - 1].z);
  return way;
}

/// The shadow rule of an order that is engraved as it is (docs/ordering.md).
std::vector<std::string> shadow_warnings(const PointCloud& cloud, double half_angle_deg) {
  const auto found = order::first_shadowed(cloud, half_angle_deg);
  if (!found) return {};
  const geometry::Point &upper = cloud[found->first], &lower = cloud[found->second];
  return {fmt::format(
      "the order of the points lets earlier points shadow later ones: point {} at ({:.4g}, {:.4g}, "
      "{:.4g}) mm is engraved before point {} at ({:.4g}, {:.4g}, {:.4g}) mm, which lies under it "
      "in "
      "the beam; choose another order than 'given'",
      found->first + 1, upper.x, upper.y, upper.z, found->second + 1, lower.x, lower.y, lower.z)};
}

}  // namespace

order::Motion motion_of(const settings::Values& values, const glass::Refraction& refraction) {
  order::Motion motion;
  constexpr double s_per_min = 60;
  for (int axis = 0; axis < static_cast<int>(motion.accel_mm_s2.size()); ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    motion.accel_mm_s2[i] = in_units(values, Id::acceleration_x, axis);
    motion.speed_mm_s[i] = in_units(values, Id::max_rate_x, axis) / s_per_min;
  }
  motion.accel_mm_s2.back() *= refraction.index;
  motion.speed_mm_s.back() *= refraction.index;
  motion.beat_s = 1 / in_units(values, Id::lamp_frequency);
  return motion;
}

order::OrderOptions order_options(const glass::OrderChoice& choice, std::optional<double> layer_mm,
                                  const order::Motion& motion) {
  order::OrderOptions options;
  if (choice.layer_mm)
    options.layer_mm = *choice.layer_mm;
  else if (layer_mm)
    options.layer_mm = *layer_mm;
  options.half_angle_deg = choice.half_angle_deg;
  options.cone = {choice.cone_up, choice.cone_down};
  options.motion = motion;
  return options;
}

std::vector<std::string> order_points(PointCloud& cloud, const std::string& name,
                                      order::OrderOptions options, Frontend& frontend) {
  frontend.restart_clock();
  const Ordering ordering = order_named(name);
  if (ordering == Ordering::given) {
    std::vector<std::string> warnings = shadow_warnings(cloud, options.half_angle_deg);
    frontend.phase("order", fmt::format("as given, path length {:.1f} mm", way_mm(cloud)));
    for (const std::string& warning : warnings) frontend.say("warning  {}", warning);
    return warnings;
  }
  const double before = way_mm(cloud);
  {
    const std::unique_ptr<Progress> progress = frontend.progress("ordering", cloud.size(), 0);
    const auto total = static_cast<double>(cloud.size());
    options.progress = [&progress, total](double part) {
      if (part < 1) progress->update(static_cast<std::size_t>(part * total));
    };
    cloud = order::order(std::move(cloud), ordering, options);
  }
  frontend.phase("order", fmt::format("{}, path length {:.1f} mm (before: {:.1f} mm)",
                                      text_of(ordering), way_mm(cloud), before));
  return {};
}

}  // namespace lamplock::run
