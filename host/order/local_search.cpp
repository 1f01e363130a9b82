#include "host/order/local_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/order/cost.hpp"

namespace lamplock::order {
namespace {

using Node = std::uint32_t;
using Slot = std::int64_t;  // in the tour, modulo its length

// The longest piece of the tour that one exchange may reverse: bounds the time of an exchange.
constexpr Slot max_piece = 1000;
// The longest piece that is moved (Or-opt).
constexpr Slot max_moved = 3;
// Gains below this are rounding, and would let exchanges undo each other.
constexpr double min_gain = 1e-9;

// For the search by the planner's model:
// Points on either side of a changed edge that are planned again; a change has no effect further
// on.
constexpr Slot search_window = 6;
// The model is not asked about an exchange whose cost is worse by more than this.
constexpr double max_search_loss = 1.5;
// Weight of the cost against a beat of the model: the cost predicts better which exchanges are
// possible next.
constexpr double search_cost_weight = 0.1;
// The minimum saving, beats.
constexpr double min_saving = 1e-3;
// Windows measure the whole tour only roughly, so exchanges might repeat for ever.
constexpr std::size_t max_rounds = 30;

class LocalSearch {
 public:
  /// An open tour is a closed one with one more node whose edges cost nothing.
  LocalSearch(std::span<const geometry::Point> points, const Neighbours& neighbours,
              Closing closing, const TourCost& cost, std::vector<Node>& tour)
      : points_(points),
        cost_(cost),
        neighbours_(neighbours),
        free_node_(static_cast<Node>(points.size())),
        tour_(tour) {
    if (closing == Closing::open) tour_.push_back(free_node_);
    size_ = static_cast<Slot>(tour_.size());
    place_.resize(points.size() + 1);
    for (Slot i = 0; i < size_; ++i) place_[at(i)] = i;
  }

  void run() {
    waiting_.assign(tour_.begin(), tour_.end());
    is_waiting_.assign(points_.size() + 1, true);
    search(std::numeric_limits<std::size_t>::max());
    cut_at_free_node();
  }

  /// The same where beats are wasted, by the model.
  void run_judged(const BeatModel& model, std::size_t max_asked) {
    judge_ = &model;
    asks_left_ = max_asked;
    is_waiting_.assign(points_.size() + 1, false);
    wake_wasted();
    search(max_rounds);
    cut_at_free_node();
  }

 private:
  Slot wrap(Slot place) const {
    return place < 0 ? place + size_ : place >= size_ ? place - size_ : place;
  }
  Node at(Slot place) const { return tour_[static_cast<std::size_t>(wrap(place))]; }

  double edge(Node a, Node b) const {
    return a == free_node_ || b == free_node_ ? 0 : cost_.edge(points_[a], points_[b]);
  }
  double turn(Node a, Node b, Node c) const {
    if (a == free_node_ || b == free_node_ || c == free_node_) return 0;
    return cost_.turn(points_[a], points_[b], points_[c]);
  }
  /// Cost of the edge b-c and of the turns at both its ends.
  double joint(Node a, Node b, Node c, Node d) const {
    return turn(a, b, c) + edge(b, c) + turn(b, c, d);
  }

  void wake(std::initializer_list<Node> nodes) {
    for (const Node node : nodes) {
      if (is_waiting_[node]) continue;
      is_waiting_[node] = true;
      waiting_.push_back(node);
    }
  }

  /// Rounds over all nodes whose surroundings changed, in the order in which they changed.
  void search(std::size_t rounds) {
    std::vector<Node> round;
    for (; !waiting_.empty() && rounds > 0 && !exhausted(); --rounds) {
      round.swap(waiting_);
      waiting_.clear();
      for (const Node node : round) {
        is_waiting_[node] = false;
        if (node != free_node_ && !exhausted() && try_node(node)) wake({node});
      }
    }
  }

  /// Nodes next to steps of several beats.
  void wake_wasted() {
    PlanState state = judge_->any_speed();
    for (Slot i = 0; i < size_; ++i) {
      const Node a = at(i), b = at(i + 1);
      if (a == free_node_ || b == free_node_) {
        state = judge_->any_speed();
      } else if (judge_->step(state, points_[a], points_[b]) > 1) {
        wake({at(i - 1), a, b, at(i + 2)});
      }
    }
  }

  /// A piece of the tour: nodes counted from the place and in the direction of an exchange.
  struct Piece {
    Slot first = 0, count = 0;
    bool turned = false;
  };

  /// A plan through one piece after the other.
  struct Ride {
    PlanState state{};
    Node last = 0;  // free_node_: the next point may have any speed
    bool has_free_node = false;
    int steps = 0, wasted = 0;  // beats above one a step
  };

  /// Continues a plan through a piece until it wastes more than `allowed` beats. The middle of a
  /// long piece is left out.
  void plan(Ride& ride, Slot from, Slot step, const Piece& piece, int allowed) const {
    for (Slot i = 0; i < piece.count; ++i) {
      if (i == search_window && piece.count > 2 * search_window) {
        i = piece.count - search_window;
        ride.last = free_node_;
      }
      const Slot place = piece.first + (piece.turned ? piece.count - 1 - i : i);
      const Node node = at(wrap(from + step * place));
      ride.has_free_node |= node == free_node_;
      if (ride.last == free_node_ || node == free_node_) {
        ride.state = judge_->any_speed();
      } else {
        ride.wasted += judge_->step(ride.state, points_[ride.last], points_[node]) - 1;
        ++ride.steps;
        if (ride.wasted > allowed) return;
      }
      ride.last = node;
    }
  }

  /// Decides on an exchange that saves `gain` of the cost: the consecutive pieces `first` and
  /// `second`, which end before node `end`, become `moved_first` and `moved_second`.
  bool accepts(double gain, Slot from, Slot step, Slot end, const Piece& first, const Piece& second,
               const Piece& moved_first, const Piece& moved_second) {
    if (judge_ == nullptr) return gain >= min_gain;
    if (gain < -max_search_loss || exhausted()) return false;
    --asks_left_;
    const Slot around = std::min(search_window, (size_ - end) / 2);
    const Piece before{-around, around}, after{end, around};
    constexpr int unlimited = std::numeric_limits<int>::max();
    Ride now;
    now.last = free_node_;
    plan(now, from, step, before, unlimited);
    Ride then = now;
    for (const Piece& piece : {first, second, after}) plan(now, from, step, piece, unlimited);
    const auto min_saved = static_cast<int>(std::ceil(min_saving - search_cost_weight * gain));
    // The free node takes away steps, and not the same number on both sides of an exchange.
    const int allowed = now.has_free_node ? unlimited : now.wasted - min_saved;
    if (then.wasted > allowed) return false;
    for (const Piece& piece : {moved_first, moved_second, after}) {
      plan(then, from, step, piece, allowed);
      if (then.wasted > allowed) return false;
    }
    return now.steps + now.wasted - then.steps - then.wasted >= min_saved;
  }

  bool exhausted() const { return judge_ != nullptr && asks_left_ == 0; }

  /// Rise of the cost above which an exchange is rejected without the model.
  double loss() const { return judge_ != nullptr ? max_search_loss : 0; }

  bool try_node(Node a) {
    for (const Slot step : {Slot{1}, Slot{-1}}) {
      const Slot p = place_[a];
      const double now = joint(at(p - step), a, at(p + step), at(p + 2 * step));
      for (const Node c : neighbours_.of(a)) {
        if (edge(a, c) >= now + loss()) break;  // the new edge alone costs more than is saved
        if (try_two_opt(p, place_[c], step, now)) return true;
      }
    }
    for (Slot length = 1; length <= max_moved && length + 5 <= size_; ++length) {
      for (const Slot step : {Slot{1}, Slot{-1}}) {
        if (try_move(a, length, step)) return true;
      }
    }
    return false;
  }

  /// Edges (p, p + step) and (q, q + step) become (p, q) and (p + step, q + step).
  bool try_two_opt(Slot p, Slot q, Slot step, double now_p) {
    if (wrap(p + step) == q || wrap(q + step) == p) return false;
    const Node a = at(p), b = at(p + step), c = at(q), d = at(q + step);
    const Node before_a = at(p - step), after_b = at(p + 2 * step);
    const Node before_c = at(q - step), after_d = at(q + 2 * step);
    const double gain = now_p + joint(before_c, c, d, after_d) - joint(before_a, a, c, before_c) -
                        joint(after_b, b, d, after_d);
    const Slot turned = wrap((q - p) * step);  // nodes after p, up to q
    if (!accepts(gain, wrap(p + step), step, turned, {0, turned}, {}, {0, turned, true}, {}))
      return false;
    Slot first = step > 0 ? wrap(p + 1) : q, last = step > 0 ? q : wrap(p - 1);
    if (piece(first, last) > size_ / 2) {  // reversing the rest of the circle gives the same tour
      std::swap(first, last);
      first = wrap(first + 1);
      last = wrap(last - 1);
    }
    if (piece(first, last) > max_piece) return false;
    reverse(first, last);
    wake({a, b, c, d, before_a, after_b, before_c, after_d});
    return true;
  }

  /// Moves the `length` nodes from `a` on in direction `step` next to a neighbour of a.
  bool try_move(Node a, Slot length, Slot step) {
    const Slot p = place_[a];
    const Node end = at(p + step * (length - 1));
    const Node u = at(p - step), w = at(p + step * length);
    const Node before_u = at(p - 2 * step), after_w = at(p + step * (length + 1));
    const Node second = length > 1 ? at(p + step) : w;
    const Node last_but_one = length > 1 ? at(p + step * (length - 2)) : u;
    // All edges and turns between the piece and the rest; a single node has only one turn.
    double now = joint(before_u, u, a, second) + joint(last_but_one, end, w, after_w);
    if (length == 1) now -= turn(u, a, w);
    const double freed = now - joint(before_u, u, w, after_w);
    if (freed < min_gain - loss()) return false;
    for (const Node c : neighbours_.of(a)) {
      if (edge(a, c) >= freed + loss()) break;
      const Slot q = place_[c];
      if (wrap((q - p) * step) < length) continue;  // inside the piece
      for (const Slot side : {Slot{1}, Slot{-1}}) {
        const Node e = at(q + side), before_c = at(q - side), after_e = at(q + 2 * side);
        if (c == u || c == w || e == u || e == w) continue;
        double then = joint(before_c, c, a, length > 1 ? second : e) +
                      joint(length > 1 ? last_but_one : c, end, e, after_e);
        if (length == 1) then -= turn(c, a, e);
        const double gain = freed + joint(before_c, c, e, after_e) - then;
        const Slot gap = wrap((q - p) * step) + (side == step ? 1 : 0) - length;
        if (!accepts(gain, p, step, length + gap, {0, length}, {length, gap}, {length, gap},
                     {0, length, side != step}))
          continue;
        if (!move(p, length, step, q, side)) continue;
        wake({u, before_u, w, after_w, c, before_c, e, after_e, a, end});
        return true;
      }
    }
    return false;
  }

  /// Makes a move if the gap that the piece jumps over is short enough.
  bool move(Slot p, Slot length, Slot step, Slot q, Slot side) {
    const Slot first = step > 0 ? p : wrap(p - length + 1), last = wrap(first + length - 1);
    const Slot low = side > 0 ? q : wrap(q - 1);  // the piece goes between low and low + 1
    const Slot forward = wrap(low - last), backward = wrap(first - low - 1);
    if (std::min(forward, backward) > max_piece) return false;
    const bool turned = step != side;
    if (forward <= backward) {
      reverse(first, low);  // swaps piece and gap, both reversed; each is then reversed again
      reverse(first, wrap(first + forward - 1));
      if (!turned) reverse(wrap(first + forward), low);
    } else {
      const Slot begin = wrap(low + 1);
      reverse(begin, last);
      reverse(wrap(begin + length), last);
      if (!turned) reverse(begin, wrap(begin + length - 1));
    }
    return true;
  }

  /// Number of nodes from place `first` to place `last`, across the end if necessary.
  Slot piece(Slot first, Slot last) const { return wrap(last - first) + 1; }

  void reverse(Slot first, Slot last) {
    for (Slot n = piece(first, last) / 2; n > 0; --n) {
      std::swap(tour_[static_cast<std::size_t>(first)], tour_[static_cast<std::size_t>(last)]);
      place_[at(first)] = first;
      place_[at(last)] = last;
      first = wrap(first + 1);
      last = wrap(last - 1);
    }
  }

  void cut_at_free_node() {
    const auto found = std::find(tour_.begin(), tour_.end(), free_node_);
    if (found == tour_.end()) return;
    std::rotate(tour_.begin(), found, tour_.end());
    tour_.erase(tour_.begin());
  }

  std::span<const geometry::Point> points_;
  const TourCost cost_;
  const Neighbours& neighbours_;
  Node free_node_;
  std::vector<Node>& tour_;
  Slot size_ = 0;
  std::vector<Slot> place_;
  std::vector<Node> waiting_;
  std::vector<bool> is_waiting_;
  const BeatModel* judge_ = nullptr;
  std::size_t asks_left_ = 0;
};

}  // namespace

void improve(std::span<const geometry::Point> points, const Neighbours& neighbours, Closing closing,
             const TourCost& cost, std::vector<std::uint32_t>& tour) {
  constexpr std::size_t too_few_to_improve = 5;
  if (points.size() < too_few_to_improve) return;
  LocalSearch(points, neighbours, closing, cost, tour).run();
}

void save_beats(std::span<const geometry::Point> points, const Neighbours& neighbours,
                Closing closing, const BeatModel& model, std::size_t max_asked,
                std::vector<std::uint32_t>& tour) {
  if (points.size() < 2 * static_cast<std::size_t>(search_window)) return;
  LocalSearch(points, neighbours, closing, TourCost(model), tour).run_judged(model, max_asked);
}

}  // namespace lamplock::order
