#include "host/order/layer_joins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "host/order/cone.hpp"
#include "host/order/cost.hpp"
#include "host/order/layers.hpp"
#include "host/order/open_tour.hpp"
#include "host/order/permute.hpp"
#include "host/order/remaining_points.hpp"
#include "host/order/shadow.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using geometry::PointCloud;
using Number = std::uint32_t;  // of a piece

constexpr Number no_piece = std::numeric_limits<Number>::max();
// Pieces, in the input order, that are candidates for the next one besides the nearest.
constexpr std::size_t choice = 64;

/// Places first .. first + count - 1 of the input order.
struct Piece {
  std::size_t first = 0, count = 0;
  bool ring = false;  // ends where it begins
  bool fired = false;
  Number blocker = no_piece;  // a piece that must be fired before, if found so far
};

/// Median distance from a point to the next.
double usual_step_mm(const PointCloud& order) {
  std::vector<float> steps;
  steps.reserve(order.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    steps.push_back(static_cast<float>(distance(order[i - 1], order[i])));
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

class Join {
 public:
  Join(const PointCloud& order, const std::vector<std::size_t>& starts, double jump,
       const BeatModel& model, double tangent)
      : order_(order),
        cost_(model),
        tangent_(tangent),
        jump_mm_(jump),
        rest_(order),
        piece_of_(order.size()) {
    // A ring's ends are not much further apart than its points.
    constexpr double steps_between_ends = 2.5;
    const double ring_mm = steps_between_ends * usual_step_mm(order);
    for (std::size_t layer = 0; layer + 1 < starts.size(); ++layer) {
      split(starts[layer], starts[layer + 1], ring_mm);
    }
  }

  /// The places of the input order, in the new order.
  Indices run(Point from, const std::function<void(std::size_t)>& progress) {
    result_.reserve(order_.size());
    for (std::size_t left = pieces_.size(); left > 0; --left) {
      while (pieces_[first_left_].fired) ++first_left_;
      fire_piece(next_piece(from), from);
      from = order_[result_.back()];
      if (progress) progress(result_.size());
    }
    return std::move(result_);
  }

 private:
  void split(std::size_t begin, std::size_t end, double ring_mm) {
    for (std::size_t i = begin; i < end;) {
      std::size_t next = i + 1;
      while (next < end && distance(order_[next - 1], order_[next]) < jump_mm_) ++next;
      std::fill(piece_of_.begin() + static_cast<std::ptrdiff_t>(i),
                piece_of_.begin() + static_cast<std::ptrdiff_t>(next), pieces_.size());
      const bool ring = next - i > 2 && distance(order_[i], order_[next - 1]) < ring_mm;
      pieces_.push_back({i, next - i, ring});
      i = next;
    }
  }

  std::span<const Point> points_of(const Piece& piece) const {
    return std::span(order_).subspan(piece.first, piece.count);
  }

  double way_to(const Point& from, const Piece& piece) const {
    const auto points = points_of(piece);
    if (!piece.ring) return std::min(distance(from, points.front()), distance(from, points.back()));
    double least = std::numeric_limits<double>::infinity();
    for (const Point& p : points) least = std::min(least, distance(from, p));
    return least;
  }

  /// The nearest of the pieces that may be fired now. The first remaining piece always may.
  Number next_piece(const Point& from) {
    std::vector<std::pair<double, Number>> near;
    for (Number i = first_left_; i < pieces_.size() && near.size() < choice; ++i) {
      if (!pieces_[i].fired) near.emplace_back(way_to(from, pieces_[i]), i);
    }
    // The nearest may be any number of layers up: with many legs the candidates are all in one
    // layer.
    const Number nearest = piece_of_[rest_.cheapest(Nearest{from})];
    near.emplace_back(way_to(from, pieces_[nearest]), nearest);
    std::sort(near.begin(), near.end());
    for (const auto& [way, i] : near) {
      if (take(i)) return i;
    }
    return first_left_;  // not reached
  }

  /// Removes the points of a piece from the rest, unless it shadows a remaining point.
  bool take(Number number) {
    Piece& piece = pieces_[number];
    if (piece.blocker != no_piece && !pieces_[piece.blocker].fired) return false;
    const auto first = static_cast<std::uint32_t>(piece.first);
    const auto end = static_cast<std::uint32_t>(piece.first + piece.count);
    for (std::uint32_t i = first; i < end; ++i) rest_.remove(i);
    if (number == first_left_) return true;
    for (std::uint32_t i = first; i < end; ++i) {
      const auto lower = rest_.under_cone(order_[i], tangent_);
      if (!lower) continue;
      piece.blocker = piece_of_[*lower];
      for (std::uint32_t k = first; k < end; ++k) rest_.put_back(k);
      return false;
    }
    return true;
  }

  void fire_piece(Number number, const Point& from) {
    Piece& piece = pieces_[number];
    piece.fired = true;
    const auto points = points_of(piece);
    Indices way(piece.count);
    std::iota(way.begin(), way.end(), static_cast<std::uint32_t>(piece.first));
    const Indices as_it_came = way;
    if (piece.ring) {
      cut_open(std::span(way), find_cut(points, last_fired(), from, cost_));
    } else if (distance(from, points.back()) < distance(from, points.front())) {
      std::reverse(way.begin(), way.end());
    }
    if (!keeps_rule(way)) way = as_it_came;
    result_.insert(result_.end(), way.begin(), way.end());
  }

  /// The last two points, or fewer.
  PointCloud last_fired() const {
    PointCloud last;
    for (std::size_t i = result_.size() - std::min<std::size_t>(2, result_.size());
         i < result_.size(); ++i)
      last.push_back(order_[result_[i]]);
    return last;
  }

  bool keeps_rule(const Indices& way) const {
    PointCloud piece;
    piece.reserve(way.size());
    for (const std::uint32_t i : way) piece.push_back(order_[i]);
    const auto [low, high] = std::minmax_element(
        piece.begin(), piece.end(), [](const Point& p, const Point& q) { return p.z < q.z; });
    return low->z == high->z || !find_shadowed(piece, tangent_);
  }

  const PointCloud& order_;
  TourCost cost_;
  double tangent_, jump_mm_;
  RestTree rest_;
  std::vector<Number> piece_of_;
  std::vector<Piece> pieces_;
  Number first_left_ = 0;
  Indices result_;
};

long beats(const BeatModel& model, const PointCloud& cloud, const Indices& order) {
  PlanState state;
  long sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    sum += model.step(state, cloud[order[i - 1]], cloud[order[i]]);
  return sum;
}

}  // namespace

double jump_mm(const PointCloud& cloud, const BeatModel& model) {
  constexpr double spacings = 3;
  // Rest to rest 2 sqrt(4) = 4 beats: a shorter jump is hardly worth a detour.
  constexpr double units = 4;
  const double unit_mm = std::max({model.unit_mm(0), model.unit_mm(1), model.unit_mm(2)});
  return std::max(spacings * usual_spacing_mm(cloud), units * unit_mm);
}

void join_pieces(PointCloud& order, const std::vector<std::size_t>& starts, const Point& from,
                 double jump, const BeatModel& model, double tangent,
                 const std::function<void(std::size_t)>& progress) {
  Indices joined = Join(order, starts, jump, model, tangent).run(from, progress);
  if (beats(model, order, joined) < model.beats(order))
    permute(std::span(order), std::move(joined));
}

}  // namespace lamplock::order
