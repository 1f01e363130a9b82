// Programs and jogs: begin, and the choice of the runner.
#include "firmware/machine/work.hpp"

namespace lamplock::machine {
namespace {

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view bytes_lost =
    "Bytes were lost, no further line runs: reset, then send the program again";

}  // namespace

/// Lost frames are repeated.
void MachineWork::lose_lines() {
  if (machine_.framed() && !machine_.ends()) return;
  refuse_lines(Refusal::until_reset, bytes_lost);
}

/// A program may run, once the planner is ready: not in a job, in an alarm or asleep.
[[gnu::hot]] bool MachineWork::start_program() {
  if (rows_.active()) return false;
  if (program_.begun()) {
    if (program_.idle()) find_position();
    return true;
  }
  if (beat_locked()) return true;
  // Also in a hold that has begun at rest: the program waits in it.
  const bool held = machine_.held_at_rest();
  if (machine_.activity() != Activity::none || machine_.locked() || machine_.ends()) return false;
  if (!motion_.at_rest() || loader_requested_) return false;
  if (shots_.undecided() || overridden_) return false;
  if (!begin_lines(values_)) return false;
  if (held) program_.hold();
  find_position();
  return true;
}

/// Sets the position from the motors: interrupted motion ends beside their steps.
void MachineWork::find_position() {
  if (!reader_.off_target()) return;
  stepper::MotionState at = motion_.generator().state();
  stepper::snap_to_motors(motion_.generator().kinematics(), at);
  reader_.find_position(at, values_);
}

/// At rest, no shot undecided: interrupts then change none of the data used here.
bool MachineWork::begin_lines(const settings::Values& values) {
  planning_.recall();
  runner_.end();
  std::uint32_t tick_q16 = 0;
  {
    const Masked masked(mask_);
    runner_.read_outcomes();  // the rest of a job must not move the machine back
    tick_q16 = runner_.lasting_min_tick_q16();
  }
  return program_.begin(values, tick_q16) == Result::ok;
}

/// The same for points on the beat: like a job, except for their number. The host of an earlier job
/// has lost it.
void MachineWork::begin_points(program::BeatLock lock) {
  planning_.recall();
  const lamp::ShotRules rules = shot_rules(values_);
  RunOptions options;
  options.mode = lock == program::BeatLock::free ? wire::JoinMode::free : wire::JoinMode::path;
  options.of_program = true;
  options.points_total = JobRunner::open_end;
  options.min_beats = static_cast<std::int32_t>(rules.min_beats);
  options.feed_percent = overrides_.feed;
  options.rapid_percent = overrides_.rapid;
  {
    const Masked masked(mask_);
    runner_.read_outcomes();
    shots_.begin_job(rules);
    options.min_tick_q16 = runner_.lasting_min_tick_q16();
  }
  runner_.begin(options, values_, 0);
  link_.forget_session();
  rows_.forget();
  dry_ = false;
}

/// Changes to points on the beat, with their mode, or to lines. False while that must wait:
/// planners share their memory, so the machine must be at rest, and every shot judged.
bool MachineWork::change_over(program::BeatLock lock) {
  if (!machine_.idle() && !machine_.running()) return false;
  if (!motion_.at_rest() || shots_.undecided()) return false;
  {
    const Masked masked(mask_);
    end_program();
  }
  if (lock == program::BeatLock::off) return begin_lines(values_);
  begin_points(lock);
  reader_.set_lock(lock);
  return true;
}

/// Beat lock is available if the laser of the stored settings may fire at all.
void MachineWork::configure_reader() {
  std::uint16_t setting = 0;
  const bool sound = check_settings(stored_, setting) == Result::ok;
  const int permitted = stored_.whole(settings::Id::channels) & board_.limits.channels;
  reader_.configure(stored_, static_cast<std::uint8_t>(sound ? permitted : 0),
                    {board_.outputs, program_inputs(board_.inputs)});
}

[[gnu::hot]] GcodeError MachineWork::begin_program_line(std::string_view line) {
  if (machine_.locked() || machine_.sleeps() || machine_.jogs() || refusal_ != Refusal::none)
    return GcodeError::locked;
  if (!start_program()) return GcodeError::not_idle;
  if (program_.shines_at_rest()) {
    const Masked masked(mask_);
    program_.end_light();
  }
  return reader_.begin(line).error;
}

GcodeError MachineWork::begin_jog(std::string_view line) {
  // Sent before the jogs were cancelled, or before the host was lost.
  if (lines_at_cancel_ != 0 || !host_present_) return GcodeError::none;
  if (machine_.locked() || machine_.sleeps()) return GcodeError::locked;
  if (door_open()) return GcodeError::door_open;
  // The state idle may be old: a line of a program may have been accepted since.
  const bool free = machine_.jogs() || program_.drained();
  if (!free || !machine_.accepts(Event::begin_jog) || !start_program()) return GcodeError::not_idle;
  const program::Fault fault = reader_.begin_jog(line, values_, work_space_);
  if (fault) return fault.error;
  const Masked masked(mask_);
  handle(Event::begin_jog);
  use_overrides();
  return GcodeError::none;
}

}  // namespace lamplock::machine
