// INTR, INTE, INTF and INTS: four words in a row that many blocks of the RP2040 have.
//
// In:  accesses; raised interrupts (INTR), which the block keeps.
// Out: enabled interrupts, and those that reach the line (INTS).
// Who: TIMER, PWM, ADC, RTC, CLOCKS, USB; DMA and PIO, which have two lines each.
//
// INTR is the block's own: in TIMER and PWM it is latched and cleared by written ones, in DMA it
// can be cleared by way of INTS too, elsewhere it is a condition that lasts. IO_BANK0 has four
// words of each for its pins and keeps them by kind of event.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip {

/// The registers of one interrupt line.
class InterruptRegisters {
 public:
  /// Offset of INTR, and the bits that exist.
  constexpr InterruptRegisters(std::uint32_t first, std::uint32_t bits)
      : first_(first), bits_(bits) {}

  void reset() { enabled_ = forced_ = 0; }
  std::uint32_t enabled() const { return enabled_; }
  std::uint32_t status(std::uint32_t raised) const { return (raised & enabled_) | forced_; }

  /// Zero for other offsets.
  std::uint32_t read(std::uint32_t offset, std::uint32_t raised) const {
    switch (offset - first_) {
      case at_raised:
        return raised;
      case at_enable:
        return enabled_;
      case at_force:
        return forced_;
      case at_status:
        return status(raised);
      default:
        return 0;
    }
  }
  /// Stores INTE or INTF; the block handles a write to INTR. False: another register.
  bool write(std::uint32_t offset, std::uint32_t value) {
    const std::uint32_t at = offset - first_;
    if (at == at_enable) enabled_ = value & bits_;
    if (at == at_force) forced_ = value & bits_;
    return at <= at_status;
  }

 private:
  static constexpr std::uint32_t at_raised = 0x0, at_enable = 0x4, at_force = 0x8, at_status = 0xc;

  std::uint32_t first_, bits_;
  std::uint32_t enabled_ = 0, forced_ = 0;
};

}  // namespace lamplock::sim::chip
