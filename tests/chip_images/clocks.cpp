// Clocks: FC0's counts at 125 MHz; then the same loop at 48, 200 and 125 MHz, on GPIO 2, 3, 4, an
// edge every 4 cycles; FC0 and TIMER after each. GPIO 21 outputs clk_sys / 10. Results on UART0 at
// the end, when clk_peri has its first frequency again.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 2.15.7.
constexpr Word gpout0 = clocks_base, sys_control = clocks_base + 0x3c,
               sys_selected = clocks_base + 0x44, reference_khz = clocks_base + 0x80,
               interval = clocks_base + 0x90, source = clocks_base + 0x94,
               status = clocks_base + 0x98, result = clocks_base + 0x9c;
enum class Source : Word { pll_sys = 1, pll_usb, rosc, xosc = 5, ref = 8, sys, peri, usb };
enum class Auxiliary : Word { pll_sys, pll_usb };

/// In kHz.
Word measure(Source which) {
  reg(reference_khz) = 12'000;
  reg(clocks_base + 0x84) = 0;
  reg(clocks_base + 0x88) = 0x01ff'ffff;
  reg(interval) = 10;
  reg(source) = static_cast<Word>(which);
  while ((read(status) & 1u << 4) == 0) {
  }
  return read(result) >> 5;
}

void choose(Auxiliary auxiliary) {
  reg(sys_control) = 0;  // clk_ref
  while ((read(sys_selected) & 1) == 0) {
  }
  reg(sys_control) = static_cast<Word>(auxiliary) << 5;
  reg(sys_control) = static_cast<Word>(auxiliary) << 5 | 1;
  while ((read(sys_selected) & 2) == 0) {
  }
}

/// 12 MHz x feedback / (post1 x post2) (2.18.2).
void set_pll(Word feedback, Word post1, Word post2) {
  reg(sys_control) = 0;
  while ((read(sys_selected) & 1) == 0) {
  }
  set_bits(resets_base, 1u << 12);
  release(1u << 12);
  reg(pll_sys_base) = 1;
  reg(pll_sys_base + 8) = feedback;
  clear_bits(pll_sys_base + 4, 1u << 0 | 1u << 5);
  while ((read(pll_sys_base) & 1u << 31) == 0) {
  }
  reg(pll_sys_base + 12) = post1 << 16 | post2 << 12;
  clear_bits(pll_sys_base + 4, 1u << 3);
}

/// `edges` edges, 1 + 1 + 2 cycles each.
void toggle(unsigned gpio, Word edges) {
  asm volatile(
      ".syntax unified\n"
      "1: str %[pin], [%[sio], #0x1c]\n"
      "subs %[edges], #1\n"
      "bne 1b\n"
      : [edges] "+l"(edges)
      : [sio] "l"(sio_base), [pin] "l"(1u << gpio)
      : "cc");
}

void show(const char* name, Word value) {
  print(name);
  print_hex(value);
}

}  // namespace

int main() {
  start();
  for (const unsigned gpio : {2u, 3u, 4u, 5u}) make_output(gpio);
  const Word khz[] = {measure(Source::pll_sys), measure(Source::pll_usb), measure(Source::xosc),
                      measure(Source::ref),     measure(Source::sys),     measure(Source::peri),
                      measure(Source::usb)};
  reg(gpout0 + 4) = 10u << 8;
  reg(gpout0) = 6u << 5 | 1u << 11;  // clk_sys, ENABLE
  select(21, Function::clock);
  gpio_set() = 1u << 5;
  const Word start_us = now_us();
  while (now_us() - start_us < 20) {
  }
  choose(Auxiliary::pll_usb);
  toggle(2, 10'000);
  const Word at_48 = measure(Source::sys);
  set_pll(100, 6, 1);
  choose(Auxiliary::pll_sys);
  toggle(3, 10'000);
  const Word at_200 = measure(Source::sys);
  const Word begin = now_us();
  gpio_clear() = 1u << 5;
  while (now_us() - begin < 1000) {
  }
  gpio_set() = 1u << 5;
  set_pll(125, 6, 2);
  choose(Auxiliary::pll_sys);
  toggle(4, 10'000);

  start_uart();
  print("khz");
  for (const Word each : khz) print_hex(each);
  show(" at48", at_48);
  show(" at200", at_200);
  show(" at125", measure(Source::sys));
  print("\n");
  const Word ring = measure(Source::rosc);
  show("ring", ring >= 1800 && ring <= 12'000 ? 1 : 0);
  print("\n");
  for (;;) {
  }
}
