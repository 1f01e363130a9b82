// ADC at 48 MHz: prints all inputs twice on UART0; free-running, the interrupt of each result
// toggles GPIO 2; then every 480 cycles of clk_adc (GPIO 3); then one conversion on request, timed
// by GPIO 4, and round robin.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {
// RP2040 datasheet, 4.9.6.
constexpr Word cs = adc_base, result = adc_base + 0x04, fcs = adc_base + 0x08,
               fifo = adc_base + 0x0c, div = adc_base + 0x10, inte = adc_base + 0x18;
constexpr Word enable = 1, sensor = 2, once = 4, many = 8, ready = 1u << 8;
constexpr unsigned irq_adc = 22;
volatile Word pin = 1u << 2;

void pause(Word us) {
  const Word begin = now_us();
  while (now_us() - begin < us) {
  }
}
void stop() {
  reg(cs) = enable;
  while ((read(cs) & ready) == 0) {
  }
  while ((read(fcs) & 1u << 8) == 0) static_cast<void>(read(fifo));
}
/// Inputs 0 to 3 and the temperature sensor.
void show_inputs() {
  print("volts");
  for (Word input = 0; input < 5; ++input) {
    reg(cs) = enable | sensor | input << 12;
    reg(cs) = enable | sensor | input << 12 | once;
    while ((read(cs) & ready) == 0) {
    }
    print_hex(read(result));
  }
  print("\n");
}
}  // namespace

extern "C" void irq22() {
  gpio_toggle() = pin;
  static_cast<void>(read(fifo));
}

int main() {
  start();
  start_uart();
  for (const unsigned gpio : {2u, 3u, 4u}) make_output(gpio);
  reg(clocks_base + 0x64) = 1u << 8;
  reg(clocks_base + 0x60) = 1u << 11;  // PLL_USB, ENABLE
  release(block::adc);
  reg(cs) = enable;
  while ((read(cs) & ready) == 0) {
  }
  show_inputs();
  pause(1000);
  show_inputs();
  flush();

  reg(fcs) = 1u << 24 | 1;  // threshold 1, FIFO on
  reg(inte) = 1;
  enable_irq(irq_adc);

  reg(div) = 0;
  reg(cs) = enable | many;
  pause(1000);
  stop();
  pin = 1u << 3;
  reg(div) = 479u << 8;
  reg(cs) = enable | many;
  pause(1000);
  stop();
  pause(20);

  reg(inte) = 0;
  reg(fcs) = 1;
  gpio_set() = 1u << 4;
  reg(cs) = enable | once;
  while ((read(cs) & ready) == 0) {
  }
  gpio_clear() = 1u << 4;
  stop();
  // More than the FIFO holds, round robin of inputs 0 to 2.
  reg(fcs) = 1;
  reg(div) = 0;
  reg(cs) = enable | many | 7u << 16;
  pause(30);
  reg(cs) = enable;
  print("fifo");
  print_hex(read(fcs) & 0xf0f00);
  reg(fcs) = 1u << 11 | 1;
  print_hex(read(fcs) & 0xf0f00);
  while ((read(fcs) & 1u << 8) == 0) static_cast<void>(read(fifo));
  static_cast<void>(read(fifo));
  print_hex(read(fcs) & 0xf0f00);
  print("\n");
  for (;;) {
  }
}
