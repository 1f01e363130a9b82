// The program reader: lines of the host, one after the other, each done before the next is looked
// at.
//
// In:  lines as they come (push), the time.
// Out: lines for the planner (ProgramRunner), or points (JobRunner) while beat lock is on, and what
//      the host is to be told, step by step: the controller asks, answers, and knows what a "$"
//      means.
// Who: the controller, main loop, unmasked; some 7000 cycles a line and 2500 a piece of a curve.
//
// A line is done, and answered with "ok", when its last action was taken: of a move that is when
// the planner has it, which may be seconds before it is run; a dwell, a pause and the end of a
// program wait until the machine stands, as in grbl. Lines behind it wait in the queue, whose room
// the host knows.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/machine/job_runner.hpp"
#include "firmware/machine/kept_program.hpp"
#include "firmware/machine/line_queue.hpp"
#include "firmware/machine/program_outputs.hpp"
#include "firmware/machine/program_runner.hpp"
#include "firmware/program/interpreter.hpp"
#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// What a board has for programs: a bit for each output and input.
struct ProgramPorts {
  std::uint8_t outputs = 0, inputs = 0;
};

/// What the interpreter follows on a machine with these settings; `beat_lock`: it may have it.
program::Options program_options(const settings::Values& values, bool beat_lock,
                                 ProgramPorts ports);

class ProgramReader {
 public:
  /// What came of a step.
  enum class Step : std::uint8_t {
    nothing,  ///< no line is under way
    waits,    ///< for room, a rest, time, or somebody who says go on
    done,     ///< the line: to be answered
    outside,  ///< the line wanted to leave the work space: the rest of it is dropped
    pauses,   ///< M0, M1, M6: waits for go_on() from now on
    changes,  ///< the machine stands: a change over to wanted_lock() is due before the next move
    inputs,   ///< it stands: M66 waits for its input, until end_wait()
    probes,   ///< it stands: before and behind the move of a probe, until end_probe()
    ended     ///< M2, M30; then done
  };

  [[gnu::cold]] ProgramReader(ProgramRunner& runner, JobRunner& points, ProgramOutputs& outputs)
      : runner_(runner), points_(points), outputs_(outputs) {}
  ProgramReader(const ProgramReader&) = delete;
  ProgramReader& operator=(const ProgramReader&) = delete;

  /// Settings that the interpreter follows; at rest, nothing under way. `channels`: a bit for each
  /// that beat lock may fire; the first is used, without one there is no beat lock.
  void configure(const settings::Values& values, std::uint8_t channels, ProgramPorts ports);

  // Who runs the moves.
  /// Points on the beat, and how they are joined; off: lines.
  program::BeatLock lock() const { return lock_; }
  void set_lock(program::BeatLock lock) { lock_ = lock; }
  /// Of the next move.
  program::BeatLock wanted_lock() const { return action_.beat_lock; }
  /// From here on as after M131; nothing is under way.
  void end_lock();

  // Lines that wait.
  /// False if it does not fit, which a host that counts never sees.
  bool push(std::string_view line) { return queue_.push(line); }
  bool lines_wait() const { return !queue_.empty(); }
  std::uint32_t free() const { return queue_.free(); }
  char front() const { return queue_.front(); }
  std::uint32_t lines() const { return queue_.lines(); }
  /// The program's end was received: its M2 or M30 is under way or waits.
  bool ends_itself() const {
    const bool ends = pending_ && action_.kind == program::ActionKind::program_end;
    return ends || queue_.ends_program();
  }
  std::string_view take_line(std::span<char> room) { return queue_.pop(room); }

  // The line under way.
  /// Begins a line of a program; with an error it is over and nothing has changed.
  program::Fault begin(std::string_view line);
  /// Begins what stands behind "$J=". Error 15 as well, if it would leave the work space.
  program::Fault begin_jog(std::string_view line, const settings::Values& values,
                           const StepLimits& space);
  /// Goes on with it. With `check` nothing moves and nothing waits.
  Step step(const settings::Values& values, const StepLimits& space, std::uint64_t clock,
            bool check);
  bool line_open() const { return open_; }
  void go_on() { paused_ = false; }
  /// What it pauses for is another tool.
  bool changes_tool() const { return action_.kind == program::ActionKind::tool_change; }
  /// What M66 waits for, and how long.
  const program::IoRequest& wait() const { return action_.io; }
  std::uint32_t wait_us() const { return action_.time_us; }
  /// That is over; `pauses`: the program goes on when somebody says so.
  void end_wait(bool pauses) {
    taken();
    paused_ = pauses;
  }
  /// Gives the move of the probe to the planner.
  void begin_probe() {
    outputs_.apply_next();
    probing_ = runner_.take(target_);
  }
  bool probing() const { return probing_; }
  /// It ends when contact is lost; it is an error if it ends by itself.
  bool probes_away() const { return action_.probe_away; }
  bool probe_must_meet() const { return action_.probe_must; }
  /// It is over; the machine stands there.
  void end_probe(const stepper::MotionState& at, const settings::Values& values);

  /// Forgets the line under way; true if there was one.
  bool drop_line();
  /// The same, and those that wait.
  void clear();
  /// After power-up and a reset: the same, and the modal state is as it is by default.
  void reset();
  /// The machine is somewhere else than the program thinks.
  void lose_position() { astray_ = true; }
  void toggle_flood() {
    interpreter_.toggle_flood();
    put_air();
  }
  void toggle_mist() {
    interpreter_.toggle_mist();
    put_air();
  }
  /// Spindle and coolant are off, and so the modal state says.
  void switch_off() { interpreter_.switch_off(); }
  bool astray() const { return astray_; }
  /// Where it is, if that was lost; nothing is under way.
  void find_position(const stepper::MotionState& at, const settings::Values& values);

  const program::Interpreter& interpreter() const { return interpreter_; }
  /// What programs leave behind; parameters are changed only while no line is under way.
  KeptProgram& kept() { return kept_; }
  const KeptProgram& kept() const { return kept_; }
  /// After power-up, first of all: what programs left behind is in force.
  void restore(const KeptProgram& kept) {
    kept_ = kept;
    interpreter_.reset();
  }

 private:
  bool next_action();
  Step act(const settings::Values& values, const StepLimits& space, std::uint64_t clock,
           bool check);
  Step move(const settings::Values& values, const StepLimits& space, bool check);
  Step pixels(const settings::Values& values, bool check);
  bool prepare_beam();
  bool planned() const { return runner_.begun() && !runner_.broken_off(); }
  bool take(const settings::Values& values);
  Step dwell(std::uint64_t clock);
  bool rests();
  Step stand();
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
  KeptProgram kept_;
  program::Options options_;
  program::Interpreter interpreter_{kept_.parameters, options_};
  program::Action action_;
  motion::LineTarget target_;  ///< of a move
  bool open_ = false;          ///< a line is under way
  bool jogs_ = false;          ///< which is a jog
  bool pending_ = false;       ///< action_ was not taken yet
  bool prepared_ = false;      ///< target_ is that of action_
  bool listed_ = false;        ///< its pixels are complete
  bool paused_ = false;
  bool probing_ = false;  ///< the move of action_ is under way
  bool astray_ = true;
  bool dwells_ = false;
  std::uint64_t dwell_end_ = 0;  ///< clock
};

}  // namespace lamplock::machine
