// The levels that an I2C master drives on SCL and SDA in each condition and byte (RP2040 datasheet,
// 4.3.4, 4.3.14).
//
// In:  the condition, the times, the bits of a byte; cycles since it began.
// Out: levels (high: released) and the cycle of the next change.
// Who: I2c.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// One condition or byte. SCL is low first, except for START; SDA changes the hold time after the
/// fall of SCL.
struct I2cWires {
  enum class Kind : std::uint8_t { released, held, start, byte, restart, stop };
  struct Levels {
    bool scl = true, sda = true;
  };

  Kind kind = Kind::released;
  Cycle high = 0, low = 0, hold = 0;
  std::uint32_t bits = 0x1ff;  ///< nine, the first one highest; 1: released
  bool before = true;          ///< SDA when it began

  Levels at(Cycle elapsed) const {
    const bool held_over = elapsed < hold;
    switch (kind) {
      case Kind::start:
        return {true, false};
      case Kind::byte:
        return byte_at(elapsed);
      case Kind::restart:
        return {elapsed >= low, held_over ? before : elapsed < 2 * low};
      case Kind::stop:
        return {elapsed >= low, held_over && before};
      case Kind::held:
        return {false, held_over ? before : true};
      default:
        return {};
    }
  }
  /// never_cycle: nothing changes before the next condition.
  Cycle next_change(Cycle elapsed) const {
    const Cycle period = kind == Kind::byte ? low + high : never_cycle;
    const Cycle base = kind == Kind::byte ? elapsed / period * period : 0;
    if (kind == Kind::released || kind == Kind::start) return never_cycle;
    if (elapsed < base + hold) return base + hold;
    if (kind == Kind::held) return never_cycle;
    if (elapsed < base + low) return base + low;
    if (kind == Kind::restart && elapsed < 2 * low) return 2 * low;
    return kind == Kind::byte && base + period < 9 * period ? base + period : never_cycle;
  }
  /// SCL is released at this time: a device may hold it low for longer.
  bool releases_clock(Cycle elapsed) const {
    if (kind == Kind::byte) return elapsed % (low + high) == low;
    return (kind == Kind::restart || kind == Kind::stop) && elapsed == low;
  }
  /// The end of the high time of a bit.
  bool takes_bit(Cycle elapsed) const {
    return kind == Kind::byte && elapsed != 0 && elapsed % (low + high) == 0;
  }

 private:
  Levels byte_at(Cycle elapsed) const {
    const Cycle bit = std::min<Cycle>(8, elapsed / (low + high));
    const Cycle within = elapsed - bit * (low + high);
    const auto level = [this](Cycle n) { return (bits >> (8 - n) & 1u) != 0; };
    const bool old = bit == 0 ? before : level(bit - 1);
    return {within >= low && within < low + high, within < hold ? old : level(bit)};
  }
};

}  // namespace lamplock::sim::chip
