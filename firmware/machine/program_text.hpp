// What the machine says about the state of its program, in the form that grbl 1.1 gave it: `$G`,
// `$#`, `$N` and `$`.
//
// In:  modal state and parameters of the interpreter, what the last probe found, stored lines.
// Out: one line of text with its end at a time; the caller sends "ok" behind the last one.
// Who: the controller, to commands of the host; main loop, not while a line is being interpreted.
//      A line of `$#` is some 15 000 cycles of a Cortex-M0+, divisions by ten as in a status
//      report.
//
// Senders take the line of `$G` apart by spaces and look each word up in tables of their own (UGS,
// gSender, CNCjs); a word that they do not know is passed over. CNCjs takes no letters but G, M, T,
// F and S, and no sign. So modes that no grbl has stand between its own as plain words, and only
// while they are not what they are after power-up: the line of a machine that knows nothing else is
// grbl's own, byte for byte. Numbers that belong to them (P of G64 and M130, R of G68) are not
// told. M7 and M8 together are two words, as grblHAL has it; grbl makes "M78" of them. M0, M2 and
// M30 never stand here: grbl resets them before it reads the next line.
//
// Offsets are those in force: a shift that G92.2 has suspended counts as none, and so does a tool
// length after G49, for senders add G54.., G92 and TLO up to the work offset.
#pragma once

#include <string_view>

#include "firmware/machine/text.hpp"
#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "firmware/program/value.hpp"

namespace lamplock::machine {

/// What the last probe found (G38.2 to G38.5); nothing after power-up.
struct ProbeResult {
  program::Place machine_e7{};
  bool met = false;
};

/// What `$#` tells; whatever is referred to stays where it is while the report is written.
struct ReportedOffsets {
  const program::Parameters& parameters;
  const program::Modal& modal;
  const ProbeResult& probe;
  int axes = 3;
  bool inches = false;  ///< setting 13
};

/// Lines of `$#`: coordinate systems, G28, G30, G92, TLO, PRB.
inline constexpr int offset_lines = program::coordinate_systems + 5;
inline constexpr int probe_line = offset_lines - 1;
/// Line `i` of them, from 0: "[G54:0.000,0.000,0.000]".
void write_offset(TextLine& line, int i, const ReportedOffsets& offsets);

/// `$G`: "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]". The feed is in mm/min, in inches/min with
/// `inches` (setting 13, whatever G20 says), in G95 per turn.
void write_modes(TextLine& line, const program::Modal& modal, bool inches);

/// One line of `$N`: "$N0=G21".
void write_start_up_line(TextLine& line, int number, std::string_view text);
/// What has become of a start-up line, after a reset: ">G21:ok" or ">G21:error:20".
void write_start_up_result(TextLine& line, std::string_view text, int error);

/// Commands that not every board answers.
struct OptionalCommands {
  bool sleep = false;   ///< $SLP
  bool check = false;   ///< $C
  bool homing = false;  ///< $H
};
/// `$`: which commands there are.
void write_help(TextLine& line, const OptionalCommands& commands);

}  // namespace lamplock::machine
