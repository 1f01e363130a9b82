// State that persists from line to line, and that a line may change.
//
// Values of enumerations are the numbers of their G codes times ten, so that a report of the state
// ($G) can print them; 10 is G1, 385 is G38.5.
#pragma once

#include <cstdint>

#include "firmware/program/action.hpp"
#include "firmware/program/rotation.hpp"
#include "firmware/program/value.hpp"

namespace lamplock::program {

enum class Motion : std::uint16_t {
  rapid = 0,
  line = 10,
  arc_clockwise = 20,
  arc_counterclockwise = 30,
  spline = 50,
  parabola = 51,
  nurbs = 52,          ///< of a line alone: the mode is none from then on
  probe_toward = 382,  ///< an error without contact
  probe_toward_quiet = 383,
  probe_away = 384,
  probe_away_quiet = 385,
  drill_chip_break = 730,
  none = 800,
  drill = 810,
  drill_dwell = 820,
  drill_peck = 830,
  bore = 850,        ///< out at the feed, to the retract level
  bore_stop = 860,   ///< out as a rapid, the spindle at rest
  bore_dwell = 890,  ///< out at the feed, after a dwell
};
constexpr bool is_arc(Motion motion) {
  return motion == Motion::arc_clockwise || motion == Motion::arc_counterclockwise;
}
/// Moves at the feed rate along a path: where a laser cuts.
constexpr bool is_feed(Motion motion) {
  return motion == Motion::line || is_arc(motion) || motion == Motion::spline ||
         motion == Motion::parabola;
}
constexpr bool is_cycle(Motion motion) {
  return motion == Motion::drill_chip_break || motion >= Motion::drill;
}
/// Cycles that rest at the bottom of a hole.
constexpr bool has_dwell(Motion cycle) {
  return cycle == Motion::drill_dwell || cycle == Motion::bore_stop || cycle == Motion::bore_dwell;
}
constexpr bool is_probe(Motion motion) {
  return motion >= Motion::probe_toward && motion <= Motion::probe_away_quiet;
}

/// Side of the cutter, seen in the direction of the cut: G40, G41, G42.
enum class Cutter : std::uint8_t { off, left, right };

enum class Plane : std::uint8_t { xy = 170, zx = 180, yz = 190 };
enum class FeedMode : std::uint16_t { inverse_time = 930, per_minute = 940, per_turn = 950 };
enum class PathMode : std::uint16_t { exact = 610, stop = 611, blend = 640 };

/// Coordinate systems G54 .. G59, G59.1 .. G59.3.
inline constexpr int coordinate_systems = 9;

/// Pulses of a continuous laser: M126, M127, M128. Without a word the settings apply.
struct Pulses {
  static constexpr std::uint32_t as_set = 0xffffffff;
  enum class Switch : std::uint8_t { as_set, off, on };
  Switch on = Switch::as_set;
  std::uint32_t milli_per_mm = as_set;  ///< thousandths of a pulse a millimetre
  std::uint32_t length_ns = as_set;
  friend bool operator==(const Pulses&, const Pulses&) = default;
};

/// The modal state. Its defaults are the state after power-up and reset.
struct Modal {
  Motion motion = Motion::rapid;
  FeedMode feed_mode = FeedMode::per_minute;
  PathMode path = PathMode::exact;
  Plane plane = Plane::xy;
  Cutter cutter = Cutter::off;
  bool inches = false;            ///< G20
  bool relative = false;          ///< G91
  bool centres_absolute = false;  ///< G90.1
  bool retract_to_r = false;      ///< G99
  bool shifted = false;           ///< the offset of G92 is active
  bool tool_length = false;       ///< the offset of G43 to G43.2 is active
  bool mist = false;              ///< M7
  bool flood = false;             ///< M8
  bool overrides_off = false;     ///< M49
  std::uint8_t system = 0;        ///< 0 is G54
  Spindle spindle = Spindle::off;
  BeatLock beat_lock = BeatLock::off;
  std::uint8_t decimals = 0;      ///< most decimals of an axis word so far
  std::uint8_t loaded_tool = 0;   ///< in the spindle: M6, M61
  std::uint32_t blend_um = 0;     ///< P of G64
  std::uint32_t feed = 0;         ///< um/min; in G95 nm per turn; not used in G93
  std::uint32_t speed_milli = 0;  ///< S, thousandths
  std::uint32_t tool = 0;         ///< T, which the next M6 loads
  Pulses pulses;                  ///< M126 to M128
  Rotation rotation;              ///< G68
  friend bool operator==(const Modal&, const Modal&) = default;
};

/// Words of canned cycles that are kept while the same cycle repeats ("sticky" numbers, NIST,
/// section 3.5.16), in 10^-7 mm as programmed: places or distances, according to G90 and G91.
struct CycleWords {
  std::int64_t retract_e7 = 0, depth_e7 = 0, peck_e7 = 0;
  std::int64_t initial_e7 = 0;  ///< where the series of cycles began, for G98
  std::uint32_t dwell_us = 0;
  bool has_retract = false, has_depth = false, has_peck = false, has_dwell = false;
  bool series = false;  ///< the previous move was a cycle as well
  friend bool operator==(const CycleWords&, const CycleWords&) = default;
};

/// The end of a spline, which the next one continues by default.
struct SplineEnd {
  std::int64_t first_e7 = 0, second_e7 = 0;  ///< from its end to its second control point
  bool known = false;
  friend bool operator==(const SplineEnd&, const SplineEnd&) = default;
};

/// The block of a NURBS, from G5.2 to G5.3.
struct NurbsBlock {
  std::int64_t first_e7 = 0, second_e7 = 0;  ///< its last control point, programmed
  std::uint8_t count = 0;                    ///< of control points; 0: no block is open
  std::uint8_t order = 0;
  friend bool operator==(const NurbsBlock&, const NurbsBlock&) = default;
};

/// Everything that a line can change, except for the parameters.
struct State {
  Modal modal;
  Place programmed_e7{};  ///< position of the program: machine coordinates before rotation
  Place machine_e7{};     ///< the same place, rotated: the target of the machine
  CycleWords cycle;
  SplineEnd spline;
  NurbsBlock nurbs;
  Rotation system_rotation;  ///< of the active coordinate system (G10 L2 R)

  Rotations rotations() const { return {system_rotation, modal.rotation}; }
  friend bool operator==(const State&, const State&) = default;
};

}  // namespace lamplock::program
