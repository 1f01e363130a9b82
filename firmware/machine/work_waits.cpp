// What a program waits for: probes, inputs, a resume, the return from parking.
#include "firmware/machine/runners/program_motion.hpp"
#include "firmware/machine/work.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;

}  // namespace

/// At rest before or after the move; true if the program continues.
bool MachineWork::work_probe() {
  if (reader_.probing()) return end_probe();
  begin_probe();
  return !reader_.line_open();
}

void MachineWork::begin_probe() {
  const bool wanted = !reader_.probes_away();
  const Masked masked(mask_);
  if (((inputs_ & set_of(Input::probe)) != 0) == wanted) return raise_alarm(alarm_probe_state);
  guard_.watch(set_of(Input::probe), wanted);
  reader_.begin_probe();
  use_overrides();
}

bool MachineWork::end_probe() {
  guard_.drop();
  const stepper::MotionState rest = motion_.generator().state();
  probe_.met = guard_.met() != 0;
  for (int a = 0; a < values_.whole(Id::axes); ++a) {
    probe_.machine_e7[index(a)] = probe_.met ? place_of(guard_.at()[index(a)], values_, a)
                                             : place_of(rest.axis[index(a)], values_, a);
  }
  const bool failed = !probe_.met && reader_.probe_must_meet();
  reader_.end_probe(rest, values_, probe_.met, probe_.machine_e7);
  {
    const Masked masked(mask_);
    use_overrides();
  }
  report_offsets(probe_line, probe_line + 1);
  if (!failed) return true;
  const Masked masked(mask_);
  raise_alarm(alarm_probe_nothing);
  return true;
}

void MachineWork::report_offsets(int first, int end) {
  const ReportedOffsets offsets{reader_.kept().parameters, reader_.interpreter().modal(), probe_,
                                values_.whole(Id::axes), inch_axes(values_)};
  for (int i = first; i < end; ++i) {
    TextLine line;
    write_offset(line, i, offsets);
    if (!line.view().empty()) link_.send_text(line.view());
  }
}

/// M66, at rest. True if the program continues.
bool MachineWork::work_input_wait() {
  const program::IoRequest& wanted = reader_.wait();
  const auto active = [this](Input input) { return (inputs_ & set_of(input)) != 0; };
  if (!input_wait_.begun()) {
    const Masked masked(mask_);
    input_wait_.begin(wanted.event, wanted.port, active(InputWait::inputs[wanted.port]),
                      now_ + std::uint64_t{reader_.wait_us()} * clocks_per_us);
  }
  const InputWait::State state = input_wait_.poll(now_);
  if (state == InputWait::State::waits) return false;
  const bool late = state == InputWait::State::late;
  TextLine text;
  text.add("Input ").add(std::int64_t{wanted.port});
  const bool on = active(input_wait_.input());
  text.add(late ? " not met: " : " ").add(on ? "on" : "off");
  report_message(text.view());
  input_wait_.end();
  const bool pauses = late && !reader_.awaits_tool();
  reader_.end_wait(on, pauses);
  if (pauses) pause();
  return !pauses;
}

/// The program waits for a resume.
void MachineWork::pause() {
  const bool changes_tool = reader_.changes_tool();
  if (changes_tool) {
    report_tool();
    reader_.await_tool();
  }
  const Masked masked(mask_);
  handle(changes_tool ? Event::await_tool : Event::pause, HoldReason::realtime);
}

/// The program continues; a cancelled jog may have left the machine anywhere.
void MachineWork::return_from_tool_change() {
  find_position();
  reader_.go_back();
}

/// Reports the tool to be inserted.
void MachineWork::report_tool() {
  TextLine text;
  text.add("Tool ").add(std::int64_t{reader_.interpreter().modal().tool});
  report_message(text.view());
}

/// Continues when the machine is at rest.
void MachineWork::work_parking() {
  if (!program_.detour_finished() || program_.batch_waits()) return;
  stepper::Segment move;
  const bool moves = parking_.next(motion_.generator().state(), program_.brake_limits(), move);
  const Masked masked(mask_);
  if (moves) return program_.run_detour(move);
  if (parking_.stage() != Parking::Stage::off) return;
  // Moves of the parked tool do not count for a probe; its contact may have changed meanwhile.
  if (guard_.check_change(Input::probe, (inputs_ & set_of(Input::probe)) != 0, steps_at_rest()))
    program_.abort_move(true);
  handle(Event::resume);
}

}  // namespace lamplock::machine
