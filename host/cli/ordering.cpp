#include "host/cli/ordering.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "host/cli/progress.hpp"
#include "host/error.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

using order::Ordering;
using points::PointCloud;
using settings::Id;

/// An order by its name, and how a report says it.
struct Named {
  std::string_view name;
  Ordering ordering;
  std::string_view told;
};
constexpr std::array known{Named{"given", Ordering::given, "as given"},
                           Named{"layers", Ordering::layers, "by layers"},
                           Named{"serpentine", Ordering::serpentine, "back and forth in layers"},
                           Named{"nearest", Ordering::nearest, "nearest neighbour in layers"},
                           Named{"cone", Ordering::cone, "by the cone rule"},
                           Named{"best", Ordering::best, "for the fewest beats"}};

const Named& order_named(const std::string& name) {
  for (const Named& one : known)
    if (one.name == name) return one;
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

void order_points(PointCloud& cloud, const Ordered& wanted, Console& console) {
  console.restart_clock();
  const Named& named = order_named(wanted.name);
  if (named.ordering == Ordering::given)
    return console.phase("order", fmt::format("as given, {:.1f} mm of way", way_mm(cloud)));
  const double before = way_mm(cloud);
  {
    Progress progress("ordering", cloud.size());
    order::OrderOptions options;
    if (wanted.layer_mm) options.layer_mm = *wanted.layer_mm;
    options.half_angle_deg = wanted.half_angle_deg;
    options.motion = wanted.motion;
    const auto total = static_cast<double>(cloud.size());
    options.progress = [&progress, total](double part) {
      if (part < 1) progress.update(static_cast<std::size_t>(part * total));
    };
    cloud = order::order(std::move(cloud), named.ordering, options);
  }
  console.phase("order", fmt::format("{}, {:.1f} mm of way (before: {:.1f})", named.told,
                                     way_mm(cloud), before));
}

}  // namespace lamplock::cli
