// The pulse stream of rows of pixels: lines, and the runs of their cells (docs/wire-format.md,
// section 4).
//
// The host writes runs with `put_runs` and their line with `put_row_line`; the firmware's decoder
// and the reader of job files parse both with `walk_row_records`. All pass a `RowState` from record
// to record.
//
//   feed   runs runs | line with light   line without   runs | line with light
//          its cells, evenly along it    a rapid
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/result.hpp"
#include "shared/units.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/records.hpp"
#include "shared/wire/runs.hpp"

namespace lamplock::wire {

/// End of a line, and how the machine moves there.
struct RowLine {
  StepPosition steps{};
  bool light = false;            ///< with the runs since the previous line; else a rapid
  std::uint32_t feed_milli = 0;  ///< thousandths of mm/min, for lines with light
  friend constexpr bool operator==(const RowLine&, const RowLine&) = default;
};

/// The state that a record refers to.
struct RowState {
  StepPosition steps{};          ///< of the previous line
  std::uint32_t feed_milli = 0;  ///< current; 0 = none yet
  std::uint32_t runs = 0;        ///< since the previous line
  std::uint32_t cells = 0;       ///< of these
};

inline constexpr std::uint8_t head_feed = 0xC3;
inline constexpr std::uint8_t head_runs = 0xC4;
inline constexpr std::size_t max_runs_a_record = 200;
/// So that four lines, each with its header, fit into the board's 2048 places.
inline constexpr std::uint32_t max_runs_a_line = 511;
inline constexpr std::uint32_t max_cells_a_line = 0xffff;
inline constexpr std::size_t max_lines_a_frame = 16;

/// Longest coding of one line: feed 5, head 2, four deltas of 4 [bytes].
inline constexpr std::size_t max_row_line_size = 5 + 2 + 4 * max_axes;
/// Size of a record of runs without its runs: head, count.
inline constexpr std::size_t runs_record_size = 2;

/// Appends one line and updates the state. False, without a change, if it is too long or needs an
/// axis that the machine lacks, if it has light without runs, feed rate or length, or runs without
/// light, or does not fit the writer.
constexpr bool put_row_line(ByteWriter& out, RowState& state, const RowLine& line, int axes) {
  StepPosition deltas{};
  if (!detail::deltas_between(state.steps, line.steps, axes, deltas)) return false;
  if (line.light != (state.runs != 0)) return false;
  if (line.light && (line.feed_milli == 0 || line.steps == state.steps)) return false;
  if (out.room() < max_row_line_size) return false;
  if (line.light && line.feed_milli != state.feed_milli) {
    out.put(head_feed);
    out.put(line.feed_milli);
    state.feed_milli = line.feed_milli;
  }
  detail::put_position(out, line.light ? kind_point : kind_move, deltas, axes);
  state.steps = line.steps;
  state.runs = state.cells = 0;
  return true;
}

/// Appends the first of these runs, and returns their number: as many as fit the writer, one
/// record, and the line.
constexpr std::size_t put_runs(ByteWriter& out, RowState& state,
                               std::span<const std::uint16_t> runs) {
  if (out.room() < runs_record_size) return 0;
  const std::size_t room = (out.room() - runs_record_size) / sizeof(std::uint16_t);
  const std::size_t most = std::min({runs.size(), room, max_runs_a_record,
                                     static_cast<std::size_t>(max_runs_a_line - state.runs)});
  std::size_t count = 0;
  std::uint32_t cells = state.cells;
  while (count < most && run_cells(runs[count]) <= max_cells_a_line - cells)
    cells += run_cells(runs[count++]);
  if (count == 0) return 0;
  out.put(head_runs);
  out.put(static_cast<std::uint8_t>(count));
  for (const std::uint16_t run : runs.first(count)) out.put(run);
  state.runs += static_cast<std::uint32_t>(count);
  state.cells = cells;
  return count;
}

namespace detail {

template <class EmitRun>
constexpr Result take_runs(ByteReader& in, RowState& state, EmitRun& emit_run) {
  const auto count = in.take<std::uint8_t>();
  if (!in.ok() || in.left() < count * sizeof(std::uint16_t)) return Result::bad_frame;
  if (count == 0 || count > max_runs_a_record) return Result::bad_value;
  if (count > max_runs_a_line - state.runs) return Result::bad_value;
  for (int i = 0; i < count; ++i) {
    const auto run = in.take<std::uint16_t>();
    if (run_cells(run) > max_cells_a_line - state.cells) return Result::bad_value;
    state.cells += run_cells(run);
    if (const Result r = emit_run(run); r != Result::ok) return r;
  }
  state.runs += count;
  return Result::ok;
}

constexpr Result take_row_line(ByteReader& in, std::uint8_t head, int axes, RowState& state,
                               RowLine& line) {
  const StepPosition before = state.steps;
  if (const Result r = take_position(in, head, axes, state.steps); r != Result::ok) return r;
  line.steps = state.steps;
  line.light = (head & kind_mask) == kind_point;
  line.feed_milli = line.light ? state.feed_milli : 0;
  if (line.light != (state.runs != 0)) return Result::bad_value;
  if (line.light && (line.feed_milli == 0 || state.steps == before)) return Result::bad_value;
  state.runs = state.cells = 0;
  return Result::ok;
}

}  // namespace detail

/// Parses records: calls `Result emit_run(std::uint16_t)` for every run, and then `Result
/// emit_line(const RowLine&)` for their line, and stops at the first result that is not ok. `state`
/// has then changed up to there: use a copy.
template <class EmitLine, class EmitRun>
constexpr Result walk_row_records(std::span<const std::uint8_t> bytes, int axes, RowState& state,
                                  EmitLine&& emit_line, EmitRun&& emit_run) {
  ByteReader in(bytes);
  while (in.left() != 0) {
    const auto head = in.take<std::uint8_t>();
    const std::uint8_t kind = head & kind_mask;
    Result r = Result::ok;
    if (kind == kind_point || kind == kind_move) {
      RowLine line;
      r = detail::take_row_line(in, head, axes, state, line);
      if (r == Result::ok) r = emit_line(line);
    } else if (head == head_runs) {
      r = detail::take_runs(in, state, emit_run);
    } else if (head == head_feed) {
      state.feed_milli = in.take<std::uint32_t>();
      if (!in.ok()) return Result::bad_frame;
      if (state.feed_milli == 0) r = Result::bad_value;
    } else {
      return Result::bad_frame;
    }
    if (r != Result::ok) return r;
  }
  return Result::ok;
}

}  // namespace lamplock::wire
