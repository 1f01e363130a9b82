// The pulse stream: targets as records of step deltas (docs/wire-format.md, section 4).
//
// The host writes records with `put_record`; the firmware's decoder and the reader of job files
// parse them with `walk_records`. Both pass a `RecordState` from record to record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "shared/result.hpp"
#include "shared/units.hpp"
#include "shared/wire/bytes.hpp"

namespace lamplock::wire {

/// One target in the pulse stream; the fields have the meaning of motion::Target. A target without
/// shots has no channel and no energy.
struct Record {
  StepPosition steps{};
  std::uint16_t beats = 0;
  std::uint8_t shots = 1;
  std::uint8_t channel = 0;
  std::uint16_t energy = 0;
  friend constexpr bool operator==(const Record&, const Record&) = default;
};

/// The state that a record refers to: the previous target and the values that hold until changed.
struct RecordState {
  StepPosition steps{};
  std::uint16_t beats = 0;
  std::uint8_t shots = 1;
  std::uint8_t channel = 0;
  std::uint16_t energy = 0;
};

inline constexpr std::uint8_t kind_mask = 0xC0;
inline constexpr std::uint8_t kind_point = 0x00;
inline constexpr std::uint8_t kind_move = 0x40;
inline constexpr std::uint8_t head_shots = 0xC0;
inline constexpr std::uint8_t head_beats = 0xC1;
inline constexpr std::uint8_t head_dwell = 0xC2;
inline constexpr std::uint8_t fourth_axis_mark = 0x40;
inline constexpr std::uint8_t max_channel = 3;

/// Longest coding of one target: shots 5, beats 3, head 2, four deltas of 4 [bytes].
inline constexpr std::size_t max_record_size = 5 + 3 + 2 + 4 * max_axes;

/// Delta from `from` to `to`; false if it exceeds 32 bits.
constexpr bool step_delta(std::int32_t from, std::int32_t to, std::int32_t& delta) {
  const std::int64_t wide = static_cast<std::int64_t>(to) - from;
  if (wide < std::numeric_limits<std::int32_t>::min() ||
      wide > std::numeric_limits<std::int32_t>::max())
    return false;
  delta = static_cast<std::int32_t>(wide);
  return true;
}

namespace detail {

constexpr std::uint8_t size_code(std::int32_t delta) {
  if (delta == 0) return 0;
  if (delta >= -128 && delta <= 127) return 1;
  return delta >= -32768 && delta <= 32767 ? 2 : 3;
}

constexpr void put_delta(ByteWriter& out, std::int32_t delta) {
  switch (size_code(delta)) {
    case 0:
      break;
    case 1:
      out.put(static_cast<std::int8_t>(delta));
      break;
    case 2:
      out.put(static_cast<std::int16_t>(delta));
      break;
    default:
      out.put(delta);
  }
}

constexpr std::int32_t take_delta(ByteReader& in, std::uint8_t code) {
  switch (code) {
    case 0:
      return 0;
    case 1:
      return in.take<std::int8_t>();
    case 2:
      return in.take<std::int16_t>();
    default:
      return in.take<std::int32_t>();
  }
}

/// Reads the size codes of a record with deltas, axis by axis; false if the head is malformed.
constexpr bool take_codes(ByteReader& in, std::uint8_t head, int axes,
                          PerAxis<std::uint8_t>& codes) {
  for (std::size_t i = 0; i < 3; ++i) codes[i] = static_cast<std::uint8_t>(head >> (2 * i) & 3);
  for (std::size_t i = static_cast<std::size_t>(axes); i < 3; ++i)
    if (codes[i] != 0) return false;
  if (axes < max_axes) return true;
  const auto fourth = in.take<std::uint8_t>();
  codes[3] = fourth & 3;
  return (fourth & ~3) == fourth_axis_mark;
}

/// Reads the deltas of one target; `at`, the previous one, is updated only if ok.
constexpr Result take_position(ByteReader& in, std::uint8_t head, int axes, StepPosition& at) {
  PerAxis<std::uint8_t> codes{};
  if (!take_codes(in, head, axes, codes)) return Result::bad_frame;
  StepPosition steps = at;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::int32_t delta = take_delta(in, codes[i]);
    // Wide, because a hostile delta may exceed 32 bits: a wrapped position could be inside.
    const std::int64_t wide = static_cast<std::int64_t>(steps[i]) + delta;
    steps[i] = static_cast<std::int32_t>(wide);
    if (steps[i] != wide) return Result::out_of_bounds;
  }
  if (!in.ok()) return Result::bad_frame;
  at = steps;
  return Result::ok;
}

/// Deltas from one target to the next; false if they cannot be coded.
constexpr bool deltas_between(const StepPosition& from, const StepPosition& to, int axes,
                              StepPosition& deltas) {
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    if (!step_delta(from[i], to[i], deltas[i])) return false;
    if (deltas[i] != 0 && static_cast<int>(i) >= axes) return false;
  }
  return true;
}

/// Appends head and deltas of one target.
constexpr void put_position(ByteWriter& out, std::uint8_t kind, const StepPosition& deltas,
                            int axes) {
  std::uint8_t head = kind;
  for (std::size_t i = 0; i < 3; ++i)
    head = static_cast<std::uint8_t>(head | size_code(deltas[i]) << (2 * i));
  out.put(head);
  if (axes == max_axes) out.put(static_cast<std::uint8_t>(fourth_axis_mark | size_code(deltas[3])));
  for (const std::int32_t delta : deltas) put_delta(out, delta);
}

/// Reads the values of a record that changes the state.
constexpr Result take_shots(ByteReader& in, RecordState& state) {
  state.channel = in.take<std::uint8_t>();
  state.shots = in.take<std::uint8_t>();
  state.energy = in.take<std::uint16_t>();
  if (!in.ok()) return Result::bad_frame;
  return state.channel > max_channel || state.shots == 0 ? Result::bad_value : Result::ok;
}

}  // namespace detail

/// Appends one target and updates the state. False, without a change, if it is too far from the
/// previous target, has a fourth axis that the machine lacks, or does not fit the writer.
constexpr bool put_record(ByteWriter& out, RecordState& state, const Record& record, int axes) {
  StepPosition deltas{};
  if (!detail::deltas_between(state.steps, record.steps, axes, deltas)) return false;
  const bool moves = record.steps != state.steps;
  if (out.room() < max_record_size) return false;
  if (!moves && record.shots == 0 && record.beats != 0) {
    out.put(head_dwell);
    out.put(record.beats);
    return true;
  }
  if (record.shots != 0 && (record.shots != state.shots || record.channel != state.channel ||
                            record.energy != state.energy)) {
    out.put(head_shots);
    out.put(record.channel);
    out.put(record.shots);
    out.put(record.energy);
    state.shots = record.shots;
    state.channel = record.channel;
    state.energy = record.energy;
  }
  if (record.beats != state.beats) {
    out.put(head_beats);
    out.put(record.beats);
    state.beats = record.beats;
  }
  detail::put_position(out, record.shots != 0 ? kind_point : kind_move, deltas, axes);
  state.steps = record.steps;
  return true;
}

/// Parses records: calls `Result emit(const Record&)` for every target and stops at the first
/// result that is not ok. `state` has then changed up to there: use a copy.
template <class Emit>
constexpr Result walk_records(std::span<const std::uint8_t> bytes, int axes, RecordState& state,
                              Emit&& emit) {
  ByteReader in(bytes);
  while (in.left() != 0) {
    const auto head = in.take<std::uint8_t>();
    const std::uint8_t kind = head & kind_mask;
    Record record;
    if (kind == kind_point || kind == kind_move) {
      if (const Result r = detail::take_position(in, head, axes, state.steps); r != Result::ok)
        return r;
      record = kind == kind_point
                   ? Record{state.steps, state.beats, state.shots, state.channel, state.energy}
                   : Record{state.steps, state.beats, 0, 0, 0};
    } else if (head == head_shots) {
      if (const Result r = detail::take_shots(in, state); r != Result::ok) return r;
      continue;
    } else if (head == head_beats) {
      state.beats = in.take<std::uint16_t>();
      if (!in.ok()) return Result::bad_frame;
      continue;
    } else if (head == head_dwell) {
      record = Record{state.steps, in.take<std::uint16_t>(), 0, 0, 0};
      if (!in.ok()) return Result::bad_frame;
      if (record.beats == 0) return Result::bad_value;
    } else {
      return Result::bad_frame;
    }
    if (const Result r = emit(record); r != Result::ok) return r;
  }
  return Result::ok;
}

}  // namespace lamplock::wire
