// What a program wants done, one thing at a time.
//
// In:  made by the interpreter from lines of G-code; curves and cycles become moves here.
// Out: taken by the machine in order: moves go to the planner, the rest waits for the planner to
//      be empty or travels with the moves, as the machine sees fit.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"

namespace lamplock::program {

enum class ActionKind : std::uint8_t {
  move,         ///< straight to `target_e7`
  pixels,       ///< of the move that comes next: `pixels` have the power `speed_milli`
  dwell,        ///< stand for `time_us`
  spindle,      ///< spindle or laser as `spindle` says, not during a move
  coolant,      ///< as `flood`, `mist` say
  pause,        ///< M0 and M1: until the user says go on
  tool_change,  ///< M6: the same, with the tool of the T word put in meanwhile
  program_end,  ///< M2 and M30
  beat_lock,    ///< M130, M131: from here on as `beat_lock` says
  output,       ///< M62 to M65, M67, M68: `io`
  wait_input,   ///< M66: `io`, no longer than `time_us`
  probe         ///< G38.2 to G38.5: a move that the probe ends; then the machine tells where it is
};

/// Direction of the spindle; of a laser: constant power, or in proportion to the actual speed.
enum class Spindle : std::uint8_t { off, constant, proportional };  // M5, M3, M4

/// Whether every end point of a feed move is a shot on the beat.
enum class BeatLock : std::uint8_t { off, path, free };  // M131, M130 P0, M130 P1

/// What an input is waited for (L of M66).
enum class InputEvent : std::uint8_t { now, rise, fall, on, off };

/// Of M62 to M68.
struct IoRequest {
  static constexpr std::uint16_t on = 65535;

  std::uint8_t port = 0;
  bool at_once = false;     ///< an output: not with the next motion
  std::uint16_t level = 0;  ///< of an output, `on` = all
  InputEvent event = InputEvent::now;
};

struct Action {
  ActionKind kind = ActionKind::move;
  /// A rapid: at the machine's highest speed, laser off.
  bool rapid = false;
  /// The feed is the time for this move and no speed (G93).
  bool timed = false;
  /// The corner at the end of this move is passed exactly and at a stop (G61.1, G9: exact stop).
  bool exact_stop = false;
  /// An end point that was programmed, not one of those that a curve was divided into.
  bool programmed_end = true;
  /// Of a probe: it ends when contact is lost; it is an error if it ends by itself.
  bool probe_away = false, probe_must = false;
  bool flood = false, mist = false;
  bool pulses = false;             ///< the laser shines in pulses (M126)
  std::uint16_t pixels = 0;        ///< of a move: its last ones, with this power; 0 = it has none
  Spindle spindle = Spindle::off;  ///< in force for this move
  BeatLock beat_lock = BeatLock::off;  ///< in force for this move
  std::uint32_t line = 0;              ///< N word of its line, 0 = none
  std::uint32_t feed_um_min = 0;  ///< speed along the path, um/min; not in rapids, not if timed
  std::uint32_t time_us = 0;      ///< of a dwell or a wait, or of a timed move
  std::uint32_t speed_milli = 0;  ///< S word in force, thousandths
  IoRequest io;
  std::uint32_t blend_um =
      0;              ///< the path may leave corners by so much (G64 P); 0 = exact path (G61)
  Place target_e7{};  ///< machine coordinates
};

}  // namespace lamplock::program
