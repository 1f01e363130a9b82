// Converts records of rows to lines and runs of pixels (docs/wire-format.md, section 4).
//
// In:  the payload of one DATA frame at a time, in order (the link ensures that).
// Out: its lines and their runs, one by one: all of a frame, or none.
// Who: the job of rows (machine/activities/row_job.hpp), at main-loop level; runs from flash.
// Budget: grey pixels of 0.1 mm at 300 mm/s are 3000 runs a second.
//
// A frame is parsed twice: check() parses all of it before take() passes anything on. The runs of a
// line may be in several frames; they are passed on as they arrive.
#pragma once

#include <cstdint>
#include <span>

#include "shared/result.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/row_records.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program {

/// Free room: lines, and places for runs and the header of each line.
struct RowRoom {
  std::uint32_t lines = 0, runs = 0;
};

/// Decoder of one job of rows.
class RowDecoder {
 public:
  /// Starts a job: deltas count from the header's origin, indices from its first index.
  void begin(const wire::JobHeader& header);

  /// Checks a payload. Results: ok; no_space (retry later); bad_frame (malformed); bad_value
  /// (forbidden by row_records.hpp, more lines than a frame may have, or than the header
  /// announced); out_of_bounds (outside `limits`, or beyond 32 bits). Changes nothing.
  Result check(std::span<const std::uint8_t> records, RowRoom room, const StepLimits& limits);
  /// Takes a checked payload: `take_run(std::uint16_t)` for each run, `take_line(const
  /// wire::RowLine&)` after those of a line.
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

  /// Index in the job of the next line.
  std::uint32_t index() const { return index_; }
  /// Start of the next line.
  const StepPosition& from() const { return state_.steps; }
  /// All announced lines were taken.
  bool complete() const { return index_ == lines_total_ && state_.runs == 0; }
  /// Index in the job of the last refused line.
  std::uint32_t refused_index() const { return refused_index_; }

 private:
  wire::RowState state_;
  std::uint32_t index_ = 0;
  std::uint32_t lines_total_ = 0;
  std::uint32_t refused_index_ = 0;
  int axes_ = 0;
};

}  // namespace lamplock::program
