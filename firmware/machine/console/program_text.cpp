#include "firmware/machine/console/program_text.hpp"

#include "firmware/machine/console/status_report.hpp"

namespace lamplock::machine {
namespace {

using program::Modal;
using namespace std::string_view_literals;  // a length that -Os does not ask strlen for

constexpr std::int64_t um_per_mm = 1000;
/// 10^-7 mm per nanometre.
constexpr std::int64_t nm_e7 = program::one_e7 / 1'000'000;

/// Lines of `$#` after the coordinate systems.
enum OffsetLine : int {
  line_g28 = program::coordinate_systems,
  line_g30,
  line_shift,
  line_tool_length,
  line_probe
};
static_assert(line_probe == probe_line);

/// Adds a code, given as ten times its number as in the interpreter.
void add_code(TextLine& line, std::uint32_t tenths) {
  line.add(std::int64_t{tenths / 10});
  if (tenths % 10 != 0) line.add("."sv).add(std::int64_t{tenths % 10});
}

void add_g(TextLine& line, std::uint32_t tenths) {
  line.add(" G"sv);
  add_code(line, tenths);
}

void add_if(TextLine& line, bool wanted, std::uint32_t tenths) {
  if (wanted) add_g(line, tenths);
}

/// G54 to G59, then G59.1 to G59.3.
std::uint32_t code_of_system(std::uint32_t system) {
  return system < 6 ? 540 + 10 * system : 590 + (system - 5);
}

/// Modes that grbl lacks, if they differ from their value at power-up.
void add_further_modes(TextLine& line, const Modal& modal) {
  add_if(line, modal.centres_absolute, 901);
  add_if(line, modal.path != program::PathMode::exact, static_cast<std::uint32_t>(modal.path));
  add_if(line, modal.cutter == program::Cutter::left, 411);
  add_if(line, modal.cutter == program::Cutter::right, 421);
  add_if(line, modal.tool_length, 431);
  add_if(line, modal.retract_to_r, 990);
  add_if(line, modal.rotation.active(), 680);
}

void add_switches(TextLine& line, const Modal& modal) {
  line.add(" M"sv).add(modal.spindle == program::Spindle::off        ? std::int64_t{5}
                       : modal.spindle == program::Spindle::constant ? std::int64_t{3}
                                                                     : std::int64_t{4});
  if (modal.mist) line.add(" M7"sv);
  if (modal.flood) line.add(" M8"sv);
  if (!modal.mist && !modal.flood) line.add(" M9"sv);
  if (modal.beat_lock != program::BeatLock::off) line.add(" M130"sv);
  if (modal.pulses.on == program::Pulses::Switch::on) line.add(" M126"sv);
}

void add_feed(TextLine& line, const Modal& modal, bool inches) {
  line.add(" F"sv);
  if (modal.feed_mode == program::FeedMode::per_turn)
    return add_length(line, modal.feed * nm_e7, inches);
  if (!inches) {
    line.add((modal.feed + um_per_mm / 2) / um_per_mm);
    return;
  }
  const std::int64_t tenths = (std::int64_t{modal.feed} * 10 + um_per_inch / 2) / um_per_inch;
  line.add(tenths / 10).add("."sv).add(tenths % 10);
}

void add_in_force(TextLine& line, bool in_force, const program::Place& place,
                  const ReportedOffsets& offsets) {
  add_place(line, in_force ? place : program::Place{}, offsets.axes, offsets.inches);
}

void add_probe(TextLine& line, const ReportedOffsets& offsets) {
  line.add("PRB:"sv);
  add_place(line, offsets.probe.machine_e7, offsets.axes, offsets.inches);
  line.add(":"sv).add(std::int64_t{offsets.probe.met ? 1 : 0});
}

void write_tool(TextLine& line, const program::ToolTable::Entry& entry,
                const ReportedOffsets& offsets) {
  if (entry.number() == 0) return;
  const program::Tool tool = entry.tool();
  line.add("[T:"sv).add(std::int64_t{entry.number()}).add("|"sv);
  add_in_force(line, true, {0, 0, tool.length_e7, 0}, offsets);
  line.add("|"sv);
  add_length(line, tool.diameter_e7 / 2, offsets.inches.any());
  line.add("]\r\n"sv);
}

/// Degrees without trailing zeros.
void add_angle(TextLine& line, std::int64_t e7) {
  if (e7 < 0) line.add("-"sv);
  const std::int64_t size = e7 < 0 ? -e7 : e7;
  line.add(size / program::one_e7);
  std::int64_t rest = size % program::one_e7, unit = program::one_e7 / 10;
  if (rest != 0) line.add("."sv);
  for (; rest != 0; unit /= 10) {
    line.add(rest / unit);
    rest %= unit;
  }
}

void write_rotations(TextLine& line, const program::Parameters& parameters) {
  std::int64_t any = 0;
  for (const std::int64_t e7 : parameters.rotations_e7) any |= e7;
  if (any == 0) return;
  std::string_view before = "[ROT:"sv;
  for (const std::int64_t e7 : parameters.rotations_e7) {
    line.add(before);
    add_angle(line, e7);
    before = ","sv;
  }
  line.add("]\r\n"sv);
}

/// The tool of the last M6 or M61.
void write_loaded_tool(TextLine& line, const Modal& modal) {
  if ((modal.loaded_tool | modal.tool) == 0) return;
  line.add("[TOOL:"sv).add(std::int64_t{modal.loaded_tool}).add("]\r\n"sv);
}

}  // namespace

void write_offset(TextLine& line, int i, const ReportedOffsets& offsets) {
  const program::Parameters& parameters = offsets.parameters;
  if (i == rotation_line) return write_rotations(line, parameters);
  if (i == spindle_line) return write_loaded_tool(line, offsets.modal);
  if (i > line_probe)
    return write_tool(line, parameters.tools.entry(static_cast<std::size_t>(i - line_probe - 1)),
                      offsets);
  line.add("["sv);
  switch (i) {
    case line_g28:
      line.add("G28:"sv);
      add_in_force(line, true, parameters.home_g28_e7, offsets);
      break;
    case line_g30:
      line.add("G30:"sv);
      add_in_force(line, true, parameters.home_g30_e7, offsets);
      break;
    case line_shift:
      line.add("G92:"sv);
      add_in_force(line, offsets.modal.shifted, parameters.shift_e7, offsets);
      break;
    case line_tool_length:
      line.add("TLO:"sv);
      add_length(line, offsets.modal.tool_length ? parameters.tool_length_e7 : 0,
                 offsets.inches.any());
      break;
    case line_probe:
      add_probe(line, offsets);
      break;
    default:
      line.add("G"sv);
      add_code(line, code_of_system(static_cast<std::uint32_t>(i)));
      line.add(":"sv);
      add_in_force(line, true, parameters.systems_e7[static_cast<std::size_t>(i)], offsets);
      break;
  }
  line.add("]\r\n"sv);
}

void write_modes(TextLine& line, const Modal& modal, bool inches) {
  line.add("[GC:G"sv);
  add_code(line, static_cast<std::uint32_t>(modal.motion));
  add_g(line, code_of_system(modal.system));
  add_g(line, static_cast<std::uint32_t>(modal.plane));
  add_g(line, modal.inches ? 200 : 210);
  add_g(line, modal.relative ? 910 : 900);
  add_g(line, static_cast<std::uint32_t>(modal.feed_mode));
  add_further_modes(line, modal);
  add_switches(line, modal);
  line.add(" T"sv).add(std::int64_t{modal.tool});
  add_feed(line, modal, inches);
  line.add(" S"sv).add((std::int64_t{modal.speed_milli} + 500) / 1000);
  line.add("]\r\n"sv);
}

void write_start_up_line(TextLine& line, int number, std::string_view text) {
  line.add("$N"sv).add(std::int64_t{number}).add("="sv).add(text).add("\r\n"sv);
}

void write_start_up_result(TextLine& line, std::string_view text, int error) {
  line.add(">"sv).add(text);
  if (error == 0)
    line.add(":ok\r\n"sv);
  else
    line.add(":error:"sv).add(std::int64_t{error}).add("\r\n"sv);
}

void write_help(TextLine& line, const OptionalCommands& commands) {
  line.add("[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line"sv);
  if (commands.sleep) line.add(" $SLP"sv);
  if (commands.check) line.add(" $C"sv);
  line.add(" $X"sv);
  if (commands.homing) line.add(" $H"sv);
  line.add(" ~ ! ? ctrl-x]\r\n"sv);
}

}  // namespace lamplock::machine
