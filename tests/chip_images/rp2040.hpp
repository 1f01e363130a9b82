// RP2040 addresses and output functions for the small images.
//
// In:  nothing. Out: registers by address; pins, UART0. Used by the images of this folder. This
//      header is separate so that the images do not inherit mistakes of the board's register
//      headers. The numbers are those of the RP2040 datasheet; each image names the sections it
//      tests.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace image {

using Word = std::uint32_t;
using Register = volatile Word;

inline Register& reg(Word address) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what there is.
  return *reinterpret_cast<Register*>(static_cast<std::uintptr_t>(address));
}
inline Word read(Word address) { return reg(address); }
/// Atomic aliases (2.1.2).
inline void set_bits(Word address, Word bits) { reg(address + 0x2000) = bits; }
inline void clear_bits(Word address, Word bits) { reg(address + 0x3000) = bits; }

// Where the blocks lie (2.2).
inline constexpr Word clocks_base = 0x4000'8000, resets_base = 0x4000'c000, psm_base = 0x4001'0000,
                      io_bank0_base = 0x4001'4000, pads_bank0_base = 0x4001'c000,
                      pll_sys_base = 0x4002'8000, uart0_base = 0x4003'4000, spi0_base = 0x4003'c000,
                      i2c0_base = 0x4004'4000, i2c1_base = 0x4004'8000, adc_base = 0x4004'c000,
                      pwm_base = 0x4005'0000, timer_base = 0x4005'4000, watchdog_base = 0x4005'8000,
                      rtc_base = 0x4005'c000, dma_base = 0x5000'0000, pio0_base = 0x5020'0000,
                      pio1_base = 0x5030'0000, sio_base = 0xd000'0000, ppb_base = 0xe000'0000;

/// RESETS (2.14.3): bits of the blocks.
namespace block {
inline constexpr Word adc = 1u << 0, busctrl = 1u << 1, dma = 1u << 2, i2c0 = 1u << 3,
                      i2c1 = 1u << 4, io_bank0 = 1u << 5, pads_bank0 = 1u << 8, pio0 = 1u << 10,
                      pio1 = 1u << 11, pwm = 1u << 14, rtc = 1u << 15, spi0 = 1u << 16,
                      syscfg = 1u << 18, sysinfo = 1u << 19, tbman = 1u << 20, timer = 1u << 21,
                      uart0 = 1u << 22, usbctrl = 1u << 24;
}  // namespace block

/// Releases blocks from reset and waits until they are ready.
inline void release(Word blocks) {
  clear_bits(resets_base, blocks);
  while ((reg(resets_base + 8) & blocks) != blocks) {
  }
}

/// Functions of pins (2.19.2).
enum class Function : Word { spi = 1, uart, i2c, pwm, sio, pio0, pio1, clock, usb };

inline Register& pin_control(unsigned gpio) { return reg(io_bank0_base + 8 * gpio + 4); }
inline void select(unsigned gpio, Function function) {
  pin_control(gpio) = static_cast<Word>(function);
}

// SIO (2.3.1.7).
inline Register& gpio_in() { return reg(sio_base + 0x04); }
inline Register& gpio_set() { return reg(sio_base + 0x14); }
inline Register& gpio_clear() { return reg(sio_base + 0x18); }
inline Register& gpio_toggle() { return reg(sio_base + 0x1c); }

/// A pin that software drives, low at first.
inline void make_output(unsigned gpio) {
  gpio_clear() = 1u << gpio;
  reg(sio_base + 0x24) = 1u << gpio;
  select(gpio, Function::sio);
}

// NVIC (2.4.8).
inline void enable_irq(unsigned irq) { reg(ppb_base + 0xe100) = 1u << irq; }

/// UART0 at 1 Mbaud, 8 bits, on GPIO 0 and 1: 125 MHz / 16 / 1 MHz = 7 + 52/64 (4.2.7.1).
inline void start_uart() {
  release(block::uart0);
  reg(uart0_base + 0x24) = 7;
  reg(uart0_base + 0x28) = 52;
  reg(uart0_base + 0x2c) = 3u << 5 | 1u << 4;       // LCR_H: 8 bits, FIFOs
  reg(uart0_base + 0x30) = 1u << 9 | 1u << 8 | 1u;  // CR: RXE, TXE, UARTEN
  select(0, Function::uart);
  select(1, Function::uart);
}

inline void put(char byte) {
  while ((reg(uart0_base + 0x18) & 1u << 5) != 0) {  // FR: TXFF
  }
  reg(uart0_base) = static_cast<unsigned char>(byte);
}
inline void print(const char* text) {
  while (*text != '\0') put(*text++);
}
/// Waits until everything has been sent.
inline void flush() {
  while ((read(uart0_base + 0x18) & 1u << 3) != 0) {  // FR: BUSY
  }
}
/// " 0123abcd"
inline void print_hex(Word value) {
  put(' ');
  for (int shift = 28; shift >= 0; shift -= 4) put("0123456789abcdef"[value >> shift & 15]);
}

/// Starts at 125 MHz from the crystal, ticks of 1 us, with pins and timer out of reset.
inline void start() { release(block::io_bank0 | block::pads_bank0 | block::timer); }

inline Word now_us() { return reg(timer_base + 0x28); }  // TIMERAWL (4.6.5)

}  // namespace image
