#include "host/cutting/cut_order.hpp"

#include <algorithm>
#include <utility>

#include "host/cutting/cut_stops.hpp"
#include "host/error.hpp"

namespace lamplock::cutting {
namespace {

/// A place on a closed contour.
struct StartPlace {
  std::size_t edge;
  double part;
};

std::size_t parts_of_edges(const Contour& contour) {
  return (starts_of_closed + contour.edges.size() - 1) / contour.edges.size();
}

/// The place of a start point by its number.
StartPlace start_place(const Contour& contour, std::size_t start) {
  const std::size_t count = contour.edges.size();
  if (count >= starts_of_closed) return {start * count / starts_of_closed, 0};
  const std::size_t parts = parts_of_edges(contour);
  return {start / parts, static_cast<double>(start % parts) / static_cast<double>(parts)};
}

std::size_t count_of_starts(const Contour& contour) {
  const std::size_t count = contour.edges.size();
  return count >= starts_of_closed ? starts_of_closed : count * parts_of_edges(contour);
}

[[noreturn]] void refuse_tree(const char* what) {
  throw Error(Exit::bad_input, "cut order", what,
              "a fault of this program: report it with the drawing");
}

/// Refuses contours that are around themselves: none of them could be cut first.
void require_tree(const std::vector<CutStop>& stops) {
  std::vector<std::size_t> open(stops.size()), ready;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    open[i] = stops[i].children;
    if (open[i] == 0) ready.push_back(i);
  }
  std::size_t done = 0;
  while (!ready.empty()) {
    const std::size_t parent = stops[ready.back()].parent;
    ready.pop_back();
    ++done;
    if (parent != CutStop::none && --open[parent] == 0) ready.push_back(parent);
  }
  if (done != stops.size()) refuse_tree("some contours are inside each other");
}

std::vector<CutStop> stops_of(const std::vector<Contour>& contours,
                              const std::vector<ContourPlace>& places,
                              const std::vector<bool>& is_directed) {
  if (places.size() != contours.size()) refuse_tree("the tree has another number of contours");
  std::vector<CutStop> stops(contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const Contour& contour = contours[i];
    CutStop& stop = stops[i];
    stop.open = !contour.closed;
    if (stop.open && !is_directed.empty() && is_directed[i]) {
      stop.starts = {contour.edges.front().from};
      stop.end = contour.edges.back().to;
    } else if (stop.open) {
      stop.starts = {contour.edges.front().from, contour.edges.back().to};
    } else {
      for (std::size_t start = 0; start < count_of_starts(contour); ++start) {
        const StartPlace place = start_place(contour, start);
        stop.starts.push_back(point_at(contour.edges[place.edge], place.part));
      }
    }
    if (!places[i].parent) continue;
    if (*places[i].parent >= stops.size())
      refuse_tree("a contour is inside of one that is missing");
    stop.parent = *places[i].parent;
    ++stops[stop.parent].children;
  }
  require_tree(stops);
  return stops;
}

CutOrder order_of(const std::vector<Contour>& contours, const std::vector<CutStop>& stops,
                  const std::vector<CutVisit>& visits, const Vec& position) {
  CutOrder order;
  order.rapid_mm = rapid_way(stops, visits, position);
  for (const CutVisit& visit : visits) {
    CutStep step{visit.stop, stops[visit.stop].open && visit.start == 1, 0, 0};
    if (!stops[visit.stop].open) {
      const StartPlace place = start_place(contours[visit.stop], visit.start);
      step.edge = place.edge;
      step.part = place.part;
    }
    order.steps.push_back(step);
  }
  return order;
}

std::vector<CutVisit> visits_by(const std::vector<CutStop>& stops, const Vec& position,
                                const OrderOptions& options) {
  if (options.search == OrderSearch::improved && stops.size() <= max_exact)
    return exact_visits(stops, position);
  std::vector<CutVisit> nearest = nearest_visits(stops, position);
  if (stops.empty()) return nearest;
  switch (options.search) {
    case OrderSearch::nearest:
      return nearest;
    case OrderSearch::genetic:
      return genetic_visits(stops, nearest, options.population, position);
    case OrderSearch::improved:
      return improved_visits(stops, nearest, position);
  }
  return nearest;
}

}  // namespace

CutOrder cut_order(const std::vector<Contour>& contours, const std::vector<ContourPlace>& places,
                   const Vec& position, const OrderOptions& options,
                   const std::vector<bool>& is_directed) {
  const std::vector<CutStop> stops = stops_of(contours, places, is_directed);
  return order_of(contours, stops, visits_by(stops, position, options), position);
}

Contour as_cut(const Contour& contour, const CutStep& step) {
  if (!contour.closed) return step.backwards ? reversed(contour) : contour;
  Contour turned = contour;
  std::rotate(turned.edges.begin(), turned.edges.begin() + static_cast<std::ptrdiff_t>(step.edge),
              turned.edges.end());
  if (step.part == 0) return turned;
  const Edge first = turned.edges.front();
  const Vec start = point_at(first, step.part);
  turned.edges.front() = cut_out(first, step.part, 1, start, first.to);
  turned.edges.push_back(cut_out(first, 0, step.part, first.from, start));
  return turned;
}

}  // namespace lamplock::cutting
