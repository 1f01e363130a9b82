// A statement: the meaning of one line, checked completely before it has any effect.
//
// In:  a line, the state of the interpreter, parameters and options.
// Out: the state after the line, changes of parameters, and the plan: the actions of the line. Or
//      an error and no change: the interpreter applies a statement as a whole or not at all.
//
// Words are checked in the order in which RS274/NGC executes them ("The NIST RS274/NGC Interpreter
// - Version 3", table 8), so that of several errors the same one is reported for every order of the
// words. Units, plane and distance mode apply to the whole line, as in grbl. Saving and restoring
// the modal state (M70 to M73) come before everything else.
//
// Where LinuxCNC, grbl and NIST report different errors: as in grbl 1.1 (numbers:
// shared/gcode_errors.hpp), but two commands of one group are always error 21. Every error refers
// to a word of the line; a missing word to the command that needs it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/program/block.hpp"
#include "firmware/program/cycles.hpp"
#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::program {

/// Values from the machine and its settings.
struct Options {
  int axes = 3;                            ///< X Y Z A from the front; words of others are error 20
  std::uint8_t rotary = 0;                 ///< a bit for A if it is in degrees ($967)
  bool shortest_way = false;               ///< absolute places of a rotary axis are reached so
  std::int64_t arc_tolerance_e7 = 20'000;  ///< 10^-7 mm, above 0 ($12; 0.002 mm as in grbl)
  std::int64_t clearance_e7 = 2'540'000;   ///< of G73 and G83; LinuxCNC's 0.01 in
  std::uint32_t blend_um = 0;              ///< of a G64 without P
  bool laser = false;                      ///< $32: speed words are part of the moves
  bool probe = false;                      ///< the board has one: G38.2 to G38.5 are supported
  std::uint8_t outputs = 0;                ///< a bit for each that M62 to M65 and M67, M68 support
  std::uint8_t inputs = 0;                 ///< the same for M66
  bool beat_lock = true;                   ///< the machine supports it: M130 is known
  bool rows = false;                       ///< the machine accepts a row of pixels as one move
  std::uint32_t pulses_milli = 0;          ///< pulses per millimetre without M127
  std::uint32_t pulse_ns = 0;              ///< their length ($932, $933)
};

/// Maximum values of words, as in grbl 1.1.
inline constexpr std::uint32_t max_line_number = 10'000'000;
inline constexpr std::uint32_t max_tool = ToolTable::max_number;
/// Pulses of a laser: up to a thousand per millimetre, from a microsecond to a second each.
inline constexpr std::uint32_t max_pulses_milli = 1'000'000;
inline constexpr std::uint32_t min_pulse_ns = 1'000, max_pulse_ns = 1'000'000'000;
/// Repetitions of a cycle.
inline constexpr std::uint32_t max_repeats = 9999;
/// Centres of arcs and control points must be within +-1 km of the machine's zero.
inline constexpr std::int64_t max_centre_e7 = 100 * max_position_e7;

/// Modal state saved by M70 or M73.
struct Saved {
  Modal modal;
  bool valid = false;
  bool restore_at_end = false;  ///< M73
  friend bool operator==(const Saved&, const Saved&) = default;
};

/// Stages of a line, in their order.
enum class Stage : std::uint8_t {
  held,  ///< cutter compensation: the move that waited for this line
  output,
  wait_input,
  tool_change,
  spindle,
  coolant,
  overrides,
  beat_lock,
  dwell,
  corner,  ///< cutter compensation: the arc before the move of this line, which then waits
  via,     ///< G28, G30: the intermediate place
  home,    ///< and the end, in machine coordinates
  move,    ///< one straight move, a probe too
  curve,
  cycle,
  stop
};

struct Plan {
  std::uint32_t stages = 0;  ///< a bit for each
  std::uint32_t line = 0;
  std::uint32_t feed_um_min = 0;
  std::uint32_t time_us = 0;  ///< of the motion, in G93
  std::uint32_t dwell_us = 0;
  std::uint32_t wait_us = 0;  ///< of M66
  std::uint32_t turns = 0;    ///< P of an arc
  std::uint32_t pieces = 0;   ///< of a line of pixels; 0 if it is not divided
  Motion motion = Motion::rapid;
  std::uint16_t stop = 0;   ///< M code
  bool in_machine = false;  ///< the end of the move is in machine coordinates
  bool exact_stop = false;
  bool jog = false;
  bool sets_cutter = false;  ///< G40 to G42.1
  /// Weights of the control points that the line adds to a NURBS, 0: none. The first one is where
  /// the block begins, the other one is points[0].
  std::array<std::uint32_t, 2> weights_e6{};
  IoRequest io;  ///< set where a stage needs it
  bool rotary;   ///< set with an arc: the rotary axis moves, and F is not for the path of all axes
  // Places are only set where a stage needs them.
  Place start;  ///< of a curve, programmed
  /// Intermediate place of G28; the centre of an arc; both control points of a spline. Programmed.
  std::array<Place, 2> points;

  void add(Stage stage) { stages |= 1u << static_cast<int>(stage); }
  /// Clears everything that is not set where it is needed.
  void clear() {
    stages = line = feed_um_min = time_us = dwell_us = turns = pieces = 0;
    motion = Motion::rapid;
    stop = 0;
    in_machine = exact_stop = jog = sets_cutter = false;
    weights_e6 = {};
  }
  /// Whether anything follows the change of the spindle for which the machine moves, rests or
  /// stops.
  bool moves() const { return stages >> static_cast<int>(Stage::dwell) != 0; }
  bool has(Stage stage) const { return (stages >> static_cast<int>(stage) & 1u) != 0; }
  bool is_rotary_arc() const { return is_arc(motion) && rotary; }
};

/// Changes of the parameters by a line.
struct Changes {
  std::uint16_t rows = 0;        ///< as Parameters::changed
  Place place;                   ///< of the row that is no tool length
  std::int64_t rotation_e7 = 0;  ///< of a coordinate system
  std::int64_t tool_length_e7 = 0;
  ToolTable::Entry tool;  ///< of the tool table

  bool has(ParameterRow row) const { return (rows >> static_cast<int>(row) & 1u) != 0; }
  void add(int row) { rows = static_cast<std::uint16_t>(rows | 1u << row); }
};

/// Axes of a plane; the same order as in CurvePlane.
struct PlaneAxes {
  std::uint8_t first, second, normal;
};
constexpr PlaneAxes axes_of(Plane plane) {
  if (plane == Plane::zx) return {2, 0, 1};
  return plane == Plane::yz ? PlaneAxes{1, 2, 0} : PlaneAxes{0, 1, 2};
}

class Statement {
 public:
  /// The state after the line and the plan are made in place; after an error the plan has no stage
  /// and that state is undefined.
  Statement(const Options& options, const Parameters& parameters, const Saved& saved,
            Expressions& expressions, const State& before, State& after, Plan& plan)
      : plan_(plan),
        options_(options),
        parameters_(parameters),
        saved_(saved),
        expressions_(expressions),
        after_(after) {
    after_ = before;
  }

  /// Reads and checks a line.
  Fault check(std::string_view line);
  /// The same for the text after "$J=". The modal state does not change.
  Fault check_jog(std::string_view line);

  const State& after() const { return after_; }
  const Changes& changes() const { return changes_; }
  /// If the plan has a cycle.
  const CycleRequest& cycle() const { return cycle_; }
  /// If the plan has pieces: their powers.
  std::string_view powers() const { return block_.powers(); }
  /// M code of group `saving`, or Block::no_code.
  std::uint16_t saving() const { return block_.code(Group::saving); }
  /// Words without effect, a bit for each (Ignored).
  std::uint8_t ignored() const { return block_.ignored(); }
  /// With G41 to G42.1: the radius of the cutter.
  std::int64_t cutter_radius_e7() const { return cutter_radius_e7_; }
  /// Commands of the line that cutter compensation excludes; `before`: the state before the line.
  [[gnu::cold]] Fault check_compensated(const Modal& before);
  /// Commands that lines of the user must not have during a tool change.
  [[gnu::cold]] Fault check_users() const;
  /// The line has axis words of the active plane.
  [[gnu::cold]] bool names_plane_axes() const;
  /// The line has a command that acts once, other than a dwell, or changes cutter compensation.
  [[gnu::cold]] bool needs_machine_place() const;
  /// Column for an error of cutter compensation.
  [[gnu::cold]] std::uint16_t compensation_column() const;

 private:
  void read(std::string_view line, bool jog);

  // Every step returns false after an error, which is then in fault_.
  bool fail(GcodeError error, std::uint16_t column);
  bool fail_at(char letter, GcodeError error);
  bool fail_axes(GcodeError error, std::uint32_t axes);
  bool fail_motion(GcodeError error);

  bool everything();
  bool before_motion();
  bool saved_state();
  bool codes();
  bool feed();
  bool inverse_time();
  bool speed();
  bool tool();
  bool tool_change();
  [[gnu::cold]] bool set_tool();
  bool line_number();
  [[gnu::cold]] bool io();
  bool no_io();
  bool port(char letter, std::uint8_t known, std::uint32_t most);
  bool digital_output();
  bool analog_output();
  bool wait_input();
  bool spindle();
  bool coolant();
  bool overrides();
  bool beat_lock();
  bool pulses();
  bool pulses_on();
  bool pulse_rate();
  bool pulse_length();
  bool dwell();
  [[gnu::cold]] bool cutter();
  bool path();
  bool tool_length();
  [[gnu::cold]] bool tool_length_of_axis();
  [[gnu::cold]] bool tool_length_of_table();
  bool set_tool_length(std::int64_t e7, std::uint16_t column);
  [[gnu::cold]] bool known_tool(std::uint32_t number, std::uint16_t column);
  [[gnu::cold]] bool find_tool(std::uint32_t number, Tool& tool, std::uint16_t column);
  [[gnu::cold]] bool tool_of(const Word* word, std::uint32_t& number);
  [[gnu::cold]] bool enter_tool(std::uint32_t kind, std::uint32_t number);
  [[gnu::cold]] bool cutter_diameter(std::int64_t& diameter_e7);
  [[gnu::cold]] bool system();
  [[gnu::cold]] bool additional_system();
  [[gnu::cold]] bool rotation();
  bool data();
  bool set_system();
  bool shift();
  bool at_home();
  bool motion();
  bool move();
  bool cut_move();
  bool pixels();
  bool stop();
  bool rest();
  bool jog();

  bool feed_in_force();
  bool straight();
  bool full_circle() const;
  bool arc();
  bool arc_of_radius(const Place& end);
  bool arc_of_centre(const Place& end);
  bool arc_turns();
  bool spline();
  bool spline_start(Place& control);
  bool parabola();
  [[gnu::cold]] bool nurbs();
  [[gnu::cold]] bool nurbs_line();
  bool nurbs_point();
  bool nurbs_weight(std::uint32_t& weight_e6);
  bool nurbs_end();
  bool curve_in_xy();
  bool drill();
  bool drill_levels();
  bool drill_values();
  bool drill_holes(const Place& first);

  bool target(Place& place, bool in_machine);
  [[gnu::cold]] std::int64_t home_of_axis(int axis, const Place& from, const Place& home) const;
  [[gnu::cold]] bool rotary_target(Place& place, bool in_machine);
  bool inside(std::int64_t e7, std::int64_t most, GcodeError error, std::uint16_t column);
  bool all_inside(const Place& place, std::uint16_t column);
  bool end_at(const Place& programmed);
  [[gnu::cold]] bool end_turned();
  bool end_at_machine(const Place& machine);
  [[gnu::cold]] void turn(const Rotation& rotation);
  [[gnu::cold]] void turn_system(const Rotation& rotation);
  [[gnu::cold]] void change_system();
  [[gnu::cold]] bool set_origin(std::uint32_t kind, std::size_t row);
  [[gnu::cold]] void origin_of_position();

  bool length(char letter, std::int64_t& e7);
  bool take(char letter);
  bool seconds(char letter, std::uint32_t& us);
  bool unsigned_value(char letter, std::int64_t value, GcodeError too_large, std::uint32_t& number);
  bool needed(char letter, std::uint16_t column);
  bool needed(char letter);
  bool integer(char letter, std::uint32_t& number);
  bool move_is_asked() const;
  std::uint16_t motion_column() const;
  std::uint16_t centre_column() const;
  std::int64_t fine_length(char letter, int digits) const;
  std::int64_t axis_e7(int axis) const;
  [[gnu::cold]] std::int64_t inch_axis_e7(int axis) const;
  std::int64_t offset_e7(int axis) const;

  // The most used members are first, within reach of short instructions.
  Fault fault_;
  Plan& plan_;
  const Options& options_;
  const Parameters& parameters_;
  const Saved& saved_;
  Expressions& expressions_;
  State& after_;
  Block block_;
  Changes changes_;
  CycleRequest cycle_;
  std::int64_t cutter_radius_e7_;  ///< with G41 to G42.1
};

}  // namespace lamplock::program
