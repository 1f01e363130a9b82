// The parts of the machine and the settings in force.
#include "firmware/machine/parts.hpp"
#include "firmware/lamp/shot_delay.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

/// High time of the lamp trigger: well above the 2 us that a lamp may require.
constexpr std::uint32_t trigger_ticks = 20;

/// All settings of the beat clock are equal.
bool same_beat(const settings::Values& a, const settings::Values& b) {
  for (auto id = static_cast<int>(Id::lamp_mode); id <= static_cast<int>(Id::period_tolerance);
       ++id)
    if (a.milli(static_cast<Id>(id)) != b.milli(static_cast<Id>(id))) return false;
  return true;
}

}  // namespace

/// Active from the start on. False if a second motor is required but has no output.
bool MachineParts::use_kinematics() {
  settings::Values values = stored_;
  const Kinematics wanted(values);
  if (const bool lacks_motor = board_.limits.axes < max_axes; lacks_motor)
    values.set_milli(Id::ganged_axis, 0);
  motion_.generator().set_kinematics(Kinematics(values));
  return motion_.generator().kinematics() == wanted;
}

void MachineParts::use_settings(const settings::Values& values) {
  // The clock restarts, and must lock again, only if its settings changed.
  const bool other_beat = !same_beat(values, values_);
  values_ = values;
  put_in_force(motion_.generator().kinematics(), values_);
  work_space_ = work_space(values);
  if (other_beat) clock_.configure(values);
  shots_.beam().configure(values);
  loop_.restart();
  motion_.generator().set_power_scale(stepper::full_scale_q15);
  set_trigger();
}

// Called with beat and fill interrupts masked, as all of commit() is.
void MachineParts::end_overrides() {
  const bool over = machine_.activity() == Activity::none && !machine_.ends();
  if (!overridden_ || !over || !runner_.at_rest() || shots_.undecided()) return;
  if (!runner_.plan_at_home()) return;  // planning reads the settings
  overridden_ = false;
  use_settings(stored_);
}

FireTiming MachineParts::fire_timing() const {
  // In 32 bits, because it is called in every round of the main loop.
  constexpr std::uint32_t max_milli = settings::range(Id::q_switch_width).max_milli;
  static_assert(settings::range(Id::q_switch_delay).max_milli <= max_milli &&
                max_milli <= (0xffffffff - 500) / clocks_per_us);
  const auto clocks = [this](Id id) {
    return (static_cast<std::uint32_t>(values_.milli(id)) * clocks_per_us + 500) / 1000;
  };
  return {lamp::shot_delay_clocks(values_.milli(Id::q_switch_delay)), clocks(Id::q_switch_width),
          clock_.mode() == settings::LampMode::free_beat};
}

void MachineParts::set_trigger() {
  const FireTiming timing = fire_timing();
  // The shot is decided earlier than it is fired: the arm window is shifted by the difference.
  static_assert(fire_decision_clocks <= lamp::max_decision_ticks * clocks_per_tick);
  const std::uint32_t lead = timing.delay_clocks - fire_decision_clocks;
  runner_.generator().set_arm_lead((lead + clocks_per_tick / 2) / clocks_per_tick);
  stepper::TriggerPattern trigger;
  // Settings that were stored before the limit existed may violate it.
  if (clock_.mode() != settings::LampMode::slave && lamp::lamp_bears(values_)) {
    trigger.period_ticks = clock_.beat_ticks();
    const std::uint32_t trigger_lead =
        (timing.delay_clocks + clocks_per_tick / 2) / clocks_per_tick;
    trigger.width_ticks = trigger_ticks;
    const std::uint64_t head = runner_.generator().tick() + trigger_lead;
    trigger.first_tick = clock_.tick_of_beat(clock_.beat_at_or_after(head)) - trigger_lead;
    // The interval after the last flash of the old beat is at least that of the new beat.
    const std::uint64_t last = runner_.generator().last_trigger();
    while (last != 0 && trigger.first_tick < last + trigger.period_ticks)
      trigger.first_tick += trigger.period_ticks;
  }
  runner_.generator().set_trigger(trigger);
}

BeatReason MachineParts::idle_reason() const {
  if (machine_.locked()) return BeatReason::alarm;
  if (machine_.state() == State::door) return BeatReason::door;
  if (machine_.state() == State::holding) return BeatReason::hold;
  if (!clock_.locked() || next_beat_milli_hz_ != 0) return BeatReason::not_locked;
  if (clock_.edges() < static_cast<std::uint32_t>(values_.whole(Id::lamp_warm_up)))
    return BeatReason::warm_up;
  if (dry_) return BeatReason::dry;
  if (runner_.waiting_for_beam()) return BeatReason::protection;
  return runner_.starving() ? BeatReason::starved : BeatReason::no_point_due;
}

bool MachineParts::host_lives() const {
  // Even with the dead man off a host requests the status several times a second.
  constexpr std::int32_t without_dead_man_us = 2'000'000;
  const std::int32_t set_us = values_.milli(Id::dead_man);
  const auto limit_us = static_cast<std::uint64_t>(set_us != 0 ? set_us : without_dead_man_us);
  return now_ - last_frame_ <= limit_us * clocks_per_us;
}

}  // namespace lamplock::machine
