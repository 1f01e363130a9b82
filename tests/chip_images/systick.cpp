// SysTick: from the processor's clock GPIO 2 every 12500 cycles; then, after GPIO 4 has risen, from
// the tick of 1 us GPIO 3 every 100 us. Counter, COUNTFLAG, CALIB on UART0 at the end.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {
// ARMv6-M Architecture Reference Manual, B3.3.
constexpr Word csr = ppb_base + 0xe010, rvr = ppb_base + 0xe014, cvr = ppb_base + 0xe018,
               calib = ppb_base + 0xe01c;
constexpr Word enable = 1, interrupt = 2, processor_clock = 4, count_flag = 1u << 16;
volatile Word pin = 1u << 2;

void begin(Word reload, Word control) {
  reg(csr) = 0;
  reg(rvr) = reload;
  reg(cvr) = 0;
  reg(csr) = control;
}
void pause(Word us) {
  const Word start = now_us();
  while (now_us() - start < us) {
  }
}
}  // namespace

extern "C" void systick() { gpio_toggle() = pin; }

int main() {
  start();
  start_uart();
  make_output(2);
  make_output(3);
  make_output(4);
  begin(12'499, enable | interrupt | processor_clock);
  pause(5000);
  reg(csr) = 0;
  pin = 1u << 3;
  gpio_set() = 1u << 4;
  begin(99, enable | interrupt);
  pause(5000);
  begin(0x00ff'ffff, enable | processor_clock);
  // Two reads of the counter, a load (2) and seven instructions of a cycle between them.
  Word first = 0, second = 0;
  asm volatile(
      "ldr %[first], [%[cvr]]\n"
      "nop; nop; nop; nop; nop; nop; nop\n"
      "ldr %[second], [%[cvr]]\n"
      : [first] "=&l"(first), [second] "=&l"(second)
      : [cvr] "l"(cvr));
  print("between");
  print_hex(first - second);
  begin(999, enable | processor_clock);
  pause(20);
  print("\nflag");
  print_hex(read(csr));
  print_hex(read(csr) & count_flag);
  reg(cvr) = 12345;
  const Word value = read(cvr);
  print_hex(value > 900 && value <= 999 ? 1 : 0);
  print("\ncalib");
  print_hex(read(calib));
  print("\n");
  for (;;) {
  }
}
