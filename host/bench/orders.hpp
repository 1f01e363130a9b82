// Savings by orders: beats of each ordering on the same clouds, by the firmware's planner.
//
// In:  a number of points, machines. Out: beats per point, for the tables of `lamplock bench`.
// Who: `lamplock bench`, the tests of the orders.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/bench/figures.hpp"
#include "host/geometry/point.hpp"
#include "host/order/order.hpp"

namespace lamplock::bench {

/// A cloud to order, and a suitable thickness of layers.
struct OrderCloud {
  std::string name;
  double layer_mm = 0;
  geometry::PointCloud points;
};

/// The example model sliced, random points with a smallest distance on a sphere, on a torus and in
/// a ball (dense and sparse), a lattice: each with about `points` points.
std::vector<OrderCloud> order_clouds(int points);

/// Machines of the table of orders.
inline constexpr std::array<Machine, 3> order_machines{{{100, 2, 1}, {100, 4, 1}, {200, 10, 1}}};
/// Every ordering but `given`.
inline constexpr std::array<order::Ordering, 5> compared_orderings{
    order::Ordering::layers, order::Ordering::serpentine, order::Ordering::nearest,
    order::Ordering::cone, order::Ordering::best};

/// The limits of the machine for the orders.
order::Motion motion_of(const Machine& machine);

/// Beats per point that the planner spends on points in this order, from rest in the first.
/// Throws std::runtime_error if a point cannot be reached.
double beats_of_order(const Machine& machine, const geometry::PointCloud& order,
                      wire::JoinMode mode = wire::JoinMode::free);

/// Beats per point of a cloud in each of the compared orderings.
struct OrderFigures {
  std::string cloud;
  Machine machine{};
  std::size_t points = 0;
  std::array<double, compared_orderings.size()> beats{};
};
OrderFigures order_figures(const OrderCloud& cloud, const Machine& machine,
                           const PointsPlanned& planned = {});

/// A row of the sorting angle: time on the machine of the source, which stops at every point, and
/// beats per point of the cone order with K+ = K- = tan(angle), our interpretation of the source.
struct SortingAngle {
  double angle_deg = 0, measured_s = 0;
  double start_stop = 0, free = 0;
};
/// Published angles and times (source: glass_tables.hpp), of an object that is not available.
inline constexpr std::array<SortingAngle, 8> measured_angles{{{10, 217, 0, 0},
                                                              {20, 194, 0, 0},
                                                              {30, 192, 0, 0},
                                                              {40, 194, 0, 0},
                                                              {50, 194, 0, 0},
                                                              {60, 195, 0, 0},
                                                              {70, 200, 0, 0},
                                                              {80, 213, 0, 0}}};
/// The source does not name the machine for these times; 192 s is between its times at 100 Hz with
/// 7 and with 7.5 m/s2.
inline constexpr Machine angle_machine{100, 7.5, 0.1};
/// The example sliced with points 0.1 mm apart, like most steps of the source's object.
OrderCloud angle_cloud(int points);
/// The experiment, without the shadow rule, which would change an order with a small angle.
SortingAngle sorting_angle(const SortingAngle& measured, const OrderCloud& cloud,
                           const PointsPlanned& planned = {});

}  // namespace lamplock::bench
