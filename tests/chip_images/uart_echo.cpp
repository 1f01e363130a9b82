// UART0 at 1 Mbaud: an interrupt for each received byte, or for the time-out, sends the same byte
// back. GPIO 2 is high in the handler, GPIO 3 rises when the image is ready. After "!" the FIFOs
// are on.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {
constexpr unsigned irq_uart0 = 20;
constexpr Word data = uart0_base, flags = uart0_base + 0x18, line = uart0_base + 0x2c,
               control = uart0_base + 0x30, levels = uart0_base + 0x34, mask = uart0_base + 0x38;
constexpr Word receive_empty = 1u << 4, receive_interrupt = 1u << 4, timeout_interrupt = 1u << 6;
}  // namespace

extern "C" void irq20() {
  gpio_set() = 1u << 2;
  while ((reg(flags) & receive_empty) == 0) {
    const char byte = static_cast<char>(reg(data));
    put(byte);
    if (byte != '!') continue;
    reg(control) = 0;
    reg(levels) = 2u << 3;          // receive interrupt at half: 16 bytes
    reg(line) = 3u << 5 | 1u << 4;  // 8 bits, FIFOs
    reg(control) = 1u << 9 | 1u << 8 | 1;
  }
  gpio_clear() = 1u << 2;
}

int main() {
  start();
  start_uart();
  reg(line) = 3u << 5;  // 8 bits, no FIFO
  make_output(2);
  make_output(3);
  reg(mask) = receive_interrupt | timeout_interrupt;
  enable_irq(irq_uart0);
  gpio_set() = 1u << 3;
  for (;;) asm volatile("wfi");
}
