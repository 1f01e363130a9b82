// RTC with short seconds: clk_rtc 46 875 Hz from the crystal, 47 periods a second. GPIO 2 rises
// when it begins at 2027-12-31 23:59:58, Friday; the alarm at 00:00:03 on any day toggles GPIO 3.
// Then leap years. Dates on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 4.8.6; clk_rtc: 2.15.7.
constexpr Word divider = rtc_base, setup0 = rtc_base + 0x04, setup1 = rtc_base + 0x08,
               control = rtc_base + 0x0c, alarm0 = rtc_base + 0x10, alarm1 = rtc_base + 0x14,
               date = rtc_base + 0x18, time = rtc_base + 0x1c, inte = rtc_base + 0x24;
constexpr Word enable = 1, active = 2, load = 16;
constexpr unsigned irq_rtc = 25;

void begin(Word year, Word month, Word day, Word weekday, Word hour, Word minute, Word second) {
  reg(control) = 0;
  while ((read(control) & active) != 0) {
  }
  reg(setup0) = year << 12 | month << 8 | day;
  reg(setup1) = weekday << 24 | hour << 16 | minute << 8 | second;
  reg(control) = load;
  reg(control) = enable;
  while ((read(control) & active) == 0) {
  }
}

void pause(Word us) {
  const Word start = now_us();
  while (now_us() - start < us) {
  }
}

void show(const char* name) {
  print(name);
  const Word clock = read(time);  // first: it holds RTC_1
  print_hex(read(date));
  print_hex(clock);
  print("\n");
}

}  // namespace

extern "C" void irq25() {
  gpio_toggle() = 1u << 3;
  clear_bits(alarm0, 1u << 28);
  while ((read(alarm0) & 1u << 29) != 0) {  // MATCH_ACTIVE: it asks until then
  }
}

int main() {
  start();
  start_uart();
  make_output(2);
  make_output(3);
  reg(clocks_base + 0x70) = 256u << 8;
  reg(clocks_base + 0x6c) = 3u << 5 | 1u << 11;  // XOSC, ENABLE
  release(block::rtc);
  reg(divider) = 46;
  begin(2027, 12, 31, 5, 23, 59, 58);
  gpio_set() = 1u << 2;
  reg(alarm1) = 7u << 28 | 0u << 16 | 0u << 8 | 3;  // hour, minute, second
  reg(alarm0) = 0;
  reg(inte) = 1;
  enable_irq(irq_rtc);
  set_bits(alarm0, 1u << 28);
  pause(4500);
  show("year");
  pause(5000);
  begin(2028, 2, 28, 1, 23, 59, 59);
  pause(1500);
  show("leap");
  begin(2027, 2, 28, 0, 23, 59, 59);
  pause(1500);
  show("plain");
  begin(2100, 2, 28, 0, 23, 59, 59);
  pause(1500);
  show("century");
  for (;;) {
  }
}
