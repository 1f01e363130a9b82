// The actions of a program, one at a time.
//
// In:  made by the interpreter from lines of G-code; curves and cycles become moves here.
// Out: taken by the machine in order: moves go to the planner, the rest waits for the planner to be
//      empty or is attached to the moves, as the machine requires.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"

namespace lamplock::program {

enum class ActionKind : std::uint8_t {
  move,         ///< straight to `target_e7`
  pixels,       ///< of the next move: `pixels` have the power `speed_milli`
  dwell,        ///< rest for `time_us`
  spindle,      ///< set spindle or laser to `spindle`, not during a move
  coolant,      ///< set to `flood`, `mist`
  pause,        ///< M0 and M1: until the user resumes
  tool_change,  ///< M6: the same, while the tool of the T word is inserted
  program_end,  ///< M2 and M30
  overrides,    ///< M48, M49: `overrides_off` from here on
  beat_lock,    ///< M130, M131: `beat_lock` from here on
  output,       ///< M62 to M65, M67, M68: `io`
  wait_input,   ///< M66: `io`, for at most `time_us`
  probe         ///< G38.2 to G38.5: a move that the probe ends; then the machine sets its position
};

/// Direction of the spindle; of a laser: constant power, or in proportion to the actual speed.
enum class Spindle : std::uint8_t { off, constant, proportional };  // M5, M3, M4

/// Whether every end point of a feed move is a shot on the beat.
enum class BeatLock : std::uint8_t { off, path, free };  // M131, M130 P0, M130 P1

/// Event of an input to wait for (L of M66).
enum class InputEvent : std::uint8_t { now, rise, fall, on, off };

/// Parameters of M62 to M68.
struct IoRequest {
  static constexpr std::uint16_t on = 65535;

  std::uint8_t port = 0;
  bool at_once = false;     ///< an output: immediately, not with the next motion
  std::uint16_t level = 0;  ///< of an output, `on` = full
  InputEvent event = InputEvent::now;
};

struct Action {
  ActionKind kind = ActionKind::move;
  /// A rapid: at the machine's maximum speed, laser off. For a dwell or a change of the spindle:
  /// true if no light at rest ($936) is permitted.
  bool rapid = false;
  /// The feed rate is the time for this move, not a speed (G93).
  bool timed = false;
  /// The corner at the end of this move is passed exactly and at a stop (G61.1, G9: exact stop).
  bool exact_stop = false;
  /// A programmed end point, not one of the division of a curve.
  bool programmed_end = true;
  /// Of a probe: the move ends when contact is lost; it is an error if it ends by itself.
  bool probe_away = false, probe_must = false;
  bool flood = false, mist = false;
  bool pulses = false;         ///< the laser shines in pulses (M126)
  bool overrides_off = false;  ///< feed, rapids and power as programmed
  /// Of a straight feed move: the last decimal of its numbers; 0 = exact.
  std::uint8_t digit_um = 0;
  std::uint16_t pixels = 0;            ///< of a move: its last ones, with this power; 0 = none
  Spindle spindle = Spindle::off;      ///< active during this move
  BeatLock beat_lock = BeatLock::off;  ///< active during this move
  std::uint32_t line = 0;              ///< N word of its line, 0 = none
  std::uint32_t feed_um_min = 0;  ///< speed along the path, um/min; not in rapids, not if timed
  std::uint32_t time_us = 0;      ///< of a dwell or a wait, or of a timed move
  std::uint32_t speed_milli = 0;  ///< active S word, thousandths
  IoRequest io;
  std::uint32_t blend_um =
      0;              ///< maximum distance of the path from corners (G64 P); 0 = exact (G61)
  Place target_e7{};  ///< machine coordinates
};

}  // namespace lamplock::program
