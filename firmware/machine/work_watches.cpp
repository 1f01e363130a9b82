// What is watched while the machine works: the host, the lamp, shots, the beat.
#include "firmware/machine/work.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;

}  // namespace

bool MachineWork::ready_to_move() const {
  if (!machine_.running() || !runner_.begun() || next_beat_milli_hz_ != 0) return false;
  if (!drives_.ready(now_)) return false;
  if (clock_.edges() < static_cast<std::uint32_t>(values_.whole(Id::lamp_warm_up))) return false;
  return moving_ ? clock_.locked() : clock_.settled();
}

Result MachineWork::change_beat(std::uint32_t milli_hz) {
  if (machine_.locked()) return Result::locked;
  if (rows_.runs()) return Result::unsupported;  // no beat to follow
  if (!wire_job()) return Result::no_job;
  settings::Values values = values_;
  refused_value_ = settings::number(Id::lamp_frequency);
  const std::int32_t most = settings::range(Id::lamp_frequency).max_milli;
  if (milli_hz > static_cast<std::uint32_t>(most)) return Result::bad_value;
  const auto milli = static_cast<std::int32_t>(milli_hz);
  if (!values.set_milli(Id::lamp_frequency, milli)) return Result::bad_value;
  std::uint16_t setting = 0;
  const Result r = check_settings(values, setting);
  refused_value_ = setting;
  if (r != Result::ok) return r;
  const Masked masked(mask_);
  next_beat_milli_hz_ = milli;
  shots_.permit(false, idle_reason());
  runner_.read_outcomes();
  brake_points();
  return Result::ok;
}

// Called with beat and fill interrupts masked, as all of prepare() is.
void MachineWork::follow_new_beat() {
  if (next_beat_milli_hz_ == 0 || !runner_.at_rest() || shots_.undecided()) return;
  if (!runner_.plan_at_home()) return;
  runner_.read_outcomes();
  settings::Values values = values_;
  values.set_milli(Id::lamp_frequency, next_beat_milli_hz_);
  next_beat_milli_hz_ = 0;
  overridden_ = true;
  use_settings(values);
  const lamp::ShotRules rules = shot_rules(values);
  shots_.change_rules(rules);
  runner_.change_beat(values, static_cast<std::int32_t>(rules.min_beats));
}

void MachineWork::hold_after_failed_shots() {
  std::uint32_t point = 0;
  if (!shots_.take_failed(point) || !runner_.begun()) return;
  handle(Event::hold, HoldReason::not_made);
  TextLine text;
  text.add("Point ").add(std::int64_t{point}).add(" not made");
  report_message(text.view());
}

/// The next point cannot be reached.
void MachineWork::reject_unreachable() {
  if (wire_job()) {
    link_.refuse_point(Result::unreachable, runner_.failed_point());
    return handle(Event::stop);
  }
  // It may be reachable from where the machine stops.
  if (motion_.at_rest()) raise_alarm(alarm_soft_limit);
}

void MachineWork::check_dead_man() {
  if (!machine_.running() || machine_.homes() || waits_for_tool()) return;
  const bool framed = machine_.framed(), jogs = machine_.jogs();
  const std::int32_t limit_us = values_.milli(framed ? Id::dead_man
                                              : jogs ? Id::jog_lease
                                                     : Id::program_dead_man);
  if (limit_us == 0) return;
  const std::uint64_t renewed = last_jog_ > last_frame_ ? last_jog_ : last_frame_;
  const std::uint64_t since = framed ? last_frame_ : jogs ? renewed : last_byte_;
  if (now_ - since > static_cast<std::uint64_t>(limit_us) * clocks_per_us) hold_without_host();
}

// Constants, because the compiler would count their characters at run time.
constexpr std::string_view held_without_host = "Host lost: program held";
constexpr std::string_view no_lamp = "No lamp: LAMP SYNC is missing or not at $901";
/// Beats without a lock until the host is informed, as many as the lock tolerates without an edge.
constexpr std::uint32_t beats_without_lamp = 32;

void MachineWork::lose_host() {
  const Masked masked(mask_);
  if (machine_.running() && !machine_.homes() && !waits_for_tool()) hold_without_host();
}

/// Motion or light that the host could not stop.
void MachineWork::hold_without_host() {
  if (machine_.does(activities(Activity::program, Activity::tool_change))) {
    if (values_.whole(Id::run_on) != 0 && reader_.ends_itself()) return;
    report_message(held_without_host);
  }
  handle(Event::hold, HoldReason::dead_man);
}

void MachineWork::check_lamp() {
  const bool locked = clock_.locked();
  const bool lost = lamp_was_locked_ && !locked;
  lamp_was_locked_ = locked;
  if (locked || !runner_.begun() || !machine_.running()) {
    no_lamp_since_ = now_;
    no_lamp_said_ = false;
    return;
  }
  const std::uint64_t limit =
      std::uint64_t{beats_without_lamp} * clock_.beat_ticks() * clocks_per_tick;
  if (!no_lamp_said_ && (lost || now_ - no_lamp_since_ >= limit)) miss_lamp();
}

/// Without the lamp a job waits, dark. As slave it continues when the lamp is back. As master, if
/// the lamp does not respond to the triggers, it is held until the user resumes it.
void MachineWork::miss_lamp() {
  no_lamp_said_ = true;
  report_message(no_lamp);
  if (clock_.mode() == settings::LampMode::master) handle(Event::hold, HoldReason::lamp);
}

}  // namespace lamplock::machine
