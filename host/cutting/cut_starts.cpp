// Rapid way of an order, its best start points, and the best order of a few contours.
#include <algorithm>
#include <cstdint>
#include <limits>

#include "host/cutting/cut_stops.hpp"

namespace lamplock::cutting {
namespace {

constexpr double no_way = std::numeric_limits<double>::infinity();

/// The shortest way from a set of exits, each with the way to it, to a point; the number of the
/// exit.
struct Arrival {
  double way_mm = no_way;
  std::size_t from = 0;
};

Arrival arrival(const CutStop& before, const std::vector<double>& ways, const Vec& at) {
  Arrival best;
  for (std::size_t i = 0; i < before.starts.size(); ++i) {
    const double way = ways[i] + distance(before.exit(i), at);
    if (way < best.way_mm) best = {way, i};
  }
  return best;
}

}  // namespace

double rapid_way(const std::vector<CutStop>& stops, const std::vector<CutVisit>& visits,
                 const Vec& position) {
  double way = 0;
  Vec at = position;
  for (const CutVisit& visit : visits) {
    way += distance(at, stops[visit.stop].entry(visit.start));
    at = stops[visit.stop].exit(visit.start);
  }
  return way;
}

void choose_starts(const std::vector<CutStop>& stops, std::vector<CutVisit>& visits,
                   const Vec& position) {
  if (visits.empty()) return;
  std::vector<std::vector<std::size_t>> from(visits.size());
  std::vector<double> ways;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    const CutStop& stop = stops[visits[i].stop];
    std::vector<double> next(stop.starts.size());
    from[i].resize(stop.starts.size());
    for (std::size_t start = 0; start < stop.starts.size(); ++start) {
      if (i == 0) {
        next[start] = distance(position, stop.entry(start));
      } else {
        const Arrival best = arrival(stops[visits[i - 1].stop], ways, stop.entry(start));
        next[start] = best.way_mm;
        from[i][start] = best.from;
      }
    }
    ways = std::move(next);
  }
  auto start = static_cast<std::size_t>(std::min_element(ways.begin(), ways.end()) - ways.begin());
  for (std::size_t i = visits.size(); i-- > 0;) {
    visits[i].start = start;
    start = from[i][start];
  }
}

std::vector<CutVisit> exact_visits(const std::vector<CutStop>& stops, const Vec& position) {
  const std::size_t count = stops.size(), sets = std::size_t{1} << count;
  // The shortest way that cuts a set of stops and ends with a start point of one of them.
  struct State {
    std::vector<double> ways;
    std::vector<CutVisit> before;
  };
  std::vector<State> states(sets * count);
  const auto state = [&](std::size_t set, std::size_t last) -> State& {
    return states[set * count + last];
  };
  std::vector<std::size_t> children(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (stops[i].parent != CutStop::none) children[stops[i].parent] |= std::size_t{1} << i;
  }
  for (std::size_t set = 1; set < sets; ++set) {
    for (std::size_t last = 0; last < count; ++last) {
      const std::size_t rest = set & ~(std::size_t{1} << last);
      if (rest == set || (children[last] & ~rest) != 0) continue;
      State& here = state(set, last);
      here.ways.assign(stops[last].starts.size(), no_way);
      here.before.resize(here.ways.size());
      for (std::size_t start = 0; start < here.ways.size(); ++start) {
        const Vec& entry = stops[last].entry(start);
        if (rest == 0) here.ways[start] = distance(position, entry);
        for (std::size_t other = 0; other < count; ++other) {
          if (rest == 0 || state(rest, other).ways.empty()) continue;
          const Arrival best = arrival(stops[other], state(rest, other).ways, entry);
          if (best.way_mm >= here.ways[start]) continue;
          here.ways[start] = best.way_mm;
          here.before[start] = {other, best.from};
        }
      }
    }
  }
  CutVisit end;
  double shortest = no_way;
  for (std::size_t last = 0; last < count; ++last) {
    const std::vector<double>& ways = state(sets - 1, last).ways;
    for (std::size_t start = 0; start < ways.size(); ++start) {
      if (ways[start] >= shortest) continue;
      shortest = ways[start];
      end = {last, start};
    }
  }
  std::vector<CutVisit> visits(count);
  std::size_t set = sets - 1;
  for (std::size_t i = count; i-- > 0;) {
    visits[i] = end;
    const CutVisit before = state(set, end.stop).before[end.start];
    set &= ~(std::size_t{1} << end.stop);
    end = before;
  }
  return visits;
}

}  // namespace lamplock::cutting
