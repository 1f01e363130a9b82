// GPOUT0 to GPOUT3: clocks on pins (RP2040 datasheet, 2.15.3.4).
//
// In:  source and divisor of each of the four generators.
// Out: levels on GPIO 21, 23, 24, 25, in the cycle of clk_sys in which or after which they change.
// Who: Clocks; the wheel at each edge of an output that a pin shows. A clock on no pin costs
//      nothing.
//
// An output is low for half a period from its set-up, then high for the other half. The edges of a
// clock faster than half of clk_sys are closer than the simulated cycles: it is reported and not
// shown. Not modelled: the jitter of fractional divisors (edges are at their mean position), the
// uneven halves of odd ones without DC50, PHASE and NUDGE.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"

namespace lamplock::sim::chip {

class ClockOutputs final : private Timed, private FunctionPins::User {
 public:
  static constexpr std::size_t output_count = 4;

  ClockOutputs(TimeWheel& wheel, FunctionPins& pins, NotModelled not_modelled);
  ClockOutputs(const ClockOutputs&) = delete;
  ClockOutputs& operator=(const ClockOutputs&) = delete;

  /// The output has a source of this frequency divided by a number in 24.8 fixed point from now on;
  /// 0 Hz: it is low. Must also be called with the same values after the frequency of clk_sys has
  /// changed.
  void set(std::size_t output, std::uint64_t source_hz, std::uint64_t divisor_q8);

 private:
  struct Output {
    std::uint64_t source_hz = 0, divisor = 0x100;
    Picoseconds since = 0;
    std::uint64_t edges = 0;  ///< that have passed; odd: high
  };

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void pins_changed(Cycle at) override;
  void pins_connecting(Cycle at) override;
  bool connected(std::size_t output) const;
  bool slow_enough(std::size_t output) const;
  bool shown(std::size_t output) const { return connected(output) && slow_enough(output); }
  void report_too_fast(std::size_t output) const;
  std::uint64_t edges_until(const Output& output, Picoseconds time) const;
  Picoseconds time_of_edge(const Output& output, std::uint64_t edge) const;
  void drive(std::size_t output, Cycle at);
  void schedule();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  FunctionPins& pins_;
  NotModelled not_modelled_;
  std::array<Output, output_count> outputs_{};
};

}  // namespace lamplock::sim::chip
