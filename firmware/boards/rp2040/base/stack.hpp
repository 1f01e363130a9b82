// The two stacks: scratch X and Y, 8 KiB, separate from all other memory. Core 0 has the upper 5
// KiB, core 1 the 3 KiB below. toolchain/gate_image checks that no chain of calls and interrupts
// can need more.
#pragma once

#include <cstdint>

// From the linker script.
extern "C" {
extern std::uint32_t second_stack_bottom[];
extern std::uint32_t second_stack_top[];  // end of the stack of core 0
extern std::uint32_t stack_top[];
}

namespace lamplock::rp2040 {

inline constexpr std::uint32_t stack_paint = 0x5aa55aa5;

/// Core 0 fills the unused part, before core 1 has begun.
[[gnu::always_inline]] inline void paint_stacks() {
  std::uint32_t* const pointer = [] {
    std::uint32_t* p;
    asm volatile("mov %0, sp" : "=r"(p));
    return p;
  }();
  for (std::uint32_t* word = second_stack_bottom; word < pointer; ++word) *word = stack_paint;
}

}  // namespace lamplock::rp2040
