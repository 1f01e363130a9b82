// DMA. A paced channel sets GPIO 2 high and low by its overrides, from a ring of two words; GPIO 3
// is high while 1000 words, then 2000 words are copied; chained channels send "first second third"
// on UART0; the results of the sniffer and of a ring on the writing side follow.
#include "tests/chip_images/dma.hpp"

using namespace image;

namespace {

constexpr Word irq_dma0 = 11;
constexpr Word inte0 = dma_base + 0x404, ints0 = dma_base + 0x40c, timer0_xy = dma_base + 0x420,
               sniff_control = dma_base + 0x434, sniff_data = dma_base + 0x438;
/// In SRAM 4, which no other master reads (2.6.2).
constexpr Word lonely = 0x2004'0000;

// GPIO2_CTRL: OUTOVER low, high (2.19.6.1).
alignas(8) constexpr Word low_high[2] = {2u << 8 | 5, 3u << 8 | 5};
constexpr char text[] = "123456789";
Word copied[2000];
alignas(16) Word ring[8];
Word counted[16];

/// Sniffs the nine digits; CALC, OUT_REV, OUT_INV as in SNIFF_CTRL (2.5.7).
Word sniff(Word seed, Word calculation, Word output = 0) {
  reg(sniff_control) = output | calculation << 5 | 3u << 1 | 1;
  reg(sniff_data) = seed;
  start_dma(3, address(text), address(copied), 9,
            channel::enable | channel::byte | channel::count_read | channel::sniff |
                channel::chain(3) | channel::request(channel::permanent));
  while (dma_busy(3)) {
  }
  return reg(sniff_data);
}

/// GPIO 3 is high from the store that starts the copy to the interrupt at its end. The core sleeps
/// and uses no bus cycle.
void copy(Word words) {
  dma_reg(1, 0) = lonely;
  dma_reg(1, 4) = address(copied);
  dma_reg(1, 8) = words;
  gpio_set() = 1u << 3;
  dma_reg(1, 12) = channel::enable | channel::word | channel::count_write | channel::chain(1) |
                   channel::request(channel::permanent);
  asm volatile("wfi");
}

void say(unsigned number, const char* what, Word bytes, unsigned next, Word trigger) {
  dma_reg(number, 0) = address(what);
  dma_reg(number, 4) = uart0_base;
  dma_reg(number, 8) = bytes;
  dma_reg(number, trigger) = channel::enable | channel::byte | channel::count_read |
                             channel::chain(next) | channel::request(channel::uart0_tx);
}

}  // namespace

extern "C" void irq11() {
  gpio_clear() = 1u << 3;
  reg(ints0) = 1u << 1;
}

int main() {
  start();
  release(block::dma);
  start_uart();
  reg(uart0_base + 0x48) = 2;  // UARTDMACR: TXDMAE
  make_output(2);
  make_output(3);

  // 125 MHz x 1 / 50: a request every 50 cycles (2.5.7, TIMER0).
  reg(timer0_xy) = 1u << 16 | 50;
  start_dma(0, address(low_high), io_bank0_base + 8 * 2 + 4, 4000,
            channel::enable | channel::word | channel::count_read | channel::ring(3) |
                channel::chain(0) | channel::request(channel::timer0));
  while (dma_busy(0)) {
  }
  select(2, Function::sio);

  reg(inte0) = 1u << 1;
  enable_irq(irq_dma0);
  copy(1000);
  copy(2000);

  constexpr Word control_without_trigger = 0x10, control = 0x0c;  // AL1_CTRL, CTRL_TRIG
  say(6, "third\n", 6, 6, control_without_trigger);
  say(5, "second ", 7, 6, control_without_trigger);
  say(4, "first ", 6, 5, control);
  while (dma_busy(4) || dma_busy(5) || dma_busy(6)) {
  }

  print("sniff");
  print_hex(sniff(0xffff'ffff, 0));
  print_hex(sniff(0xffff'ffff, 1, 1u << 10 | 1u << 11));
  print_hex(sniff(0xffff, 2));
  print_hex(sniff(0, 14));
  print_hex(sniff(0, 15));
  print("\nring");
  for (Word i = 0; i < 16; ++i) counted[i] = i;
  for (Word& word : ring) word = 0xff;
  start_dma(7, address(counted), address(ring), 11,
            channel::enable | channel::word | channel::count_read | channel::count_write |
                channel::ring(4) | channel::ring_write | channel::chain(7) |
                channel::request(channel::permanent));
  while (dma_busy(7)) {
  }
  for (const Word word : ring) print_hex(word);
  print("\n");
  for (;;) {
  }
}
