// Pins: overrides of output, input and interrupt, edge latches and levels, pulls, the two
// flip-flops before SIO. GPIO 2 follows GPIO 8 by software; GPIO 3 is the handler's; results on
// UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 2.19.6.1: CTRL OUTOVER 9:8, OEOVER 13:12, INOVER 17:16, IRQOVER 29:28; 1
// inverts, 2 low (off), 3 high (on). 2.19.6.3: pads.
constexpr Word intr0 = io_bank0_base + 0xf0, inte1 = io_bank0_base + 0x104,
               intf1 = io_bank0_base + 0x114, ints1 = io_bank0_base + 0x124;
constexpr unsigned irq_io_bank0 = 13;
constexpr Word pull_down = 1u << 2, pull_up = 1u << 3, drive = 1u << 4, input = 1u << 6,
               disable = 1u << 7;

inline Register& pad(unsigned gpio) { return reg(pads_bank0_base + 4 + 4 * gpio); }
inline Register& status(unsigned gpio) { return reg(io_bank0_base + 8 * gpio); }
bool high(unsigned gpio) { return (gpio_in() >> gpio & 1) != 0; }
void settle() { asm volatile("nop; nop; nop; nop"); }

/// Level that SIO sees with these pulls.
Word pulled(unsigned gpio, Word pulls) {
  pad(gpio) = input | drive | pulls;
  settle();
  return high(gpio) ? 1 : 0;
}

Word overridden(unsigned gpio, Word bits) {
  pin_control(gpio) = static_cast<Word>(Function::sio) | bits;
  settle();
  return high(gpio) ? 1 : 0;
}

volatile Word seen;

}  // namespace

extern "C" void irq13() {
  gpio_set() = 1u << 3;
  const Word which = read(ints1);
  seen = seen | which;
  reg(intr0 + 4) = which;  // clears edges, not levels
  if ((which & 3) != 0) reg(inte1) = 0;
  gpio_clear() = 1u << 3;
}

int main() {
  start();
  start_uart();
  make_output(2);
  make_output(3);

  print("pulls");
  select(5, Function::sio);
  print_hex(pulled(5, pull_up));
  print_hex(pulled(5, pull_down));
  pad(5) = drive | pull_up;  // no input
  settle();
  print_hex(high(5) ? 1 : 0);

  // GPIO 4: an output that is low.
  make_output(4);
  print("\nover");
  print_hex(overridden(4, 0));
  print_hex(overridden(4, 1u << 8));   // out inverted
  print_hex(overridden(4, 3u << 8));   // out high
  print_hex(overridden(4, 1u << 16));  // in inverted
  gpio_set() = 1u << 4;
  print_hex(overridden(4, 0));
  print_hex(overridden(4, 2u << 8));   // out low
  print_hex(overridden(4, 2u << 12));  // not enabled: the pull-down
  pad(4) = input | disable | drive;
  pad(4) = input | disable | drive | pull_down;
  print_hex(overridden(4, 0));  // OD of the pad
  pad(4) = input | drive;
  pin_control(4) = 31;
  print("\n");

  // Edges of GPIO 8 latch: low, high (level) 0, 1; fall, rise 2, 3.
  select(8, Function::sio);
  reg(intr0 + 4) = 0xf;
  print("edge");
  print_hex(read(intr0 + 4) & 0xf);
  flush();
  gpio_set() = 1u << 2;
  gpio_clear() = 1u << 2;
  while (!high(8)) {
  }
  while (high(8)) {
  }
  print_hex(read(intr0 + 4) & 0xf);
  reg(intr0 + 4) = 4;
  print_hex(read(intr0 + 4) & 0xf);
  reg(intr0 + 4) = 8;
  print_hex(read(intr0 + 4) & 0xf);
  print("\n");

  // From here on GPIO 3 is high in the handler of GPIO 8's rises.
  reg(inte1) = 8;
  enable_irq(irq_io_bank0);
  print("rises\n");
  flush();
  const Word begin = now_us();
  while (now_us() - begin < 500) {
  }
  print("irq");
  print_hex(seen);
  // Inverted for the interrupt: a fall is a rise.
  seen = 0;
  pin_control(8) = static_cast<Word>(Function::sio) | 1u << 28;
  settle();
  reg(intr0 + 4) = 0xf;
  print("\ninverted\n");
  flush();
  while (now_us() - begin < 1500) {
  }
  print("irq");
  print_hex(seen);
  // A forced interrupt, and a level.
  seen = 0;
  reg(inte1) = 0;
  pin_control(8) = static_cast<Word>(Function::sio);
  settle();
  reg(intr0 + 4) = 0xf;
  reg(inte1) = 1;  // level low: at once
  settle();
  print("\nlevel");
  print_hex(seen);
  print_hex(status(2) >> 8 & 0xf);
  print("\n");
  reg(intf1) = 0;

  // The final polling loop copies GPIO 8 to GPIO 2.
  asm volatile(
      ".syntax unified\n"
      "1: ldr r0, [%[sio], #4]\n"  // 1
      "lsrs r0, #8\n"              // 1
      "ands r0, %[one]\n"          // 1
      "lsls r0, #2\n"              // 1
      "str r0, [%[sio], #0x10]\n"  // 1
      "b 1b\n"                     // 2
      ::[sio] "l"(sio_base),
      [one] "l"(1)
      : "r0", "cc");
  return 0;
}
