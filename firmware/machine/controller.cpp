#include "firmware/machine/controller.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;

}  // namespace

Controller::Controller(const settings::Values& stored, const InterruptMask& mask,
                       const BoardFeatures& board)
    : MachineConsole(stored, mask, board) {
  clock_.configure(stored);
  const bool ganged = use_kinematics();
  use_settings(stored);
  configure_reader();
  shots_.permit(false, BeatReason::no_point_due);
  send_banner();
  if (!ganged)
    report_message("No second motor: $966 is ignored, it needs a board with outputs for A");
  if (stored.whole(Id::homing) == 0) return;
  // The position is unknown until the machine is homed.
  handle(Event::power_up_unhomed, alarm_homing_wanted);
  report_message(unlock_text);
}

void Controller::receive(std::span<const std::uint8_t> bytes, bool before_jog_cancel) {
  before_jog_cancel_ = before_jog_cancel;
  if (!bytes.empty()) last_byte_ = now_;
  link_.receive(bytes, *this);
}

bool Controller::prepare(std::uint64_t clock) {
  now_ = clock;
  if (link_.take_frame_seen()) last_frame_ = clock;
  drives_.update(values_, clock, drives_may_rest(), !drives_may_be_on());
  check_dead_man();
  check_lamp();
  if constexpr (TemperatureLoop::exists)
    if (loop_.mode(values_) != settings::LoopMode::off) follow_temperature();
  follow_new_beat();
  if (runner_.underrun()) raise_alarm(alarm_position_lost);
  hold_after_failed_shots();
  const bool go = ready_to_move();
  if (moving_ && !go) runner_.brake();
  moving_ = go;
  shots_.permit(go && !dry_, idle_reason());
  shots_.beam().update(!runner_.at_rest() || shots_.point_pending(), clock);
  if (!runner_.begun()) runner_.read_outcomes();
  if (!program_.begun()) return runner_.begun() && runner_.prepare(go);
  const bool plans = program_.prepare();
  if (rows_.active()) rows_.poll();
  return plans;
}

bool Controller::commit() {
  // A hold or an alarm since prepare() has invalidated the plan.
  const bool wanted = moving_ && !runner_.underrun();
  const Committed committed = wanted ? runner_.commit() : Committed::nothing;
  if (committed == Committed::no_way) reject_unreachable();
  settle();
  end_overrides();
  if (board_.parts == HandoutMode::straight) program_.stage();
  // A job may have waited for prepare() before it began to move.
  const bool lines = drives_.ready(now_) && program_.commit();
  return committed == Committed::part || lines;
}

void Controller::input_changed(Input input, bool active, const StepPosition& at) {
  const Kinematics& kinematics = motion_.generator().kinematics();
  if (input == Input::limit_z && second_switch_at_z(kinematics, stored_)) input = Input::limit_a;
  const InputSet bit = set_of(input);
  inputs_ = static_cast<InputSet>(active ? inputs_ | bit : inputs_ & ~unsigned{bit});
  if (!parking_.holds_machine() && guard_.check_change(input, active, kinematics.loads_of(at)))
    program_.abort_move(true);
  input_wait_.note_change(input, active);
  switch (input) {
    case Input::estop:
      handle(active ? Event::estop_pressed : Event::estop_released, alarm_estop);
      break;
    case Input::door:
      handle(active ? Event::door_opened : Event::door_shut, HoldReason::host);
      break;
    case Input::probe:
    case Input::aux:
      break;
    default:
      if (active && values_.whole(Id::hard_limits) != 0) handle(Event::limit, alarm_hard_limit);
      break;
  }
}

void Controller::stopped_at(const StepPosition& motors) {
  shots_.end_check();
  runner_.read_outcomes();  // a shot that the board has found when it stopped
  runner_.halt();
  program_.halt();
  reader_.invalidate_position();
  runner_.generator().set_motors(motors);
  clear_racking();
}

bool Controller::take_settings(settings::Values& values) {
  if (!store_due_) return false;
  store_due_ = false;
  values = stored_;
  return true;
}

}  // namespace lamplock::machine
