// Masks the beat and fill interrupts while the main loop uses data that it shares with them.
//
// In:  two registers of the board's interrupt controller, and its bits: a write to one disables, a
//      write to the other enables. A board without interrupts has none.
// Out: stretches of some microseconds in which those interrupts wait; the e-stop's never does.
// Level: main loop; not nested.
#pragma once

#include <cstdint>

namespace lamplock::machine {

/// The two registers; null: there are no interrupts.
struct InterruptMask {
  volatile std::uint32_t* disable = nullptr;
  volatile std::uint32_t* enable = nullptr;
  std::uint32_t bits = 0;
};

/// Masked for the life of the object.
class Masked {
 public:
  explicit Masked(const InterruptMask& mask) : mask_(mask) {
    if (mask_.disable == nullptr) return;
    *mask_.disable = mask_.bits;
    // After this the write has taken effect, and an interrupt already accepted has run.
#ifdef __arm__
    asm volatile("dsb\n isb" ::: "memory");
#else
    asm volatile("" ::: "memory");
#endif
  }
  ~Masked() {
    asm volatile("" ::: "memory");
    if (mask_.enable != nullptr) *mask_.enable = mask_.bits;
  }
  Masked(const Masked&) = delete;
  Masked& operator=(const Masked&) = delete;

 private:
  const InterruptMask& mask_;
};

}  // namespace lamplock::machine
