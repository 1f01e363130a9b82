// The lines of a program that the planner knows: the ring of the look-ahead.
//
// In:  one line at a time, measured (line/geometry.hpp).
// Out: the line that is run, and the limits from the lines after it.
// One owner: the planner. Its length follows from braking distance: 100 mm/s through lines of 0.1
// mm at 1 m/s2 need 50.
//
// Units: a length is in steps of the coarsest axis, as for mm in path/geometry.hpp; time in ticks.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/line/place.hpp"
#include "firmware/motion/line/real.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// The laser along a line.
enum class LinePower : std::uint8_t {
  off,
  constant,     ///< the same at any speed
  proportional  ///< to actual over programmed speed
};

/// Full power of a laser.
inline constexpr std::uint32_t full_power = 65535;

/// A straight line as programmed: where it ends, and how.
struct LineTarget : LinePlace {
  std::uint32_t feed_um_min = 0;  ///< speed along it; not of rapids, not if timed
  std::uint32_t time_us = 0;      ///< time for it, if timed; else the minimum
  std::uint32_t line = 0;         ///< N word or row index, for reports
  std::uint16_t power = 0;        ///< of the laser, 0..full_power; of pixels: their list
  LinePower laser = LinePower::off;
  bool pixels = false;  ///< equal cells with a power each (stepper/power_table.hpp)
  bool pulses = false;  ///< the laser shines in pulses, at a constant distance
  bool rapid = false;   ///< at maximum speed, laser off
  bool timed = false;
  bool exact_stop = false;   ///< a stop at its end
  std::uint8_t changes = 0;  ///< of outputs, due at its start (stepper/change_queue.hpp)
  /// The last decimal of its numbers: it may be joined to the line before it; 0 = never.
  std::uint8_t digit_um = 0;
};

/// A line in the ring, and where it ends.
struct Line : LinePlace {
  std::uint32_t length_mantissa = 0;  ///< 32 bits of it: the way must be exact
  LinePacked accel;                   ///< along it
  LinePacked speed;                   ///< maximum of the axes along it
  LinePacked feed;                    ///< programmed, at 100 %
  LinePacked corner_2;                ///< highest speed at its start, squared
  LinePacked entry_2;                 ///< planned speed there, squared
  std::uint32_t line : 24 = 0;        ///< N word, 10^7 at most
  std::uint32_t changes : 8 = 0;
  std::uint16_t power = 0;
  std::int8_t length_exponent = 0;
  LinePower laser : 2 = LinePower::off;
  bool rapid : 1 = false, timed : 1 = false;
  bool pixels : 1 = false, pulses : 1 = false;

  void set_place(const LinePlace& place) { static_cast<LinePlace&>(*this) = place; }
  UFloat length() const {
    return length_mantissa == 0 ? UFloat() : UFloat::of_parts(length_mantissa, length_exponent);
  }
  void set_length(UFloat length) {
    length_mantissa = length.mantissa();
    length_exponent =
        is_zero(length) ? std::int8_t{0} : static_cast<std::int8_t>(length.exponent());
  }
};
static_assert(sizeof(Line) <= 52);

/// Fixed ring; indices never decrease.
class LineRing {
 public:
  static constexpr std::uint32_t capacity = 128;

  std::uint32_t size() const { return end_ - begin_; }
  bool empty() const { return begin_ == end_; }
  bool full() const { return size() == capacity; }
  std::uint32_t begin() const { return begin_; }
  std::uint32_t end() const { return end_; }

  Line& at(std::uint32_t i) { return lines_[i % capacity]; }
  const Line& at(std::uint32_t i) const { return lines_[i % capacity]; }

  /// The place after the last line; push() appends it.
  Line& next() { return at(end_); }
  void push() { ++end_; }
  /// The last line is next() again.
  void unpush() { --end_; }
  void pop() { ++begin_; }
  /// Restores the lines that were popped since begin() had this value; no line may have been pushed
  /// meanwhile.
  void return_to(std::uint32_t begin) { begin_ = begin; }
  void clear() { begin_ = end_; }

 private:
  std::array<Line, capacity> lines_{};
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace lamplock::motion
