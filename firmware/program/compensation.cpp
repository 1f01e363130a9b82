#include "firmware/program/compensation.hpp"

namespace lamplock::program {

bool Compensation::end_at(const PlanePoint& end) {
  part_ = offset_.part_of(block(), held_.begin, end);
  if (part_ == BlockPart::backward) return false;
  held_.end = end;
  if (part_ == BlockPart::circle) held_.begin = end;
  return true;
}

bool Compensation::enter(const PlaneBlock& entry) {
  begin_ = entry.from;
  return distance_e7(entry.from, entry.to) > offset_.radius_e7();
}

bool Compensation::join(const PlaneBlock& next) {
  CutterCorner corner;
  if (!offset_.fits_into(next) || !offset_.turn_corner(block(), next, corner)) return false;
  if (!end_at(corner.end)) return false;
  begin_ = corner.begin;
  arc_ = corner.arc;
  return true;
}

bool Compensation::finish() { return end_at(offset_.beside_end(block())); }

ArcRequest Compensation::held_arc(std::int64_t tolerance_e7) const {
  const Place centre = put(held_.start_e7, held_.centre);
  return {put(held_.start_e7, held_.begin),
          held_end(),
          centre,
          plane_,
          held_.clockwise,
          1,
          tolerance_e7};
}

ArcRequest Compensation::corner_arc(const Place& programmed, std::int64_t tolerance_e7) const {
  return {put(programmed, held_.end),
          put(programmed, begin_),
          programmed,
          plane_,
          offset_.turns_clockwise(),
          1,
          tolerance_e7};
}

Compensation::Held& Compensation::hold() {
  held_.begin = begin_;
  holds_ = true;
  return held_;
}

}  // namespace lamplock::program
