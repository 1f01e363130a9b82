#include "firmware/machine/console/status_report.hpp"

namespace lamplock::machine {
namespace {

// Reports between two that contain these fields, as in grbl 1.1: fewer while idle.
constexpr std::uint8_t offset_idle = 10, offset_busy = 30;
constexpr std::uint8_t overrides_idle = 10, overrides_busy = 20;

constexpr std::int64_t um_min_per_mm_min = 1000;
/// 10^-7 mm in the last digit: 0.001 mm, 0.0001 in.
constexpr std::int64_t last_of_mm = program::one_e7 / 1000,
                       last_of_inch = program::inch_e7 / 10'000;

/// Rounds half away from zero.
std::int64_t rounded(std::int64_t value, std::int64_t unit) {
  return (value < 0 ? value - unit / 2 : value + unit / 2) / unit;
}

/// Whole mm/min or degrees/min, or inches/min with a decimal.
void add_rate(TextLine& line, std::uint32_t um_min, bool inches) {
  if (!inches) {
    line.add(rounded(um_min, um_min_per_mm_min));
    return;
  }
  const std::int64_t tenths = rounded(std::int64_t{um_min} * 10, um_per_inch);
  line.add(tenths / 10).add(".").add(tenths % 10);
}

void add_pins(TextLine& line, std::uint16_t pins) {
  if (pins == 0) return;
  line.add("|Pn:");
  for (std::size_t i = 0; i < pin_letters.size(); ++i)
    if ((pins >> i & 1u) != 0) line.add(pin_letters.substr(i, 1));
}

void add_overrides(TextLine& line, const ReportedStatus& status) {
  const Overrides& o = status.overrides;
  line.add("|Ov:").add(std::int64_t{o.feed}).add(",").add(std::int64_t{o.rapid});
  line.add(",").add(std::int64_t{o.spindle});
  if (!status.clockwise && !status.counterclockwise && !status.flood && !status.mist) return;
  line.add("|A:");
  if (status.clockwise) line.add("S");
  if (status.counterclockwise) line.add("C");
  if (status.flood) line.add("F");
  if (status.mist) line.add("M");
}

}  // namespace

void add_length(TextLine& line, std::int64_t length_e7, bool inches) {
  if (!inches) {
    line.add_milli(rounded(length_e7, last_of_mm));
    return;
  }
  const std::int64_t tenths = rounded(length_e7, last_of_inch);  // of a thousandth
  const std::int64_t size = tenths < 0 ? -tenths : tenths;
  if (tenths < 0) line.add("-");
  line.add_milli(size / 10).add(size % 10);
}

void add_place(TextLine& line, const program::Place& place_e7, int axes, InchAxes inches) {
  for (int a = 0; a < axes; ++a) {
    if (a != 0) line.add(",");
    add_length(line, place_e7[index(a)], inches.has(a));
  }
}

bool StatusReporter::offset_due(const ReportedStatus& status) {
  if (offset_in_ != 0 && told_offset_e7_ == status.work_offset_e7) {
    --offset_in_;
    return false;
  }
  offset_in_ = (status.busy ? offset_busy : offset_idle) - 1;
  told_offset_e7_ = status.work_offset_e7;
  if (overrides_in_ == 0) overrides_in_ = 1;  // not both in one line
  return true;
}

bool StatusReporter::overrides_due(const ReportedStatus& status) {
  const bool known = reported_ == status.overrides && reported_flood_ == status.flood &&
                     reported_mist_ == status.mist;
  if (overrides_in_ != 0 && known) {
    --overrides_in_;
    return false;
  }
  overrides_in_ = (status.busy ? overrides_busy : overrides_idle) - 1;
  reported_ = status.overrides;
  reported_flood_ = status.flood;
  reported_mist_ = status.mist;
  return true;
}

void StatusReporter::begin(TextLine& line, const ReportedStatus& status, std::uint32_t mask,
                           InchAxes inches) {
  const bool machine = (mask & report_machine_position) != 0;
  program::Place place = status.machine_e7;
  if (!machine)
    for (std::size_t a = 0; a < place.size(); ++a) place[a] -= status.work_offset_e7[a];
  line.add("<").add(status.state).add(machine ? "|MPos:" : "|WPos:");
  add_place(line, place, status.axes, inches);
  if ((mask & report_buffer) != 0)
    line.add("|Bf:")
        .add(std::int64_t{status.free_lines})
        .add(",")
        .add(std::int64_t{status.free_bytes});
  if (status.line != 0) line.add("|Ln:").add(std::int64_t{status.line});
  line.add("|FS:");
  add_rate(line, status.feed_um_min, inches.any() && !status.feed_in_degrees);
  line.add(",").add(rounded(status.speed_milli, 1000));
  add_pins(line, status.pins);
  if (offset_due(status)) {
    line.add("|WCO:");
    add_place(line, status.work_offset_e7, status.axes, inches);
  }
  if (overrides_due(status)) add_overrides(line, status);
}

}  // namespace lamplock::machine
