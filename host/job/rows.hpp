// Rows of pixels for a continuous laser: the lines of a job and the runs of cells on them.
//
// In:  lines in the order to run them; cells in wire format (shared/wire/runs.hpp).
// Out: payloads for DATA frames, beginning at any line; the number of entries of the board's run
//      table that they need.
// Who: host/raster makes rows, Job has them, RecordEncoder cuts them, the sender counts entries.
//
//   line        rapid | light | light | rapid | light ...     entries of the board's run table:
//   runs              [ ---- ][ ---- ]        [ ---- ]        one per run and per line with light
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/wire/row_records.hpp"

namespace lamplock::job {

/// A line and its runs: none on a rapid.
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

/// Changes rows so that they can continue at line `from`, which is engraved from its beginning, and
/// returns the line to start at: in the middle of a row this is one line earlier, which becomes
/// dark and brings the machine to its speed. A board moves to the begin of its first line by
/// itself, dark.
std::size_t continue_at(Rows& rows, std::size_t from);

/// Cuts lines and runs into payloads, each to be decoded after the one before. The cells of a line
/// may be in several of them.
class RowEncoder {
 public:
  /// Starts at line `first`, which is relative to `origin`. The rows must outlive the encoder.
  RowEncoder(const Rows& rows, std::size_t first, const StepPosition& origin, int axes);

  /// The next payload: at most `max_bytes` bytes (at least wire::max_row_line_size) and `max_lines`
  /// lines; empty at the end of the rows. Throws Error(bad_input) for a line that no record can
  /// represent.
  std::vector<std::uint8_t> next(std::size_t max_bytes, std::size_t max_lines);

  /// Index after the last line encoded.
  std::size_t index() const { return index_; }
  /// Entries of the board's run table that all payloads so far need.
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
