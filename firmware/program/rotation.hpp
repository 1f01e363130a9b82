// Rotation of a program in a plane (G68, G10 L2 R): exact at right angles, far below a step
// elsewhere.
//
// Programs are interpreted without rotation; places are rotated on output. So programmed values
// stay exact, and only an end is rounded, to 10^-7 mm. Sine and cosine have 62 fractional bits: 4 m
// from the centre their error is below 10^-14 m.
//
// The centre is stored in machine coordinates. That of G68 does not move when offsets change later;
// that of a coordinate system is its origin.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"

namespace lamplock::program {

class Rotation {
 public:
  /// No rotation.
  Rotation() = default;
  /// Turns the plane of two axes, from the first towards the second, by `angle_e7` (10^-7 degrees)
  /// round the centre.
  Rotation(int first, int second, const Place& centre_e7, std::int64_t angle_e7);

  bool active() const { return active_; }
  /// It turns the plane of these two axes.
  bool turns(int a, int b) const {
    return (first_ == a && second_ == b) || (first_ == b && second_ == a);
  }
  /// 10^-7 degrees, as programmed.
  std::int64_t angle_e7() const { return angle_e7_; }
  /// Position on the machine of a programmed place.
  Place turned(const Place& place) const { return active_ ? turn(place, sine_q62_) : place; }
  /// The programmed place of a position on the machine; turned() of it is off by 10^-7 mm at most.
  Place turned_back(const Place& place) const { return active_ ? turn(place, -sine_q62_) : place; }

  friend bool operator==(const Rotation&, const Rotation&) = default;

 private:
  Place turn(const Place& place, std::int64_t sine_q62) const;

  std::int64_t angle_e7_ = 0;
  std::int64_t first_centre_e7_ = 0, second_centre_e7_ = 0;
  std::int64_t sine_q62_ = 0, cosine_q62_ = 0;
  std::uint8_t first_ = 0, second_ = 1;
  bool active_ = false;
};

/// The rotations in force: that of the coordinate system acts first, then that of G68.
struct Rotations {
  const Rotation& system;
  const Rotation& program;

  bool active() const { return system.active() || program.active(); }
  /// All that are active turn the plane of these two axes.
  bool turn_only(int a, int b) const {
    return (!system.active() || system.turns(a, b)) && (!program.active() || program.turns(a, b));
  }
  /// Position on the machine of a programmed place.
  [[gnu::cold]] Place turned(const Place& place) const;
  /// The programmed place of a position on the machine.
  [[gnu::cold]] Place turned_back(const Place& place) const;
};

}  // namespace lamplock::program
