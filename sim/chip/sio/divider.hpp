// The integer divider of a core (RP2040 datasheet, 2.3.1.5): 32 by 32 bits in eight cycles.
//
// In:  operands and results written by the core, with the cycle of the access.
// Out: quotient, remainder, and the flags READY and DIRTY.
// Who: Sio, for the registers DIV_*.
#pragma once

#include <cstdint>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// One divider. Values are computed at the write; they count as valid eight cycles later.
class Divider {
 public:
  static constexpr Cycle cycles = 8;

  void write_dividend(std::uint32_t value, bool is_signed, Cycle at) {
    dividend_ = value;
    start(is_signed, at);
  }
  void write_divisor(std::uint32_t value, bool is_signed, Cycle at) {
    divisor_ = value;
    start(is_signed, at);
  }
  /// Writing a result ends a calculation (to restore an interrupted one).
  void write_quotient(std::uint32_t value, Cycle at) {
    quotient_ = value;
    ready_at_ = at;
    dirty_ = true;
  }
  void write_remainder(std::uint32_t value, Cycle at) {
    remainder_ = value;
    ready_at_ = at;
    dirty_ = true;
  }

  std::uint32_t dividend() const { return dividend_; }
  std::uint32_t divisor() const { return divisor_; }
  /// Undefined in the chip while ready() is false; here the future value.
  std::uint32_t quotient() const { return quotient_; }
  std::uint32_t remainder() const { return remainder_; }
  /// Side effect of reading QUOTIENT.
  void clear_dirty() { dirty_ = false; }
  bool ready(Cycle at) const { return at >= ready_at_; }
  bool dirty() const { return dirty_; }

 private:
  void start(bool is_signed, Cycle at);

  std::uint32_t dividend_ = 0, divisor_ = 0, quotient_ = 0, remainder_ = 0;
  Cycle ready_at_ = 0;
  bool dirty_ = false;
};

}  // namespace lamplock::sim::chip
