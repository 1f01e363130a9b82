// SIO: what the cores access in one cycle (RP2040 datasheet, 2.3.1).
//
// In:  accesses of each core, through a block of registers of its own (Bus::map_sio); levels of the
//      pins, two flip-flops late.
// Out: GPIO outputs of software, mailboxes between the cores with their interrupts, spin locks,
//      dividers and interpolators.
// Who: the bus. Dividers and interpolators belong to a core; all else is shared.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/sio/divider.hpp"
#include "sim/chip/sio/interpolator.hpp"

namespace lamplock::sim::chip {

/// SIO of both cores. Levels of the QSPI pins (GPIO_HI_IN, in the order SCLK, SS, SD0-3) come from
/// `qspi_inputs`; nothing is driven on them from here.
class Sio {
 public:
  using QspiInputs = std::function<std::uint32_t()>;
  Sio(TimeWheel& wheel, Gpio& gpio, IrqLines& irqs, QspiInputs qspi_inputs,
      NotModelled not_modelled);
  Sio(const Sio&) = delete;
  Sio& operator=(const Sio&) = delete;

  /// The registers as core 0 or 1 sees them.
  Peripheral& core(int core) { return views_[static_cast<std::size_t>(core)]; }
  /// Sets the source of the cores' cycles: a divider runs in its own core's time, which may be
  /// before the wheel's after a flash miss of the other core. Without it, the wheel's time is used.
  void follow_cores(std::function<Cycle(std::size_t)> cycle_of) { cycle_of_ = std::move(cycle_of); }
  /// SYSCFG PROC_IN_SYNC_BYPASS: pins for which GPIO_IN bypasses the synchroniser.
  void set_synchroniser_bypass(std::uint32_t pins) { synchroniser_bypass_ = pins; }
  /// PSM resets SIO as a whole.
  void reset();

 private:
  static constexpr std::size_t fifo_depth = 8;

  /// State of one core.
  struct Own {
    Divider divider;
    Interpolator interpolator0{Interpolator::Kind::blend};
    Interpolator interpolator1{Interpolator::Kind::clamp};
    std::deque<std::uint32_t> inbox;  ///< from the other core
    bool read_on_empty = false;       ///< ROE
    bool write_on_full = false;       ///< WOF
  };
  class View final : public Peripheral {
   public:
    View(Sio& sio, std::size_t core) : sio_(sio), core_(core) {}
    std::string_view name() const override { return "SIO"; }
    std::uint32_t read(std::uint32_t offset) override { return sio_.read(core_, offset); }
    std::uint32_t peek(std::uint32_t offset) const override { return sio_.peek(core_, offset); }
    void write(std::uint32_t offset, std::uint32_t value) override {
      sio_.write(core_, offset, value);
    }
    std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
    void reset() override { sio_.reset(); }

   private:
    Sio& sio_;
    std::size_t core_;
  };

  std::uint32_t read(std::size_t core, std::uint32_t offset);
  std::uint32_t peek(std::size_t core, std::uint32_t offset) const;
  void write(std::size_t core, std::uint32_t offset, std::uint32_t value);
  std::uint32_t read_divider(std::size_t core, std::uint32_t offset);
  static void write_divider(Own& own, std::uint32_t offset, std::uint32_t value, Cycle at);
  void write_fifo(std::size_t core, std::uint32_t offset, std::uint32_t value);
  std::uint32_t fifo_status(std::size_t core) const;
  std::uint32_t gpio_in() const;
  void update_irqs();

  Cycle time_of(std::size_t core) const { return cycle_of_ ? cycle_of_(core) : wheel_.now(); }

  TimeWheel& wheel_;
  std::function<Cycle(std::size_t)> cycle_of_;
  Gpio& gpio_;
  IrqLines& irqs_;
  QspiInputs qspi_inputs_;
  NotModelled not_modelled_;
  std::array<View, 2> views_{View{*this, 0}, View{*this, 1}};
  std::array<Own, 2> own_{};
  std::uint32_t out_ = 0, enable_ = 0;  ///< GPIO 0-29
  std::uint32_t qspi_out_ = 0, qspi_enable_ = 0;
  std::uint32_t locks_ = 0;
  std::uint32_t synchroniser_bypass_ = 0;
};

}  // namespace lamplock::sim::chip
