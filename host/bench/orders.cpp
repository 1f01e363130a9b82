#include "host/bench/orders.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>

#include "host/bench/machine.hpp"
#include "host/bench/plan_stream.hpp"
#include "host/model/example.hpp"
#include "host/model/transform.hpp"
#include "host/points/slice.hpp"
#include "host/points/weld.hpp"

namespace lamplock::bench {
namespace {

using geometry::Point;
using geometry::PointCloud;
using std::numbers::pi;

/// Minimum distance of points for a lens of 43 mm ("Mechatronic positioning ... in glass").
constexpr double spacing_mm = 0.09;
/// Distance for a picture of tones in a solid.
constexpr double sparse_mm = 0.35;
constexpr double order_steps_per_mm = 500;

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Random points, without those too close to an earlier one.
PointCloud thrown(int points, double distance_mm, std::uint64_t seed,
                  const std::function<Point(Random&)>& throw_one) {
  // Ever fewer fit: this many throws per point give half of the saturated number.
  constexpr int throws_a_point = 20;
  Random random(seed);
  PointCloud cloud;
  for (int i = 0; i < throws_a_point * points; ++i) cloud.push_back(throw_one(random));
  return points::weld(std::move(cloud), distance_mm).points;
}

/// Fraction of a surface that discs, or of a volume that balls, of the points' distance then cover.
constexpr double covered_area = 0.48, covered_volume = 0.27;

PointCloud on_a_sphere(int points) {
  const double radius = spacing_mm * std::sqrt(points / (16 * covered_area));
  return thrown(points, spacing_mm, 1, [&](Random& random) {
    const double z = uniform(random, -1, 1), angle = uniform(random, 0, 2 * pi);
    const double ring = std::sqrt(1 - z * z);
    return Point{radius * ring * std::cos(angle), radius * ring * std::sin(angle), radius * z};
  });
}

/// An upright torus: layers in its middle have two parts.
PointCloud on_a_torus(int points) {
  constexpr double slender = 10.0 / 3;  // ring radius over tube radius
  const double tube = spacing_mm * std::sqrt(points / (16 * covered_area * pi * slender));
  return thrown(points, spacing_mm, 2, [&](Random& random) {
    const double along = uniform(random, 0, 2 * pi), around = uniform(random, 0, 2 * pi);
    const double out = tube * (slender + std::cos(around));
    return Point{out * std::cos(along), tube * std::sin(around), out * std::sin(along)};
  });
}

PointCloud in_a_ball(int points, double distance_mm) {
  const double radius = distance_mm * std::cbrt(points / (8 * covered_volume));
  return thrown(points, distance_mm, 3, [&](Random& random) {
    while (true) {
      const Point p{uniform(random, -radius, radius), uniform(random, -radius, radius),
                    uniform(random, -radius, radius)};
      if (p.x * p.x + p.y * p.y + p.z * p.z <= radius * radius) return p;
    }
  });
}

constexpr double lattice_mm = 0.1;

PointCloud lattice(int points) {
  const int side = std::max(1, static_cast<int>(std::lround(std::cbrt(points))));
  PointCloud cloud;
  for (int i = 0; i < side * side * side; ++i) {
    const int x = i % side, y = i / side % side, z = i / side / side;
    cloud.push_back({x * lattice_mm, y * lattice_mm, z * lattice_mm});
  }
  return cloud;
}

// The example at this size: number of points of a slicing times the square of their spacing.
constexpr double example_mm = 20, example_area_mm2 = 1304;

OrderCloud sliced_example(int points, double size_mm) {
  const double between_mm = size_mm / example_mm * std::sqrt(example_area_mm2 / points);
  return {"example, sliced", between_mm,
          points::slice(model::centred_and_scaled(model::example_model(), size_mm),
                        {.layer_mm = between_mm, .vertex_mm = between_mm})};
}

std::vector<wire::Target> targets_of(const PointCloud& order) {
  std::vector<wire::Target> targets;
  targets.reserve(order.size());
  const auto steps = [](double mm) {
    return static_cast<std::int32_t>(std::lround(mm * order_steps_per_mm));
  };
  for (const Point& p : order) {
    wire::Target target;
    target.steps[0] = steps(p.x - order[0].x);
    target.steps[1] = steps(p.y - order[0].y);
    target.steps[2] = steps(p.z - order[0].z);
    targets.push_back(target);
  }
  return targets;
}

}  // namespace

std::vector<OrderCloud> order_clouds(int points) {
  // Layers in which no point shadows another: 0.9 < cos(20 degrees).
  constexpr double layer_part = 0.9;
  return {sliced_example(points, example_mm),
          {"sphere", layer_part * spacing_mm, on_a_sphere(points)},
          {"torus", layer_part * spacing_mm, on_a_torus(points)},
          {"lattice", lattice_mm, lattice(points)},
          {"solid", layer_part * spacing_mm, in_a_ball(points, spacing_mm)},
          {"sparse solid", layer_part * sparse_mm, in_a_ball(points, sparse_mm)}};
}

OrderCloud angle_cloud(int points) {
  constexpr double between_mm = 0.1;
  return sliced_example(points, example_mm * between_mm * std::sqrt(points / example_area_mm2));
}

order::Motion motion_of(const Machine& machine) {
  const double accel = machine.accel_m_s2 * 1e3, speed = machine.speed_m_s * 1e3;
  return {{accel, accel, accel}, {speed, speed, speed}, 1 / machine.lamp_hz};
}

double beats_of_order(const Machine& machine, const PointCloud& order, wire::JoinMode mode) {
  if (order.empty()) return 0;
  const motion::Limits limits = limits_of(machine_settings(
      machine.lamp_hz, machine.accel_m_s2, machine.speed_m_s, 3, order_steps_per_mm));
  const auto planner = std::make_unique<motion::Planner>();
  const StreamPlan plan = plan_stream(limits, targets_of(order), {.mode = mode}, *planner);
  if (plan.result != Result::ok)
    throw std::runtime_error("point " + std::to_string(plan.beats.size()) + " cannot be reached");
  return static_cast<double>(plan.total_beats()) / static_cast<double>(order.size());
}

OrderFigures order_figures(const OrderCloud& cloud, const Machine& machine,
                           const PointsPlanned& planned) {
  OrderFigures figures{cloud.name, machine, cloud.points.size(), {}};
  order::OrderOptions options;
  options.layer_mm = cloud.layer_mm;
  options.motion = motion_of(machine);
  for (std::size_t i = 0; i < compared_orderings.size(); ++i) {
    figures.beats[i] =
        beats_of_order(machine, order::order(cloud.points, compared_orderings[i], options));
    if (planned) planned(cloud.points.size());
  }
  return figures;
}

SortingAngle sorting_angle(const SortingAngle& measured, const OrderCloud& cloud,
                           const PointsPlanned& planned) {
  const double weight = std::tan(measured.angle_deg * pi / 180);
  order::OrderOptions options;
  options.cone = {weight, weight};
  options.half_angle_deg = 0;
  const PointCloud ordered = order::order(cloud.points, order::Ordering::cone, options);
  SortingAngle row = measured;
  row.start_stop = beats_of_order(angle_machine, ordered, wire::JoinMode::start_stop);
  row.free = beats_of_order(angle_machine, ordered);
  if (planned) planned(cloud.points.size());
  return row;
}

}  // namespace lamplock::bench
