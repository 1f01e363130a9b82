// Probing (G38.2 to G38.5): a guarded move of a program, and its report.
#include "firmware/machine/controller.hpp"
#include "firmware/machine/runners/program_motion.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

}  // namespace

/// At rest before or after the move; true if the program continues.
bool Controller::work_probe() {
  if (reader_.probing()) return end_probe();
  begin_probe();
  return !reader_.line_open();
}

void Controller::begin_probe() {
  const bool wanted = !reader_.probes_away();
  const Masked masked(mask_);
  if (((inputs_ & set_of(Input::probe)) != 0) == wanted) return raise_alarm(alarm_probe_state);
  guard_.watch(set_of(Input::probe), wanted);
  reader_.begin_probe();
  use_overrides();
}

bool Controller::end_probe() {
  guard_.drop();
  const stepper::MotionState rest = motion_.generator().state();
  probe_.met = guard_.met() != 0;
  for (int a = 0; a < values_.whole(Id::axes); ++a) {
    probe_.machine_e7[index(a)] = probe_.met ? place_of(guard_.at()[index(a)], values_, a)
                                             : place_of(rest.axis[index(a)], values_, a);
  }
  const bool failed = !probe_.met && reader_.probe_must_meet();
  reader_.end_probe(rest, values_);
  {
    const Masked masked(mask_);
    use_overrides();
  }
  tell_offsets(probe_line, probe_line + 1);
  if (!failed) return true;
  const Masked masked(mask_);
  raise_alarm(alarm_probe_nothing);
  return true;
}

}  // namespace lamplock::machine
