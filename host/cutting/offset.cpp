#include "host/cutting/offset.hpp"

#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "host/cutting/contour_groups.hpp"
#include "host/cutting/offset_loops.hpp"
#include "host/cutting/offset_pieces.hpp"
#include "host/cutting/raw_offset.hpp"
#include "host/cutting/simple_contours.hpp"
#include "host/error.hpp"
#include "host/geometry/parallel.hpp"
#include "host/geometry/union_find.hpp"

namespace lamplock::cutting {
namespace {

// A group with more crossings is not meant to be cut; all its contours are treated as one area.
constexpr std::size_t max_crossings = 1000;

OffsetContours offset_right(const std::vector<Contour>& contours, const OffsetOptions& options) {
  const RawOffset raw = raw_offset(contours, options);
  return loops_of(contours, raw.edges, pieces_at_distance(contours, raw, options.distance_mm),
                  2 * options.distance_mm);
}

template <class T>
void append(std::vector<T>& all, std::vector<T>& more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Contours to be offset, with their numbers among those of the call.
struct Group {
  std::vector<Contour> contours;
  std::vector<std::size_t> numbers;
};

/// Sets of closed contours that cross or overlap each other, or themselves.
std::vector<std::vector<std::size_t>> crossing_sets(const std::vector<Contour>& contours,
                                                    const std::vector<Fault>& faults) {
  const auto is_closed = [&](std::optional<std::size_t> i) { return i && contours[*i].closed; };
  std::vector<bool> is_crossed(contours.size(), false);
  geometry::UnionFind joined(contours.size());
  std::optional<std::size_t> first;
  for (const Fault& fault : faults) {
    if (!is_closed(fault.contour) || !is_closed(fault.other)) continue;
    is_crossed[*fault.contour] = is_crossed[*fault.other] = true;
    joined.join(*fault.contour, *fault.other);
    first = fault.contour;
  }
  // Faults beyond the limit are not known: any two contours may cross.
  for (std::size_t i = 0; first && faults.size() >= max_crossings && i < contours.size(); ++i) {
    if (!contours[i].closed) continue;
    is_crossed[i] = true;
    joined.join(i, *first);
  }
  std::vector<std::vector<std::size_t>> sets = joined.sets();
  std::erase_if(sets, [&](const auto& set) { return !is_crossed[set.front()]; });
  return sets;
}

/// Replaces closed contours that cross each other or themselves by the boundary of their area.
Group without_crossings(Group group, const std::vector<Fault>& faults) {
  const auto sets = crossing_sets(group.contours, faults);
  if (sets.empty()) return group;
  Group simple, rest;
  std::vector<bool> is_replaced(group.contours.size(), false);
  for (const std::vector<std::size_t>& set : sets) {
    std::vector<Contour> crossed;
    for (const std::size_t i : set) crossed.push_back(group.contours[i]);
    SimpleContours result = simple_contours(crossed);
    // A line that is drawn forth and back has no area; it is cut around as it is.
    if (result.contours.empty()) continue;
    for (const std::size_t i : set) is_replaced[i] = true;
    append(simple.contours, result.contours);
    for (const std::size_t from : result.from) simple.numbers.push_back(group.numbers[set[from]]);
  }
  for (std::size_t i = 0; i < is_replaced.size(); ++i) {
    if (is_replaced[i]) continue;
    rest.contours.push_back(std::move(group.contours[i]));
    rest.numbers.push_back(group.numbers[i]);
  }
  append(rest.contours, simple.contours);
  append(rest.numbers, simple.numbers);
  return rest;
}

/// Sets the numbers of contours in faults to those of the call.
void renumber(std::vector<Fault>& faults, const std::vector<std::size_t>& numbers) {
  for (Fault& fault : faults) {
    if (fault.contour) fault.contour = numbers[*fault.contour];
    if (fault.other) fault.other = numbers[*fault.other];
  }
}

/// The offset of some of the contours, with their numbers.
OffsetContours offset_group(const std::vector<Contour>& contours,
                            const std::vector<std::size_t>& numbers, const OffsetOptions& options) {
  Group group{{}, numbers};
  group.contours.reserve(numbers.size());
  for (const std::size_t i : numbers) group.contours.push_back(contours[i]);
  std::vector<Fault> crossings = contour_faults(group.contours, max_crossings);
  if (!crossings.empty()) group = without_crossings(std::move(group), crossings);
  const bool is_left = options.distance_mm < 0;
  if (is_left) {
    for (Contour& contour : group.contours) contour = reversed(contour);
  }
  OffsetOptions right = options;
  right.distance_mm = std::abs(options.distance_mm);
  OffsetContours result = offset_right(group.contours, right);
  if (is_left) {
    for (Contour& contour : result.contours) contour = reversed(contour);
  }
  for (std::size_t& from : result.from) from = group.numbers[from];
  renumber(result.faults, group.numbers);
  renumber(crossings, numbers);
  append(result.faults, crossings);
  return result;
}

}  // namespace

OffsetContours offset(const std::vector<Contour>& contours, const OffsetOptions& options) {
  if (!std::isfinite(options.distance_mm) || !(options.max_mitre >= 1))
    throw Error(Exit::bad_input, "compensation", "the distance or the mitre limit is not a number",
                "give half the beam width in mm and a mitre limit of at least 1");
  OffsetContours result;
  if (options.distance_mm == 0) {
    result.contours = contours;
    for (std::size_t i = 0; i < contours.size(); ++i) result.from.push_back(i);
    return result;
  }
  // Offsets reach as far as the tips of mitres.
  const double reach_mm =
      std::abs(options.distance_mm) * (options.join == Join::mitre ? options.max_mitre : 1);
  const auto groups = contour_groups(contours, 2 * reach_mm);
  std::vector<OffsetContours> parts(groups.size());
  geometry::for_each_index(groups.size(), 0, [&](std::size_t i) {
    parts[i] = offset_group(contours, groups[i], options);
  });
  for (OffsetContours& part : parts) {
    append(result.contours, part.contours);
    append(result.from, part.from);
    append(result.faults, part.faults);
  }
  return result;
}

}  // namespace lamplock::cutting
