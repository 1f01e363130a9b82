// Programmable I/O (RP2040 datasheet, 3.7).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct PioStateMachineRegisters {
  Register clkdiv;
  Register execctrl;
  Register shiftctrl;
  Register addr;
  Register instr;
  Register pinctrl;
};

struct PioRegisters {
  Register ctrl;
  Register fstat;
  Register fdebug;
  Register flevel;
  Register txf[4];
  Register rxf[4];
  Register irq;
  Register irq_force;
  Register input_sync_bypass;
  Register dbg_padout;
  Register dbg_padoe;
  Register dbg_cfginfo;
  Register instr_mem[32];
  PioStateMachineRegisters sm[4];
  Register intr;
  Register irq0_inte;
  Register irq0_intf;
  Register irq0_ints;
  Register irq1_inte;
  Register irq1_intf;
  Register irq1_ints;
};
static_assert(offsetof(PioRegisters, rxf) == 0x20);
static_assert(offsetof(PioRegisters, instr_mem) == 0x48);
static_assert(offsetof(PioRegisters, sm) == 0xc8);
static_assert(offsetof(PioRegisters, intr) == 0x128);
static_assert(offsetof(PioRegisters, irq1_ints) == 0x140);

inline PioRegisters& pio0() { return *reinterpret_cast<PioRegisters*>(0x50200000); }
inline PioRegisters& pio1() { return *reinterpret_cast<PioRegisters*>(0x50300000); }

namespace pio_ctrl {
constexpr std::uint32_t enable(unsigned machines) { return machines; }
constexpr std::uint32_t restart(unsigned machines) { return machines << 4; }
constexpr std::uint32_t clkdiv_restart(unsigned machines) { return machines << 8; }
}  // namespace pio_ctrl

namespace pio_flevel {
constexpr unsigned tx(std::uint32_t flevel, unsigned sm) { return flevel >> (8 * sm) & 15; }
constexpr unsigned rx(std::uint32_t flevel, unsigned sm) { return flevel >> (8 * sm + 4) & 15; }
}  // namespace pio_flevel

namespace pio_execctrl {
constexpr std::uint32_t wrap_bottom(unsigned address) { return address << 7; }
constexpr std::uint32_t wrap_top(unsigned address) { return address << 12; }
constexpr std::uint32_t jmp_pin(unsigned gpio) { return gpio << 24; }
inline constexpr std::uint32_t side_en = 1u << 30;
}  // namespace pio_execctrl

namespace pio_shiftctrl {
inline constexpr std::uint32_t autopush = 1u << 16;  ///< threshold 0 means 32 bits
inline constexpr std::uint32_t autopull = 1u << 17;
inline constexpr std::uint32_t in_right = 1u << 18;
inline constexpr std::uint32_t out_right = 1u << 19;
inline constexpr std::uint32_t join_tx = 1u << 30;
inline constexpr std::uint32_t join_rx = 1u << 31;
}  // namespace pio_shiftctrl

namespace pio_pinctrl {
constexpr std::uint32_t out(unsigned base, unsigned count) { return base | count << 20; }
constexpr std::uint32_t set(unsigned base, unsigned count) { return base << 5 | count << 26; }
constexpr std::uint32_t side(unsigned base, unsigned count) { return base << 10 | count << 29; }
constexpr std::uint32_t in(unsigned base) { return base << 15; }
}  // namespace pio_pinctrl

namespace pio_intr {
constexpr std::uint32_t rx_not_empty(unsigned sm) { return 1u << sm; }
}  // namespace pio_intr

}  // namespace lamplock::rp2040
