// SPI0 in loop-back, visible on its pins: 8 words of 16 bits at 12.5 MHz (GPIO 2 is high while it
// is busy), its FIFOs and flags, 1000 bytes by two DMA channels (GPIO 3). I2C0 without a device on
// the bus: a byte without an acknowledge (GPIO 6). Results on UART0.
#include "tests/chip_images/dma.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 4.4.4.
constexpr Word cr0 = spi0_base, cr1 = spi0_base + 4, data = spi0_base + 8, sr = spi0_base + 12,
               cpsr = spi0_base + 16, ris = spi0_base + 24, dmacr = spi0_base + 36;
constexpr Word busy = 1u << 4, not_empty = 1u << 2;
constexpr Word mode_3 = 3u << 6;

unsigned char sent[1000], received[1000];

void start_spi(Word bits, Word mode, Word divisor) {
  reg(cr1) = 0;
  reg(cpsr) = divisor;
  reg(cr0) = (bits - 1) | mode;
  reg(cr1) = 3;  // loop, enable
}

/// Eight words, GPIO 2 high from before the first until it is no longer busy.
void eight() {
  gpio_set() = 1u << 2;
  for (Word i = 0; i < 8; ++i) reg(data) = 0x1110 + 0x1111 * i;
  while ((read(sr) & busy) != 0) {
  }
  gpio_clear() = 1u << 2;
}

void drain() {
  while ((read(sr) & not_empty) != 0) print_hex(read(data));
}

void spi() {
  release(block::spi0 | block::dma);
  for (const unsigned gpio : {17u, 18u, 19u}) select(gpio, Function::spi);  // CSn, SCK, TX
  start_spi(16, mode_3, 10);
  print("idle");
  print_hex(read(sr));
  eight();
  const Word flags = read(sr), asked = read(ris);
  print("\nfull");
  print_hex(flags);
  print_hex(asked);
  print("\ndata");
  drain();
  print("\n");
  flush();
  start_spi(16, 0, 10);
  eight();
  // Eight more into a full FIFO: the first is lost.
  reg(data) = 0;
  while ((read(sr) & busy) != 0) {
  }
  print("over");
  print_hex(read(ris) & 1);
  reg(spi0_base + 32) = 1;
  print_hex(read(ris) & 1);
  drain();
  print("\n");

  flush();
  start_spi(8, mode_3, 2);
  reg(dmacr) = 3;
  for (unsigned i = 0; i < 1000; ++i) sent[i] = static_cast<unsigned char>(i * 7);
  start_dma(0, spi0_base + 8, address(received), 1000,
            channel::enable | channel::byte | channel::count_write | channel::chain(0) |
                channel::request(17));
  gpio_set() = 1u << 3;
  start_dma(1, address(sent), spi0_base + 8, 1000,
            channel::enable | channel::byte | channel::count_read | channel::chain(1) |
                channel::request(16));
  while (dma_busy(0)) {
  }
  gpio_clear() = 1u << 3;
  Word wrong = 0;
  for (unsigned i = 0; i < 1000; ++i) wrong += received[i] != sent[i] ? 1u : 0u;
  print("wrong");
  print_hex(wrong);
  print("\n");
}

// 4.3.17.
inline Register& i2c(Word offset) { return reg(i2c0_base + offset); }

void i2c_alone() {
  release(block::i2c0);
  for (const unsigned gpio : {4u, 5u}) {
    reg(pads_bank0_base + 4 + 4 * gpio) = 1u << 6 | 1u << 3 | 1u << 1;  // pulled up
    select(gpio, Function::i2c);
  }
  i2c(0x6c) = 0;
  i2c(0x00) = 1u << 6 | 1u << 5 | 1u << 1 | 1;  // master, standard speed
  i2c(0x04) = 0x55;
  i2c(0x14) = 617;
  i2c(0x18) = 624;
  i2c(0xa0) = 1;
  i2c(0x6c) = 1;
  print("i2c");
  print_hex(i2c(0x70) & 0x3f);
  flush();
  gpio_set() = 1u << 6;
  i2c(0x10) = 1u << 9 | 0xa5;  // and STOP
  while ((i2c(0x34) & 1u << 6) == 0) {
  }
  gpio_clear() = 1u << 6;
  while ((i2c(0x70) & 1u << 5) != 0) {
  }
  gpio_set() = 1u << 6;
  print_hex(i2c(0x80) & 0xffff);
  print_hex(i2c(0x34) >> 9 & 1);
  static_cast<void>(read(i2c0_base + 0x54));
  print_hex(i2c(0x34) >> 6 & 1);
  print_hex(i2c(0x80) & 0xffff);
  print("\n");
}

}  // namespace

int main() {
  start();
  start_uart();
  for (const unsigned gpio : {2u, 3u, 6u}) make_output(gpio);
  spi();
  i2c_alone();
  for (;;) {
  }
}
