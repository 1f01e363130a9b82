// Programs: the order of lines, jogs, and the choice of the runner.
#include "firmware/machine/console/program_text.hpp"
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {
namespace {

using wire::HoldReason;

/// Maximum lines of a program in one round of the main loop, which has other work.
constexpr int max_lines_at_once = 4;
/// Room for a list, which is an answer to "$"; without it lines wait.
constexpr std::size_t list_room = 2048;
/// In the queue, for a line that was too long or damaged.
constexpr std::string_view lost_line = "\x01";

// Constants, because the compiler would count their characters at run time.
constexpr std::string_view stopped_at_error = "Stopped at an error: '$X' or reset to continue";
constexpr std::string_view bytes_lost = "Bytes were lost: reset to continue";

}  // namespace

[[gnu::hot]] std::size_t Controller::receive_room() const {
  const std::size_t open = link_.line_size();
  return reader_.free() > open ? reader_.free() - open : 0;
}

[[gnu::hot]] void Controller::on_line(std::string_view line) {
  if (!reader_.push(line)) return answer(GcodeError::line_too_long);
  if (line.starts_with("$J=")) last_jog_ = now_;
  if (before_jog_cancel_) lines_at_cancel_ = reader_.lines();
  work_lines();
}

void Controller::on_line_too_long() { on_line(lost_line); }

[[gnu::hot]] void Controller::work_lines() {
  if (machine_.homes()) return work_homing();
  for (int i = 0; i < max_lines_at_once && !machine_.homes(); ++i) {
    if (reader_.line_open() && !finish_line()) break;
    if (machine_.ends() && !machine_.framed()) break;
    if (program_.cancelling() || program_.batch_waits()) break;
    // After a cancelled jog, until the machine is at rest at the start of the next line.
    if (reader_.off_target() && !program_.idle() && !rows_.active()) break;
    if (run_start_up_line()) continue;
    if (start_up_next_ < start_up_lines && start_up_waits()) break;
    if (!reader_.lines_wait()) break;
    const std::size_t answer_size = reader_.front() == '$' ? list_room : answer_room;
    if (link_.room() < answer_size + status_room) break;
    std::array<char, wire::max_line> room;
    begin_line(reader_.take_line(room));
    if (lines_at_cancel_ != 0) --lines_at_cancel_;
  }
  if (!reader_.lines_wait()) lines_at_cancel_ = 0;
  const bool points = beat_locked() && runner_.queue().size() != 0;
  const bool busy = reader_.line_open() || !program_.drained() || points;
  if (!busy || machine_.activity() != Activity::none) return;
  const Masked masked(mask_);
  handle(Event::begin_program);
}

/// Continues the open line; false if it waits.
[[gnu::hot]] bool Controller::finish_line() {
  using Step = ProgramReader::Step;
  for (;;) {
    switch (reader_.step(values_, work_space_, now_, machine_.checks())) {
      case Step::nothing:
        return true;
      case Step::waits:
        return false;
      case Step::done:
        if (!own_line_) {
          if (new_start_up_ != start_up_lines) keep_new_start_up_line();
          answer(GcodeError::none);
        }
        own_line_ = false;
        return true;
      case Step::outside:
        if (!own_line_) answer(GcodeError::bad_target);
        own_line_ = false;
        if (!machine_.checks()) {
          const Masked masked(mask_);
          raise_alarm(alarm_soft_limit);
        }
        return true;
      case Step::pauses:
        pause();
        return false;
      case Step::changes:
        if (!change_over(reader_.wanted_lock())) return false;
        break;
      case Step::probes:
        if (!work_probe()) return false;
        break;
      case Step::inputs:
        if (!work_input_wait()) return false;
        break;
      case Step::ended:
        tell_end();
        break;
    }
  }
}

/// M2 and M30: switches off everything that the program has switched.
void Controller::tell_end() {
  say("Pgm End");
  end_overrides_of_program();
  const Masked masked(mask_);
  outputs_off();
}

/// The program waits for a resume.
void Controller::pause() {
  if (reader_.changes_tool()) say_tool();
  const Masked masked(mask_);
  handle(Event::pause, HoldReason::realtime);
}

/// Reports the tool to be inserted.
void Controller::say_tool() {
  TextLine text;
  text.add("Tool ").add(std::int64_t{reader_.interpreter().modal().tool});
  say(text.view());
}

/// After an alarm: the open line is not completed.
void Controller::drop_open_line() {
  if (reader_.drop_line() && !own_line_) answer(GcodeError::locked);
  own_line_ = false;
}

[[gnu::hot]] void Controller::begin_line(std::string_view line) {
  new_start_up_ = start_up_lines;
  if (line.empty()) return answer(GcodeError::none);
  if (line == lost_line) {
    answer(GcodeError::line_too_long);
    return stop_after(GcodeError::line_too_long);
  }
  const bool starts_up = line.starts_with("$N") && line.size() > 2;
  if (line.front() == '$' && !starts_up && !line.starts_with("$J="))
    return answer_system_command(line);
  const GcodeError error = starts_up             ? keep_start_up_line(line)
                           : line.front() == '$' ? begin_jog(line.substr(3))
                                                 : begin_program_line(line);
  if (error == GcodeError::none && reader_.line_open()) {
    finish_line();
    return;
  }
  answer(error);
  if (line.front() != '$') stop_after(error);
}

/// A line of a program was refused: with $981 no other is accepted; accepted lines run to their
/// end.
void Controller::stop_after(GcodeError error) {
  const bool of_line = error != GcodeError::none && error != GcodeError::locked &&
                       error != GcodeError::not_idle && error != GcodeError::door_open;
  if (!of_line || machine_.checks() || values_.whole(settings::Id::stop_at_error) == 0) return;
  refuse_lines(Refusal::until_unlocked, stopped_at_error);
}

/// Lost frames are repeated.
void Controller::lose_lines() {
  if (machine_.framed() && !machine_.ends()) return;
  refuse_lines(Refusal::until_reset, bytes_lost);
}

/// No further line of a program begins; accepted lines run to their end.
void Controller::refuse_lines(Refusal until, std::string_view reason) {
  if (refusal_ >= until) return;
  refusal_ = until;
  program_outputs_.drop_next();
  if (beat_locked()) runner_.close();
  say(reason);
}

/// A program may run, once the planner is ready: not in a job, in an alarm or asleep.
[[gnu::hot]] bool Controller::start_program() {
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
void Controller::find_position() {
  if (!reader_.off_target()) return;
  stepper::MotionState at = motion_.generator().state();
  stepper::snap_to_motors(motion_.generator().kinematics(), at);
  reader_.find_position(at, values_);
}

/// At rest, no shot undecided: interrupts then change none of the data used here.
bool Controller::begin_lines(const settings::Values& values) {
  planning_.recall();
  runner_.end();
  std::uint32_t tick_q16 = 0;
  {
    const Masked masked(mask_);
    runner_.read_outcomes();  // the rest of a job must not move the machine back
    tick_q16 = runner_.shortest_tick_q16();
  }
  return program_.begin(values, tick_q16) == Result::ok;
}

/// The same for points on the beat: like a job, except for their number. The host of an earlier job
/// has lost it.
void Controller::begin_points(program::BeatLock lock) {
  planning_.recall();
  const lamp::ShotRules rules = shot_rules(values_);
  RunOptions options;
  options.mode = lock == program::BeatLock::free ? wire::JoinMode::free : wire::JoinMode::path;
  options.of_program = true;
  options.points_total = JobRunner::open_end;
  options.least_beats = static_cast<std::int32_t>(rules.least_beats);
  options.feed_percent = overrides_.feed;
  options.rapid_percent = overrides_.rapid;
  {
    const Masked masked(mask_);
    runner_.read_outcomes();
    shots_.begin_job(rules);
    options.shortest_tick_q16 = runner_.shortest_tick_q16();
  }
  runner_.begin(options, values_, 0);
  link_.forget_session();
  rows_.forget();
  dry_ = false;
}

/// Changes to points on the beat, with their mode, or to lines. False while that must wait:
/// planners share their memory, so the machine must be at rest, and every shot judged.
bool Controller::change_over(program::BeatLock lock) {
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
void Controller::configure_reader() {
  std::uint16_t setting = 0;
  const bool sound = check_settings(stored_, setting) == Result::ok;
  const int permitted = stored_.whole(settings::Id::channels) & board_.channels;
  reader_.configure(stored_, static_cast<std::uint8_t>(sound ? permitted : 0),
                    {board_.outputs, program_inputs(board_.inputs)});
}

[[gnu::hot]] GcodeError Controller::begin_program_line(std::string_view line) {
  if (machine_.locked() || machine_.sleeps() || machine_.jogs() || refusal_ != Refusal::none)
    return GcodeError::locked;
  if (!start_program()) return GcodeError::not_idle;
  return reader_.begin(line).error;
}

GcodeError Controller::begin_jog(std::string_view line) {
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

/// No line is left, or none continues.
void Controller::end_program() {
  program_.end();
  rows_.end();
  if (!beat_locked()) return;
  reader_.set_lock(program::BeatLock::off);
  runner_.end();
  moving_ = false;
}

}  // namespace lamplock::machine
