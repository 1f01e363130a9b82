// Rows of pixels for a continuous laser: the lines of a job and the runs of cells on them.
//
// In:  lines in the order to run them; cells as they lie on the wire (shared/wire/runs.hpp).
// Out: payloads for DATA frames, from any line on; how many places of the board's table they take.
// Who: host/raster makes rows, Job has them, RecordEncoder cuts them, the sender counts places.
//
//   line        rapid | light | light | rapid | light ...     places of the board's table:
//   runs              [ ---- ][ ---- ]        [ ---- ]        one a run and one a line with light
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/wire/row_records.hpp"

namespace lamplock::job {

/// A line, and which of the runs lie on it: none on a rapid.
struct Line {
  wire::RowLine to;
  std::size_t first_run = 0;
  std::size_t runs = 0;
  friend bool operator==(const Line&, const Line&) = default;
};

/// Lines one after the other.
struct Rows {
  std::vector<Line> lines;
  std::vector<std::uint16_t> runs;

  std::span<const std::uint16_t> runs_of(const Line& line) const {
    return std::span(runs).subspan(line.first_run, line.runs);
  }
  friend bool operator==(const Rows&, const Rows&) = default;
};

/// Makes rows so that they can be gone on with at line `from`, which is burnt from its beginning,
/// and says at which line to start: in the middle of a row one before, which becomes dark, so that
/// the machine comes in motion. A board goes to where its first line begins by itself, dark.
std::size_t go_on_at(Rows& rows, std::size_t from);

/// Cuts lines and runs into payloads, each to be decoded after the one before. The cells of a line
/// may be in several of them.
class RowEncoder {
 public:
  /// Starts at line `first`, which is relative to `origin`. The rows must outlive the encoder.
  RowEncoder(const Rows& rows, std::size_t first, const StepPosition& origin, int axes);

  /// The next payload: at most `max_bytes` bytes (at least wire::max_row_line_size) and `max_lines`
  /// lines; empty at the end of the rows. Throws Error(bad_input) for a line that no record can be.
  std::vector<std::uint8_t> next(std::size_t max_bytes, std::size_t max_lines);

  /// Index after the last line encoded.
  std::size_t index() const { return index_; }
  /// Places of the board's table that all payloads so far take.
  std::uint64_t places() const { return places_; }

 private:
  bool put_runs(wire::ByteWriter& out);
  [[noreturn]] void refuse_line() const;

  const Rows* rows_;
  int axes_;
  std::size_t index_;
  std::size_t done_runs_ = 0;  ///< of that line
  std::uint64_t places_ = 0;
  wire::RowState state_;
};

}  // namespace lamplock::job
