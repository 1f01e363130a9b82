// The DMA's sniffer: a checksum over the data that passes (RP2040 datasheet, 2.5.5.2).
//
// In:  transfers of the channel it watches. Out: SNIFF_DATA.
// The CRCs shift the data in from the top bit of the transfer; the "reversed" ones reverse the bits
// of the whole transfer first, so that the lowest bit of the lowest byte comes first.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip {

/// SNIFF_CTRL and SNIFF_DATA.
class Sniffer {
 public:
  void reset() { *this = {}; }
  std::uint32_t control() const { return control_; }
  void set_control(std::uint32_t value) { control_ = value & 0xfffu; }
  bool watches(unsigned channel) const {
    return (control_ & 1u) != 0 && (control_ >> 1 & 0xfu) == channel;
  }
  /// The result as it appears on the bus: OUT_REV, OUT_INV.
  std::uint32_t data() const;
  void set_data(std::uint32_t value) { data_ = value; }
  /// A transfer of `bits` (8, 16, 32), after the channel's own byte swap.
  void observe(std::uint32_t value, unsigned bits);

 private:
  void shift_in(std::uint32_t value, unsigned bits, std::uint32_t polynomial, unsigned width);
  std::uint32_t control_ = 0;
  std::uint32_t data_ = 0;
};

}  // namespace lamplock::sim::chip
