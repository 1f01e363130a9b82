// Single-cycle I/O: the CPU's direct access to the pins (RP2040 datasheet, 2.3.1.7). No aliases.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct SioRegisters {
  Register cpuid;
  Register gpio_in;
  Register gpio_hi_in;
  Register reserved;
  Register gpio_out;
  Register gpio_out_set;
  Register gpio_out_clr;
  Register gpio_out_xor;
  Register gpio_oe;
  Register gpio_oe_set;
  Register gpio_oe_clr;
  Register gpio_oe_xor;
  Register reserved_hi[8];  ///< of the flash pins
  Register fifo_st;
  Register fifo_wr;
  Register fifo_rd;
  Register spinlock_st;
  // The divider: 2.3.1.5.
  Register div_udividend;
  Register div_udivisor;
  Register div_sdividend;
  Register div_sdivisor;
  Register div_quotient;
  Register div_remainder;
};
static_assert(offsetof(SioRegisters, gpio_oe_xor) == 0x2c);
static_assert(offsetof(SioRegisters, fifo_rd) == 0x58);
static_assert(offsetof(SioRegisters, div_remainder) == 0x74);

namespace fifo_field {
inline constexpr std::uint32_t valid = 1u << 0;  // FIFO_ST: something to read
inline constexpr std::uint32_t ready = 1u << 1;  // FIFO_ST: room to write
}  // namespace fifo_field

inline SioRegisters& sio() { return *reinterpret_cast<SioRegisters*>(0xd0000000); }

}  // namespace lamplock::rp2040
