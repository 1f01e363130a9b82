// PIO instructions, decoded for the machine that runs them (RP2040 datasheet, 3.4).
//
// In:  the 16 bits of an instruction; side-set and pin mapping of a state machine.
// Out: what it does, its delay, and which bits of the block's output latches its side-set writes.
#pragma once

#include <bit>
#include <cstdint>

namespace lamplock::sim::chip::pio {

/// Operations. All jumps come first.
enum class Operation : std::uint8_t {
  jmp_always,
  jmp_not_x,
  jmp_x_dec,
  jmp_not_y,
  jmp_y_dec,
  jmp_x_ne_y,
  jmp_pin,
  jmp_not_osre,
  wait_gpio,
  wait_pin,
  wait_irq,
  wait_reserved,
  in,
  out,
  push,
  pull,
  mov,
  irq,
  set_pins,
  set_x,
  set_y,
  set_pindirs,
  set_reserved
};
constexpr bool is_jump(Operation operation) { return operation <= Operation::jmp_not_osre; }

/// Bits n-1..0, n <= 32.
constexpr std::uint32_t low_bits(unsigned n) { return n >= 32 ? ~0u : (1u << n) - 1u; }

/// `count` pins from `base` on, modulo 32.
constexpr std::uint32_t pin_mask(unsigned base, unsigned count) {
  return std::rotl(low_bits(count), static_cast<int>(base));
}

/// The pin mapping and side-set fields that decoding depends on.
struct Mapping {
  unsigned set_base = 0, set_count = 5;
  unsigned side_base = 0, side_count = 0;
  bool side_enable = false;  ///< the top side-set bit says whether there is one
  bool side_pindir = false;
};

/// One instruction, ready to run.
struct Decoded {
  Operation operation = Operation::jmp_always;
  std::uint8_t delay = 0;
  std::uint8_t arg = 0;    ///< bits 4..0; 1..32 where it counts bits
  std::uint8_t field = 0;  ///< bits 7..5
  bool side_to_dirs = false;
  /// Only its machine notices it, unless pins show it.
  bool own = false;
  std::uint16_t raw = 0;
  std::uint32_t side_mask = 0, side_bits = 0;
  std::uint32_t set_mask = 0, set_bits = 0;
};

/// Decodes one instruction for one state machine.
Decoded decode(std::uint16_t raw, const Mapping& mapping);

}  // namespace lamplock::sim::chip::pio
