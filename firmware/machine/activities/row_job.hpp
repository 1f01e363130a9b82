// A job of rows: lines of pixels that come in frames (docs/wire-format.md), for a continuous laser.
//
// In:  the payloads of DATA, in order; the progress of the program runner.
// Out: lines for the program runner, the powers of their cells; the progress of the job.
// Who: the controller, main loop; its code is in flash. poll() in every round while a job runs,
//      masked; take() once a frame.
//
//   off  -> begin()  runs  -> stop()  stops  -> end()  off
//                          -> end()   off
//
// This class does not move or stop the machine: holds, doors and alarms act on the program runner,
// as for programs. A machine that has run all its lines rests, dark, until more arrive.
//
// Lines carry the lower bits of their index through the planner. A line is done when the next one
// has been played, or when the machine rests at its end: the reported progress may lag by some
// milliseconds, but is never ahead.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/machine/runners/program_runner.hpp"
#include "firmware/program/row_decoder.hpp"
#include "shared/result.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/status.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

class RowJob {
 public:
  explicit RowJob(ProgramRunner& runner) : runner_(runner) {}
  RowJob(const RowJob&) = delete;
  RowJob& operator=(const RowJob&) = delete;

  /// The program runner has begun, and the machine rests at `at`.
  [[gnu::cold]] void begin(const wire::JobHeader& header, const StepPosition& at);
  /// Accepts a payload. Errors as RowDecoder::check(); no_job if no job runs.
  [[gnu::cold]] Result take(std::span<const std::uint8_t> records, const StepLimits& space);
  /// Updates the progress from the program runner.
  [[gnu::cold]] void poll();
  /// The laser stays off from now on, and the reported progress is frozen.
  void stop() {
    if (runs()) stage_ = Stage::stops;
  }
  /// The machine is at rest, or will not move any more. The reported progress is kept.
  void end() { stage_ = Stage::off; }
  /// Another job has begun and replaces the reported progress.
  void forget() {
    end();
    known_ = false;
  }

  /// Lines are accepted and run.
  bool runs() const { return stage_ == Stage::runs; }
  /// Runs, or is being stopped.
  bool active() const { return stage_ != Stage::off; }
  /// The last job was one of rows: the reported progress is about it.
  bool known() const { return known_; }
  /// The laser may shine in any motion that runs.
  bool may_shine() const { return stage_ != Stage::stops && !(dry_ && runs()); }
  /// All lines were accepted.
  bool complete() const { return decoder_.complete(); }
  /// All lines were run, or the rest will not be. As of the last poll().
  bool over() const { return runner_.idle() && (complete() || !runs()); }

  std::uint32_t refused_index() const { return decoder_.refused_index(); }
  /// Lines and runs that can be taken.
  [[gnu::cold]] program::RowRoom room() const;
  /// Writes the progress into STATUS.
  [[gnu::cold]] void fill_status(wire::Status& status) const;

 private:
  enum class Stage : std::uint8_t { off, runs, stops };

  void take_run(std::uint16_t run);
  void take_line(const wire::RowLine& line);
  std::uint32_t index_of(std::uint32_t carried) const;
  void pass(std::uint32_t index);

  ProgramRunner& runner_;
  program::RowDecoder decoder_;
  Stage stage_ = Stage::off;
  bool known_ = false;
  bool dry_ = false;
  bool off_target_ = false;  ///< the machine is not where the first line begins
  bool seen_ = false;        ///< next_ is being filled from next_tick_ on, or from before
  std::uint32_t first_ = 0;  ///< line not run to its end
  std::uint32_t next_ = 0;   ///< with the bits that lines carry
  std::uint64_t next_tick_ = 0;
};

}  // namespace lamplock::machine
