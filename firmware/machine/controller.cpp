#include "firmware/machine/controller.hpp"

#include "firmware/lamp/shot_delay.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;

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

Controller::Controller(const settings::Values& stored, const InterruptMask& mask,
                       const BoardFeatures& board)
    : mask_(mask),
      board_(board),
      stored_(stored),
      values_(stored),
      runner_(clock_, shots_, motion_, planning_, board.parts),
      drives_(board.second_wire) {
  clock_.configure(stored);
  const bool ganged = use_kinematics();
  use_settings(stored);
  configure_reader();
  shots_.permit(false, BeatReason::no_point_due);
  send_banner();
  if (!ganged) say("No second motor: $966 needs a board with outputs for A");
  if (stored.whole(Id::homing) == 0) return;
  // The position is unknown until the machine is homed.
  handle(Event::power_up_unhomed, alarm_homing_wanted);
  say(unlock_text);
}

/// Active from the start on. False if a second motor is required but has no output.
bool Controller::use_kinematics() {
  settings::Values values = stored_;
  const Kinematics wanted(values);
  if (const bool lacks_motor = board_.axes < max_axes; lacks_motor)
    values.set_milli(Id::ganged_axis, 0);
  motion_.generator().set_kinematics(Kinematics(values));
  return motion_.generator().kinematics() == wanted;
}

void Controller::use_settings(const settings::Values& values) {
  // The clock restarts, and must lock again, only if its settings changed.
  const bool other_beat = !same_beat(values, values_);
  values_ = values;
  put_in_force(motion_.generator().kinematics(), values_);
  work_space_ = work_space(values);
  if (other_beat) clock_.configure(values);
  shots_.beam().configure(values);
  set_trigger();
}

// Called with beat and fill interrupts masked, as all of commit() is.
void Controller::end_overrides() {
  const bool over = machine_.activity() == Activity::none && !machine_.ends();
  if (!overridden_ || !over || !runner_.at_rest() || shots_.undecided()) return;
  if (!runner_.plan_at_home()) return;  // planning reads the settings
  overridden_ = false;
  use_settings(stored_);
}

FireTiming Controller::fire_timing() const {
  // In 32 bits, because it is called in every round of the main loop.
  constexpr std::uint32_t most_milli = settings::range(Id::q_switch_width).max_milli;
  static_assert(settings::range(Id::q_switch_delay).max_milli <= most_milli &&
                most_milli <= (0xffffffff - 500) / clocks_per_us);
  const auto clocks = [this](Id id) {
    return (static_cast<std::uint32_t>(values_.milli(id)) * clocks_per_us + 500) / 1000;
  };
  return {lamp::shot_delay_clocks(values_.milli(Id::q_switch_delay)), clocks(Id::q_switch_width),
          clock_.mode() == settings::LampMode::free_beat};
}

void Controller::set_trigger() {
  const FireTiming timing = fire_timing();
  // The shot is decided earlier than it is fired: the arm window is shifted by the difference.
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

Result Controller::change_beat(std::uint32_t milli_hz) {
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
void Controller::follow_new_beat() {
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
  runner_.change_beat(values, static_cast<std::int32_t>(rules.least_beats));
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
  if (rows_.active()) rows_.look();
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

/// The next point cannot be reached.
void Controller::reject_unreachable() {
  if (wire_job()) {
    link_.refuse_point(Result::unreachable, runner_.failed_point());
    return handle(Event::stop);
  }
  // It may be reachable from where the machine stops.
  if (motion_.at_rest()) raise_alarm(alarm_soft_limit);
}

bool Controller::ready_to_move() const {
  if (!machine_.running() || !runner_.begun() || next_beat_milli_hz_ != 0) return false;
  if (!drives_.ready(now_)) return false;
  if (clock_.edges() < static_cast<std::uint32_t>(values_.whole(Id::lamp_warm_up))) return false;
  return moving_ ? clock_.locked() : clock_.settled();
}

BeatReason Controller::idle_reason() const {
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

void Controller::check_dead_man() {
  if (!machine_.running() || machine_.homes()) return;
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

void Controller::lose_host() {
  const Masked masked(mask_);
  if (machine_.running() && !machine_.homes()) hold_without_host();
}

/// Motion or light that the host could not stop.
void Controller::hold_without_host() {
  if (machine_.activity() == Activity::program) {
    if (values_.whole(Id::run_on) != 0 && reader_.ends_itself()) return;
    say(held_without_host);
  }
  handle(Event::hold, HoldReason::dead_man);
}

void Controller::check_lamp() {
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
void Controller::miss_lamp() {
  no_lamp_said_ = true;
  say(no_lamp);
  if (clock_.mode() == settings::LampMode::master) handle(Event::hold, HoldReason::lamp);
}

bool Controller::host_lives() const {
  // Even with the dead man off a host requests the status several times a second.
  constexpr std::int32_t without_dead_man_us = 2'000'000;
  const std::int32_t set_us = values_.milli(Id::dead_man);
  const auto limit_us = static_cast<std::uint64_t>(set_us != 0 ? set_us : without_dead_man_us);
  return now_ - last_frame_ <= limit_us * clocks_per_us;
}

void Controller::input_changed(Input input, bool active, const StepPosition& at) {
  const Kinematics& kinematics = motion_.generator().kinematics();
  if (input == Input::limit_z && second_switch_at_z(kinematics, stored_)) input = Input::limit_a;
  const InputSet bit = set_of(input);
  inputs_ = static_cast<InputSet>(active ? inputs_ | bit : inputs_ & ~unsigned{bit});
  if (!parking_.holds_machine() && guard_.see(input, active, kinematics.loads_of(at)))
    program_.abort_move(true);
  input_wait_.see(input, active);
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

void Controller::hold_after_failed_shots() {
  std::uint32_t point = 0;
  if (!shots_.take_failed(point) || !runner_.begun()) return;
  handle(Event::hold, HoldReason::not_made);
  TextLine text;
  text.add("Point ").add(std::int64_t{point}).add(" not made");
  say(text.view());
}

Result Controller::on_data(std::span<const std::uint8_t> records) {
  if (rows_.known()) return take_rows(records);
  if (!wire_job()) return Result::no_job;
  const Result r = decoder_.decode(records, runner_.queue(), work_space_);
  refused_value_ = decoder_.refused_index();
  return r;
}

Result Controller::on_end(std::uint32_t total) {
  if (rows_.known()) return end_rows(total);
  if (!wire_job()) return Result::no_job;
  return total == points_total_ && runner_.queue().end() == total ? Result::ok : Result::bad_value;
}

Result Controller::on_command(const wire::CommandRequest& request) {
  refused_value_ = request.value;
  if (machine_.locked()) return Result::locked;
  if (request.command == wire::Command::lamp_frequency) return change_beat(request.value);
  const Masked masked(mask_);
  switch (request.command) {
    case wire::Command::hold:
      handle(Event::hold, HoldReason::host);
      break;
    case wire::Command::resume:
      if (door_open()) return Result::door_open;
      handle(Event::resume);
      break;
    case wire::Command::stop:
      handle(Event::stop);
      break;
    case wire::Command::lamp_frequency:
      break;
    case wire::Command::job_speed:
      if (request.value == 0 || request.value > wire::max_job_speed) return Result::bad_value;
      if (rows_.runs()) return set_speed_of_rows(request.value);
      runner_.set_job_speed(request.value);
      break;
  }
  return Result::ok;
}

bool Controller::take_settings(settings::Values& values) {
  if (!store_due_) return false;
  store_due_ = false;
  values = stored_;
  return true;
}

}  // namespace lamplock::machine
