// The 32 interrupt lines between peripherals and the two cores (RP2040 datasheet, 2.3.2).
//
// Lines are levels: a peripheral raises its line as long as the condition lasts; each core's NVIC
// samples the lines and latches them.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::sim::chip {

/// Numbers of the lines, as the datasheet lists them.
enum class Irq : std::uint8_t {
  timer_0,
  timer_1,
  timer_2,
  timer_3,
  pwm_wrap,
  usbctrl,
  xip,
  pio0_0,
  pio0_1,
  pio1_0,
  pio1_1,
  dma_0,
  dma_1,
  io_bank0,
  io_qspi,
  sio_proc0,
  sio_proc1,
  clocks,
  spi0,
  spi1,
  uart0,
  uart1,
  adc_fifo,
  i2c0,
  i2c1,
  rtc
};
inline constexpr int irq_line_count = 26;

/// Levels of all lines. All go to both cores, except those of the GPIO banks, of which each core
/// has its own (2.3.2); SIO_IRQ_PROC0/1 are two lines, both seen by both cores.
class IrqLines {
 public:
  void set(Irq line, bool level) {
    const std::uint32_t bit = 1u << static_cast<unsigned>(line);
    const std::uint32_t levels = level ? levels_ | bit : levels_ & ~bit;
    if (levels == levels_) return;
    levels_ = levels;
    ++changes_;
  }
  /// A line that goes to one core (0 or 1) only: io_bank0, io_qspi.
  void set_for_core(int core, Irq line, bool level) {
    std::uint32_t& own = own_levels_[static_cast<unsigned>(core)];
    const std::uint32_t bit = 1u << static_cast<unsigned>(line);
    const std::uint32_t levels = level ? own | bit : own & ~bit;
    if (levels == own) return;
    own = levels;
    ++changes_;
  }
  /// Levels that a core sees.
  std::uint32_t levels(int core = 0) const {
    return levels_ | own_levels_[static_cast<unsigned>(core)];
  }
  /// Counts changes, so that a core samples only after a change.
  std::uint32_t changes() const { return changes_; }

 private:
  std::uint32_t levels_ = 0;
  std::array<std::uint32_t, 2> own_levels_{};
  std::uint32_t changes_ = 0;
};

}  // namespace lamplock::sim::chip
