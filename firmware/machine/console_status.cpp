// Status reports, in text and in frames.
#include "firmware/machine/console.hpp"
#include "firmware/machine/runners/program_motion.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

/// Position of the machine and its speed as F means it: that of the linear axes along their path,
/// or that of a rotary axis which moves alone (program/rotary.hpp).
void report_motion(ReportedStatus& status, const stepper::MotionState& motion,
                   const settings::Values& values) {
  std::uint64_t squares = 0;
  std::uint32_t rotary = 0;
  bool linear_axes_rest = true;
  for (int a = 0; a < status.axes; ++a) {
    const stepper::AxisState& axis = motion.axis[index(a)];
    const auto steps_per_mm_milli = static_cast<std::uint32_t>(values.milli(Id::steps_per_mm_x, a));
    status.machine_e7[index(a)] = place_of(axis, values, a);
    const std::int64_t steps_per_min =
        (Int128::product(axis.speed_q62, 60 * std::int64_t{ticks_per_second}) >> 62).to_int64();
    const auto um_min =
        static_cast<std::uint32_t>(mul_div(abs64(steps_per_min), 1'000'000, steps_per_mm_milli));
    if (is_rotary(values, a)) {
      rotary = um_min;
    } else {
      squares += wide_product(um_min, um_min);
      if (axis.speed_q62 != 0) linear_axes_rest = false;
    }
  }
  status.feed_in_degrees = linear_axes_rest && rotary != 0;
  status.feed_um_min = status.feed_in_degrees ? rotary : isqrt(squares);
}

/// A bit for each of pin_letters.
std::uint16_t active_pins(InputSet active) {
  constexpr std::uint16_t probe_pin = 1u << pin_letters.find('P');
  constexpr std::uint16_t door_pin = 1u << pin_letters.find('D');
  constexpr auto first_limit = static_cast<unsigned>(pin_letters.find('X'));
  unsigned pins = unsigned{engaged_axes(active)} << first_limit;
  if ((active & set_of(Input::probe)) != 0) pins |= probe_pin;
  if ((active & set_of(Input::door)) != 0) pins |= door_pin;
  return static_cast<std::uint16_t>(pins);
}

/// Modal values of the program.
void report_program(ReportedStatus& status, const program::Interpreter& interpreter) {
  const program::Modal& modal = interpreter.modal();
  status.work_offset_e7 = interpreter.work_offset_e7();
  if (modal.spindle != program::Spindle::off) status.speed_milli = modal.speed_milli;
  status.clockwise = modal.spindle == program::Spindle::constant;
  status.counterclockwise = modal.spindle == program::Spindle::proportional;
  status.flood = modal.flood;
  status.mist = modal.mist;
}

}  // namespace

std::string_view MachineConsole::state_name() const {
  const bool rests = runner_.at_rest();
  if (rests && machine_.changes_tool() && machine_.running()) return "Tool";
  switch (machine_.state()) {
    case State::idle:
      return "Idle";
    case State::check:
      return "Check";
    case State::sleep:
      return "Sleep";
    case State::running:
    case State::stopping:
    case State::resetting:
    case State::aborting:
      if (machine_.homes()) return "Home";
      return machine_.jogs() ? std::string_view("Jog") : std::string_view("Run");
    case State::holding:
      return rests ? "Hold:0" : "Hold:1";
    case State::door:
      if (parking_.comes_back()) return "Door:3";
      if (parking_.stage() != Parking::Stage::off && parking_.stage() != Parking::Stage::parked)
        return "Door:2";
      if (!rests) return "Door:2";
      return door_open() ? "Door:1" : "Door:0";
    case State::alarm:
    case State::estop:
      break;
  }
  return "Alarm";
}

ReportedStatus MachineConsole::reported_status() const {
  stepper::MotionState motion;
  ReportedStatus status;
  {
    const Masked masked(mask_);
    motion = runner_.generator().state();
    status.state = state_name();
    status.line = program_.line();
  }
  stepper::snap_to_motors(runner_.generator().kinematics(), motion);
  status.busy = machine_.activity() != Activity::none;
  status.axes = values_.whole(Id::axes);
  report_motion(status, motion, values_);
  report_program(status, reader_.interpreter());
  status.free_lines = beat_locked() ? runner_.queue().free() : program_.free();
  constexpr std::size_t beyond = LineQueue::capacity - LineQueue::window;
  const std::size_t room = receive_room();
  status.free_bytes = static_cast<std::uint32_t>(room > beyond ? room - beyond : 0);
  status.overrides = overrides_;
  status.pins = active_pins(inputs_);
  return status;
}

/// Waits for room: a host that reads no answers gets its status later.
void MachineConsole::send_status_line() {
  if (link_.room() < status_room) return;
  TextLine line;
  reporter_.begin(line, reported_status(),
                  static_cast<std::uint32_t>(values_.whole(Id::report_mask)), inch_axes(values_));
  add_beats(line);
  line.add(">\r\n");
  if (link_.send_text(line.view())) status_line_due_ = false;
}

void MachineConsole::add_beats(TextLine& line) const {
  line.add(clock_.locked() ? "|Lamp:1," : "|Lamp:0,").add(std::int64_t{clock_.edges()});
  wire::Status status;
  fill_status(status);
  const BeatsByReason &inside = status.beats_by_reason, &outside = status.beats_outside;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    line.add(i == 0 ? "|Beats:" : ",").add(std::int64_t{inside[i]} + outside[i]);
}

void MachineConsole::fill_status(wire::Status& status) const {
  const Masked masked(mask_);
  static_cast<wire::StatusSummary&>(status) = status_summary();
  status.received = runner_.queue().end();
  status.first_unfired = runner_.queue().begin();
  status.shots = shots_.ledger().shots();
  status.beats = shots_.ledger().beats();
  status.beats_before = shots_.ledger().beats_before();
  status.starvations = runner_.starvations();
  status.beats_by_reason = shots_.ledger().by_reason();
  status.beats_outside = shots_.ledger().outside();
  status.shots_made = shots_.checks().made;
  status.shots_not_made = shots_.checks().not_made;
  status.repeats = shots_.checks().repeats;
  if (rows_.known()) rows_.fill_status(status);
}

void MachineConsole::add_rows(wire::StatusSummary& summary) const {
  const program::RowRoom room = rows_.room();
  summary.free_points = room.lines;
  summary.free_runs = room.runs;
  summary.rows = true;
}

}  // namespace lamplock::machine
