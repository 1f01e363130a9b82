// Homing: its commands, its moves, its end.
#include "firmware/machine/work.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

constexpr AxisSet every_axis = (1u << max_axes) - 1;

/// The settings of a machine whose axis A is the racking of a gantry.
settings::Values with_racking(const settings::Values& own, int ganged_axis) {
  settings::Values values = own;
  values.set_milli(Id::axes, max_axes * 1000);
  for (const Id id : {Id::steps_per_mm_x, Id::max_rate_x, Id::acceleration_x, Id::travel_x,
                      Id::min_corner_x, Id::speed_jump_x, Id::jerk_x})
    values.set_milli(settings::for_axis(id, Kinematics::gang_motor), own.milli(id, ganged_axis));
  return values;
}

}  // namespace

/// "$H", "$HX". Answered when homing has ended.
GcodeError MachineWork::begin_homing(std::string_view axes) {
  AxisSet wanted = every_axis;
  if (!axes.empty()) {
    std::size_t axis = 0;
    while (axis != axis_letters.size() && axis_letters[axis] != axes.front()) ++axis;
    if (axis == axis_letters.size()) return GcodeError::unknown_command;
    wanted = static_cast<AxisSet>(1u << axis);
  }
  if (stored_.whole(Id::homing) == 0) return GcodeError::homing_disabled;
  if (machine_.state() == State::estop) return GcodeError::emergency_stop;
  if (door_open()) return GcodeError::door_open;
  if (!may_be_changed() || machine_.checks() || loader_requested_) return GcodeError::not_idle;
  const Kinematics& kinematics = motion_.generator().kinematics();
  const int ganged = kinematics.ganged_axis();
  InputSet inputs = board_.inputs;
  if ((inputs & set_of(Input::limit_z)) != 0 && second_switch_at_z(kinematics, stored_))
    inputs = static_cast<InputSet>(inputs | set_of(Input::limit_a));
  if (!homing_.begin(stored_, inputs, wanted, ganged)) return GcodeError::homing_disabled;
  if (ganged >= 0 && (wanted >> ganged & 1u) != 0 && homing_.squared_axis() < 0)
    report_message("Not squared: A has no limit switch");
  reader_.end_lock();
  const Masked masked(mask_);
  handle(Event::begin_homing);
  end_refusal();
  use_overrides();
  return GcodeError::none;
}

/// Continues when the machine is at rest.
void MachineWork::work_homing() {
  if (!machine_.running() || !program_.idle() || !motion_.at_rest()) return;
  if (homing_.waits(now_)) return;
  switch (homing_.next({steps_at_rest(), inputs_, guard_})) {
    case Homing::Next::move:
      return go_homing();
    case Homing::Next::wait:
      return homing_.wait_from(now_);
    case Homing::Next::set_position: {
      end_program();
      const Masked masked(mask_);
      motion_.generator().set_position(homing_.position());
      return;
    }
    case Homing::Next::done:
      return end_homing();
    case Homing::Next::still_engaged:
      return fail_homing(alarm_homing_engaged);
    case Homing::Next::switch_not_found:
      return fail_homing(alarm_homing_not_found);
    case Homing::Next::gantry_not_squared:
      return fail_homing(alarm_homing_not_squared);
  }
}

void MachineWork::go_homing() {
  const int squared = homing_.squared_axis();
  if (!begin_lines(squared < 0 ? values_ : with_racking(values_, squared)))
    return fail_homing(alarm_homing_not_found);
  motion::LineTarget line;
  line.steps = homing_.move().target;
  line.feed_um_min = homing_.move().feed_um_min;
  const Masked masked(mask_);
  guard_.watch(homing_.move().watch, true);
  program_.take(line);
}

/// At rest.
void MachineWork::fail_homing(std::uint8_t alarm) {
  const Masked masked(mask_);
  raise_alarm(alarm);
}

void MachineWork::end_homing() {
  const Masked masked(mask_);
  guard_.drop();
  homing_.end();
  end_program();
  reader_.invalidate_position();
  handle(Event::homed);
  use_overrides();
  if (homing_.of_machine()) start_up_next_ = 0;
  answer(GcodeError::none);
}

}  // namespace lamplock::machine
