// genetic_visits(): a genetic algorithm over orders of contours. Two parents are chosen by
// tournaments; a child takes a piece of the first one and the rest in the order of the second one
// (order crossover, Davis, "Applying adaptive algorithms to epistatic domains", IJCAI 1985), and a
// piece of some children is turned. The best order of each generation is kept.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "host/cutting/cut_stops.hpp"
#include "host/geometry/random.hpp"

namespace lamplock::cutting {
namespace {

// Usual values of the literature (Goldberg, "Genetic Algorithms in Search, Optimization, and
// Machine Learning", 1989); the source of cutting names the population alone.
constexpr double crossover_share = 0.9, mutation_share = 0.3;
constexpr std::size_t tournament = 3;
// Generations without a gain after which the search ends.
constexpr int max_idle_generations = 200;
// Contours placed in all orders of all generations; some ten seconds.
constexpr std::size_t max_work = 200'000'000;

class GeneticSearch {
 public:
  GeneticSearch(const std::vector<CutStop>& stops, std::size_t population, const Vec& position)
      : stops_(stops), population_(std::max<std::size_t>(population, 2)), position_(position) {}

  std::vector<CutVisit> best(const std::vector<CutVisit>& first) {
    std::vector<Member> members = first_generation(first);
    int idle = 0;
    for (std::size_t work = 0; idle < max_idle_generations && work < max_work;
         work += population_ * stops_.size()) {
      std::vector<Member> next{best_of(members)};
      const double before = next.front().way_mm;
      while (next.size() < population_) next.push_back(child_of(members));
      members = std::move(next);
      idle = best_of(members).way_mm < before ? 0 : idle + 1;
    }
    std::vector<CutVisit> visits = visits_of(best_of(members).order);
    choose_starts(stops_, visits, position_);
    return visits;
  }

 private:
  using Order = std::vector<std::size_t>;  ///< numbers of stops
  struct Member {
    Order order;
    double way_mm = 0;
  };

  std::size_t random_below(std::size_t count) { return random_.next() % count; }

  std::vector<Member> first_generation(const std::vector<CutVisit>& first) {
    Order order;
    for (const CutVisit& visit : first) order.push_back(visit.stop);
    std::vector<Member> members{member_of(order)};
    while (members.size() < population_) {
      for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[random_below(i)]);
      members.push_back(member_of(order));
    }
    return members;
  }

  Member member_of(const Order& order) {
    Member member{with_children_first(order), 0};
    member.way_mm = rapid_way(stops_, visits_of(member.order), position_);
    return member;
  }

  static const Member& best_of(const std::vector<Member>& members) {
    return *std::min_element(members.begin(), members.end(),
                             [](const Member& a, const Member& b) { return a.way_mm < b.way_mm; });
  }

  const Member& winner(const std::vector<Member>& members) {
    const Member* best = &members[random_below(members.size())];
    for (std::size_t i = 1; i < tournament; ++i) {
      const Member& other = members[random_below(members.size())];
      if (other.way_mm < best->way_mm) best = &other;
    }
    return *best;
  }

  Member child_of(const std::vector<Member>& members) {
    const Member& first = winner(members);
    Order order = first.order;
    if (random_.uniform() < crossover_share) order = crossed(first.order, winner(members).order);
    if (random_.uniform() < mutation_share) {
      const auto [low, high] = random_piece();
      std::reverse(order.begin() + low, order.begin() + high);
    }
    return member_of(order);
  }

  /// First and one after the last place of a piece of an order.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> random_piece() {
    const auto one = static_cast<std::ptrdiff_t>(random_below(stops_.size()));
    const auto other = static_cast<std::ptrdiff_t>(random_below(stops_.size()));
    return {std::min(one, other), std::max(one, other) + 1};
  }

  Order crossed(const Order& first, const Order& second) {
    const auto [low, high] = random_piece();
    std::vector<bool> is_taken(stops_.size(), false);
    for (std::ptrdiff_t i = low; i < high; ++i) is_taken[first[static_cast<std::size_t>(i)]] = true;
    Order rest;
    for (const std::size_t stop : second)
      if (!is_taken[stop]) rest.push_back(stop);
    rest.insert(rest.begin() + low, first.begin() + low, first.begin() + high);
    return rest;
  }

  /// The same order, but each stop waits for its children and is cut directly after the last one.
  Order with_children_first(const Order& order) const {
    std::vector<std::size_t> open(stops_.size());
    for (std::size_t i = 0; i < stops_.size(); ++i) open[i] = stops_[i].children;
    std::vector<bool> is_waiting(stops_.size(), false);
    Order result;
    result.reserve(order.size());
    for (const std::size_t stop : order) {
      is_waiting[stop] = true;
      for (std::size_t i = stop; i != CutStop::none && is_waiting[i] && open[i] == 0;
           i = stops_[i].parent) {
        result.push_back(i);
        is_waiting[i] = false;
        if (stops_[i].parent != CutStop::none) --open[stops_[i].parent];
      }
    }
    return result;
  }

  /// Each stop with the start point that is nearest to the exit before.
  std::vector<CutVisit> visits_of(const Order& order) const {
    std::vector<CutVisit> visits;
    visits.reserve(order.size());
    Vec at = position_;
    for (const std::size_t stop : order) {
      CutVisit nearest{stop, 0};
      double shortest = std::numeric_limits<double>::infinity();
      for (std::size_t start = 0; start < stops_[stop].starts.size(); ++start) {
        const double away = distance(at, stops_[stop].entry(start));
        if (away >= shortest) continue;
        shortest = away;
        nearest.start = start;
      }
      visits.push_back(nearest);
      at = stops_[stop].exit(nearest.start);
    }
    return visits;
  }

  const std::vector<CutStop>& stops_;
  std::size_t population_;
  Vec position_;
  geometry::Random random_{1};
};

}  // namespace

std::vector<CutVisit> genetic_visits(const std::vector<CutStop>& stops,
                                     const std::vector<CutVisit>& visits, std::size_t population,
                                     const Vec& position) {
  return GeneticSearch(stops, population, position).best(visits);
}

}  // namespace lamplock::cutting
