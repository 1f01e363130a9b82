// Records of rows become lines and runs of pixels (docs/wire-format.md, section 4).
//
// In:  the payload of one DATA frame at a time, in order (the link sees to that).
// Out: its lines and their runs, one by one: all of a frame, or none.
// Who: the job of rows (machine/row_job.hpp), at main-loop level; runs from flash. Grey pixels of
//      0.1 mm at 300 mm/s are 3000 runs a second.
//
// A frame is looked at twice: check() goes to its end before take() hands out anything. The runs of
// a line may come in several frames; they are handed out as they come.
#pragma once

#include <cstdint>
#include <span>

#include "shared/result.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/row_records.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program {

/// What can be taken: lines, and places for runs and the header of each line's.
struct RowRoom {
  std::uint32_t lines = 0, runs = 0;
};

/// Decoder of one job of rows.
class RowDecoder {
 public:
  /// Starts a job: deltas count from the header's origin, indices from its first index.
  void begin(const wire::JobHeader& header);

  /// Looks through a payload. Results: ok; no_space (ask again later); bad_frame (malformed);
  /// bad_value (what row_records.hpp does not allow, more lines than a frame may have, or than the
  /// header announced); out_of_bounds (outside `limits`, or beyond 32 bits). Changes nothing.
  Result check(std::span<const std::uint8_t> records, RowRoom room, const StepLimits& limits);
  /// Takes it, if it is well: `take_run(std::uint16_t)` for each run, `take_line(const
  /// wire::RowLine&)` behind those of a line.
  template <class TakeLine, class TakeRun>
  void take(std::span<const std::uint8_t> records, TakeLine&& take_line, TakeRun&& take_run) {
    wire::walk_row_records(
        records, axes_, state_,
        [&](const wire::RowLine& line) {
          take_line(line);
          ++index_;
          return Result::ok;
        },
        [&](std::uint16_t run) {
          take_run(run);
          return Result::ok;
        });
  }

  /// Index in the job of the line that comes next.
  std::uint32_t index() const { return index_; }
  /// Where it begins.
  const StepPosition& from() const { return state_.steps; }
  /// All that were announced are taken.
  bool complete() const { return index_ == lines_total_ && state_.runs == 0; }
  /// Index in the job of the line that the last refusal is about.
  std::uint32_t refused_index() const { return refused_index_; }

 private:
  wire::RowState state_;
  std::uint32_t index_ = 0;
  std::uint32_t lines_total_ = 0;
  std::uint32_t refused_index_ = 0;
  int axes_ = 0;
};

}  // namespace lamplock::program
