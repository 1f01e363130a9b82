// WATCHDOG: countdown, forced reset, scratch registers, tick generator (RP2040 datasheet, 4.7).
//
// In:  ticks; registers.
// Out: a call when it fires. WDSEL of PSM and RESETS select what is reset then.
// Who: the bus; the wheel when the countdown ends.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/tick_generator.hpp"

namespace lamplock::sim::chip {

/// The watchdog. It and its scratch registers are reset by power-up and RUN only.
class Watchdog final : public Peripheral, private Timed, private TickListener {
 public:
  using Fired = std::function<void()>;
  Watchdog(TimeWheel& wheel, TickGenerator& ticks, NotModelled not_modelled, Fired fired);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  std::string_view name() const override { return "WATCHDOG"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  /// Whether the last reset was one that software forced (TRIGGER).
  bool was_forced() const;
  /// Power-up or RUN.
  void reset() override;
  /// Its clock stops or starts: the count stops, ticks and registers do not (assumed).
  void set_clock(bool runs);

 private:
  static constexpr std::size_t scratch_count = 8;

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void ticks_moved() override { schedule(); }
  std::uint32_t count() const;
  void hold_count();
  void schedule();
  void fire(std::uint32_t reason);
  void write_control(std::uint32_t value);

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  TickGenerator& ticks_;
  NotModelled not_modelled_;
  Fired fired_;
  std::uint32_t control_ = 0;
  std::uint32_t base_count_ = 0;  ///< at base_ticks_
  std::uint64_t base_ticks_ = 0;
  std::uint32_t reason_ = 0;
  std::uint32_t tick_ = 0;
  std::array<std::uint32_t, scratch_count> scratch_{};
  bool stopped_ = false;    ///< no clock
  bool exhausted_ = false;  ///< has fired and was not loaded since
};

}  // namespace lamplock::sim::chip
