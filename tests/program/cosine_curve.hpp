// The worked example of a further curve: half a wave of a cosine from rest to rest.
//
// In:  start and end. Out: ends of the pieces in the plane: the first axis runs evenly, the second
//      one by (1 - cos(pi t)) / 2 of its way.
// Who: Curve, as arc, spline and NURBS: a line in its `Kind`, in its union and in next_in_plane(),
//      and a begin_cosine() of one line.
//
// Division: the second derivative of the second axis is at most pi^2/2 of its way d, so a chord
// over 1/n of the parameter is within pi^2 d / (16 n^2) of the curve.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/program/curves/shape.hpp"
#include "firmware/program/decimal.hpp"
#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program::test {

struct CosineRequest {
  Place start, end;
  CurvePlane plane;
  std::int64_t tolerance_e7;
};

/// The shape. A plain struct without initial values, because it lives in the union of Curve.
class Cosine {
 public:
  Division begin(const CosineRequest& request, std::int64_t other_way_e7) {
    start_ = {request.start[request.plane.first], request.start[request.plane.second]};
    way_ = {request.end[request.plane.first] - start_.first_e7,
            request.end[request.plane.second] - start_.second_e7};
    // pi^2 / 16 is below 0.617.
    const std::int64_t tolerance_e7 = std::max<std::int64_t>(request.tolerance_e7, 1);
    const std::int64_t square = abs64(way_.second_e7) * 617 / (1000 * tolerance_e7) + 1;
    const std::uint32_t pieces = isqrt(static_cast<std::uint64_t>(square)) + 1;
    std::int64_t length_e7 = 0;
    PlanePoint here = start_;
    for (done_ = 0; done_ < pieces;) {
      const PlanePoint to = next(pieces);
      length_e7 += length_of(to.first_e7 - here.first_e7, to.second_e7 - here.second_e7);
      here = to;
    }
    done_ = 0;
    return {pieces, length_of(length_e7, other_way_e7)};
  }

  PlanePoint next(std::uint32_t pieces) {
    ++done_;
    const std::int64_t part_e9 = std::int64_t{done_} * one_e9 / pieces;
    const std::int64_t rise_e9 = (one_e9 - cosine_e9(180 * part_e9)) / 2;
    return {start_.first_e7 + part_of(way_.first_e7, part_e9),
            start_.second_e7 + part_of(way_.second_e7, rise_e9)};
  }

 private:
  static std::int64_t part_of(std::int64_t way_e7, std::int64_t part_e9) {
    return mul_div(way_e7, part_e9, std::uint32_t{one_e9});
  }

  PlanePoint start_, way_;
  std::uint32_t done_;
};

}  // namespace lamplock::program::test
