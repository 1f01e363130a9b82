// A job of rows: lines of pixels that come in frames (docs/wire-format.md), for a continuous laser.
//
// In:  the payloads of DATA, in order; how far the program runner is.
// Out: lines for the program runner, the powers of their cells; how far the job is.
// Who: the controller, main loop; its code lies in flash. look() in every round while a job runs,
//      masked; take() once a frame.
//
//   off  -> begin()  runs  -> stop()  stops  -> end()  off
//                          -> end()   off
//
// Nothing here moves the machine or makes it stop: holds, doors and alarms act on the program
// runner, as for programs. A machine that has run what it has stands, dark, until more comes.
//
// Lines carry the lower bits of their index through the planner. A line is done when the one behind
// it has been played, or the machine stands where it ends: what is told may lag by some
// milliseconds, but never names a line too late.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/machine/program_runner.hpp"
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

  /// The program runner has begun, and the machine stands `at`.
  [[gnu::cold]] void begin(const wire::JobHeader& header, const StepPosition& at);
  /// Takes a payload. As RowDecoder::check(); no_job, if it does not run.
  [[gnu::cold]] Result take(std::span<const std::uint8_t> records, const StepLimits& space);
  /// Sees how far the machine is.
  [[gnu::cold]] void look();
  /// The laser stays off from now on, and what is told stays as it is.
  void stop() {
    if (runs()) stage_ = Stage::stops;
  }
  /// The machine stands, or will not move any more. What was told of the job stays.
  void end() { stage_ = Stage::off; }
  /// Another job has begun, to which what is told belongs.
  void forget() {
    end();
    known_ = false;
  }

  /// Lines are taken, and run.
  bool runs() const { return stage_ == Stage::runs; }
  /// The same, or it is being stopped.
  bool active() const { return stage_ != Stage::off; }
  /// The last job was one of rows: what is told is about it.
  bool known() const { return known_; }
  /// The laser of whatever is run.
  bool may_shine() const { return stage_ != Stage::stops && !(dry_ && runs()); }
  /// All lines were taken.
  bool complete() const { return decoder_.complete(); }
  /// And run, or what is left of them will not be. As of the last look().
  bool over() const { return runner_.idle() && (complete() || !runs()); }

  std::uint32_t refused_index() const { return decoder_.refused_index(); }
  /// Lines and runs that can be taken.
  [[gnu::cold]] program::RowRoom room() const;
  /// What STATUS tells of it.
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
  bool astray_ = false;      ///< the machine is not where the first line begins
  bool seen_ = false;        ///< next_ is being filled from next_tick_ on, or before
  std::uint32_t first_ = 0;  ///< line not run to its end
  std::uint32_t next_ = 0;   ///< as lines carry it
  std::uint64_t next_tick_ = 0;
};

}  // namespace lamplock::machine
