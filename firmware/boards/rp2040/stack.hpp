// The one stack: scratch X and Y, 8 KiB, apart from everything else. toolchain/gate_image checks
// that no chain of calls and interrupts can need more.
#pragma once

#include <cstdint>

// From the linker script.
extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t stack_top[];
}

namespace lamplock::rp2040 {

inline constexpr std::uint32_t stack_paint = 0x5aa55aa5;

/// Fills what is not in use.
[[gnu::always_inline]] inline void paint_stack() {
  std::uint32_t* const pointer = [] {
    std::uint32_t* p;
    asm volatile("mov %0, sp" : "=r"(p));
    return p;
  }();
  for (std::uint32_t* word = stack_bottom; word < pointer; ++word) *word = stack_paint;
}

}  // namespace lamplock::rp2040
