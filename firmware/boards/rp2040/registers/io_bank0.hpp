// User I/O bank: function select, overrides, pin interrupts (RP2040 datasheet, 2.19.6.1).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct IoBank0Registers {
  struct {
    Register status;
    Register ctrl;
  } gpio[30];
  Register intr[4];
  Register proc0_inte[4];
  Register proc0_intf[4];
  Register proc0_ints[4];
};
static_assert(offsetof(IoBank0Registers, intr) == 0xf0);
static_assert(offsetof(IoBank0Registers, proc0_inte) == 0x100);
static_assert(offsetof(IoBank0Registers, proc0_ints) == 0x120);

inline IoBank0Registers& io_bank0() { return *reinterpret_cast<IoBank0Registers*>(0x40014000); }

namespace io_ctrl {
enum class Function : std::uint8_t {
  uart = 2,
  pwm = 4,
  sio = 5,
  pio0 = 6,
  pio1 = 7,
  usb_debug = 8,
  none = 31,
};
constexpr std::uint32_t function(Function f) { return static_cast<std::uint32_t>(f); }
inline constexpr std::uint32_t function_mask = 0x1f;
/// OUTOVER = 2: the output is low independent of the peripheral. One bit away from normal, so that
/// the set and clear aliases switch it.
inline constexpr std::uint32_t output_low = 2u << 8;
/// OUTOVER = 1: the output is the inverse of the peripheral's.
inline constexpr std::uint32_t output_inverted = 1u << 8;
/// OEOVER = 2: not driven. INOVER = 1: peripherals see the inverse of the pad, 3: a high level.
inline constexpr std::uint32_t output_off = 2u << 12;
inline constexpr std::uint32_t input_inverted = 1u << 16;
inline constexpr std::uint32_t input_high = 3u << 16;
}  // namespace io_ctrl

/// Four bits a pin in INTR, INTE, INTS.
namespace io_interrupt {
constexpr unsigned word(unsigned gpio) { return gpio / 8; }
constexpr std::uint32_t edge_low(unsigned gpio) { return 4u << (4 * (gpio % 8)); }
constexpr std::uint32_t edge_high(unsigned gpio) { return 8u << (4 * (gpio % 8)); }
}  // namespace io_interrupt

inline void force_low(unsigned gpio) { set_bits(io_bank0().gpio[gpio].ctrl, io_ctrl::output_low); }
inline void release(unsigned gpio) { clear_bits(io_bank0().gpio[gpio].ctrl, io_ctrl::output_low); }

}  // namespace lamplock::rp2040
