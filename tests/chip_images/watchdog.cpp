// WATCHDOG. First start: GPIO 2 rises, no feeding, the reset comes 10 ms later. Second: fed for 20
// ms, then forced by TRIGGER, scratch registers kept. Third: starts at an address in SRAM; there
// GPIO 3 rises.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 4.7.6.
constexpr Word control = watchdog_base, load = watchdog_base + 4, reason = watchdog_base + 8;
constexpr Word enable = 1u << 30, trigger = 1u << 31;
inline Register& scratch(unsigned number) { return reg(watchdog_base + 0x0c + 4 * number); }

alignas(8) Word stack[64];

/// Selects everything except the oscillators for reset (PSM_WDSEL, 2.13.5).
void choose() { reg(psm_base + 8) = 0x1'fffc; }

[[noreturn]] void resumed() {
  start();
  make_output(3);
  gpio_set() = 1u << 3;
  for (;;) {
  }
}

}  // namespace

int main() {
  start();
  start_uart();
  make_output(2);
  choose();
  print("life");
  print_hex(scratch(0));
  print_hex(scratch(3));
  print_hex(reg(reason));
  print("\n");
  flush();
  const Word life = scratch(0);
  scratch(0) = life + 1;
  scratch(3) = 0x5eed'0000 + life;
  if (life == 0) {
    reg(load) = 20'000;
    reg(control) = enable;
    gpio_set() = 1u << 2;
  } else if (life == 1) {
    gpio_set() = 1u << 2;
    reg(load) = 10'000;
    reg(control) = enable;
    const Word begin = now_us();
    while (now_us() - begin < 20'000) reg(load) = 10'000;
    reg(control) = enable | trigger;
  } else {
    // 2.8.1.1: magic number, entry mixed with it, stack, entry.
    constexpr Word magic = 0xb007'c0d3;
    const Word entry = static_cast<Word>(reinterpret_cast<std::uintptr_t>(&resumed));
    scratch(4) = magic;
    scratch(5) = entry ^ -magic;
    scratch(6) = static_cast<Word>(reinterpret_cast<std::uintptr_t>(stack + 64));
    scratch(7) = entry;
    gpio_set() = 1u << 2;
    reg(control) = trigger;
  }
  for (;;) {
  }
}
