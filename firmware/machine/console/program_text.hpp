// Reports about the state of the program in the format of grbl 1.1: `$G`, `$#`, `$N` and `$`.
//
// In:  modal state and parameters of the interpreter, the result of the last probe, stored lines.
// Out: one line of text with its line end at a time; the caller sends "ok" after the last one.
// Who: the controller, for commands of the host; main loop, not while a line is being interpreted.
//      A line of `$#` is some 15 000 cycles of a Cortex-M0+, divisions by ten as in a status
//      report.
//
// Senders split the line of `$G` at spaces and look each word up in their tables (UGS, gSender,
// CNCjs); unknown words are ignored. CNCjs accepts only the letters G, M, T, F and S, and no sign.
// So modes that grbl lacks appear between grbl's as plain words, and only while they differ from
// their value at power-up: without them the line is exactly grbl's. Their numbers (P of G64 and
// M130, R of G68) are not reported. M7 and M8 together are two words, as in grblHAL; grbl writes
// "M78". M0, M2 and M30 never appear: grbl resets them before it reads the next line.
//
// Offsets are the active ones: a shift suspended by G92.2 is reported as 0, and so is a tool length
// after G49, since senders add G54.., G92 and TLO to get the work offset.
#pragma once

#include <string_view>

#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "firmware/program/value.hpp"
#include "shared/inch_axes.hpp"
#include "shared/text_line.hpp"

namespace lamplock::machine {

/// Result of the last probe (G38.2 to G38.5); zero after power-up.
struct ProbeResult {
  program::Place machine_e7{};
  bool met = false;
};

/// Data of `$#`; the objects referred to must not move while the report is written.
struct ReportedOffsets {
  const program::Parameters& parameters;
  const program::Modal& modal;
  const ProbeResult& probe;
  int axes = 3;
  InchAxes inches{};
};

/// Lines of `$#`: coordinate systems, G28, G30, G92, TLO, PRB, then the places of the tool table,
/// the rotations of the systems and the tool in the spindle.
inline constexpr int probe_line = program::coordinate_systems + 4;
inline constexpr int rotation_line = probe_line + 1 + int{program::ToolTable::capacity};
inline constexpr int spindle_line = rotation_line + 1;
inline constexpr int offset_lines = spindle_line + 1;
/// Line `i` of them, from 0: "[G54:0.000,0.000,0.000]". A tool is, as in grblHAL, its number, its
/// offsets and its radius: "[T:1|0.000,0.000,5.000|3.000]"; an empty place has no line. Rotations
/// are degrees from G54 to G59.3, "[ROT:0,12.5,0,0,0,0,0,0,0]"; there is no line if all are 0, so
/// that senders see it only where it says something. The tool in the spindle is "[TOOL:2]", because
/// T of `$G` is the one for the next M6; there is no line if both are 0.
void write_offset(TextLine& line, int i, const ReportedOffsets& offsets);

/// `$G`: "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]". The feed rate is in mm/min, or in inches/min
/// with `inches` (setting 13, independent of G20); in G95 per turn.
void write_modes(TextLine& line, const program::Modal& modal, bool inches);

/// One line of `$N`: "$N0=G21".
void write_start_up_line(TextLine& line, int number, std::string_view text);
/// Result of a start-up line after a reset: ">G21:ok" or ">G21:error:20".
void write_start_up_result(TextLine& line, std::string_view text, int error);

/// Commands that only some boards have.
struct OptionalCommands {
  bool sleep = false;   ///< $SLP
  bool check = false;   ///< $C
  bool homing = false;  ///< $H
};
/// `$`: lists the commands.
void write_help(TextLine& line, const OptionalCommands& commands);

}  // namespace lamplock::machine
