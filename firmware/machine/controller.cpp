#include "firmware/machine/controller.hpp"

#include "firmware/machine/settings_text.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;
using wire::MachineState;

// Alarm numbers of grbl 1.1; 10 as grblHAL has it.
constexpr std::uint8_t alarm_hard_limit = 1;
constexpr std::uint8_t alarm_estop = 10;
// Error numbers of grbl 1.1.
constexpr int error_not_idle = 8;
constexpr int error_locked = 9;
constexpr int error_line_too_long = 11;
constexpr int error_unsupported = 20;
constexpr int error_estop = 50;  // of grblHAL
// Real-time bytes of grbl 1.1.
constexpr std::uint8_t byte_reset = 0x18;
constexpr std::uint8_t byte_door = 0x84;

/// The lamp trigger is high for this long: well above the 2 us a lamp may ask for.
constexpr std::uint32_t trigger_ticks = 20;

/// Bytes that a sender may have under way, as told by `$I` and status reports.
constexpr std::uint32_t receive_window = 1024;

constexpr std::string_view ok_line = "ok\r\n";
constexpr std::string_view version_line = "[VER:1.1h.20261121:lamplock]\r\n";

/// The firmware's settings are the truth for what the machine is, for its limits and protections:
/// true if a job asks for another machine or for more than the machine's own setting allows. With
/// other steps/mm every limit would mean another length.
bool oversteps(Id id, std::int32_t asked, std::int32_t own) {
  switch (id) {
    case Id::step_pulse:
    case Id::steps_per_mm_x:
    case Id::steps_per_mm_y:
    case Id::steps_per_mm_z:
    case Id::steps_per_mm_a:
    case Id::axes:
    case Id::pin_map:
      return asked != own;
    case Id::soft_limits:
    case Id::hard_limits:
    case Id::lamp_warm_up:
      return asked < own;
    case Id::dead_man:
    case Id::jerk_x:
    case Id::jerk_y:
    case Id::jerk_z:
    case Id::jerk_a:
      return own != 0 && (asked == 0 || asked > own);
    case Id::max_shot_rate:
    case Id::lamp_power:
    case Id::speed_jump_x:
    case Id::speed_jump_y:
    case Id::speed_jump_z:
    case Id::speed_jump_a:
    case Id::period_tolerance:
      return asked > own;
    case Id::lamp_energy:
    case Id::shutter_open:
    case Id::shutter_close:
    case Id::attenuator_settle:
      return asked < own;
    case Id::channels:
      return ((asked / 1000) & ~(own / 1000)) != 0;
    default:
      return id >= Id::max_rate_x && id <= Id::travel_a && asked > own;
  }
}

/// Nothing differs that the beat clock is made of.
bool same_beat(const settings::Values& a, const settings::Values& b) {
  for (auto id = static_cast<int>(Id::lamp_mode); id <= static_cast<int>(Id::period_tolerance);
       ++id)
    if (a.milli(static_cast<Id>(id)) != b.milli(static_cast<Id>(id))) return false;
  return true;
}

/// The work space of a job lies inside the machine's own.
bool inside_work_space(const settings::Values& job, const settings::Values& own, int axis) {
  const auto low = [axis](const settings::Values& v) { return v.milli(Id::min_corner_x, axis); };
  const auto high = [&](const settings::Values& v) { return low(v) + v.milli(Id::travel_x, axis); };
  return low(job) >= low(own) && high(job) <= high(own);
}

}  // namespace

Controller::Controller(const settings::Values& stored, const InterruptMask& mask, int board_axes,
                       std::uint8_t board_channels, Parts parts)
    : mask_(mask),
      board_axes_(board_axes),
      board_channels_(board_channels),
      stored_(stored),
      values_(stored),
      runner_(clock_, shots_, parts) {
  clock_.configure(stored);
  use_settings(stored);
  shots_.permit(false, BeatReason::no_point_due);
  send_banner();
}

void Controller::use_settings(const settings::Values& values) {
  // The clock starts anew, and has to lock again, only if it has to.
  const bool other_beat = !same_beat(values, values_);
  values_ = values;
  work_space_ = work_space(values);
  if (other_beat) clock_.configure(values);
  shots_.beam().configure(values);
  set_trigger();
}

// Called with beat and fill interrupts masked, as all of commit() is.
void Controller::end_overrides() {
  const bool over = state_ == MachineState::idle || state_ == MachineState::alarm ||
                    state_ == MachineState::estop;
  if (!overridden_ || !over || !runner_.at_rest() || shots_.undecided()) return;
  if (!runner_.plan_at_home()) return;  // it reads the settings
  overridden_ = false;
  use_settings(stored_);
}

FireTiming Controller::fire_timing() const {
  const auto clocks = [this](Id id) {
    return static_cast<std::uint32_t>((std::int64_t{values_.milli(id)} * clocks_per_us + 500) /
                                      1000);
  };
  return {clocks(Id::q_switch_delay), clocks(Id::q_switch_width),
          clock_.mode() == settings::LampMode::free_beat};
}

void Controller::set_trigger() {
  const FireTiming timing = fire_timing();
  // The shot is decided earlier than it is fired: the arm window moves by the difference.
  const std::uint32_t lead = timing.delay_clocks - fire_decision_clocks;
  runner_.generator().set_arm_lead((lead + clocks_per_tick / 2) / clocks_per_tick);
  stepper::TriggerPattern trigger;
  if (clock_.mode() != settings::LampMode::slave) {
    trigger.period_ticks = clock_.beat_ticks();
    const std::uint32_t trigger_lead =
        (timing.delay_clocks + clocks_per_tick / 2) / clocks_per_tick;
    trigger.width_ticks = trigger_ticks;
    const std::uint64_t head = runner_.generator().tick() + trigger_lead;
    trigger.first_tick = clock_.tick_of_beat(clock_.beat_at_or_after(head)) - trigger_lead;
    // No flash sooner after the last one of the old beat than the new beat allows.
    const std::uint64_t last = runner_.generator().last_trigger();
    while (last != 0 && trigger.first_tick < last + trigger.period_ticks)
      trigger.first_tick += trigger.period_ticks;
  }
  runner_.generator().set_trigger(trigger);
}

Result Controller::change_beat(std::uint32_t milli_hz) {
  if (state_ == MachineState::alarm || state_ == MachineState::estop) return Result::locked;
  if (!job_) return Result::no_job;
  settings::Values values = values_;
  refused_value_ = settings::row(Id::lamp_frequency).number;
  const std::int32_t most = settings::row(Id::lamp_frequency).max_milli;
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
  if (moving_) runner_.brake();
  moving_ = false;
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

void Controller::receive(std::span<const std::uint8_t> bytes) {
  byte_seen_ = byte_seen_ || !bytes.empty();
  link_.receive(bytes, *this);
}

bool Controller::prepare(std::uint64_t clock) {
  now_ = clock;
  if (byte_seen_) {
    byte_seen_ = false;
    last_byte_ = clock;
  }
  check_dead_man();
  follow_new_beat();
  if (runner_.underrun()) raise_alarm(alarm_position_lost);
  hold_after_failed_shots();
  const bool go = ready_to_move();
  if (moving_ && !go) runner_.brake();
  moving_ = go;
  shots_.permit(go && !dry_, idle_reason());
  shots_.beam().update(!runner_.at_rest() || shots_.point_pending(), clock);
  if (!job_) runner_.read_outcomes();
  return job_ && runner_.prepare(go);
}

bool Controller::commit() {
  // A hold or an alarm since prepare() has made the plan worthless.
  const bool wanted = moving_ && !runner_.underrun();
  const Committed committed = wanted ? runner_.commit() : Committed::nothing;
  if (committed == Committed::no_way) {
    link_.refuse_point(Result::unreachable, runner_.failed_point());
    stop();
  }
  // A stop is over when the machine stands and the last shot that was decided has been counted.
  const bool stopping = !job_ && (state_ == MachineState::run || state_ == MachineState::hold ||
                                  state_ == MachineState::door);
  if (stopping && runner_.at_rest() && !shots_.undecided()) {
    // The edge may have come since prepare(): who sees idle shall see every shot.
    runner_.read_outcomes();
    state_ = MachineState::idle;
  }
  if (state_ == MachineState::run && job_ && runner_.complete() && runner_.at_rest())
    state_ = MachineState::idle;
  end_overrides();
  return committed == Committed::part;
}

bool Controller::ready_to_move() const {
  if (state_ != MachineState::run || !job_ || next_beat_milli_hz_ != 0) return false;
  if (clock_.edges() < static_cast<std::uint32_t>(values_.whole(Id::lamp_warm_up))) return false;
  return moving_ ? clock_.locked() : clock_.settled();
}

BeatReason Controller::idle_reason() const {
  switch (state_) {
    case MachineState::alarm:
    case MachineState::estop:
      return BeatReason::alarm;
    case MachineState::door:
      return BeatReason::door;
    case MachineState::hold:
      return BeatReason::hold;
    default:
      break;
  }
  if (!clock_.locked() || next_beat_milli_hz_ != 0) return BeatReason::not_locked;
  if (clock_.edges() < static_cast<std::uint32_t>(values_.whole(Id::lamp_warm_up)))
    return BeatReason::warm_up;
  if (dry_) return BeatReason::dry;
  if (runner_.waiting_for_beam()) return BeatReason::protection;
  return runner_.starving() ? BeatReason::starved : BeatReason::no_point_due;
}

void Controller::check_dead_man() {
  const std::int32_t milli_ms = values_.milli(Id::dead_man);
  if (milli_ms == 0 || state_ != MachineState::run) return;
  const std::uint64_t limit = static_cast<std::uint64_t>(milli_ms) * clocks_per_us;
  if (now_ - last_byte_ > limit) hold(HoldReason::dead_man);
}

void Controller::input_changed(Input input, bool active) {
  switch (input) {
    case Input::estop:
      estop_ = active;
      if (active)
        raise_alarm(alarm_estop);
      else if (state_ == MachineState::estop)
        state_ = MachineState::alarm;
      break;
    case Input::door:
      door_open_ = active;
      if (active && (state_ == MachineState::run || state_ == MachineState::hold)) {
        state_ = MachineState::door;
        hold_reason_ = HoldReason::none;
        if (moving_) runner_.brake();
        moving_ = false;
        shots_.permit(false, BeatReason::door);
      } else if (!active && state_ == MachineState::door) {
        state_ = MachineState::hold;  // a closed door waits for somebody to say go on
        hold_reason_ = HoldReason::host;
      }
      break;
    default:
      if (active && values_.whole(Id::hard_limits) != 0) raise_alarm(alarm_hard_limit);
      break;
  }
}

void Controller::stopped_at(const StepPosition& steps) {
  shots_.end_check();
  runner_.read_outcomes();  // of a shot that the board has found when it stopped
  runner_.halt();
  runner_.generator().set_position(steps);
}

void Controller::raise_alarm(std::uint8_t number) {
  shots_.permit(false, BeatReason::alarm);
  shots_.beam().cut();
  shots_.end_check();
  if (job_) runner_.read_outcomes();  // whoever asks now, where to go on, shall know every shot
  runner_.halt();
  moving_ = false;
  next_beat_milli_hz_ = 0;
  // While the e-stop is pressed no other alarm may make the machine look as if `$X` could free it.
  state_ = estop_ ? MachineState::estop : MachineState::alarm;
  alarm_ = estop_ ? alarm_estop : number;
  hold_reason_ = HoldReason::none;
  TextLine line;
  line.add("ALARM:").add(std::int64_t{alarm_}).add("\r\n");
  link_.send_text(line.view());
}

void Controller::unlock() {
  if (state_ != MachineState::alarm) return;
  // The position is not what it was: the job cannot simply go on.
  stop();
  link_.forget_session();
  state_ = MachineState::idle;
  alarm_ = 0;
}

void Controller::hold(HoldReason reason) {
  // The host's own hold outranks one that a stray byte or its silence has caused.
  if (state_ == MachineState::hold && reason == HoldReason::host) hold_reason_ = reason;
  if (state_ != MachineState::run) return;
  shots_.permit(false, BeatReason::hold);
  runner_.read_outcomes();  // who asks now, where to go on, shall not be told too low a number
  if (moving_) runner_.brake();
  moving_ = false;
  state_ = MachineState::hold;
  hold_reason_ = reason;
}

void Controller::hold_after_failed_shots() {
  std::uint32_t point = 0;
  if (!shots_.take_failed(point) || !job_) return;
  hold(HoldReason::not_made);
  TextLine text;
  text.add("Point ").add(std::int64_t{point}).add(" not made");
  say(text.view());
}

void Controller::resume() {
  if (state_ != MachineState::hold || door_open_) return;
  state_ = MachineState::run;
  hold_reason_ = HoldReason::none;
  last_byte_ = now_;
}

void Controller::stop() {
  shots_.permit(false, BeatReason::no_point_due);
  // Shots fired since the last poll count: the next job goes on behind them.
  if (job_) runner_.read_outcomes();
  if (moving_) runner_.brake();
  moving_ = false;
  job_ = false;
  next_beat_milli_hz_ = 0;
  hold_reason_ = HoldReason::none;
}

Result Controller::job_settings(const wire::JobHeader& header, settings::Values& values) {
  values = stored_;
  for (const wire::Override& item : header.used_overrides()) {
    refused_value_ = item.number;
    const Id id = settings::find_number(item.number);
    if (id == Id::count) return Result::bad_value;
    if (oversteps(id, item.value_milli, stored_.milli(id))) return Result::bad_value;
    if (!values.set_milli(id, item.value_milli)) return Result::bad_value;
  }
  for (int axis = 0; axis < max_axes; ++axis) {
    refused_value_ = settings::row(settings::for_axis(Id::min_corner_x, axis)).number;
    if (!inside_work_space(values, stored_, axis)) return Result::bad_value;
  }
  refused_value_ = 0;
  if (header.settings_hash != 0 && header.settings_hash != values.hash())
    return Result::settings_mismatch;
  if (header.axes != values.whole(Id::axes) || header.axes > board_axes_) {
    refused_value_ = settings::row(Id::axes).number;
    return Result::bad_value;
  }
  std::uint16_t setting = 0;
  const Result r = check_settings(values, setting);
  refused_value_ = setting;
  return r;
}

Result Controller::check_settings(const settings::Values& values, std::uint16_t& setting) const {
  motion::Limits limits;
  const Result r = motion::make_limits(values, beat_ticks(values), full_tick_q16, limits, setting);
  if (r != Result::ok) return r;
  setting = lamp::broken_protection(values);
  return setting == 0 ? Result::ok : Result::bad_value;
}

lamp::ShotRules Controller::shot_rules(const settings::Values& values) const {
  const auto count = [&values](Id id) { return static_cast<std::uint32_t>(values.whole(id)); };
  const auto clocks = [&values](Id id) {
    return static_cast<std::uint32_t>(std::int64_t{values.milli(id)} * clocks_per_us / 1000);
  };
  const std::int64_t rate = values.milli(Id::max_shot_rate);
  lamp::ShotRules rules;
  rules.least_beats =
      static_cast<std::uint32_t>((values.milli(Id::lamp_frequency) + rate - 1) / rate);
  rules.check = lamp::shot_check(values);
  rules.answer_clocks = clocks(Id::q_switch_delay) + clocks(Id::sensor_time);
  rules.repeats = count(Id::shot_repeats);
  return rules;
}

Result Controller::on_begin(const wire::JobHeader& header) {
  refused_value_ = 0;
  if (state_ == MachineState::alarm || state_ == MachineState::estop) return Result::locked;
  if (loader_requested_) return Result::busy;
  if (door_open_) return Result::door_open;
  if (!runner_.at_rest() || state_ == MachineState::run) return Result::busy;
  if (shots_.undecided()) return Result::busy;  // a shot of the last job may still come
  settings::Values values;
  if (const Result r = job_settings(header, values); r != Result::ok) return r;
  const lamp::ShotRules rules = shot_rules(values);
  RunOptions options;
  runner_.recall_plan();
  {
    const Masked masked(mask_);
    overridden_ = !(values == stored_);
    if (!(values == values_)) use_settings(values);
    shots_.begin_job(rules);
    options.shortest_tick_q16 = runner_.shortest_tick_q16();
  }
  options.mode = static_cast<motion::JoinMode>(header.mode);
  options.dry = dry_ = header.dry;
  options.points_total = points_total_ = header.points_total;
  options.least_beats = static_cast<std::int32_t>(rules.least_beats);
  runner_.begin(options, values, header.first_index);
  decoder_.begin(header, static_cast<std::uint8_t>(values.whole(Id::channels)) & board_channels_);
  job_ = true;
  state_ = MachineState::run;
  hold_reason_ = HoldReason::none;
  last_byte_ = now_;
  return Result::ok;
}

Result Controller::on_data(std::span<const std::uint8_t> records) {
  if (!job_) return Result::no_job;
  const Result r = decoder_.decode(records, runner_.queue(), work_space_);
  refused_value_ = decoder_.refused_index();
  return r;
}

Result Controller::on_end(std::uint32_t total) {
  if (!job_) return Result::no_job;
  return total == points_total_ && runner_.queue().end() == total ? Result::ok : Result::bad_value;
}

Result Controller::on_command(const wire::CommandRequest& request) {
  refused_value_ = request.value;
  if (state_ == MachineState::alarm || state_ == MachineState::estop) return Result::locked;
  if (request.command == wire::Command::lamp_frequency) return change_beat(request.value);
  const Masked masked(mask_);
  switch (request.command) {
    case wire::Command::hold:
      hold(HoldReason::host);
      break;
    case wire::Command::resume:
      if (door_open_) return Result::door_open;
      resume();
      break;
    case wire::Command::stop:
      stop();
      break;
    case wire::Command::lamp_frequency:
      break;
    case wire::Command::job_speed:
      if (request.value == 0 || request.value > highest_job_speed) return Result::bad_value;
      runner_.set_job_speed(request.value);
      break;
  }
  return Result::ok;
}

void Controller::on_realtime(std::uint8_t byte) {
  if (byte == '?') return send_status_line();
  const Masked masked(mask_);
  switch (byte) {
    case '!':
      hold(HoldReason::realtime);
      break;
    case '~':
      // One flipped bit must not end a hold that the host has asked for by a frame.
      if (hold_reason_ != HoldReason::host) resume();
      break;
    case byte_door:
      hold(HoldReason::realtime);
      break;
    case byte_reset:
      // In a job it may be one flipped bit: nothing is lost but time. Else it is a reset, which
      // throws away what was being typed.
      if (state_ == MachineState::run) {
        hold(HoldReason::reset);
      } else if (state_ != MachineState::hold && state_ != MachineState::door) {
        link_.drop_line();
        reporter_.reset();
        send_banner();
      }
      break;
    default:
      break;
  }
}

void Controller::on_line(std::string_view line) {
  if (line.empty())
    link_.send_text(ok_line);
  else if (line.front() == '$')
    answer_system_command(line);
  else
    send_error(state_ == MachineState::alarm ? error_locked : error_unsupported);
}

void Controller::answer_system_command(std::string_view line) {
  int error = 0;
  if (line == "$I") {
    TextLine options;
    options.add("[OPT:V,")
        .add(std::int64_t{motion::PointQueue::capacity})
        .add(",")
        .add(std::int64_t{receive_window});
    options.add("]\r\n");
    link_.send_text(version_line);
    link_.send_text(options.view());
  } else if (line == "$X") {
    const Masked masked(mask_);
    if (state_ == MachineState::estop)
      error = error_estop;
    else
      unlock();
  } else if (line == "$$") {
    list_settings();
  } else if (line == "$RST=$" || line == "$RST=*" || line == "$BOOT") {
    if (!may_be_changed())
      error = error_not_idle;
    else if (line == "$BOOT")
      loader_requested_ = true;
    else
      restore_defaults();
  } else {
    error = change_setting(line);
  }
  if (error == 0)
    link_.send_text(ok_line);
  else
    send_error(error);
}

bool Controller::may_be_changed() const {
  return (state_ == MachineState::idle || state_ == MachineState::alarm) && runner_.at_rest() &&
         !shots_.undecided();
}

int Controller::change_setting(std::string_view line) {
  const SettingLine asked = read_setting(line);
  if (asked.error != 0) return asked.error;
  if (!may_be_changed()) return error_not_idle;
  settings::Values values = stored_;
  values.set_milli(asked.id, asked.milli);
  std::uint16_t setting = 0;
  if (check_settings(values, setting) != Result::ok) return error_setting_range;
  if (values == stored_) return 0;
  runner_.recall_plan();
  stored_ = values;
  store_due_ = true;
  const Masked masked(mask_);
  use_settings(values);
  return 0;
}

void Controller::restore_defaults() {
  runner_.recall_plan();
  stored_ = settings::Values{};
  store_due_ = true;
  const Masked masked(mask_);
  use_settings(stored_);
}

bool Controller::take_settings(settings::Values& values) {
  if (!store_due_) return false;
  store_due_ = false;
  values = stored_;
  return true;
}

void Controller::list_settings() {
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    TextLine line;
    write_setting(line, static_cast<Id>(i), stored_);
    link_.send_text(line.view());
  }
}

void Controller::say(std::string_view text) {
  TextLine line;
  line.add("[MSG:").add(text).add("]\r\n");
  link_.send_text(line.view());
}

void Controller::send_error(int number) {
  TextLine answer;
  answer.add("error:").add(std::int64_t{number}).add("\r\n");
  link_.send_text(answer.view());
}

void Controller::on_line_too_long() { send_error(error_line_too_long); }

void Controller::send_banner() { link_.send_text("\r\nGrbl 1.1h ['$' for help]\r\n"); }

std::string_view Controller::state_name() const {
  const bool rests = runner_.at_rest();
  switch (state_) {
    case MachineState::idle:
      return "Idle";
    case MachineState::run:
      return "Run";
    case MachineState::hold:
      return rests ? "Hold:0" : "Hold:1";
    case MachineState::door:
      return rests ? "Door:1" : "Door:2";
    default:
      return "Alarm";
  }
}

ReportedStatus Controller::reported_status() const {
  stepper::MotionState motion;
  ReportedStatus status;
  {
    const Masked masked(mask_);
    motion = runner_.generator().state();
    status.state = state_name();
  }
  status.busy = job_unfinished();
  status.axes = values_.whole(Id::axes);
  std::uint64_t squares = 0;
  for (int a = 0; a < status.axes; ++a) {
    const stepper::AxisState& axis = motion.axis[index(a)];
    const auto steps_per_mm_milli =
        static_cast<std::uint32_t>(values_.milli(Id::steps_per_mm_x, a));
    status.machine_e7[index(a)] =
        axis.step() * (program::one_e7 * 1000) / std::int64_t{steps_per_mm_milli};
    const std::int64_t steps_per_min =
        (Int128::product(axis.speed_q62, 60 * std::int64_t{ticks_per_second}) >> 62).to_int64();
    const std::int64_t um_min = mul_div(abs64(steps_per_min), 1'000'000, steps_per_mm_milli);
    squares += wide_product(static_cast<std::uint32_t>(um_min), static_cast<std::uint32_t>(um_min));
  }
  status.feed_um_min = isqrt(squares);
  status.free_lines = runner_.queue().free();
  status.free_bytes = receive_window;
  constexpr std::uint16_t door_pin = 1u << pin_letters.find('D');
  if (door_open_) status.pins |= door_pin;
  return status;
}

void Controller::send_status_line() {
  TextLine line;
  reporter_.begin(line, reported_status(),
                  static_cast<std::uint32_t>(values_.whole(Id::report_mask)),
                  values_.whole(Id::report_inches) != 0);
  add_beats(line);
  line.add(">\r\n");
  link_.send_text(line.view());
}

void Controller::add_beats(TextLine& line) const {
  line.add(clock_.locked() ? "|Lamp:1," : "|Lamp:0,").add(std::int64_t{clock_.edges()});
  wire::Status status;
  fill_status(status);
  const BeatsByReason &inside = status.beats_by_reason, &outside = status.beats_outside;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    line.add(i == 0 ? "|Beats:" : ",").add(std::int64_t{inside[i]} + outside[i]);
}

void Controller::fill_status(wire::Status& status) const {
  const Masked masked(mask_);
  static_cast<wire::Standing&>(status) = standing();
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
}

}  // namespace lamplock::machine
