// The 1 us reference: clk_ref divided by a number of cycles (RP2040 datasheet, 4.7.2).
//
// In:  WATCHDOG TICK; the frequency of clk_ref.
// Out: the number of ticks so far; the cycle of clk_sys of a future tick.
// Who: Watchdog sets it; it and Timer count its ticks. Nothing happens per tick.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/clock_counter.hpp"
#include "sim/chip/system/clocks.hpp"

namespace lamplock::sim::chip {

/// Called when future ticks have moved: cycles returned before are no longer right.
class TickListener {
 public:
  virtual ~TickListener() = default;
  virtual void ticks_moved() = 0;
};

/// Ticks as a function of time, exact for any relation of clk_sys and clk_ref.
class TickGenerator final : private ClockListener {
 public:
  TickGenerator(TimeWheel& wheel, Clocks& clocks);
  TickGenerator(const TickGenerator&) = delete;
  TickGenerator& operator=(const TickGenerator&) = delete;

  /// A tick every `cycles` of clk_ref, the first one `cycles` from now; 0 or not enabled: none.
  void configure(std::uint32_t cycles, bool enabled);
  bool running() const { return enabled_; }
  /// Ticks up to now.
  std::uint64_t ticks() const;
  /// Cycles of clk_ref until the next tick.
  std::uint32_t remaining() const;
  /// First cycle of clk_sys at which ticks() is `tick` or more; never_cycle: none is foreseeable.
  Cycle cycle_of(std::uint64_t tick) const;
  void listen(TickListener& listener) { listeners_.push_back(&listener); }

 private:
  void clocks_changed() override;
  bool counting() const { return enabled_ && cycles_ != 0 && counter_.hz() != 0; }
  void report();

  TimeWheel& wheel_;
  Clocks& clocks_;
  std::vector<TickListener*> listeners_;
  std::uint32_t cycles_ = 0;
  bool enabled_ = false;
  ClockCounter counter_;          ///< of clk_ref since it was configured
  std::uint64_t base_ticks_ = 0;  ///< up to then
};

}  // namespace lamplock::sim::chip
