// Jobs in frames: their settings against those of the machine, begin, data, commands.
#include "firmware/machine/work.hpp"
#include "shared/job_limits.hpp"
#include "shared/pulse_times.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;
using wire::HoldReason;

/// Number of the setting that shared motors do not permit, in the present or the requested
/// kinematics; 0 = none.
std::uint16_t broken_motors(const settings::Values& values, const motion::Limits& limits,
                            const Kinematics& in_force) {
  if (const std::uint16_t setting = broken_kinematics(values); setting != 0) return setting;
  if (!in_force.core_xy() && !Kinematics(values).core_xy()) return 0;
  const std::int64_t together_q62 = limits.axis[0].speed_q62 + limits.axis[1].speed_q62;
  const std::int64_t max_q62 =
      one_q62 / 100 * max_shared_step_percent / pulse_times(values).period_ticks;
  const bool too_fast = together_q62 > max_q62;
  return too_fast ? settings::number(Id::max_rate_y) : 0;
}

}  // namespace

Result MachineWork::job_settings(const wire::JobHeader& header, settings::Values& values) {
  values = stored_;
  for (const wire::Override& item : header.used_overrides()) {
    refused_value_ = item.number;
    const Id id = settings::find_number(item.number);
    if (id == Id::count || !settings::of_jobs(id)) return Result::bad_value;
    if (oversteps(id, item.value_milli, stored_.milli(id))) return Result::bad_value;
    if (!values.set_milli(id, item.value_milli)) return Result::bad_value;
  }
  for (int axis = 0; axis < max_axes; ++axis) {
    refused_value_ = settings::number(settings::for_axis(Id::min_corner_x, axis));
    if (!inside_work_space(values, stored_, axis)) return Result::bad_value;
  }
  refused_value_ = misused_lamp(header, values, stored_);
  if (refused_value_ == 0 && fires_without_edges(header, values))
    refused_value_ = settings::number(Id::lamp_mode);
  if (refused_value_ != 0) return Result::bad_value;
  if (header.settings_hash != 0 && header.settings_hash != values.hash())
    return Result::settings_mismatch;
  if (header.axes != values.whole(Id::axes) || header.axes > board_.limits.axes) {
    refused_value_ = settings::number(Id::axes);
    return Result::bad_value;
  }
  std::uint16_t setting = 0;
  const Result r = check_settings(values, setting);
  refused_value_ = setting;
  return r;
}

/// Without a lamp shots follow the trigger output, which this board may not have.
bool MachineWork::fires_without_edges(const wire::JobHeader& header,
                                      const settings::Values& values) const {
  const auto mode = static_cast<settings::LampMode>(values.whole(Id::lamp_mode));
  return !board_.limits.triggers_lamp && !header.dry && header.mode != wire::mode_rows &&
         mode != settings::LampMode::slave;
}

Result MachineWork::check_settings(const settings::Values& values, std::uint16_t& setting) const {
  if (values.milli(Id::lamp_frequency) > board_.limits.max_lamp_milli_hz) {
    setting = settings::number(Id::lamp_frequency);
    return Result::bad_value;
  }
  motion::Limits limits;
  const Result r = motion::make_limits(values, beat_ticks(values), full_tick_q16, limits, setting);
  if (r != Result::ok) return r;
  setting = broken_motors(values, limits, motion_.generator().kinematics());
  if (setting == 0) setting = lamp::broken_protection(values);
  return setting == 0 ? Result::ok : Result::bad_value;
}

lamp::ShotRules MachineWork::shot_rules(const settings::Values& values) const {
  const auto count = [&values](Id id) { return static_cast<std::uint32_t>(values.whole(id)); };
  const auto clocks = [&values](Id id) {
    return static_cast<std::uint32_t>(std::int64_t{values.milli(id)} * clocks_per_us / 1000);
  };
  const std::int64_t rate = values.milli(Id::max_shot_rate);
  lamp::ShotRules rules;
  rules.min_beats =
      static_cast<std::uint32_t>((values.milli(Id::lamp_frequency) + rate - 1) / rate);
  rules.check = lamp::shot_check(values);
  rules.answer_clocks = clocks(Id::q_switch_delay) + clocks(Id::sensor_time);
  rules.repeats = count(Id::shot_repeats);
  return rules;
}

Result MachineWork::on_begin(const wire::JobHeader& header) {
  refused_value_ = 0;
  if (const Result r = may_begin_job(); r != Result::ok) return r;
  if (const Result r = begin_job(header); r != Result::ok) return r;
  const Masked masked(mask_);
  handle(header.mode == wire::mode_rows ? Event::begin_rows : Event::begin_points);
  return Result::ok;
}

Result MachineWork::may_begin_job() const {
  if (machine_.locked()) return Result::locked;
  if (loader_requested_) return Result::busy;
  if (door_open()) return Result::door_open;
  if (machine_.held_at_rest()) return Result::held;
  if (!machine_.accepts(Event::begin_points) || !runner_.at_rest()) return Result::busy;
  if (program_unfinished() || reader_.lines_wait() || start_up_waits()) return Result::busy;
  // A shot of the last job may still be fired.
  return shots_.undecided() ? Result::busy : Result::ok;
}

/// Its stack is free again before the event is handled.
[[gnu::noinline]] Result MachineWork::begin_job(const wire::JobHeader& header) {
  settings::Values values;
  if (const Result r = job_settings(header, values); r != Result::ok) return r;
  const bool of_rows = header.mode == wire::mode_rows;
  if (of_rows && stored_.whole(Id::laser_mode) == 0) {
    refused_value_ = settings::number(Id::laser_mode);
    return Result::bad_value;
  }
  const lamp::ShotRules rules = shot_rules(values);
  RunOptions options;
  end_program();
  reader_.invalidate_position();
  planning_.recall();
  {
    const Masked masked(mask_);
    overridden_ = !(values == stored_);
    if (!(values == values_)) use_settings(values);
    shots_.begin_job(rules);
    options.min_tick_q16 = runner_.lasting_min_tick_q16();
  }
  dry_ = header.dry;
  points_total_ = header.points_total;
  if (of_rows) {
    const Result r = begin_rows(header, values, options.min_tick_q16);
    if (r != Result::ok) return r;
  } else {
    options.mode = static_cast<wire::JoinMode>(header.mode);
    options.dry = header.dry;
    options.points_total = header.points_total;
    options.min_beats = static_cast<std::int32_t>(rules.min_beats);
    rows_.forget();
    runner_.begin(options, values, header.first_index);
    decoder_.begin(header,
                   static_cast<std::uint8_t>(values.whole(Id::channels)) & board_.limits.channels);
  }
  return Result::ok;
}

Result MachineWork::on_data(std::span<const std::uint8_t> records) {
  if (rows_.known()) return take_rows(records);
  if (!wire_job()) return Result::no_job;
  const Result r = decoder_.decode(records, runner_.queue(), work_space_);
  refused_value_ = decoder_.refused_index();
  return r;
}

Result MachineWork::on_end(std::uint32_t total) {
  if (rows_.known()) return end_rows(total);
  if (!wire_job()) return Result::no_job;
  return total == points_total_ && runner_.queue().end() == total ? Result::ok : Result::bad_value;
}

Result MachineWork::on_command(const wire::CommandRequest& request) {
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

}  // namespace lamplock::machine
