// PWM. Slice 1 (GPIO 2, 3): plain; slice 2 (GPIO 4): phase-correct; slice 3 (GPIO 6): fractional
// divider; slice 4 (GPIO 8, input 9): counts rising edges; slice 5: wraps, its interrupt toggles
// GPIO 10; slice 7 (GPIO 14, input 15): counts while its input is high. GPIO 7 rises when all run.
// Later slice 1 gets other compare levels, which apply from its next wrap.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 4.5.3.
constexpr Word phase_correct = 2, invert_b = 8, gate_by_level = 1 << 4, count_rises = 2 << 4;
constexpr Word pwm_enable = pwm_base + 0xa0, pwm_intr = pwm_base + 0xa4, pwm_inte = pwm_base + 0xa8;
constexpr unsigned irq_pwm = 4;

void set_up(unsigned slice, Word mode, Word divider_16, Word top, Word compare) {
  const Word base = pwm_base + 0x14 * slice;
  reg(base + 0x00) = mode;
  reg(base + 0x04) = divider_16;
  reg(base + 0x08) = 0;
  reg(base + 0x0c) = compare;
  reg(base + 0x10) = top;
}

}  // namespace

extern "C" void irq4() {
  gpio_toggle() = 1u << 10;
  reg(pwm_intr) = 1u << 5;
}

int main() {
  start();
  release(block::pwm);
  make_output(7);
  make_output(10);
  set_up(1, invert_b, 1 << 4, 99, 60 << 16 | 30);
  set_up(2, phase_correct, 1 << 4, 99, 30);
  set_up(3, 0, 2 << 4 | 8, 9, 5);
  set_up(4, count_rises, 1 << 4, 4, 1);
  set_up(5, 0, 1 << 4, 12'499, 0);
  set_up(7, gate_by_level, 1 << 4, 9, 5);
  for (const unsigned gpio : {2u, 3u, 4u, 6u, 8u, 9u, 14u, 15u}) select(gpio, Function::pwm);
  reg(pwm_inte) = 1u << 5;
  enable_irq(irq_pwm);
  reg(pwm_enable) = 1u << 1 | 1u << 2 | 1u << 3 | 1u << 4 | 1u << 5 | 1u << 7;
  gpio_set() = 1u << 7;
  const Word begin = now_us();
  while (now_us() - begin < 1000) {
  }
  // At least 20 cycles after a wrap, long before the next.
  while (reg(pwm_base + 0x14 + 8) < 20 || reg(pwm_base + 0x14 + 8) > 40) {
  }
  reg(pwm_base + 0x14 + 0x0c) = 100u << 16 | 70;
  gpio_clear() = 1u << 7;
  for (;;) {
  }
}
