// improved_visits(): other start points, 2-opt (Croes 1958) and Or-opt (Or 1976) with neighbour
// lists and a queue of contours whose surroundings changed (Bentley, "Fast algorithms for geometric
// traveling salesman problems", ORSA Journal on Computing 4, 1992). Each move is checked for
// parents before children.
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "host/cutting/cut_stops.hpp"
#include "host/geometry/kd_tree.hpp"
#include "host/geometry/random.hpp"

namespace lamplock::cutting {
namespace {

// Nearest contours that a contour is tried next to; more gain hardly anything (Johnson and McGeoch,
// "The traveling salesman problem: a case study in local optimization", 1997).
constexpr std::size_t max_neighbours = 10;
// Or's moves are those of up to three places.
constexpr std::size_t max_block = 3;
// Moves over more places take longer to carry out than they are worth.
constexpr std::size_t max_span = 50'000;
// Pieces that are exchanged are near to each other, and so is what then improves the order.
constexpr std::size_t max_trial_span = 1'000;
// Maximum number of visits in each of two pieces that are exchanged.
constexpr std::size_t max_piece = 30;
// A gain below this is rounding. mm.
constexpr double min_gain_mm = 1e-9;

// Rounds of start points and orders, until one gains less than this part; then pieces are
// exchanged.
constexpr int max_rounds = 6;
constexpr double min_round_gain = 1e-3;
constexpr std::size_t exchanges_per_stop = 10, max_exchanges = 10'000;

class CutSearch {
 public:
  CutSearch(const std::vector<CutStop>& stops, const std::vector<CutVisit>& visits,
            const Vec& position)
      : stops_(stops), place_(stops.size()), position_(position), is_queued_(stops.size(), false) {
    visits_.reserve(visits.size());
    for (const CutVisit& visit : visits) {
      place_[visit.stop] = visits_.size();
      visits_.push_back(spot(visit.stop, visit.start));
    }
    find_neighbours();
  }

  /// Improves the order for its start points and the start points for the order in turns.
  std::vector<CutVisit> improved() {
    for (Place i = 0; i < count(); ++i) queue(i);
    work();
    double way = whole_way();
    for (int round = 0; round < max_rounds; ++round) {
      choose_all_starts();
      work();
      const double shorter = whole_way();
      const bool is_done = shorter > way * (1 - min_round_gain);
      way = shorter;
      if (is_done) break;
    }
    const std::size_t exchanges = std::min(exchanges_per_stop * stops_.size(), max_exchanges);
    is_on_trial_ = true;
    for (std::size_t i = 0; i < exchanges; ++i) exchange();
    is_on_trial_ = false;
    choose_all_starts();
    return order();
  }

 private:
  // Places are signed: -1 is the position of the machine, that after the last one nowhere.
  using Place = std::ptrdiff_t;

  /// A visit with its points, so that a way is found without looking at the stops.
  struct Spot {
    std::size_t stop, start;
    Vec entry, exit;
  };
  Spot spot(std::size_t stop, std::size_t start) const {
    return {stop, start, stops_[stop].entry(start), stops_[stop].exit(start)};
  }

  /// Visits `begin` to `end`, both included, moved to after `target`; with `target` = begin - 1
  /// they are turned in their place.
  struct Move {
    std::size_t begin, end;
    std::ptrdiff_t target;
    bool is_turned;
  };

  std::vector<CutVisit> order() const {
    std::vector<CutVisit> order;
    order.reserve(visits_.size());
    for (const Spot& one : visits_) order.push_back({one.stop, one.start});
    return order;
  }

  double whole_way() const {
    double sum = 0;
    for (Place i = -1; i < count(); ++i) sum += gap(i);
    return sum;
  }

  void choose_all_starts() {
    std::vector<CutVisit> chosen = order();
    choose_starts(stops_, chosen, position_);
    for (Place i = 0; i < count(); ++i) {
      const CutVisit& one = chosen[static_cast<std::size_t>(i)];
      if (one.start != visit(i).start) restart_at(i, one.start);
    }
  }

  /// Improves until no move gains anything.
  void work() {
    while (!queue_.empty()) {
      const std::size_t stop = queue_.front();
      queue_.pop_front();
      is_queued_[stop] = false;
      while (improve(stop)) {
      }
    }
  }

  /// Exchanges two pieces of the order that follow each other, and improves what that changed;
  /// takes it back if the way is longer (iterated local search with local double bridges, Johnson
  /// and McGeoch).
  void exchange() {
    const auto random_length = [&] { return 1 + static_cast<Place>(random_.next() % max_piece); };
    const auto begin = static_cast<Place>(random_.next() % visits_.size());
    const Place end = begin + random_length() - 1, target = end + random_length();
    if (target >= count() || !may_shift(begin, end, target, false)) return;
    changes_.clear();
    changed_.clear();
    gained_mm_ = gap(begin - 1) + gap(end) + gap(target) - way(exit(begin - 1), end + 1) -
                 distance(exit(target), entry(begin)) - way(exit(end), target + 1);
    apply({static_cast<std::size_t>(begin), static_cast<std::size_t>(end), target, false});
    work();
    if (gained_mm_ < 0) take_back();
  }

  /// Stores the visits `low` to `high` before they change.
  void remember(Place low, Place high) {
    if (!is_on_trial_) return;
    changes_.emplace_back(low, high);
    changed_.insert(changed_.end(), visits_.begin() + low, visits_.begin() + high + 1);
  }

  /// Undoes all changes since the last exchange.
  void take_back() {
    while (!changes_.empty()) {
      const auto [low, high] = changes_.back();
      changes_.pop_back();
      for (Place i = high; i >= low; --i) {
        visits_[static_cast<std::size_t>(i)] = changed_.back();
        changed_.pop_back();
        place_[visit(i).stop] = static_cast<std::size_t>(i);
      }
    }
  }

  void find_neighbours() {
    geometry::PointCloud points;
    points.reserve(stops_.size());
    centres_.reserve(stops_.size());
    reaches_.reserve(stops_.size());
    for (const CutStop& stop : stops_) {
      Vec sum;
      for (const Vec& start : stop.starts) sum = sum + start;
      const Vec centre = sum * (1 / static_cast<double>(stop.starts.size()));
      double reach = 0;
      for (const Vec& start : stop.starts) reach = std::max(reach, distance(centre, start));
      points.push_back({centre.x, centre.y, 0});
      centres_.push_back(centre);
      reaches_.push_back(reach);
    }
    const auto tree = geometry::kd_tree_of(points);
    neighbours_.reserve(max_neighbours * stops_.size());
    first_neighbour_.reserve(stops_.size() + 1);
    std::array<std::uint32_t, max_neighbours + 1> numbers;
    std::array<double, max_neighbours + 1> squares;
    for (std::size_t i = 0; i < stops_.size(); ++i) {
      first_neighbour_.push_back(neighbours_.size());
      const std::size_t found = tree.nearest(points[i], numbers.size(), numbers, squares);
      for (std::size_t k = 0; k < found; ++k) {
        if (numbers[k] != i) neighbours_.push_back(numbers[k]);
      }
    }
    first_neighbour_.push_back(neighbours_.size());
  }

  Place count() const { return static_cast<Place>(visits_.size()); }
  const Spot& visit(Place i) const { return visits_[static_cast<std::size_t>(i)]; }
  const Vec& entry(Place i) const { return visit(i).entry; }
  const Vec& exit(Place i) const { return i < 0 ? position_ : visit(i).exit; }
  /// The way from an exit to the entry of a place; none after the last.
  double way(const Vec& from, Place to) const {
    return to >= count() ? 0 : distance(from, entry(to));
  }
  double gap(Place i) const { return way(exit(i), i + 1); }

  Place span() const { return static_cast<Place>(is_on_trial_ ? max_trial_span : max_span); }

  bool improve(std::size_t stop) {
    const auto i = static_cast<Place>(place_[stop]);
    for (std::size_t k = first_neighbour_[stop]; k < first_neighbour_[stop + 1]; ++k) {
      const auto j = static_cast<Place>(place_[neighbours_[k]]);
      const auto [low, high] = std::minmax(i, j);
      // 2-opt: the exits, or the entries, of both become neighbours.
      if (turn(low + 1, high) || turn(low, high - 1)) return true;
      for (Place length = 1; length <= static_cast<Place>(max_block); ++length) {
        if (shift(i, i + length - 1, j) || shift(i - length + 1, i, j)) return true;
      }
    }
    if (restart(i)) return true;
    const auto last = count() - 1;
    return turn(i, last) || (i > 0 && turn(0, i));
  }

  bool turn(Place begin, Place end) {
    if (begin < 0 || begin > end) return false;
    const double gain = gap(begin - 1) + gap(end) - distance(exit(begin - 1), exit(end)) -
                        way(entry(begin), end + 1);
    if (gain <= min_gain_mm || end - begin > span()) return false;
    if (!may_turn(begin, end)) return false;
    gained_mm_ += gain;
    apply({static_cast<std::size_t>(begin), static_cast<std::size_t>(end), begin - 1, true});
    return true;
  }

  /// The start point of a closed contour with the shortest way between two points; none after it
  /// if `to` is the end of the order.
  std::size_t best_start(std::size_t stop, const Vec& from, Place to, double& shortest) const {
    const std::vector<Vec>& starts = stops_[stop].starts;
    std::size_t best = 0;
    for (std::size_t start = 0; start < starts.size(); ++start) {
      const double length = distance(from, starts[start]) + way(starts[start], to);
      if (start > 0 && length >= shortest) continue;
      shortest = length;
      best = start;
    }
    return best;
  }

  /// Another start point of a closed contour in its place.
  bool restart(Place i) {
    const std::size_t stop = visit(i).stop;
    if (stops_[stop].open) return false;
    double length = 0;
    const std::size_t start = best_start(stop, exit(i - 1), i + 1, length);
    const double gain = gap(i - 1) + gap(i) - length;
    if (gain <= min_gain_mm) return false;
    gained_mm_ += gain;
    restart_at(i, start);
    return true;
  }

  void restart_at(Place i, std::size_t start) {
    remember(i, i);
    visits_[static_cast<std::size_t>(i)] = spot(visit(i).stop, start);
    for (const Place near : {i - 1, i, i + 1}) queue(near);
  }

  /// Moves a closed contour to after `target` with the best start point there.
  bool shift_and_restart(Place i, Place target, double freed) {
    const std::size_t stop = visit(i).stop;
    // No start point is nearer than this; most targets end here.
    const double before = distance(exit(target), centres_[stop]) - reaches_[stop];
    const double after =
        target + 1 < count() ? distance(entry(target + 1), centres_[stop]) - reaches_[stop] : 0;
    if (freed + gap(target) <= std::max(0.0, before) + std::max(0.0, after)) return false;
    double length = 0;
    const std::size_t start = best_start(stop, exit(target), target + 1, length);
    const double gain = freed - (length - gap(target));
    if (gain <= min_gain_mm || !may_shift(i, i, target, false)) return false;
    gained_mm_ += gain;
    restart_at(i, start);
    apply({static_cast<std::size_t>(i), static_cast<std::size_t>(i), target, false});
    return true;
  }

  /// Moves a block before or after the place j, either way round.
  bool shift(Place begin, Place end, Place j) {
    if (begin < 0 || end >= count() || (j >= begin && j <= end)) return false;
    const double freed = gap(begin - 1) + gap(end) - way(exit(begin - 1), end + 1);
    if (freed <= min_gain_mm) return false;
    for (const Place target : {j - 1, j}) {
      if (target >= begin - 1 && target <= end) continue;
      if (begin == end && !stops_[visit(begin).stop].open) {
        if (shift_and_restart(begin, target, freed)) return true;
        continue;
      }
      for (const bool is_turned : {false, true}) {
        const Vec &first = is_turned ? exit(end) : entry(begin),
                  &last = is_turned ? entry(begin) : exit(end);
        const double added = distance(exit(target), first) + way(last, target + 1) - gap(target);
        if (freed - added > min_gain_mm && may_shift(begin, end, target, is_turned)) {
          gained_mm_ += freed - added;
          apply(
              {static_cast<std::size_t>(begin), static_cast<std::size_t>(end), target, is_turned});
          return true;
        }
      }
    }
    return false;
  }

  /// True if a parent of one of the visits `begin` to `end` is at `from` to `to`.
  bool has_parent_within(Place begin, Place end, Place from, Place to) const {
    for (Place i = begin; i <= end; ++i) {
      const std::size_t parent = stops_[visit(i).stop].parent;
      if (parent == CutStop::none) continue;
      const auto place = static_cast<Place>(place_[parent]);
      if (place >= from && place <= to) return true;
    }
    return false;
  }

  /// Children remain before their parents, and contours with a direction keep it.
  bool may_turn(Place begin, Place end) const {
    for (Place i = begin; i <= end; ++i)
      if (stops_[visit(i).stop].end) return false;
    return !has_parent_within(begin, end, begin, end);
  }

  bool may_shift(Place begin, Place end, Place target, bool is_turned) const {
    if (std::abs(target - begin) > span()) return false;
    if (is_turned && !may_turn(begin, end)) return false;
    // Towards the end the block passes visits that may be its parents, otherwise children.
    if (target > end) return !has_parent_within(begin, end, end + 1, target);
    return !has_parent_within(target + 1, begin - 1, begin, end);
  }

  void apply(const Move& move) {
    const auto at = [&](Place i) { return visits_.begin() + i; };
    const auto begin = static_cast<Place>(move.begin), end = static_cast<Place>(move.end);
    const Place low = std::min(begin, move.target + 1), high = std::max(end, move.target);
    remember(low, high);
    if (move.is_turned) {
      std::reverse(at(begin), at(end + 1));
      for (Place i = begin; i <= end; ++i) {
        Spot& turned = visits_[static_cast<std::size_t>(i)];
        if (!stops_[turned.stop].open) continue;
        turned.start = 1 - turned.start;
        std::swap(turned.entry, turned.exit);
      }
    }
    if (move.target > end) std::rotate(at(begin), at(end + 1), at(move.target + 1));
    if (move.target < begin - 1) std::rotate(at(move.target + 1), at(begin), at(end + 1));
    for (Place i = low; i <= high; ++i) place_[visit(i).stop] = static_cast<std::size_t>(i);
    // The ends of the changed pieces: of the block in its new place, and of what it passed.
    const Place length = end - begin;
    for (const Place i : {low - 1, low, low + length, low + length + 1, high - length - 1,
                          high - length, high, high + 1})
      queue(i);
  }

  void queue(Place i) {
    if (i < 0 || i >= count() || is_queued_[visit(i).stop]) return;
    is_queued_[visit(i).stop] = true;
    queue_.push_back(visit(i).stop);
  }

  const std::vector<CutStop>& stops_;
  std::vector<Spot> visits_;
  std::vector<std::size_t> place_;  ///< of each stop among the visits
  Vec position_;
  std::vector<bool> is_queued_;
  std::deque<std::size_t> queue_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::size_t> first_neighbour_;  ///< of each stop, and their number
  std::vector<Vec> centres_;
  std::vector<double> reaches_;  ///< largest distance of a start point from the centre
  double gained_mm_ = 0;         ///< since the last exchange
  bool is_on_trial_ = false;     ///< changes may be undone
  std::vector<std::pair<Place, Place>> changes_;  ///< since then: places in order of time ...
  std::vector<Spot> changed_;                     ///< ... and what they were before
  geometry::Random random_{1};
};

}  // namespace

std::vector<CutVisit> improved_visits(const std::vector<CutStop>& stops,
                                      const std::vector<CutVisit>& visits, const Vec& position) {
  return CutSearch(stops, visits, position).improved();
}

}  // namespace lamplock::cutting
