// RESETS: which blocks are held in reset (RP2040 datasheet, 2.14).
//
// In:  registers; the watchdog.
// Out: a block whose bit is set takes its reset values and keeps them until it is released; writes
//      to it are lost, and reported.
// Who: the bus; System, which attaches the blocks by bit.
#pragma once

#include <cstdint>
#include <deque>
#include <string_view>

#include "sim/chip/fabric/peripheral.hpp"

namespace lamplock::sim::chip {

/// Bits of RESET, WDSEL and RESET_DONE (2.14.3).
enum class ResetBit : std::uint8_t {
  adc,
  busctrl,
  dma,
  i2c0,
  i2c1,
  io_bank0,
  io_qspi,
  jtag,
  pads_bank0,
  pads_qspi,
  pio0,
  pio1,
  pll_sys,
  pll_usb,
  pwm,
  rtc,
  spi0,
  spi1,
  syscfg,
  sysinfo,
  tbman,
  timer,
  uart0,
  uart1,
  usbctrl
};

/// The subsystem resets. After power-up all blocks are held.
class Resets final : public Peripheral {
 public:
  explicit Resets(NotModelled not_modelled);
  Resets(const Resets&) = delete;
  Resets& operator=(const Resets&) = delete;

  /// Attaches a block to a bit (several may share one). The bus must reach it through the result.
  Peripheral& attach(ResetBit bit, Peripheral& block);
  bool held(ResetBit bit) const { return (reset_ >> static_cast<unsigned>(bit) & 1u) != 0; }
  /// The clock of a block's registers stops or starts (CLOCKS WAKE_EN, SLEEP_EN). The effect of an
  /// access without it is not documented: it is reported and does nothing.
  void set_clock(ResetBit bit, bool runs) {
    const std::uint32_t mask = 1u << static_cast<unsigned>(bit);
    stopped_ = runs ? stopped_ & ~mask : stopped_ | mask;
  }
  /// The watchdog has fired: what WDSEL selects is reset.
  void watchdog_fired();

  std::string_view name() const override { return "RESETS"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  /// A block as the bus sees it.
  class Gate final : public Peripheral {
   public:
    Gate(Resets& resets, ResetBit bit, Peripheral& block)
        : resets_(resets), bit_(bit), block_(block) {}
    std::string_view name() const override { return block_.name(); }
    std::uint32_t read(std::uint32_t offset) override {
      if (resets_.answers(bit_)) return block_.read(offset);
      report();
      return block_.peek(offset);
    }
    std::uint32_t peek(std::uint32_t offset) const override { return block_.peek(offset); }
    void write(std::uint32_t offset, std::uint32_t value) override {
      if (resets_.answers(bit_)) return block_.write(offset, value);
      report();
    }
    std::uint32_t write_clear_bits(std::uint32_t offset) const override {
      return block_.write_clear_bits(offset);
    }
    void reset() override { block_.reset(); }
    ResetBit bit() const { return bit_; }

   private:
    void report() const;
    Resets& resets_;
    ResetBit bit_;
    Peripheral& block_;
  };

  bool answers(ResetBit bit) const {
    return ((reset_ | stopped_) >> static_cast<unsigned>(bit) & 1u) == 0;
  }
  void reset_blocks(std::uint32_t bits);

  NotModelled not_modelled_;
  std::deque<Gate> gates_;  ///< references stay valid
  std::uint32_t reset_ = 0, watchdog_select_ = 0;
  std::uint32_t stopped_ = 0;  ///< blocks whose registers have no clock
};

}  // namespace lamplock::sim::chip
