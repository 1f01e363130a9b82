// Integer divider and interpolators. Results on UART0, GPIO 2 high while the divider works.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

constexpr Word udividend = sio_base + 0x60, sdividend = sio_base + 0x68, quotient = sio_base + 0x70,
               remainder = sio_base + 0x74, csr = sio_base + 0x78;

/// The divisor's register follows the dividend's.
void divide(Word dividend_register, Word dividend, Word divisor) {
  reg(dividend_register) = dividend;
  reg(dividend_register + 4) = divisor;
  asm volatile("nop; nop; nop; nop; nop; nop; nop; nop");
  const Word rest = reg(remainder);
  print_hex(reg(quotient));
  print_hex(rest);
}

/// READY in the first, second and sixth cycle after the store of the divisor, from bit 0 on; then
/// in the eleventh.
void show_ready() {
  Word first = 0, second = 0, sixth = 0, last = 0;
  asm volatile(
      "str %[divisor], [%[base], #0x64]\n"
      "ldr %[first], [%[base], #0x78]\n"
      "ldr %[second], [%[base], #0x78]\n"
      "nop; nop; nop\n"
      "ldr %[sixth], [%[base], #0x78]\n"
      "nop; nop; nop; nop\n"
      "ldr %[last], [%[base], #0x78]\n"
      : [first] "=&l"(first), [second] "=&l"(second), [sixth] "=&l"(sixth), [last] "=&l"(last)
      : [base] "l"(sio_base), [divisor] "l"(7));
  print_hex((first & 1) | (second & 1) << 1 | (sixth & 1) << 2);
  print_hex(last & 1);
}

/// An interpolator's registers (2.3.1.7).
struct Interpolator {
  Word base;
  Register& accumulator(Word lane) const { return reg(base + 4 * lane); }
  Register& base_of(Word lane) const { return reg(base + 0x08 + 4 * lane); }  // 2: of the sum
  Word pop(Word lane) const { return reg(base + 0x14 + 4 * lane); }
  Word peek(Word lane) const { return reg(base + 0x20 + 4 * lane); }
  Register& control(Word lane) const { return reg(base + 0x2c + 4 * lane); }
  Register& add(Word lane) const { return reg(base + 0x34 + 4 * lane); }
  Register& both_bases() const { return reg(base + 0x3c); }
};
constexpr Interpolator interp0{sio_base + 0x80}, interp1{sio_base + 0xc0};
constexpr Word is_signed = 1 << 15, cross_input = 1 << 16, cross_result = 1 << 17,
               add_raw = 1 << 18, blend = 1 << 21, clamp = 1 << 22;
constexpr Word shift(Word bits) { return bits; }
constexpr Word mask(Word lowest, Word highest) { return lowest << 5 | highest << 10; }

void show_interpolators() {
  const Interpolator& i = interp0;
  print("mask");
  i.control(0) = shift(4) | mask(0, 7);
  i.control(1) = shift(0) | mask(0, 31);
  i.accumulator(0) = 0x1234'5678;
  i.base_of(0) = 0x1000;
  print_hex(i.peek(0));
  i.control(0) = shift(4) | mask(0, 7) | is_signed;
  i.accumulator(0) = 0xff0;
  print_hex(i.peek(0));
  i.control(0) = shift(4) | mask(4, 7);
  print_hex(i.peek(0));
  i.control(0) = shift(4) | mask(0, 3) | add_raw;
  print_hex(i.peek(0));

  print("\npop");
  i.control(0) = mask(0, 31);
  i.control(1) = mask(0, 31);
  i.accumulator(0) = 0;
  i.accumulator(1) = 100;
  i.base_of(0) = 5;
  i.base_of(1) = 7;
  i.base_of(2) = 1000;
  for (int n = 0; n < 3; ++n) print_hex(i.pop(0));
  print_hex(i.accumulator(1));
  print_hex(i.peek(2));
  i.add(0) = 0x10;
  print_hex(i.accumulator(0));

  print("\ncross");
  i.control(0) = mask(0, 31) | cross_result;
  i.control(1) = mask(0, 31) | cross_result;
  i.accumulator(0) = 1;
  i.accumulator(1) = 2;
  i.base_of(0) = 0x10;
  i.base_of(1) = 0x20;
  print_hex(i.pop(0));
  print_hex(i.accumulator(0));
  print_hex(i.accumulator(1));
  i.control(0) = mask(0, 31) | cross_input;
  print_hex(i.peek(0));

  print("\nbases");
  i.control(0) = mask(0, 31) | is_signed;
  i.control(1) = mask(0, 31);
  i.both_bases() = 0xfffe'fffd;
  print_hex(i.base_of(0));
  print_hex(i.base_of(1));

  print("\nblend");
  i.control(0) = blend;
  i.control(1) = mask(0, 7);
  i.base_of(0) = 100;
  i.base_of(1) = 300;
  for (const Word fraction : {0u, 64u, 128u, 255u}) {
    i.accumulator(1) = fraction;
    print_hex(i.peek(1));
  }

  print("\nbetween");
  i.control(0) = mask(0, 31) | blend;
  i.control(1) = mask(0, 7) | is_signed;
  i.accumulator(0) = 5;
  i.base_of(0) = static_cast<Word>(-100);
  i.base_of(1) = 100;
  for (const Word fraction : {32u, 0x1c0u}) {
    i.accumulator(1) = fraction;
    print_hex(i.peek(1));
    print_hex(i.peek(0));
  }
  print_hex(i.peek(2));

  print("\nclamp");
  const Interpolator& c = interp1;
  c.control(0) = mask(0, 31) | is_signed | clamp;
  c.base_of(0) = static_cast<Word>(-10);
  c.base_of(1) = 20;
  for (const int value : {-11, -3, 20, 21}) {
    c.accumulator(0) = static_cast<Word>(value);
    print_hex(c.peek(0));
  }
  c.control(0) = mask(0, 31) | clamp;
  c.base_of(0) = 10;
  for (const int value : {-1, 9, 15}) {
    c.accumulator(0) = static_cast<Word>(value);
    print_hex(c.peek(0));
  }

  print("\nflags");
  c.control(0) = mask(0, 7) | 2u << 19;  // FORCE_MSB
  c.control(1) = mask(0, 31);
  c.base_of(0) = 0x1000;
  c.accumulator(0) = 0xff;
  print_hex(c.control(0) >> 23 & 7);
  c.accumulator(0) = 0x112;
  print_hex(c.control(0) >> 23 & 7);
  print_hex(c.pop(0));
  print_hex(c.accumulator(0));
  print("\n");
}

}  // namespace

int main() {
  start();
  start_uart();
  print("unsigned");
  divide(udividend, 1'000'000'007, 12'345);
  divide(udividend, 5, 0);
  print("\nsigned");
  divide(sdividend, static_cast<Word>(-7), 2);
  divide(sdividend, 7, static_cast<Word>(-2));
  divide(sdividend, static_cast<Word>(-7), 0);
  divide(sdividend, 7, 0);
  divide(sdividend, 0x8000'0000, static_cast<Word>(-1));
  print("\ncsr");
  reg(udividend) = 100;
  show_ready();
  print_hex(reg(csr));
  static_cast<void>(read(quotient));
  print_hex(reg(csr));
  print("\n");
  show_interpolators();
  for (;;) {
  }
}
