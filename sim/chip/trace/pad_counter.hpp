// Counts the edges of all pads.
//
// In:  the pads. Out: numbers for a summary. Who: the owner of a chip; listens from construction
//      on.
#pragma once

#include <array>
#include <cstdint>

#include "sim/chip/chip.hpp"

namespace lamplock::sim::chip {

/// Edges of one pad.
struct PadCount {
  std::uint64_t rises = 0, falls = 0;
  Picoseconds first_rise = 0, last_rise = 0;
  std::uint64_t edges() const { return rises + falls; }
  /// Mean frequency of the rising edges; 0: fewer than two.
  double hz() const {
    if (rises < 2) return 0;
    return static_cast<double>(rises - 1) / seconds(last_rise - first_rise);
  }
};

/// Counts of all pads of one chip; must live as long as the chip runs.
class PadCounter final : private PadListener {
 public:
  explicit PadCounter(Chip& chip) : wheel_(chip.wheel()) {
    chip.gpio().listen(static_cast<PadListener&>(*this));
  }
  PadCounter(const PadCounter&) = delete;
  PadCounter& operator=(const PadCounter&) = delete;

  const std::array<PadCount, gpio_count>& pads() const { return pads_; }

 private:
  void pad_changed(unsigned gpio, bool level, Cycle at) override {
    PadCount& pad = pads_[gpio];
    if (!level) {
      ++pad.falls;
      return;
    }
    pad.last_rise = wheel_.time_of(at);
    if (pad.rises++ == 0) pad.first_rise = pad.last_rise;
  }

  const TimeWheel& wheel_;
  std::array<PadCount, gpio_count> pads_{};
};

}  // namespace lamplock::sim::chip
