#include "sim/chip/sio/divider.hpp"

namespace lamplock::sim::chip {

// Magnitudes are divided as unsigned numbers and the signs applied afterwards, which also gives the
// documented results of a division by zero (all ones, or one for a negative dividend; the dividend
// remains) and of the most negative number by minus one (itself, remainder 0).
void Divider::start(bool is_signed, Cycle at) {
  const bool dividend_negative = is_signed && (dividend_ >> 31) != 0;
  const bool divisor_negative = is_signed && (divisor_ >> 31) != 0;
  const std::uint32_t dividend = dividend_negative ? 0u - dividend_ : dividend_;
  const std::uint32_t divisor = divisor_negative ? 0u - divisor_ : divisor_;
  const std::uint32_t quotient = divisor == 0 ? ~0u : dividend / divisor;
  const std::uint32_t remainder = divisor == 0 ? dividend : dividend % divisor;
  quotient_ = dividend_negative != divisor_negative ? 0u - quotient : quotient;
  remainder_ = dividend_negative ? 0u - remainder : remainder;
  ready_at_ = at + cycles;
  dirty_ = true;
}

}  // namespace lamplock::sim::chip
