// Chip identification (RP2040 datasheet, 2.20.2).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct SysinfoRegisters {
  Register chip_id;  ///< revision 31:28, part 27:12, manufacturer 11:0
  Register platform;
};
static_assert(offsetof(SysinfoRegisters, platform) == 0x4);

inline SysinfoRegisters& sysinfo() { return *reinterpret_cast<SysinfoRegisters*>(0x40000000); }

}  // namespace lamplock::rp2040
