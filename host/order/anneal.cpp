#include "host/order/anneal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "host/geometry/random.hpp"
#include "host/order/cone.hpp"
#include "host/order/cost.hpp"
#include "host/order/layers.hpp"
#include "host/order/local_search.hpp"
#include "host/order/permute.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using Node = std::uint32_t;
using Index = std::int32_t;  // in a stretch

// Values tuned on the torus of docs/ordering.md at 100 Hz and 2 m/s2; its other clouds, and clouds
// of other sizes and shapes, were used as a check only.

// Points of a stretch.
constexpr std::size_t stretch_points = 4000;
// Stretches of the second pass begin in the middle of those of the first.
constexpr std::size_t passes = 2;
// Points on either side of a change that are planned again, as in the local search; as many at the
// ends of a stretch keep their places.
constexpr Index window = 6;
// The longest piece that is reversed: 50 leaves 0.4 % more beats, 1000 saves none.
constexpr Index max_turned = 300;
// Maximum lengths of long and short moved pieces, maximum distance; share of moves of long pieces.
constexpr Index max_moved = 100, short_moved = 3, max_exchange = 1000;
constexpr double long_share = 0.3;
// Exchanges that are tried for each node in a round.
constexpr int tries = 4;
// The temperature at the beginning and at the end, in beats that an exchange may waste.
constexpr double hot = 0.15, cold = 0.05;
// Weight of the cost of a tour against a beat of the model, and the maximum rise of the cost.
constexpr double cost_weight = 0.3, max_loss = 1.5;

/// Places first .. first + count - 1 of the path, maybe reversed.
struct AnnealedPiece {
  Index first = 0, count = 0;
  bool turned = false;

  Index at(Index i) const { return first + (turned ? count - 1 - i : i); }
};
using AnnealedPieces = std::array<AnnealedPiece, 2>;

/// Two consecutive pieces, and the pieces that replace them. The second may be empty.
struct Exchange {
  AnnealedPieces now{}, then{};
  Index first = 0, end = 0;  // of both
};

/// One stretch of an order.
class Stretch {
 public:
  Stretch(std::span<const Point> path, const BeatModel& model, double tangent, std::size_t asks,
          std::uint64_t seed)
      : points_(path),
        model_(model),
        cost_(model),
        tangent_(tangent),
        asks_(asks),
        size_(static_cast<Index>(path.size())),
        neighbours_(find_neighbours(path, few_beats_neighbours)),
        path_(path.size()),
        place_(path.size()),
        random_(seed) {
    std::iota(path_.begin(), path_.end(), 0u);
    std::iota(place_.begin(), place_.end(), 0);
  }

  /// The numbers of the points in the best order found.
  Indices run() {
    Indices best = path_;
    long fewest = find_wasted();
    for (std::size_t left = asks_; left > 0 && !wasted_.empty();) {
      const double done = 1 - static_cast<double>(left) / static_cast<double>(asks_);
      temperature_ = hot * std::pow(cold / hot, done);
      asked_ = 0;
      for (const Node node : wasted_) {
        for (int i = 0; i < tries; ++i) try_one(node);
      }
      // A round costs time even if it never asks the model.
      constexpr std::size_t nodes_an_ask = 8;
      left -= std::min(left, std::max(asked_, wasted_.size() / nodes_an_ask + 1));
      const long beats = find_wasted();
      if (beats >= fewest) continue;
      fewest = beats;
      best = path_;
    }
    return best;
  }

 private:
  Node node(Index place) const { return path_[static_cast<std::size_t>(place)]; }
  const Point& at(Index place) const { return points_[node(place)]; }
  /// 0 to count - 1.
  Index random_below(std::size_t count) { return static_cast<Index>(random_.next() % count); }

  /// Beats of the whole path; notes the nodes near steps that take several.
  long find_wasted() {
    constexpr Index near = 3;
    wasted_.clear();
    Index noted = window;
    PlanState state = model_.any_speed();
    long sum = 0;
    for (Index i = 1; i < size_; ++i) {
      const int step = model_.step(state, at(i - 1), at(i));
      sum += step;
      if (step == 1) continue;
      for (noted = std::max(noted, i - near); noted < std::min(size_ - window, i + near); ++noted)
        wasted_.push_back(node(noted));
    }
    return sum;
  }

  /// Tries to place a node beside one of its neighbours.
  void try_one(Node a) {
    const auto near = neighbours_.of(a);
    const Index p = place_[a],
                q = place_[near[static_cast<std::size_t>(random_below(near.size()))]];
    switch (random_below(4)) {
      case 0:
        return turn(std::min(p, q) + 1, std::max(p, q));
      case 1:
        return turn(std::min(p, q), std::max(p, q) - 1);
      default:
        return move(p, q);
    }
  }

  /// Considers reversing the piece between two places (2-opt).
  void turn(Index first, Index last) {
    const Index count = last - first + 1;
    if (count < 2 || count > max_turned) return;
    consider({{{{first, count, false}, {}}}, {{{first, count, true}, {}}}, first, last + 1});
  }

  /// Considers moving a piece that begins or ends at p so that its node at p follows or precedes
  /// the node at q.
  void move(Index p, Index q) {
    const bool is_long = random_.uniform() < long_share;
    const Index most = is_long ? max_moved : short_moved;
    const Index count = 1 + random_below(static_cast<std::size_t>(most));
    const bool ahead = random_below(2) == 1, after_q = random_below(2) == 1;
    const Index first = ahead ? p : p - count + 1, end = first + count;
    const Index gap = after_q ? q + 1 : q;  // the piece goes before this place
    if (gap >= first && gap <= end) return;
    const AnnealedPiece piece{first, count, false}, moved{first, count, ahead != after_q};
    const AnnealedPiece way =
        gap > end ? AnnealedPiece{end, gap - end} : AnnealedPiece{gap, first - gap};
    if (way.count > max_exchange) return;
    if (gap > end)
      consider({{{piece, way}}, {{way, moved}}, first, gap});
    else
      consider({{{way, piece}}, {{moved, way}}, gap, end});
  }

  void consider(const Exchange& exchange) {
    if (exchange.first < window || exchange.end > size_ - window) return;
    const double gain = cost(exchange, exchange.now) - cost(exchange, exchange.then);
    if (gain < -max_loss) return;
    ++asked_;
    // 1 - uniform() is never 0.
    const double worst = temperature_ * std::log(1 - random_.uniform());
    if (!saves(exchange, static_cast<long>(std::ceil(worst - cost_weight * gain)))) return;
    if (keeps_rule(exchange)) carry_out(exchange);
  }

  /// Checks all pairs of points whose order would be reversed.
  bool keeps_rule(const Exchange& exchange) const {
    for (const AnnealedPiece& piece : exchange.then) {
      if (!piece.turned) continue;
      for (Index i = 1; i < piece.count; ++i)
        if (shadows_any(piece.first + i, {piece.first, i})) return false;
    }
    const auto& [one, two] = exchange.now;
    for (Index i = 0; i < two.count; ++i)
      if (shadows_any(two.first + i, one)) return false;
    return true;
  }

  /// True if a defect at place `upper` shadows a point of the piece.
  bool shadows_any(Index upper, const AnnealedPiece& piece) const {
    const Point& apex = at(upper);
    for (Index i = piece.first; i < piece.first + piece.count; ++i)
      if (shadows(apex, at(i), tangent_)) return true;
    return false;
  }

  void carry_out(const Exchange& exchange) {
    changed_.clear();
    for (const AnnealedPiece& piece : exchange.then)
      for (Index i = 0; i < piece.count; ++i) changed_.push_back(node(piece.at(i)));
    Index place = exchange.first;
    for (const Node one : changed_) {
      path_[static_cast<std::size_t>(place)] = one;
      place_[one] = place++;
    }
  }

  /// Visits the points of pieces and of up to `around` points after them, each with the number of
  /// consecutive points visited before it, the first with `known`: the middles of long pieces are
  /// left out. Ends when a visit returns false, and returns whether none did.
  template <class Visit>
  bool walk(const Exchange& exchange, const AnnealedPieces& pieces, Index around, int known,
            Visit&& visit) const {
    for (const AnnealedPiece& piece : pieces) {
      for (Index i = 0; i < piece.count; ++i) {
        if (i == around && piece.count > 2 * around) {
          i = piece.count - around;
          known = 0;
        }
        if (!visit(at(piece.at(i)), known++)) return false;
      }
    }
    for (Index i = exchange.end; i < exchange.end + around; ++i)
      if (!visit(at(i), known++)) return false;
    return true;
  }

  double cost(const Exchange& exchange, const AnnealedPieces& pieces) const {
    constexpr Index felt = 2;  // a turn is between three points
    double sum = 0;
    const Point *last = &at(exchange.first - 1), *before = &at(exchange.first - felt);
    walk(exchange, pieces, felt, felt, [&](const Point& p, int known) {
      if (known >= 1) sum += cost_.edge(*last, p);
      if (known >= 2) sum += cost_.turn(*before, *last, p);
      before = last;
      last = &p;
      return true;
    });
    return sum;
  }

  /// True if an exchange saves at least `min_saved` beats. The points before it are planned once,
  /// and the new pieces only as long as they can still save enough.
  bool saves(const Exchange& exchange, long min_saved) const {
    PlanState before = model_.any_speed();
    for (Index i = exchange.first - window + 1; i < exchange.first; ++i)
      model_.step(before, at(i - 1), at(i));
    constexpr long unlimited = std::numeric_limits<long>::max();
    const long allowed = wasted(exchange, exchange.now, before, unlimited) - min_saved;
    return allowed >= 0 && wasted(exchange, exchange.then, before, allowed) <= allowed;
  }

  /// Beats above one a step in the pieces and in the points after them, from the state in the point
  /// before them; some number above `allowed` if there are more. Both sides of an exchange have as
  /// many steps.
  long wasted(const Exchange& exchange, const AnnealedPieces& pieces, PlanState state,
              long allowed) const {
    long sum = 0;
    const Point* last = &at(exchange.first - 1);
    walk(exchange, pieces, window, window, [&](const Point& p, int known) {
      if (known == 0) {
        state = model_.any_speed();
      } else {
        sum += model_.step(state, *last, p) - 1;
      }
      last = &p;
      return sum <= allowed;
    });
    return sum;
  }

  std::span<const Point> points_;
  const BeatModel& model_;
  TourCost cost_;
  double tangent_;
  std::size_t asks_, asked_ = 0;
  Index size_;
  double temperature_ = hot;
  Neighbours neighbours_;
  Indices path_;  // nodes by their places, and the other way round
  std::vector<Index> place_;
  std::vector<Node> wasted_, changed_;
  geometry::Random random_;
};

/// Begins of the stretches of a pass; none is shorter than half of the others.
Starts stretches(std::size_t points, std::size_t pass) {
  Starts starts{0};
  constexpr std::size_t half = stretch_points / 2;
  for (std::size_t i = pass == 0 ? stretch_points : half; i + half < points; i += stretch_points)
    starts.push_back(i);
  starts.push_back(points);
  return starts;
}

/// State of the model at a point of a path.
struct Ride {
  PlanState state{};
  long beats = 0;
};

/// A stretch was planned from any speed to any other, with some fixed points on either side. With
/// the real speeds at its begin and end the whole order may still take more beats: such stretches
/// are restored from `before`.
void take_back_waste(std::span<const Point> before, std::span<Point> order, const Starts& starts,
                     const BeatModel& model) {
  const auto go = [&model](Ride& ride, std::span<const Point> path, std::size_t to) {
    if (to > 0) ride.beats += model.step(ride.state, path[to - 1], path[to]);
  };
  Ride chosen;
  for (std::size_t s = 0; s + 1 < starts.size(); ++s) {
    const std::size_t end = starts[s + 1];
    Ride was = chosen, now = chosen;
    std::size_t i = starts[s];
    for (; i < end; ++i) {
      go(now, order, i);
      go(was, before, i);
    }
    const Ride was_there = was, now_there = now;
    // The later stretches are unchanged so far.
    for (; i < before.size() && was.state != now.state; ++i) {
      go(now, before, i);
      go(was, before, i);
    }
    const bool wastes = now.beats > was.beats;
    chosen = wastes ? was_there : now_there;
    if (wastes)
      std::copy(before.begin() + static_cast<std::ptrdiff_t>(starts[s]),
                before.begin() + static_cast<std::ptrdiff_t>(end),
                order.begin() + static_cast<std::ptrdiff_t>(starts[s]));
  }
}

}  // namespace

void anneal(geometry::PointCloud& order, const BeatModel& model, double tangent,
            double asked_a_point, unsigned threads,
            const std::function<void(std::size_t)>& progress) {
  constexpr std::size_t fewest_points = 5 * window;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const geometry::PointCloud before = order;
    const Starts starts = stretches(order.size(), pass);
    const auto work = [&](std::span<Point> path) {
      if (path.size() < fewest_points) return;
      const auto asks = static_cast<std::size_t>(asked_a_point * static_cast<double>(path.size()) /
                                                 static_cast<double>(passes));
      permute(path, Stretch(path, model, tangent, asks, pass).run());
    };
    for_each_layer(order, starts, threads, work, [&](std::size_t done) {
      if (progress) progress((pass * order.size() + done) / passes);
    });
    take_back_waste(before, order, starts, model);
  }
}

}  // namespace lamplock::order
