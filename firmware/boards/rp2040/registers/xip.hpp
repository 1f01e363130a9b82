// Control of the execute-in-place cache (RP2040 datasheet, 2.6.3.6).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct XipCtrlRegisters {
  Register ctrl;
  Register flush;
  Register stat;
  Register ctr_hit;
  Register ctr_acc;
  Register stream_addr;
  Register stream_ctr;
  Register stream_fifo;
};
static_assert(offsetof(XipCtrlRegisters, stream_fifo) == 0x1c);

inline XipCtrlRegisters& xip_ctrl() { return *reinterpret_cast<XipCtrlRegisters*>(0x14000000); }

/// Flash as memory: through the cache, and past it (datasheet, 2.6.3.2).
inline constexpr std::uintptr_t xip_base = 0x10000000;
inline constexpr std::uintptr_t xip_nocache_base = 0x13000000;

}  // namespace lamplock::rp2040
