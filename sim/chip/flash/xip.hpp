// Execution in place: XIP_CTRL (RP2040 datasheet, 2.6.3), the SSI and the flash chip on the bus.
//
// In:  registers of XIP_CTRL, XIP_SSI, IO_QSPI, PADS_QSPI; power.
// Out: the flash's contents in the XIP window while the SSI is set so that reads work; nobody there
//      otherwise (the bus faults and reports).
// Reads of the window are plain memory: without the cache's misses. XipCache below is that cache by
// itself, ready for the bus to ask.
#pragma once

#include <array>
#include <cstdint>

#include "sim/chip/bus.hpp"
#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/qspi_pins.hpp"
#include "sim/chip/flash/ssi.hpp"
#include "sim/chip/peripheral.hpp"

namespace lamplock::sim::chip {

/// The cache: 16 KiB, two ways, lines of eight bytes (2.6.3.1). Which way is replaced is not
/// documented: assumed the one used longer ago.
class XipCache {
 public:
  static constexpr std::uint32_t set_count = 1024;

  /// An access to a flash offset (24 bits) in the caching window: true if it hits; a miss fills.
  bool access(std::uint32_t offset) {
    ++accesses_;
    const std::uint32_t line = (offset & 0xff'ffffu) >> 3;
    Set& set = sets_[line % set_count];
    const std::uint32_t tag = line / set_count + 1;
    for (unsigned way = 0; way < 2; ++way) {
      if (set.tags[way] != tag) continue;
      set.oldest = way ^ 1u;
      ++hits_;
      return true;
    }
    set.tags[set.oldest] = tag;
    set.oldest ^= 1u;
    return false;
  }
  /// A write to the caching window drops the line.
  void invalidate(std::uint32_t offset);
  void flush() { sets_ = {}; }

  std::uint32_t hits() const { return hits_; }
  std::uint32_t accesses() const { return accesses_; }

 private:
  struct Set {
    std::array<std::uint32_t, 2> tags{};  ///< 0: empty
    unsigned oldest = 0;
  };
  std::array<Set, set_count> sets_{};
  std::uint32_t hits_ = 0;
  std::uint32_t accesses_ = 0;
};

/// Everything about execution in place.
class Xip {
 public:
  Xip(TimeWheel& wheel, Bus& bus, FlashChip& flash, NotModelled not_modelled);
  Xip(const Xip&) = delete;
  Xip& operator=(const Xip&) = delete;

  Ssi& ssi() { return ssi_; }
  QspiPins& pins() { return pins_; }
  Peripheral& control() { return control_; }

  /// SSI and XIP_CTRL take their reset values; the pins have a reset of their own (RESETS).
  void reset();
  /// Power fails: the flash stops where it is, everything here takes its reset values.
  void power_cut();

 private:
  struct Control final : Peripheral {
    explicit Control(Xip& xip) : owner(xip) {}
    std::string_view name() const override { return "XIP_CTRL"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    Xip& owner;
    std::uint32_t setting = 3;
  };

  Bus& bus_;
  FlashChip& flash_;
  NotModelled not_modelled_;
  QspiPins pins_;
  Ssi ssi_;
  Control control_;
  std::array<std::uint8_t, 16 * 1024> cache_as_memory_{};
};

}  // namespace lamplock::sim::chip
