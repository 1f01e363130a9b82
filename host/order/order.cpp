#include "host/order/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/order/anneal.hpp"
#include "host/order/clusters.hpp"
#include "host/order/cost.hpp"
#include "host/order/layer_joins.hpp"
#include "host/order/layers.hpp"
#include "host/order/open_tour.hpp"
#include "host/order/permute.hpp"
#include "host/order/serpentine.hpp"
#include "host/order/shadow.hpp"
#include "host/order/tour.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using geometry::PointCloud;

/// Fits a layer to the points fired before it, or to the position of the machine if there are none.
using Fit =
    std::function<void(std::span<Point> layer, std::span<const Point> before, const Point& from)>;

/// Begins strips at the nearer end.
void turn_to(std::span<Point> strips, std::span<const Point> before, const Point& from) {
  const Point& last = before.empty() ? from : before.back();
  if (distance(last, strips.back()) < distance(last, strips.front()))
    std::reverse(strips.begin(), strips.end());
}

Fit cut_by(const TourCost& cost) {
  return [cost](std::span<Point> tour, std::span<const Point> before, const Point& from) {
    cut_tour(tour, before, from, cost);
  };
}

/// Evaluations of the model per point for `best`: for a million points those possible within 20 s
/// on two cores beside the annealing; for small clouds more, up to the useful maximum.
std::size_t asked_a_point(std::size_t points) {
  constexpr std::size_t asked_in_all = 2'000'000, fewest = 2, most = 200;
  return std::clamp<std::size_t>(asked_in_all / points, fewest, most);
}

/// The same for the annealing of the whole order, whose evaluations are slower and save more.
double annealed_a_point(std::size_t points) {
  constexpr double asked_in_all = 560e3, fewest = 0.35, most = 40;
  return std::clamp(asked_in_all / static_cast<double>(points), fewest, most);
}

/// One job of ordering a cloud that is not empty.
class Run {
 public:
  Run(PointCloud& cloud, const OrderOptions& options)
      : cloud_(cloud), options_(options), tangent_(cone_tangent(options.half_angle_deg)) {}

  void layers() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    by_layers(
        starts, [](std::span<Point> layer) { permute(layer, even_tour(layer)); },
        cut_by(TourCost()), 1);
  }

  void serpentine() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    by_layers(
        starts, [](std::span<Point> layer) { permute(layer, to_and_fro(layer)); }, turn_to, 1);
  }

  void best() {
    constexpr double layers_part = 0.5, pieces_part = 0.6;
    const BeatModel model(options_.motion);
    const std::size_t asked = asked_a_point(cloud_.size());
    const Starts layers = sort_into_fitting_layers(cloud_, tangent_);
    const double jump = jump_mm(cloud_, model);
    const Starts starts = split_into_parts(cloud_, layers, jump, tangent_);
    by_layers(
        starts, [&](std::span<Point> layer) { permute(layer, beat_tour(layer, model, asked)); },
        cut_by(TourCost(model)), layers_part);
    join_pieces(cloud_, starts, options_.start, jump, model, tangent_,
                reporter(layers_part, pieces_part));
    anneal(cloud_, model, tangent_, annealed_a_point(cloud_.size()), options_.threads,
           reporter(pieces_part, 1));
  }

  void nearest() {
    const Starts starts = sort_into_layers(cloud_, options_.layer_mm);
    Point from = options_.start;
    const auto report = reporter(0, 1);
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      const std::span<Point> layer =
          std::span(cloud_).subspan(starts[i], starts[i + 1] - starts[i]);
      permute(layer, nearest_first(layer, from, tangent_,
                                   [&](std::size_t done) { report(starts[i] + done); }));
      from = layer.back();
      report(starts[i + 1]);
    }
  }

  void cone() {
    permute(std::span(cloud_),
            cone_first(cloud_, options_.start, options_.cone, tangent_, reporter(0, 1)));
  }

 private:
  /// Arranges each layer, fits each to the end of the one below, and repairs violations of the
  /// shadow rule inside it. `end` is the progress after it.
  void by_layers(const Starts& starts, const LayerWork& arrange_layer, const Fit& fit, double end) {
    constexpr double arranged_part = 0.95;
    for_each_layer(cloud_, starts, options_.threads, arrange_layer,
                   reporter(0, arranged_part * end));
    const std::span<Point> all(cloud_);
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      fit(all.subspan(starts[i], starts[i + 1] - starts[i]), all.first(starts[i]), options_.start);
    }
    for_each_layer(
        cloud_, starts, options_.threads,
        [this](std::span<Point> layer) { pull_ahead(layer, tangent_); },
        reporter(arranged_part * end, end));
  }

  /// A function that converts points done to progress from `first` to `last` and reports it.
  std::function<void(std::size_t)> reporter(double first, double last) const {
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
  geometry::require_count(static_cast<double>(cloud.size()), "order");
  geometry::require_positive(options.layer_mm, "order", "layer thickness");
  cone_tangent(options.half_angle_deg);
  require_coordinates(cloud);
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
