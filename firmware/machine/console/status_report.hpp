// The status report of grbl 1.1, as senders read it:
// "<Run|MPos:1.000,2.000,0.000|FS:600,1000|...>".
//
// In:  position and state of the machine, in plain numbers; the report mask ($10) and units ($13).
// Out: one line of text with its end.
// Who: the controller, for every '?', in every state; main loop, some 20 000 cycles of a
//      Cortex-M0+, most of them divisions by ten.
//
// Fields and their order are those of grbl, which senders expect: the work offset (WCO) in the
// first report and after each change, else in every 10th, every 30th while something moves;
// overrides (Ov, with accessories A) in the report after it, else in every 10th or 20th. Fields
// that grbl lacks are at the end: senders ignore unknown fields.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/program/value.hpp"
#include "shared/inch_axes.hpp"
#include "shared/text_line.hpp"

namespace lamplock::machine {

/// Bits of setting 10.
inline constexpr std::uint32_t report_machine_position = 1;  ///< MPos; without it WPos
inline constexpr std::uint32_t report_buffer = 2;            ///< Bf

/// Inputs that are active, one bit each, in the order of their letters in the field Pn: probe,
/// limits of X Y Z A, door, reset, hold, start.
inline constexpr std::string_view pin_letters = "PXYZADRHS";

/// Percent of the programmed value.
struct Overrides {
  std::uint8_t feed = 100, rapid = 100, spindle = 100;
  friend constexpr bool operator==(const Overrides&, const Overrides&) = default;
};

/// Contents of a report. Positions in 10^-7 mm of the machine.
struct ReportedStatus {
  std::string_view state;  ///< "Idle", "Run", "Hold:0" ...
  bool busy = false;       ///< something moves or is about to
  int axes = 3;
  program::Place machine_e7{};
  program::Place work_offset_e7{};
  std::uint32_t free_lines = 0;   ///< of the planner
  std::uint32_t free_bytes = 0;   ///< for lines
  std::uint32_t line = 0;         ///< N word of the line being run, 0 = none
  std::uint32_t feed_um_min = 0;  ///< of the machine, now
  bool feed_in_degrees = false;   ///< a rotary axis moves alone: the feed is 0.001 degrees/min
  std::uint32_t speed_milli = 0;  ///< of the spindle or laser, now
  std::uint16_t pins = 0;         ///< a bit for each of pin_letters
  Overrides overrides;
  bool clockwise = false, counterclockwise = false;  ///< spindle: M3, M4
  bool flood = false, mist = false;
};

/// A length, given in 10^-7 mm, as grbl prints it: mm with three decimals, inches with four.
void add_length(TextLine& line, std::int64_t length_e7, bool inches);
/// The same of all axes, commas between.
void add_place(TextLine& line, const program::Place& place_e7, int axes, InchAxes inches);

/// Writes reports; counts the reports since a field was last sent.
class StatusReporter {
 public:
  /// After a reset the first report contains all fields.
  void reset() { *this = StatusReporter(); }
  /// Begins a report; `mask` as setting 10. The caller adds further fields and ">\r\n".
  void begin(TextLine& line, const ReportedStatus& status, std::uint32_t mask, InchAxes inches);

 private:
  bool offset_due(const ReportedStatus& status);
  bool overrides_due(const ReportedStatus& status);

  program::Place told_offset_e7_{};
  Overrides reported_;
  bool reported_flood_ = false, reported_mist_ = false;
  std::uint8_t offset_in_ = 0;     ///< reports until the next one
  std::uint8_t overrides_in_ = 1;  ///< as above; not in the first report
};

}  // namespace lamplock::machine
