// The frame of a UART: line levels of a character, and the character received from line levels
// (RP2040 datasheet, 4.2.3 and 4.2.4; ARM PrimeCell UART PL011 manual, "UART operation").
//
// In:  characters; levels of the line with their time.
// Out: levels of the line; characters with their errors, at the middle of the stop bit.
// Who: Uart.
//
// The receiver counts Baud16, sixteen of which are a bit. After a falling edge of the idle line it
// samples at the eighth count: still low, it is a start bit; then at every sixteenth for data,
// parity and one stop bit, however many stop bits are set.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/world/time.hpp"

namespace lamplock::sim::chip {

/// Form of the frames, from LCR_H, and the time of a bit (0: the rate is not set).
struct UartFormat {
  unsigned data_bits = 8;  ///< 5 to 8
  bool parity = false, even = false, stick = false, two_stops = false;
  Picoseconds bit = 0;

  static UartFormat from(std::uint32_t line_control, Picoseconds bit) {
    const auto set = [line_control](unsigned n) { return (line_control >> n & 1u) != 0; };
    return {5 + (line_control >> 5 & 3u), set(1), set(2), set(7), set(3), bit};
  }
  /// Bits from the start bit to the last before the stop bits.
  unsigned bits_before_stop() const { return 1 + data_bits + (parity ? 1u : 0u); }
  unsigned bits() const { return bits_before_stop() + (two_stops ? 2u : 1u); }
  std::uint32_t data_mask() const { return (1u << (data_bits & 15u)) - 1; }
  Picoseconds length() const { return bit * static_cast<Picoseconds>(bits()); }
  /// From the beginning of a frame to where the receiver samples its stop bit.
  Picoseconds to_stop_sample() const {
    return bit * static_cast<Picoseconds>(bits_before_stop()) + bit / 2;
  }
  /// The parity bit of the data: with "stick" always 1, or 0 for even.
  bool parity_bit(std::uint32_t data) const;
};

/// One character being sent.
class UartFrame {
 public:
  UartFrame() = default;
  UartFrame(std::uint32_t data, const UartFormat& format, Picoseconds start);
  bool level(Picoseconds at) const { return (levels_ >> index(at) & 1u) != 0; }
  /// When the level changes next after `at`; never: it stays high.
  Picoseconds next_change(Picoseconds at) const;
  /// Time has been stopped for this long.
  void delay(Picoseconds time) { start_ += time; }

 private:
  unsigned index(Picoseconds at) const;

  std::uint32_t levels_ = ~0u;  ///< bit 0 first; high after the stop bits
  Picoseconds start_ = 0, bit_ = 1;
};

/// A character as in DR: data and error bits.
namespace uart_data {
inline constexpr std::uint32_t framing_error = 1u << 8;
inline constexpr std::uint32_t parity_error = 1u << 9;
inline constexpr std::uint32_t break_error = 1u << 10;
inline constexpr std::uint32_t overrun_error = 1u << 11;
}  // namespace uart_data

/// Receives characters from the levels of the line.
class UartReceiver {
 public:
  /// Drops a frame under way.
  void reset(bool level);
  /// The line has this level from `at` on. A frame that begins now has this form; a bit time of 0:
  /// the receiver is off. Samples before `at` are taken first: returns what was complete by then.
  std::optional<std::uint32_t> line(bool level, Picoseconds at, const UartFormat& format);
  /// Takes all samples up to and including `through`.
  std::optional<std::uint32_t> run(Picoseconds through);
  /// The next sample.
  Picoseconds due() const { return busy_ ? sample_at_ : never; }
  /// Time has been stopped for this long.
  void delay(Picoseconds time) {
    start_ += time;
    sample_at_ += time;
  }

 private:
  std::optional<std::uint32_t> sample();
  std::uint32_t character() const;

  UartFormat format_;
  bool level_ = true;
  bool busy_ = false;
  bool awaits_mark_ = false;  ///< after a break or a wrong stop bit the line must be high first
  Picoseconds start_ = 0, sample_at_ = 0;
  unsigned index_ = 0;         ///< of the next sample; 0 is the start bit
  std::uint32_t sampled_ = 0;  ///< bit n: sample n
};

}  // namespace lamplock::sim::chip
