// State of the machine and the link: payload of STATUS (docs/wire-format.md, section 5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/beat_reason.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/messages.hpp"

namespace lamplock::wire {

/// State of the machine. The values are part of the wire format: never renumber.
enum class MachineState : std::uint8_t { idle = 0, run, hold, alarm, door, estop, home };

/// The cause of a hold. The host only resumes a hold that its own silence has caused.
enum class HoldReason : std::uint8_t {
  none = 0,
  host,      ///< COMMAND hold, or a door that was opened and has been closed
  realtime,  ///< `!` or 0x84
  dead_man,  ///< the host was silent for too long
  reset,     ///< 0x18 during a job, which its host stops
  not_made,  ///< the photosensor has not detected a shot, nor its repeats
  lamp,      ///< the lamp does not answer our triggers
  sensor     ///< the temperature sensor is out of its range
};

/// Errors on the wire, counted since power-up.
struct LinkCounters {
  std::uint32_t bad_frames = 0;    ///< CRC, length or stuffing
  std::uint32_t duplicates = 0;    ///< DATA or END already accepted
  std::uint32_t out_of_order = 0;  ///< a gap before it, no space for it, or another session
  std::uint32_t lost_lines = 0;    ///< too long or spoilt
  std::uint32_t transmit_overflows = 0;
  friend constexpr bool operator==(const LinkCounters&, const LinkCounters&) = default;
};

/// The board sends a STATUS unasked when this many points, or in a job of rows this many lines or
/// runs, have become free since the last one.
inline constexpr std::uint32_t free_points_step = 128, free_lines_step = 8, free_runs_step = 128;

/// State that the host gets without a request.
struct StatusSummary {
  MachineState state = MachineState::idle;
  HoldReason hold_reason = HoldReason::none;
  std::uint8_t alarm = 0;  ///< alarm number of grbl, 0 = none
  bool lamp_locked = false;
  std::uint32_t free_points = 0;  ///< or lines, in a job of rows
  std::uint32_t free_runs = 0;    ///< of pixels, in a job of rows
  bool rows = false;              ///< it is one; not sent
  friend constexpr bool operator==(const StatusSummary&, const StatusSummary&) = default;

  /// True if the host, last informed by `sent`, must be informed of this.
  constexpr bool is_news(const StatusSummary& sent) const {
    const std::uint32_t step = rows ? free_lines_step : free_points_step;
    return free_points >= sent.free_points + step || free_runs >= sent.free_runs + free_runs_step ||
           state != sent.state || hold_reason != sent.hold_reason || alarm != sent.alarm ||
           lamp_locked != sent.lamp_locked;
  }
};

/// All that the host may request. The machine sets its members (`fill_status`), the link the fields
/// marked [link].
struct Status : StatusSummary {
  std::uint16_t version = protocol_version;  ///< [link]
  std::uint32_t session = 0;                 ///< [link] sent in the frame header
  std::uint32_t number = 0;                  ///< [link] running count, in the frame header
  std::uint32_t next_number = 0;             ///< [link] next DATA or END expected
  std::uint32_t echo = 0;                    ///< [link] number of the last QUERY
  std::uint32_t last_command = 0;            ///< [link] number of the last COMMAND accepted
  std::uint32_t received = 0;                ///< index after the last point accepted
  std::uint32_t first_unfired = 0;           ///< index of the first point not fired
  std::uint32_t shots = 0;
  std::uint32_t beats = 0;         ///< lamp periods from the first shot on
  std::uint32_t beats_before = 0;  ///< lamp periods before the first shot
  std::uint32_t starvations = 0;
  BeatsByReason beats_by_reason{};  ///< their sum is `beats`
  BeatsByReason beats_outside{};    ///< those before the first shot and after the last
  std::uint32_t shots_made = 0;     ///< detected by their photosensor
  std::uint32_t shots_not_made = 0;
  std::uint32_t repeats = 0;  ///< shots at a point whose last shot was not made
  LinkCounters link;          ///< [link]
  friend constexpr bool operator==(const Status&, const Status&) = default;
};
inline constexpr std::size_t status_size = 210;
static_assert(status_size <= max_payload);

inline constexpr std::uint8_t lamp_locked_flag = 1;

constexpr void write_status(ByteWriter& out, const Status& status) {
  out.put(status.version);
  out.put(static_cast<std::uint8_t>(status.state));
  out.put(static_cast<std::uint8_t>(status.hold_reason));
  out.put(status.alarm);
  out.put(status.lamp_locked ? lamp_locked_flag : std::uint8_t{0});
  for (const std::uint32_t value :
       {status.next_number, status.echo, status.last_command, status.free_points, status.received,
        status.first_unfired, status.shots, status.beats, status.beats_before, status.starvations})
    out.put(value);
  for (const std::uint32_t beats : status.beats_by_reason) out.put(beats);
  for (const std::uint32_t beats : status.beats_outside) out.put(beats);
  for (const std::uint32_t value :
       {status.shots_made, status.shots_not_made, status.repeats, status.link.bad_frames,
        status.link.duplicates, status.link.out_of_order, status.link.lost_lines,
        status.link.transmit_overflows, status.free_runs})
    out.put(value);
}

/// Reads a STATUS payload. With another version only `version` is set. False if it is malformed.
constexpr bool read_status(const FrameHeader& header, std::span<const std::uint8_t> payload,
                           Status& status) {
  ByteReader in(payload);
  Status read;
  read.session = header.session;
  read.number = header.number;
  read.version = in.take<std::uint16_t>();
  if (!in.ok()) return false;
  if (read.version != protocol_version) {
    status = read;
    return true;
  }
  read.state = static_cast<MachineState>(in.take<std::uint8_t>());
  read.hold_reason = static_cast<HoldReason>(in.take<std::uint8_t>());
  read.alarm = in.take<std::uint8_t>();
  read.lamp_locked = (in.take<std::uint8_t>() & lamp_locked_flag) != 0;
  for (std::uint32_t* value :
       {&read.next_number, &read.echo, &read.last_command, &read.free_points, &read.received,
        &read.first_unfired, &read.shots, &read.beats, &read.beats_before, &read.starvations})
    *value = in.take<std::uint32_t>();
  for (std::uint32_t& beats : read.beats_by_reason) beats = in.take<std::uint32_t>();
  for (std::uint32_t& beats : read.beats_outside) beats = in.take<std::uint32_t>();
  for (std::uint32_t* value :
       {&read.shots_made, &read.shots_not_made, &read.repeats, &read.link.bad_frames,
        &read.link.duplicates, &read.link.out_of_order, &read.link.lost_lines,
        &read.link.transmit_overflows, &read.free_runs})
    *value = in.take<std::uint32_t>();
  if (!in.exhausted() || read.state > MachineState::home) return false;
  status = read;
  return true;
}

}  // namespace lamplock::wire
