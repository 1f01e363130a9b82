// Clock sources: crystal, ring oscillator and the two PLLs (RP2040 datasheet, 2.16-2.18).
//
// In:  registers; simulated time.
// Out: the frequency each of them gives now (0: none), and a call when that changes.
// Who: Clocks selects among them; the bus reaches the registers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/clock_counter.hpp"

namespace lamplock::sim::chip {

/// Called after the frequency of a source has changed.
using SourceChanged = std::function<void()>;

/// The end of a start-up time: a moment in real time, independent of clk_sys.
class Deadline : private Timed {
 public:
  Deadline(TimeWheel& wheel, std::function<void()> reached)
      : wheel_(wheel), slot_(wheel.add(*this)), reached_(std::move(reached)) {}
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  void start(Picoseconds delay) {
    time_ = wheel_.time() + delay;
    running_ = true;
    wheel_.set(slot_, wheel_.cycle_at(time_));
  }
  void cancel() {
    running_ = false;
    wheel_.set(slot_, never_cycle);
  }
  bool running() const { return running_; }

 private:
  void run(Cycle) override {
    if (!running_) return;
    running_ = false;
    reached_();
  }
  void clock_changed() override {
    if (running_) wheel_.set(slot_, wheel_.cycle_at(time_));
  }

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  std::function<void()> reached_;
  Picoseconds time_ = 0;
  bool running_ = false;
};

/// The counter of XOSC and ROSC: counts down to zero at the oscillator's frequency.
class PauseCounter {
 public:
  explicit PauseCounter(TimeWheel& wheel) : wheel_(wheel) {}
  void write(std::uint32_t value, std::uint64_t hz);
  std::uint32_t read() const;

 private:
  TimeWheel& wheel_;
  std::uint32_t start_ = 0;
  ClockCounter counter_;  ///< since it was written
};

/// The crystal oscillator; 12 MHz on a Pico.
class Xosc final : public Peripheral {
 public:
  static constexpr std::uint64_t pico_crystal_hz = 12'000'000;
  Xosc(TimeWheel& wheel, NotModelled not_modelled);

  std::uint64_t hz() const { return stable_ ? pico_crystal_hz : 0; }
  void on_change(SourceChanged changed) { changed_ = std::move(changed); }

  std::string_view name() const override { return "XOSC"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;

 private:
  void write_control(std::uint32_t value);
  void set_stable(bool stable);

  NotModelled not_modelled_;
  SourceChanged changed_;
  std::uint32_t control_ = 0, startup_ = 0;
  bool enabled_ = false, stable_ = false, bad_write_ = false;
  Deadline start_up_;
  PauseCounter counter_;
};

/// The ring oscillator. Its frequency varies from chip to chip and with temperature; the nominal
/// one is assumed for the eight stages with the weakest drive. FREQ_RANGE removes stages from the
/// ring (2.17.3), a stage's bits of FREQA, FREQB multiply its drive (2.17.4). It is assumed that
/// the delay of a stage is the inverse of its drive, and the same for all stages.
class Rosc final : public Peripheral {
 public:
  /// 6.5 MHz nominally after the reset divider of 16 (2.17.1: 1.8 to 12 MHz).
  static constexpr std::uint64_t nominal_ring_hz = 104'000'000;
  Rosc(TimeWheel& wheel, NotModelled not_modelled);

  std::uint64_t hz() const { return enabled_ ? ring_frequency() / divisor() : 0; }
  void on_change(SourceChanged changed) { changed_ = std::move(changed); }

  std::string_view name() const override { return "ROSC"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;

 private:
  std::uint32_t divisor() const;
  std::uint64_t ring_frequency() const;
  void write_control(std::uint32_t value);

  NotModelled not_modelled_;
  SourceChanged changed_;
  std::uint32_t control_ = 0, frequency_a_ = 0, frequency_b_ = 0, divider_ = 0, phase_ = 0;
  std::uint32_t random_ = 1;
  bool enabled_ = true, bad_write_ = false;
  PauseCounter counter_;
};

/// PLL_SYS or PLL_USB, fed by the crystal.
class Pll final : public Peripheral {
 public:
  /// From power-up or a new feedback divisor to LOCK, in cycles of the divided reference. Not
  /// documented; assumed.
  static constexpr std::uint64_t lock_reference_cycles = 240;
  Pll(std::string_view name, TimeWheel& wheel, const Xosc& xosc, NotModelled not_modelled);

  std::uint64_t hz() const;
  void on_change(SourceChanged changed) { changed_ = std::move(changed); }
  /// The crystal has started or stopped.
  void reference_changed();

  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  std::uint64_t reference_hz() const;
  bool powered() const;
  void relock();
  void report();

  std::string name_;
  const Xosc& xosc_;
  NotModelled not_modelled_;
  SourceChanged changed_;
  std::uint32_t control_ = 0, power_ = 0, feedback_ = 0, post_dividers_ = 0;
  bool locked_ = false;
  Deadline lock_;
};

}  // namespace lamplock::sim::chip
