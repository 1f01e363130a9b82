#include "firmware/boards/rp2040/base/second_core.hpp"

#include "firmware/boards/rp2040/base/stack.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"

namespace lamplock::rp2040 {
namespace {

/// The ROM answers within some microseconds, plus interrupts of core 0.
constexpr std::uint32_t patience_us = 2000;

}  // namespace

bool start_second_core(void (*entry)()) {
  const std::uint32_t words[] = {0,
                                 0,
                                 1,
                                 scb().vtor,
                                 reinterpret_cast<std::uintptr_t>(second_stack_top),
                                 reinterpret_cast<std::uintptr_t>(entry)};
  constexpr std::uint32_t count = sizeof(words) / sizeof(words[0]);
  SioRegisters& s = sio();
  const std::uint32_t begin = timer().timerawl;
  bool sent = false;
  for (std::uint32_t i = 0; i < count;) {
    if (timer().timerawl - begin > patience_us) {
      hold_second_core();
      return false;
    }
    const std::uint32_t state = s.fifo_st;
    if ((state & fifo_field::valid) != 0) {
      // A word received before one was sent is an old one.
      const bool echoed = s.fifo_rd == words[i];
      if (sent) i = echoed ? i + 1 : 0;
      sent = false;
    } else if (!sent && (state & fifo_field::ready) != 0) {
      s.fifo_wr = words[i];
      sent = true;
    }
    send_event();
  }
  return true;
}

}  // namespace lamplock::rp2040
