// Registers common to ARM's PrimeCells UART (PL011) and SSP (PL022).
//
// In:  accesses; raised interrupts, which the block keeps.
// Out: IMSC, RIS, MIS; the identification of the part.
// Who: Uart, Spi.
//
// IMSC, RIS, MIS and ICR are four words in a row, with another first offset and other bits in each
// part; the eight words of identification are the last ones of both (PL011 and PL022 manuals, 3.3).
// Unlike INTS of the other blocks of the RP2040, MIS has no bits that are forced. The block defines
// what a write to ICR clears.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::sim::chip {

/// The interrupt registers and the identification of one PrimeCell.
class PrimeCell {
 public:
  static constexpr std::uint32_t offset_identification = 0xfe0;  // PERIPHID0-3, PCELLID0-3

  /// Offset of IMSC; the existing interrupts; the last two digits of the part's number, as in
  /// PERIPHID0.
  constexpr PrimeCell(std::uint32_t first, std::uint32_t bits, std::uint32_t part)
      : first_(first), bits_(bits), part_(part) {}

  void reset() { mask_ = 0; }
  std::uint32_t masked(std::uint32_t raised) const { return raised & mask_; }

  /// Zero for other offsets, and for ICR.
  std::uint32_t read(std::uint32_t offset, std::uint32_t raised) const {
    if (offset >= offset_identification) return identification(offset);
    switch (offset - first_) {
      case at_mask:
        return mask_;
      case at_raised:
        return raised;
      case at_masked:
        return masked(raised);
      default:
        return 0;
    }
  }
  /// Stores IMSC. False: another register.
  bool write(std::uint32_t offset, std::uint32_t value) {
    if (offset == first_ + at_mask) mask_ = value & bits_;
    return offset - first_ <= at_clear || offset >= offset_identification;
  }

 private:
  static constexpr std::uint32_t at_mask = 0x0, at_raised = 0x4, at_masked = 0x8, at_clear = 0xc;

  std::uint32_t identification(std::uint32_t offset) const {
    constexpr std::array<std::uint32_t, 8> bytes{0, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1};
    const std::uint32_t byte = (offset - offset_identification) / 4 % bytes.size();
    return byte == 0 ? part_ : bytes[byte];
  }

  std::uint32_t first_, bits_, part_;
  std::uint32_t mask_ = 0;
};

}  // namespace lamplock::sim::chip
