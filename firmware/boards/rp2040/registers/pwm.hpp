// PWM: eight slices of two channels (RP2040 datasheet, 4.5.3).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct PwmSliceRegisters {
  Register csr;
  Register div;  ///< 8.4 bits; 1 after reset
  Register ctr;
  Register cc;  ///< A in the lower half, B in the upper one; takes effect at the next wrap
  Register top;
};
struct PwmRegisters {
  PwmSliceRegisters slice[8];
  Register en;
};
static_assert(offsetof(PwmRegisters, en) == 0xa0);

inline PwmRegisters& pwm() { return *reinterpret_cast<PwmRegisters*>(0x40050000); }

namespace pwm_csr {
inline constexpr std::uint32_t enable = 1;
}

/// Slice of a pin; odd pins are its channel B (RP2040 datasheet, 4.5.2).
constexpr unsigned pwm_slice(unsigned gpio) { return gpio / 2 % 8; }
constexpr unsigned pwm_shift(unsigned gpio) { return gpio % 2 * 16; }

}  // namespace lamplock::rp2040
