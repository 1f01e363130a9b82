// Packets of the GDB remote serial protocol (manual "Debugging with GDB", appendix E.1).
//
// In:  bytes of a debugger, in pieces of any size, possibly damaged; payloads to send.
// Out: payloads and interrupt requests in order; bytes for the debugger.
// Who: Stub. A packet is $payload#checksum; in the payload } announces a character that was XORed
//      with 0x20. Each packet is acknowledged by + or refused by - until both sides agree to stop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lamplock::sim::chip::gdb {

/// The framing layer of one connection.
class Packets {
 public:
  /// Maximum length of a payload on the line, as announced to the debugger.
  static constexpr std::size_t max_size = 0x4000;

  /// What the debugger has sent.
  struct Received {
    bool interrupt = false;  ///< ctrl-C (0x03) outside of a packet
    std::string payload;     ///< escapes resolved
  };

  void receive(std::span<const std::uint8_t> bytes);
  std::optional<Received> next();

  /// Puts a packet into the output.
  void send(std::string_view payload);
  /// Ends acknowledgements in both directions; a debugger that connects again begins with them.
  void stop_acknowledging();
  /// Returns and removes the bytes for the debugger.
  std::string take_output();

 private:
  enum class State : std::uint8_t { outside, payload, first_digit, second_digit };

  void receive_byte(std::uint8_t byte);
  void receive_outside(std::uint8_t byte);
  void finish(unsigned checksum);

  State state_ = State::outside;
  bool acknowledging_ = true;
  bool last_acknowledgement_due_ = false;  ///< of the answer that ended acknowledgements
  unsigned checksum_digit_ = 0;
  std::string raw_;   ///< payload as received
  std::string last_;  ///< packet sent last, for a repetition
  std::string output_;
  std::deque<Received> received_;
};

/// Value of a hexadecimal digit; empty if it is not one.
std::optional<unsigned> hex_digit(char digit);
/// Two digits a byte.
std::string to_hex(std::span<const std::uint8_t> bytes);
std::string to_hex(std::string_view bytes);
/// Empty if there is an odd digit or a character that is not a digit.
std::optional<std::string> from_hex(std::string_view digits);

}  // namespace lamplock::sim::chip::gdb
