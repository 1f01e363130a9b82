// Requests to the device on endpoint 0, and their answers.
//
// In:  SETUP packets (USB 2.0, chapter 9; PSTN 1.2, 6.3) and the data of those that have some.
// Out: a Reaction: the answer and the effect on the endpoints. No registers here.
// Who: ControlPipe, in the USB interrupt.
//
// A request that is unknown, not permitted in the present state or malformed is answered by a
// STALL, and the next SETUP starts again. Line coding, DTR, RTS and break are stored and otherwise
// ignored: actions of a host on opening a port (DTR, 1200 baud) must not reset a machine. A falling
// DTR is the end of the program that used the port (usb_serial.hpp, present()).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/boards/rp2040/usb/descriptors.hpp"

namespace lamplock::rp2040::usb {

/// USB 2.0, table 9-2.
struct SetupPacket {
  std::uint8_t type = 0;  ///< bmRequestType
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  /// From the two words of the stored packet.
  static constexpr SetupPacket from_words(std::uint32_t low, std::uint32_t high) {
    return {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(low >> 8),
            static_cast<std::uint16_t>(low >> 16), static_cast<std::uint16_t>(high),
            static_cast<std::uint16_t>(high >> 16)};
  }
  constexpr bool to_host() const { return (type & direction_in) != 0; }
};

/// The next stage of a control transfer.
enum class Answer : std::uint8_t {
  stall,
  acknowledge,  ///< no data: status stage
  send,         ///< data to the host
  receive,      ///< data from the host, to be handed to `received`
};

/// Effect on the endpoints, immediate except for the address.
enum class Effect : std::uint8_t {
  none,
  use_address,  ///< after the status stage: `address`
  configure,    ///< restart all endpoints
  deconfigure,
  restart,  ///< `pipes`: halt over, data toggle back to DATA0
  halt,     ///< `pipes`: answer by STALL
};

/// Set of endpoints other than 0.
using Pipes = std::uint8_t;
inline constexpr Pipes pipe_out = 1;
inline constexpr Pipes pipe_in = 2;
inline constexpr Pipes pipe_notify = 4;
inline constexpr Pipes pipe_stream_out = 8;
inline constexpr Pipes pipe_stream_in = 16;
/// By function: serial port, pulse stream.
inline constexpr std::array<Pipes, 2> out_pipes{pipe_out, pipe_stream_out};
inline constexpr std::array<Pipes, 2> in_pipes{pipe_in, pipe_stream_in};

/// Answer and effect of a SETUP packet.
struct Reaction {
  Answer answer = Answer::stall;
  Effect effect = Effect::none;
  Pipes pipes = 0;
  std::span<const std::uint8_t> data{};  ///< `send`: valid until the next SETUP
};

/// State of the device as defined by chapter 9.
class ControlRequests {
 public:
  /// PSTN 1.2, table 17.
  static constexpr std::size_t line_coding_size = 7;

  /// Serial number: 16 characters; missing ones are '0'.
  void set_serial_number(std::string_view text);

  Reaction setup(const SetupPacket& setup);
  /// Data of a request that was answered with `receive`; false: STALL.
  bool received(std::span<const std::uint8_t> data);
  /// The bus was reset: not configured, no address.
  void reset();

  bool configured() const { return configuration_ != 0; }
  std::uint8_t address() const { return address_; }
  std::span<const std::uint8_t> line_coding() const { return line_coding_; }
  /// A program has the port open, according to DTR.
  bool dtr() const { return (control_lines_ & 1) != 0; }
  /// How often DTR was raised.
  std::uint32_t opened() const { return opened_; }

 private:
  Reaction device_request(const SetupPacket& setup);
  Reaction interface_request(const SetupPacket& setup);
  Reaction endpoint_request(const SetupPacket& setup);
  Reaction class_request(const SetupPacket& setup);
  Reaction descriptor(const SetupPacket& setup) const;
  Reaction string(const SetupPacket& setup) const;
  Reaction set_address(const SetupPacket& setup);
  Reaction set_configuration(const SetupPacket& setup);
  Reaction reply_status(const SetupPacket& setup, bool flag);
  Reaction reply_byte(const SetupPacket& setup, std::uint8_t value);

  std::uint8_t configuration_ = 0;
  std::uint8_t address_ = 0;
  std::uint8_t control_lines_ = 0;
  Pipes halted_ = 0;
  std::uint32_t opened_ = 0;
  std::array<std::uint8_t, 2> reply_{};
  /// 115200 baud, 1 stop bit, no parity, 8 bits.
  std::array<std::uint8_t, line_coding_size> line_coding_ = {0x00, 0xC2, 0x01, 0x00, 0, 0, 8};
  std::array<std::uint8_t, 2 + 2 * serial_number_size> serial_number_ = no_serial_number();

  static constexpr std::array<std::uint8_t, 2 + 2 * serial_number_size> no_serial_number() {
    return string_descriptor("0000000000000000");
  }
};

}  // namespace lamplock::rp2040::usb
