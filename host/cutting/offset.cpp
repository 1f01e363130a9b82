#include "host/cutting/offset.hpp"

#include <cmath>
#include <utility>

#include "host/cutting/contour_groups.hpp"
#include "host/cutting/offset_loops.hpp"
#include "host/cutting/offset_pieces.hpp"
#include "host/cutting/raw_offset.hpp"
#include "host/error.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

OffsetContours offset_right(const std::vector<Contour>& contours, const OffsetOptions& options) {
  const RawOffset raw = raw_offset(contours, options);
  return loops_of(contours, raw.edges, pieces_at_distance(contours, raw, options.distance_mm),
                  2 * options.distance_mm);
}

/// The offset of some of the contours, with their numbers.
OffsetContours offset_group(const std::vector<Contour>& contours,
                            const std::vector<std::size_t>& group, const OffsetOptions& options) {
  std::vector<Contour> chosen;
  chosen.reserve(group.size());
  const bool is_left = options.distance_mm < 0;
  for (const std::size_t i : group) chosen.push_back(is_left ? reversed(contours[i]) : contours[i]);
  OffsetOptions right = options;
  right.distance_mm = std::abs(options.distance_mm);
  OffsetContours result = offset_right(chosen, right);
  if (is_left) {
    for (Contour& contour : result.contours) contour = reversed(contour);
  }
  for (std::size_t& from : result.from) from = group[from];
  for (Fault& fault : result.faults) {
    if (fault.contour) fault.contour = group[*fault.contour];
  }
  return result;
}

template <class T>
void append(std::vector<T>& all, std::vector<T>& more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
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
