// Execution in place: XIP_CTRL (RP2040 datasheet, 2.6.3), the SSI and the flash chip on the bus.
//
// In:  registers of XIP_CTRL and XIP_SSI; of IO_QSPI and PADS_QSPI, which the owner maps on the
//      bus; power.
// Out: the flash through the cache in the XIP window (XipMemory) while the SSI is set so that reads
//      work; otherwise only the cache's contents, and faults; the cache's memory while it is off;
//      words streamed for the DMA (XipStream).
#pragma once

#include <cstdint>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/xip_memory.hpp"
#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/qspi_pins.hpp"
#include "sim/chip/flash/ssi.hpp"

namespace lamplock::sim::chip {

class Xip {
 public:
  Xip(TimeWheel& wheel, Bus& bus, FlashChip& flash, NotModelled not_modelled);
  Xip(const Xip&) = delete;
  Xip& operator=(const Xip&) = delete;

  Ssi& ssi() { return ssi_; }
  QspiPins& pins() { return pins_; }
  /// Connects the requests to the DMA.
  void connect(DreqLines& dreqs);
  /// Counts the reads of the flash through the XIP window from now on; null: none.
  void count_use(FlashUse* use) { memory_.count_use(use); }

  /// SSI and XIP_CTRL take their reset values; the pins have a reset of their own (RESETS).
  void reset();
  /// Power fails: the flash stops in its operation, all registers here take their reset values.
  void power_cut();

 private:
  struct Control final : Peripheral {
    explicit Control(Xip& xip) : owner(xip) {}
    std::string_view name() const override { return "XIP_CTRL"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
    void reset() override;
    void set(std::uint32_t value);
    Xip& owner;
    std::uint32_t setting = 3;
  };

  TimeWheel& wheel_;
  Bus& bus_;
  NotModelled not_modelled_;
  QspiPins pins_;
  XipStream stream_;
  XipMemory memory_;
  Ssi ssi_;
  Control control_;
};

}  // namespace lamplock::sim::chip
