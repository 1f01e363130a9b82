#include "host/order/tour.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "host/geometry/bounds.hpp"
#include "host/order/cost.hpp"
#include "host/order/greedy.hpp"
#include "host/order/local_search.hpp"
#include "host/order/serpentine.hpp"

namespace lamplock::order {
namespace {

using Indices = std::vector<std::uint32_t>;
using Points = std::span<const geometry::Point>;

// Bits per coordinate of the space-filling curve: finer than any point distance.
constexpr unsigned curve_bits = 20;

/// Place on the Hilbert curve of 2^bits cells a side that begins at (0, 0) and ends at (max, 0).
std::uint64_t hilbert(std::uint32_t x, std::uint32_t y, unsigned bits) {
  std::uint64_t place = 0;
  for (unsigned bit = bits; bit-- > 0;) {
    const std::uint32_t right = x >> bit & 1, upper = y >> bit & 1;
    place = place << 2 | ((3 * right) ^ upper);
    if (upper == 0) {
      const std::uint32_t mask = (1u << bits) - 1;
      if (right == 1) {
        x = mask - x;
        y = mask - y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

/// Place on the closed curve: four Hilbert curves, up on the left and down on the right.
std::uint64_t moore(std::uint32_t x, std::uint32_t y) {
  const unsigned bits = curve_bits - 1;
  const std::uint32_t mask = (1u << bits) - 1;
  const bool right = x >> bits != 0, upper = y >> bits != 0;
  x &= mask;
  y &= mask;
  const std::uint64_t quarter = right ? (upper ? 2 : 3) : (upper ? 1 : 0);
  const std::uint64_t place = right ? hilbert(mask - y, x, bits) : hilbert(y, mask - x, bits);
  return quarter << (2 * bits) | place;
}

/// Indices along the closed curve; equal points are consecutive.
Indices along_curve(Points layer) {
  const geometry::Bounds box = geometry::bounds(layer);
  const double side = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  const double scale = side > 0 ? ((1u << curve_bits) - 1) / side : 0;
  std::vector<std::uint64_t> place(layer.size());
  for (std::size_t i = 0; i < layer.size(); ++i) {
    place[i] = moore(static_cast<std::uint32_t>((layer[i].x - box.low.x) * scale),
                     static_cast<std::uint32_t>((layer[i].y - box.low.y) * scale));
  }
  Indices order(layer.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const geometry::Point &p = layer[a], &q = layer[b];
    return std::tie(place[a], p.x, p.y, p.z, a) < std::tie(place[b], q.x, q.y, q.z, b);
  });
  return order;
}

std::size_t distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

/// True if the points fill a large part of a lattice parallel to x and y.
bool is_lattice(Points nodes) {
  constexpr std::size_t fewest_points = 16;
  constexpr double min_part = 0.2;  // below, rows are mostly gaps
  if (nodes.size() < fewest_points) return false;
  std::vector<double> x, y;
  for (const geometry::Point& node : nodes) {
    x.push_back(node.x);
    y.push_back(node.y);
  }
  const double cells =
      static_cast<double>(distinct(std::move(x))) * static_cast<double>(distinct(std::move(y)));
  return static_cast<double>(nodes.size()) >= min_part * cells;
}

/// Rows of equal `major`, to and fro along `minor`.
Indices along_rows(Points nodes, double geometry::Point::*major, double geometry::Point::*minor) {
  Indices order(nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(nodes[a].*major, nodes[a].*minor, nodes[a].z, a) <
           std::tuple(nodes[b].*major, nodes[b].*minor, nodes[b].z, b);
  });
  bool back = false;
  for (auto row = order.begin(); row != order.end(); back = !back) {
    const double value = nodes[*row].*major;
    const auto end =
        std::find_if(row, order.end(), [&](std::uint32_t i) { return nodes[i].*major != value; });
    if (back) std::reverse(row, end);
    row = end;
  }
  return order;
}

/// Cost of the closed tour without its longest edge, where it will usually be cut.
double cost(Points nodes, const TourCost& by, const Indices& tour) {
  double sum = 0, longest = 0;
  const std::size_t n = tour.size();
  for (std::size_t i = 0; i < n; ++i) {
    const geometry::Point &p = nodes[tour[i]], &q = nodes[tour[(i + 1) % n]],
                          &r = nodes[tour[(i + 2) % n]];
    const double length = by.edge(p, q);
    sum += length + by.turn(p, q, r);
    longest = std::max(longest, length + by.turn(p, q, r));
  }
  return sum - longest;
}

/// The initial order of the points of a layer for the search.
Indices numbered(std::size_t count) {
  Indices order(count);
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

/// Improved tours of points that all differ and are sorted along the curve.
std::vector<Indices> even_tours(Points nodes, const Neighbours& neighbours, const TourCost& by) {
  std::vector<Indices> tours{numbered(nodes.size())};
  improve(nodes, neighbours, Closing::closed, by, tours.back());
  if (!is_lattice(nodes)) return tours;
  for (const bool along_x : {true, false}) {
    tours.push_back(along_x ? along_rows(nodes, &geometry::Point::y, &geometry::Point::x)
                            : along_rows(nodes, &geometry::Point::x, &geometry::Point::y));
    improve(nodes, neighbours, Closing::open, by, tours.back());
  }
  return tours;
}

/// The same from two more starts: nearest first, which follows contours, and serpentine. The result
/// also contains these starts.
std::vector<Indices> beat_tours(Points nodes, const Neighbours& neighbours, const TourCost& by) {
  std::vector<Indices> tours = even_tours(nodes, neighbours, by);
  for (const Indices& start : {nearest_first(nodes, nodes.front(), 0), to_and_fro(nodes)}) {
    tours.push_back(start);
    tours.push_back(start);
    improve(nodes, neighbours, Closing::closed, by, tours.back());
  }
  return tours;
}

/// Beats of a closed tour by the model, without those wasted on its longest step, where it will
/// usually be cut.
double beats(Points nodes, const BeatModel& model, const Indices& tour) {
  PlanState state = model.any_speed();
  double sum = 0;
  int longest = 1;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const int step = model.step(state, nodes[tour[i]], nodes[tour[(i + 1) % tour.size()]]);
    sum += step;
    longest = std::max(longest, step);
  }
  return sum - (longest - 1);
}

/// Rotates a closed tour so that its longest edge is the closing one. Returns open if this edge is
/// a jump, as between the first and the last row of a lattice: the tour will be cut there.
Closing open_at_jump(Points nodes, Indices& tour) {
  constexpr double mean_steps_of_a_jump = 4;
  const std::size_t n = tour.size();
  if (n == 0) return Closing::closed;
  double sum = 0, longest = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double length = distance(nodes[tour[i]], nodes[tour[(i + 1) % n]]);
    sum += length;
    if (length <= longest) continue;
    longest = length;
    at = i + 1;
  }
  std::rotate(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(at % n), tour.end());
  const double mean = sum / static_cast<double>(n);
  return longest > mean_steps_of_a_jump * mean ? Closing::open : Closing::closed;
}

/// The distinct points along the curve, and for each the begin of its equal points there.
struct Nodes {
  Indices curve, first;
  std::vector<geometry::Point> points;

  explicit Nodes(Points layer) : curve(along_curve(layer)) {
    for (std::uint32_t i = 0; i < curve.size(); ++i) {
      if (i > 0 && layer[curve[i]] == layer[curve[i - 1]]) continue;
      points.push_back(layer[curve[i]]);
      first.push_back(i);
    }
    first.push_back(static_cast<std::uint32_t>(curve.size()));
  }
  /// Converts a tour of the nodes to one of the layer: equal points are consecutive.
  Indices of_layer(const Indices& tour) const {
    Indices all;
    all.reserve(curve.size());
    for (const std::uint32_t node : tour) {
      for (std::uint32_t i = first[node]; i < first[node + 1]; ++i) all.push_back(curve[i]);
    }
    return all;
  }
};

/// The first of the tours with the least cost.
Indices cheapest(const std::vector<Indices>& tours, const auto& cost_of) {
  std::vector<double> costs;
  costs.reserve(tours.size());
  for (const Indices& tour : tours) costs.push_back(cost_of(tour));
  return tours[static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) -
                                        costs.begin())];
}

}  // namespace

Indices even_tour(Points layer) {
  if (layer.empty()) return {};
  const Nodes nodes(layer);
  const TourCost by;
  const auto tours =
      even_tours(nodes.points, find_neighbours(nodes.points, short_way_neighbours), by);
  return nodes.of_layer(
      cheapest(tours, [&](const Indices& tour) { return cost(nodes.points, by, tour); }));
}

Indices beat_tour(Points layer, const BeatModel& model, std::size_t asked_a_point) {
  if (layer.empty()) return {};
  const Nodes nodes(layer);
  const TourCost by(model);
  const Neighbours neighbours = find_neighbours(nodes.points, few_beats_neighbours);
  // Among tours of equal beats the cost decides; its weight is small.
  constexpr double tie = 1e-3;
  Indices best = cheapest(beat_tours(nodes.points, neighbours, by), [&](const Indices& tour) {
    return beats(nodes.points, model, tour) + tie * cost(nodes.points, by, tour);
  });
  const Closing closing = open_at_jump(nodes.points, best);
  save_beats(nodes.points, neighbours, closing, model, asked_a_point * layer.size(), best);
  return nodes.of_layer(best);
}

}  // namespace lamplock::order
