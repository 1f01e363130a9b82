// The program reader: executes the lines of the host strictly in order.
//
// In:  lines as they arrive (push), the time.
// Out: lines for the planner (ProgramRunner), or points (JobRunner) while beat lock is on; the
//      result of each step. The controller calls it, answers the host, and interprets "$" commands.
// Who: the controller, main loop, unmasked; some 7000 cycles a line and 2500 a piece of a curve.
//
// A line is done, and is answered with "ok", when its last action has been accepted. A move is
// accepted when the planner has it, which may be seconds before it runs; a dwell, a pause and the
// end of a program wait until the machine is at rest, as in grbl. Later lines wait in the queue,
// whose room the host knows.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/machine/console/line_queue.hpp"
#include "firmware/machine/console/persistent_state.hpp"
#include "firmware/machine/outputs/program_outputs.hpp"
#include "firmware/machine/runners/job_runner.hpp"
#include "firmware/machine/runners/program_runner.hpp"
#include "firmware/program/interpreter.hpp"
#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// Outputs and inputs that a board has for programs, a bit for each.
struct ProgramPorts {
  std::uint8_t outputs = 0, inputs = 0;
};

/// Options of the interpreter from these settings; `beat_lock`: beat lock is permitted.
program::Options program_options(const settings::Values& values, bool beat_lock,
                                 ProgramPorts ports);

class ProgramReader {
 public:
  /// Result of a step.
  enum class Step : std::uint8_t {
    nothing,    ///< no line is under way
    waits,      ///< for room, rest, time, or a resume
    done,       ///< the line: to be answered
    outside,    ///< the line would have left the work space: the rest of it is dropped
    pauses,     ///< M0, M1, M6: waits for resume() or end_tool_change() from now on
    returns,    ///< a tool change is over: find_position() and go_back() are due
    changes,    ///< at rest: a change to wanted_lock() is due before the next move
    lights,     ///< at rest: the laser shines with light_power() for light_ticks()
    overrides,  ///< M48, M49: overrides_off() has changed
    inputs,     ///< at rest: M66 waits for its input, until end_wait()
    probes,     ///< at rest, before and after the move of a probe, until end_probe()
    ended       ///< M2, M30; then done
  };

  [[gnu::cold]] ProgramReader(ProgramRunner& runner, JobRunner& points, ProgramOutputs& outputs)
      : runner_(runner), points_(points), outputs_(outputs) {}
  ProgramReader(const ProgramReader&) = delete;
  ProgramReader& operator=(const ProgramReader&) = delete;

  /// Applies settings; at rest, no line open. `channels`: a bit for each channel that beat lock may
  /// fire; the first is used, without one there is no beat lock.
  void configure(const settings::Values& values, std::uint8_t channels, ProgramPorts ports);

  // How moves are run.
  /// How points on the beat are joined; off: lines.
  program::BeatLock lock() const { return lock_; }
  void set_lock(program::BeatLock lock) { lock_ = lock; }
  /// Beat lock of the next move.
  program::BeatLock wanted_lock() const { return action_.beat_lock; }
  /// Ends beat lock as after M131; no line may be open.
  void end_lock();

  // Lines that wait.
  /// False if it does not fit; a host that counts bytes does not overrun the queue.
  bool push(std::string_view line) { return queue_.push(line); }
  bool lines_wait() const { return !queue_.empty(); }
  std::uint32_t free() const { return queue_.free(); }
  char front() const { return queue_.front(); }
  std::uint32_t lines() const { return queue_.lines(); }
  /// The end of the program was received: its M2 or M30 is in progress or waits.
  bool ends_itself() const {
    const bool ends = pending_ && action_.kind == program::ActionKind::program_end;
    return ends || queue_.ends_program();
  }
  std::string_view take_line(std::span<char> room) { return queue_.pop(room); }

  // The open line.
  /// Begins a line of a program; after an error no line is open and nothing has changed.
  program::Fault begin(std::string_view line);
  /// Begins the text after "$J=". Error 15 also if it would leave the work space.
  program::Fault begin_jog(std::string_view line, const settings::Values& values,
                           const StepLimits& space);
  /// Continues the open line. With `check` nothing moves and nothing waits.
  Step step(const settings::Values& values, const StepLimits& space, std::uint64_t clock,
            bool check);
  bool line_open() const { return open_; }
  /// Overrides have no effect (M49).
  bool overrides_off() const { return overrides_off_; }
  bool has_ignored() const { return interpreter_.has_ignored(); }
  std::uint8_t take_ignored() { return interpreter_.take_ignored(); }
  /// As program::take_message().
  [[gnu::cold]] bool take_message(std::string_view& line, TextLine& text) {
    return interpreter_.take_message(line, text);
  }
  /// As Interpreter::clear_parameters(), while no line is open.
  [[gnu::cold]] void clear_parameters() { interpreter_.clear_parameters(); }
  void resume() { paused_ = false; }
  /// The pause is for a tool change.
  bool changes_tool() const { return action_.kind == program::ActionKind::tool_change; }

  // Tool changes: from M6, at rest, until end_tool_change(). After an acknowledgement lines are
  // taken as the user's, while those of the program and the line of M6 wait.
  [[gnu::cold]] void await_tool() { tool_ = ToolChange::awaited; }
  bool awaits_tool() const { return tool_ != ToolChange::none && tool_ != ToolChange::over; }
  [[gnu::cold]] void acknowledge_tool() {
    if (tool_ == ToolChange::awaited) tool_ = ToolChange::acknowledged;
  }
  bool tool_acknowledged() const { return tool_ == ToolChange::acknowledged; }
  /// False if the line of M6 has other commands after it.
  [[gnu::cold]] bool begin_users_lines();
  bool users_line_runs() const {
    return tool_ == ToolChange::users_lines && (open_ || !queue_.empty());
  }
  [[gnu::cold]] void end_tool_change();
  /// Restores the modal state and moves to where the machine was at M6.
  [[gnu::cold]] void go_back();
  /// Drops lines of the user that wait, and the line of M6: returns their number.
  [[gnu::cold]] std::uint32_t drop_tool_change();

  /// The input that M66 waits for, and the time limit.
  const program::IoRequest& wait() const { return action_.io; }
  std::uint32_t wait_us() const { return action_.time_us; }
  /// The wait is over, the input is on or off; `pauses`: it came too late, and the program
  /// continues after resume().
  void end_wait(bool on, bool pauses) {
    interpreter_.results().input = pauses ? std::int8_t{-1} : static_cast<std::int8_t>(on ? 1 : 0);
    taken();
    paused_ = pauses;
  }
  /// Of a dwell with light, or of light until the next line: the power of S and the permitted one,
  /// full_power = all, and ticks.
  [[gnu::cold]] std::uint16_t light_power(const settings::Values& values) const;
  [[gnu::cold]] std::uint16_t max_light_power(const settings::Values& values) const;
  [[gnu::cold]] std::uint32_t light_ticks(const settings::Values& values) const;
  /// Gives the move of the probe to the planner.
  void begin_probe() {
    outputs_.apply_next();
    probing_ = runner_.take(target_);
  }
  bool probing() const { return probing_; }
  /// The move ends when contact is lost; if it ends by itself, that is an error.
  bool probes_away() const { return action_.probe_away; }
  bool probe_must_meet() const { return action_.probe_must; }
  /// The move is over; the machine rests at `at`. The contact changed at `place_e7` if it was met.
  void end_probe(const stepper::MotionState& at, const settings::Values& values, bool met,
                 const program::Place& place_e7);

  /// Drops the open line; true if there was one.
  bool drop_line();
  /// Drops the open line and those that wait.
  void clear();
  /// After power-up and a reset: drops all lines and sets the modal state to its defaults.
  void reset();
  /// The machine is not where the program assumes.
  void invalidate_position() { off_target_ = true; }
  void toggle_flood() {
    interpreter_.toggle_flood();
    put_air();
  }
  void toggle_mist() {
    interpreter_.toggle_mist();
    put_air();
  }
  /// Sets spindle and coolant off in the modal state.
  void switch_off() { interpreter_.switch_off(); }
  bool off_target() const { return off_target_; }
  /// Sets the position if it was lost; no line may be open.
  void find_position(const stepper::MotionState& at, const settings::Values& values);

  const program::Interpreter& interpreter() const { return interpreter_; }
  /// Data that programs keep; parameters change only while no line is open.
  PersistentState& kept() { return kept_; }
  const PersistentState& kept() const { return kept_; }
  /// After power-up, before anything else: applies the data that programs kept.
  void restore(const PersistentState& kept) {
    kept_ = kept;
    interpreter_.reset();
  }

 private:
  enum class ToolChange : std::uint8_t {
    none,
    awaited,
    acknowledged,
    users_lines,  ///< run, one after the other
    over          ///< the machine returns
  };

  bool next_action();
  [[gnu::cold]] Step check_extent(const settings::Values& values, const StepLimits& space,
                                  bool check);
  Step act(const settings::Values& values, const StepLimits& space, std::uint64_t clock,
           bool check);
  Step move(const settings::Values& values, const StepLimits& space, bool check);
  Step pixels(const settings::Values& values, bool check);
  bool prepare_beam();
  bool planned() const { return runner_.begun() && !runner_.broken_off(); }
  bool take(const settings::Values& values);
  Step dwell(const settings::Values& values, std::uint64_t clock);
  [[gnu::cold]] Step spindle(const settings::Values& values);
  [[gnu::cold]] bool wants_light(const settings::Values& values) const;
  bool rests();
  Step wait_for_rest();
  [[gnu::cold]] Step coolant();
  [[gnu::cold]] Step output();
  bool take_changes();
  void put_air() {
    const program::Modal& modal = interpreter_.modal();
    outputs_.set_air(modal.flood || modal.mist);
  }
  Step taken();
  program::Place stand_at(const stepper::MotionState& at, const settings::Values& values);

  ProgramRunner& runner_;
  JobRunner& points_;
  ProgramOutputs& outputs_;
  program::BeatLock lock_ = program::BeatLock::off;
  std::uint8_t channel_ = 0;  ///< of shots in a program
  StepPosition from_{};       ///< where the next move begins
  LineQueue queue_;
  PersistentState kept_;
  program::Options options_;
  program::Interpreter interpreter_{kept_.parameters, options_};
  program::Action action_;
  motion::LineTarget target_;  ///< of a move
  bool open_ = false;          ///< a line is in progress
  bool jogs_ = false;          ///< the line is a jog
  bool unchecked_ = false;     ///< the extent of the line was not compared with the work space yet
  bool pending_ = false;       ///< action_ was not accepted yet
  bool prepared_ = false;      ///< target_ is that of action_
  bool overrides_off_ = false;
  bool listed_ = false;  ///< its pixels are complete
  bool paused_ = false;
  bool probing_ = false;  ///< the move of action_ is in progress
  bool off_target_ = true;
  bool dwells_ = false;
  ToolChange tool_ = ToolChange::none;
  std::uint64_t dwell_end_ = 0;  ///< clock
  /// Of the program, during lines of the user. Not initialised: that would be code in SRAM.
  union Before {
    Before() {}  // NOLINT(modernize-use-equals-default): that is deleted where members have values
    struct {
      program::Modal modal;
      program::Place place_e7;
    } at_m6;
  } before_;
};

}  // namespace lamplock::machine
