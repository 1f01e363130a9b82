// Areas that are filled with lines back and forth, each with its run-up and its gaps dark.
//
// In:  closed contours, the hatch of an operation, the place of the beam. Out: strokes in the order
//      in which they are engraved. Who: plan_cuts().
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/cutting/cut_plan.hpp"
#include "host/cutting/operation.hpp"

namespace lamplock::cutting {

struct Engraving {
  std::vector<Stroke> strokes{};
  std::vector<std::size_t> missed{};    ///< contours that no line crosses
  std::vector<std::size_t> unfilled{};  ///< contours without a fill beside filled ones
};

/// Fills what a picture of the drawing shows in another colour than the page's. If none of the
/// contours has such a fill, they are a drawing of lines, and the places with an odd number of them
/// around are filled. `covers`: areas of other operations in the colour of the page. Contours
/// nearer to each other than the gap that is crossed at the feed are filled together, the others
/// one after the other, the nearest one next. Throws Error(bad_input) as hatch().
Engraving engrave_areas(const std::vector<Contour>& contours, const std::vector<Contour>& covers,
                        const Operation& operation, const Vec& position);

}  // namespace lamplock::cutting
