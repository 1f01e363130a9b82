// Frame types and the header every frame has (docs/wire-format.md, section 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/result.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::wire {

/// Increased with every change that the other end would misinterpret.
inline constexpr std::uint16_t protocol_version = 3;

/// First byte of a frame's content.
enum class FrameType : std::uint8_t {
  query = 0x40,
  begin = 0x41,
  data = 0x42,
  end = 0x43,
  command = 0x44,
  status = 0x60,
  refused = 0x61,
};

/// Command of the host's user for a running job. Acts at once, out of sequence.
enum class Command : std::uint8_t {
  hold = 1,
  resume = 2,
  stop = 3,
  lamp_frequency = 4,  ///< value: mHz
  job_speed = 5        ///< value: percent of the job's speed, 1..140
};

/// Payload of COMMAND. Only some commands have a value.
struct CommandRequest {
  Command command = Command::hold;
  std::uint32_t value = 0;
  friend constexpr bool operator==(const CommandRequest&, const CommandRequest&) = default;
};
inline constexpr std::size_t max_command_size = 5;

constexpr bool has_value(Command command) { return command >= Command::lamp_frequency; }

constexpr void write_command(ByteWriter& out, const CommandRequest& request) {
  out.put(static_cast<std::uint8_t>(request.command));
  if (has_value(request.command)) out.put(request.value);
}

/// False if it is malformed or unknown.
constexpr bool read_command(std::span<const std::uint8_t> payload, CommandRequest& request) {
  ByteReader in(payload);
  CommandRequest read;
  read.command = static_cast<Command>(in.take<std::uint8_t>());
  if (has_value(read.command)) read.value = in.take<std::uint32_t>();
  if (!in.exhausted() || read.command < Command::hold || read.command > Command::job_speed)
    return false;
  request = read;
  return true;
}

/// Header of a frame.
struct FrameHeader {
  FrameType type = FrameType::query;
  std::uint32_t session = 0;  ///< 0 = none
  std::uint32_t number = 0;   ///< meaning depends on the type
};
inline constexpr std::size_t frame_header_size = 1 + 4 + 4;
inline constexpr std::size_t max_payload = max_content - frame_header_size - crc_size;
static_assert(max_payload == 499);

constexpr void write_header(ByteWriter& out, const FrameHeader& header) {
  out.put(static_cast<std::uint8_t>(header.type));
  out.put(header.session);
  out.put(header.number);
}

/// Reads the header; the reader's ok() is false if it was incomplete. The type may be unknown.
constexpr FrameHeader read_header(ByteReader& in) {
  FrameHeader header;
  header.type = static_cast<FrameType>(in.take<std::uint8_t>());
  header.session = in.take<std::uint32_t>();
  header.number = in.take<std::uint32_t>();
  return header;
}

/// Payload of REFUSED.
struct Refused {
  FrameType type = FrameType::begin;  ///< of the frame that was refused
  Result result = Result::ok;
  std::uint32_t value = 0;  ///< setting number (BEGIN) or index of the point (DATA)
};
inline constexpr std::size_t refused_size = 6;

constexpr void write_refused(ByteWriter& out, const Refused& refused) {
  out.put(static_cast<std::uint8_t>(refused.type));
  out.put(static_cast<std::uint8_t>(refused.result));
  out.put(refused.value);
}

constexpr Refused read_refused(ByteReader& in) {
  Refused refused;
  refused.type = static_cast<FrameType>(in.take<std::uint8_t>());
  refused.result = static_cast<Result>(in.take<std::uint8_t>());
  refused.value = in.take<std::uint32_t>();
  return refused;
}

}  // namespace lamplock::wire
