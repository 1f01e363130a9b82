#include "host/order/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "host/error.hpp"
#include "host/order/cost.hpp"
#include "host/order/layers.hpp"
#include "host/order/serpentine.hpp"
#include "host/order/shadow.hpp"
#include "host/order/tour.hpp"
#include "host/points/limits.hpp"

namespace lamplock::order {
namespace {

using points::Point;
using points::PointCloud;
using Indices = std::vector<std::uint32_t>;

void arrange(std::span<Point> points, const Indices& order) {
  const PointCloud copy(points.begin(), points.end());
  for (std::size_t i = 0; i < order.size(); ++i) points[i] = copy[order[i]];
}

/// Cuts the closed tour and goes it the way that costs least for a machine at `from`.
void cut_tour(std::span<Point> tour, const Point& from) {
  std::size_t best = 0;
  bool backward = false;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const std::size_t before = (i + tour.size() - 1) % tour.size();
    const double removed = distance(tour[before], tour[i]);
    // Cut between `before` and i: begin at i and go forward, or begin at `before` and go back.
    const double forward_cost = distance(from, tour[i]) - removed;
    const double backward_cost = distance(from, tour[before]) - removed;
    if (std::min(forward_cost, backward_cost) >= lowest) continue;
    lowest = std::min(forward_cost, backward_cost);
    best = i;
    backward = backward_cost < forward_cost;
  }
  std::rotate(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(best), tour.end());
  if (backward) std::reverse(tour.begin(), tour.end());
}

/// Goes strips from the end that is nearer.
void turn_to(std::span<Point> strips, const Point& from) {
  if (distance(from, strips.back()) < distance(from, strips.front()))
    std::reverse(strips.begin(), strips.end());
}

/// One job of ordering a cloud that is not empty.
class Run {
 public:
  Run(PointCloud& cloud, const OrderOptions& options)
      : cloud_(cloud), options_(options), tangent_(cone_tangent(options.half_angle_deg)) {}

  void layers() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    tours(starts, [](std::span<Point> layer) { arrange(layer, even_tour(layer)); });
  }

  void best() {
    const BeatModel model(options_.motion);
    const Starts starts = sort_into_fitting_layers(cloud_, tangent_);
    tours(starts, [&](std::span<Point> layer) { arrange(layer, beat_tour(layer, model)); });
  }

  void serpentine() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    for_each_layer(
        cloud_, starts, options_.threads,
        [](std::span<Point> layer) { arrange(layer, to_and_fro(layer)); }, tell(0, tours_part));
    join(starts, turn_to);
    keep_rule(starts);
  }

  void nearest() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    Point from = options_.start;
    const auto told = tell(0, 1);
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      const std::span<Point> layer =
          std::span(cloud_).subspan(starts[i], starts[i + 1] - starts[i]);
      arrange(layer, nearest_first(layer, from, tangent_,
                                   [&](std::size_t done) { told(starts[i] + done); }));
      from = layer.back();
      told(starts[i + 1]);
    }
  }

  void cone() {
    arrange(cloud_, cone_first(cloud_, options_.start, options_.cone, tangent_, tell(0, 1)));
  }

 private:
  // Part of the progress at which all tours have been made; the rest is repair.
  static constexpr double tours_part = 0.95;

  void tours(const Starts& starts, const LayerWork& make_tour) {
    for_each_layer(cloud_, starts, options_.threads, make_tour, tell(0, tours_part));
    join(starts, cut_tour);
    keep_rule(starts);
  }

  /// Each layer goes on where the one below ended.
  void join(const Starts& starts, void (*fit)(std::span<Point>, const Point&)) {
    Point from = options_.start;
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      const std::span<Point> layer =
          std::span(cloud_).subspan(starts[i], starts[i + 1] - starts[i]);
      fit(layer, from);
      from = layer.back();
    }
  }

  void keep_rule(const Starts& starts) {
    for_each_layer(
        cloud_, starts, options_.threads,
        [this](std::span<Point> layer) { pull_ahead(layer, tangent_); }, tell(tours_part, 1));
  }

  /// Told points done, tells progress from `first` to `last`.
  std::function<void(std::size_t)> tell(double first, double last) const {
    return [this, first, last](std::size_t done) {
      if (!options_.progress) return;
      const double part = static_cast<double>(done) / static_cast<double>(cloud_.size());
      options_.progress(first + (last - first) * part);
    };
  }

  PointCloud& cloud_;
  const OrderOptions& options_;
  double tangent_;
};

void check(const PointCloud& cloud, const OrderOptions& options) {
  points::require_count(static_cast<double>(cloud.size()), "order");
  points::require_positive(options.layer_mm, "order", "layer thickness");
  cone_tangent(options.half_angle_deg);
  for (const double weight : {options.cone.up, options.cone.down}) {
    if (std::isfinite(weight)) continue;
    throw Error(Exit::bad_input, "order", fmt::format("a weight of the cone is {}", weight),
                "give finite numbers");
  }
}

}  // namespace

std::optional<Ordering> ordering_named(std::string_view name) {
  const auto found = std::find(ordering_names.begin(), ordering_names.end(), name);
  if (found == ordering_names.end()) return std::nullopt;
  return static_cast<Ordering>(found - ordering_names.begin());
}

PointCloud order(PointCloud cloud, Ordering ordering, const OrderOptions& options) {
  if (ordering == Ordering::given || cloud.empty()) return cloud;
  check(cloud, options);
  Run run(cloud, options);
  switch (ordering) {
    case Ordering::given:
      break;
    case Ordering::layers:
      run.layers();
      break;
    case Ordering::serpentine:
      run.serpentine();
      break;
    case Ordering::nearest:
      run.nearest();
      break;
    case Ordering::cone:
      run.cone();
      break;
    case Ordering::best:
      run.best();
      break;
  }
  if (options.progress) options.progress(1);
  return cloud;
}

}  // namespace lamplock::order
