#include "firmware/motion/line/chords.hpp"

namespace lamplock::motion {

void LineChords::reset(const LinePlace& at, std::uint32_t line, const LineLimits& limits) {
  min_way_ = UFloat(window_) * limits.rounding;
  mark_ = at;
  mark_line_ = line;
  way_ = {};
  before_ = {};
}

bool LineChords::add(std::uint32_t line, const LinePlace& end, const LineShape& shape,
                     const LineLimits& limits, LineCap& cap) {
  way_ = way_ + shape.length;
  if (way_ < min_way_) return false;
  // A line that is long enough is a chord by itself, and the short ones before it are dropped: a
  // corner at its far end must not slow them down.
  const bool alone = !(shape.length < min_way_), skips = alone && line != mark_line_;
  const bool single = alone || line == mark_line_;
  const LineShape chord = single ? shape : make_shape(way_between(mark_, end), limits);
  // Between two adjacent single lines the corner rule is sufficient.
  const bool compare =
      !is_zero(before_.length) && !is_zero(chord.length) && !(single && before_single_ && !skips);
  if (compare) cap = {before_line_ + 1, line, curve_speed_2(before_, chord, bends_, limits)};
  before_ = chord;
  before_line_ = alone ? line : mark_line_;
  before_single_ = single;
  mark_ = end;
  mark_line_ = line + 1;
  way_ = {};
  return compare;
}

}  // namespace lamplock::motion
