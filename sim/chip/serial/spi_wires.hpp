// The wires of an SPI block in Motorola format, half a bit at a time (RP2040 datasheet, 4.4.3.9 to
// 4.4.3.13): the levels it drives, and the bits it receives as a slave.
//
// In:  a word and its shape; as a slave, levels of SCK, CSn and RX.
// Out: levels of SCK and TX in each half bit; words from the master.
// Who: Spi.
//
// Half bits count from the fall of CSn, or with SPH 1 from the last capture of the word before. TX
// has its first bit from half bit 1 on. Captures are at 2, 4 .. 2N: with SPH 0 on the first edges
// of SCK (high in half bits 2, 4 .. 2N), with SPH 1 on the second ones (high in 1, 3 .. 2N - 1).
// SPO inverts SCK.
#pragma once

#include <cstdint>
#include <optional>

namespace lamplock::sim::chip {

/// DSS, SPO and SPH.
struct SpiShape {
  unsigned bits = 8;
  bool polarity = false, phase = false;

  bool sck(unsigned half) const {
    const bool active =
        phase ? half % 2 == 1 && half < 2 * bits : half % 2 == 0 && half >= 2 && half <= 2 * bits;
    return active != polarity;
  }
  /// Level of TX; before half bit 1 it keeps the last level of the word before.
  bool tx(std::uint16_t word, unsigned half) const {
    const unsigned bit = half < 1 ? 0 : (half - 1) / 2;
    return (word >> (bit < bits ? bits - 1 - bit : 0) & 1u) != 0;
  }
  bool captures(unsigned half) const { return half % 2 == 0 && half >= 2 && half <= 2 * bits; }
  /// The last half bit in which something changes.
  unsigned last_half() const { return 2 * bits + 1; }
};

/// A slave's shift register: the word it sends, and the bits received.
class SpiSlaveShifter {
 public:
  /// CSn has gone low: a word begins. With SPH 0 its first bit is on TX at once.
  void select(const SpiShape& shape) {
    shape_ = shape;
    selected_ = true;
    open_ = true;
    captured_ = 0;
    shifted_ = shape.phase ? 0 : 1;
    received_ = 0;
    sck_ = shape.polarity;
  }
  void deselect() { selected_ = open_ = false; }
  bool selected() const { return selected_; }
  /// True when the word to send must be set: with its first bit.
  bool wants_word() const {
    return open_ && shifted_ == (shape_.phase ? 0u : 1u) && captured_ == 0;
  }
  void send(std::uint16_t word) { word_ = word; }
  bool tx() const {
    const unsigned bit = shifted_ == 0 ? 0 : shifted_ - 1;
    return (word_ >> (bit < shape_.bits ? shape_.bits - 1 - bit : 0) & 1u) != 0;
  }
  /// SCK has this level now, RX had the given one; returns a word when it is complete.
  std::optional<std::uint16_t> clock(bool sck, bool rx) {
    if (!open_ || sck == sck_) return std::nullopt;
    sck_ = sck;
    const bool leading = sck != shape_.polarity;
    if (leading == shape_.phase) {
      ++shifted_;
      return std::nullopt;
    }
    received_ = static_cast<std::uint16_t>(received_ * 2u + (rx ? 1u : 0u));
    if (++captured_ < shape_.bits) return std::nullopt;
    const std::uint16_t word = received_;
    captured_ = shifted_ = 0;
    received_ = 0;
    // With SPH 0 the next word needs another edge of CSn.
    open_ = shape_.phase;
    return word;
  }

 private:
  SpiShape shape_;
  bool selected_ = false;
  bool open_ = false;  ///< takes bits
  bool sck_ = false;
  unsigned captured_ = 0, shifted_ = 0;
  std::uint16_t word_ = 0, received_ = 0;
};

}  // namespace lamplock::sim::chip
