#include "firmware/program/curves/curve.hpp"

#include "firmware/program/wide_number.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program {

template <class Shape, class Request>
void Curve::begin(Kind kind, Shape& shape, const Request& request) {
  shape = Shape{};  // begins its lifetime in the union
  kind_ = kind;
  plane_ = request.plane;
  end_ = request.end;
  const std::size_t normal = plane_.normal;
  const std::int64_t other_way = length_of(request.end[normal] - request.start[normal],
                                           request.end[rotary_axis] - request.start[rotary_axis]);
  const Division division = shape.begin(request, other_way);
  pieces_ = left_ = division.pieces;
  length_e7_ = division.length_e7;
  normal_.begin(request.start[normal], end_[normal], pieces_);
  rotary_.begin(request.start[rotary_axis], end_[rotary_axis], pieces_);
}

void Curve::begin_arc(const ArcRequest& request) { begin(Kind::arc, arc, request); }
void Curve::begin_spline(const SplineRequest& request) { begin(Kind::spline, spline, request); }
void Curve::begin_nurbs(const NurbsRequest& request) { begin(Kind::nurbs, nurbs, request); }

PlanePoint Curve::next_in_plane() {
  switch (kind_) {
    case Kind::spline:
      return spline.next(pieces_);
    case Kind::nurbs:
      return nurbs.next(pieces_);
    case Kind::arc:
      break;
  }
  return arc.next(pieces_);
}

bool Curve::next(Place& end) {
  if (left_ == 0) return false;
  --left_;
  if (left_ == 0) {
    end = end_;
    return true;
  }
  const PlanePoint point = next_in_plane();
  end[plane_.first] = point.first_e7;
  end[plane_.second] = point.second_e7;
  end[plane_.normal] = normal_.next(pieces_);
  end[rotary_axis] = rotary_.next(pieces_);
  return true;
}

}  // namespace lamplock::program
