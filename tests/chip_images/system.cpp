// Identification of the chip, and small blocks: SYSINFO, TBMAN, VREG_AND_CHIP_RESET, PSM, SYSCFG
// (synchronisers, NMI), ROSC, the frequency counter after dividers, BUSCTRL with its counters,
// counters of the XIP cache. Results on UART0.
#include "tests/chip_images/dma.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 2.2.
constexpr Word sysinfo_base = 0x4000'0000, syscfg_base = 0x4000'4000, busctrl_base = 0x4003'0000,
               rosc_base = 0x4006'0000, vreg_base = 0x4006'4000, tbman_base = 0x4006'c000,
               xip_base = 0x1000'0000, xip_past_cache = 0x1300'0000, xip_control_base = 0x1400'0000,
               sram4 = 0x2004'0000, sram5 = 0x2004'1000;

void show_identity() {
  print("chip");
  print_hex(reg(sysinfo_base));
  print_hex(reg(sysinfo_base + 4));
  print_hex(reg(tbman_base));
  print("\nvreg");
  for (const Word offset : {0u, 4u, 8u}) print_hex(reg(vreg_base + offset));
}

void show_power_stages() {
  constexpr Word force_off = psm_base + 4, done = psm_base + 0xc, core1 = 1u << 16;
  print("\npsm");
  print_hex(reg(done));
  set_bits(force_off, core1);
  print_hex(reg(done));
  clear_bits(force_off, core1);
  print_hex(reg(done));
}

/// Answers `count` pulses at GPIO 8 on GPIO 2: polls every 1 + 1 + 2 cycles, and stores 1 + 1 + 1
/// cycles after the poll that sees the pulse.
[[gnu::noinline]] void answer(Word count) {
  asm volatile(
      ".syntax unified\n"
      "1: ldr r3, [%[sio], #0x04]\n"
      "tst r3, %[in]\n"
      "beq 1b\n"
      "str %[out], [%[sio], #0x14]\n"
      "2: ldr r3, [%[sio], #0x04]\n"
      "tst r3, %[in]\n"
      "bne 2b\n"
      "str %[out], [%[sio], #0x18]\n"
      "subs %[count], #1\n"
      "bne 1b\n"
      : [count] "+l"(count)
      : [sio] "l"(sio_base), [in] "l"(1u << 8), [out] "l"(1u << 2)
      : "r3", "cc");
}

void answer_without_synchroniser() {
  constexpr Word bypass = syscfg_base + 0x0c;
  print("\nanswers\n");
  answer(50);
  reg(bypass) = 1u << 8;
  print("sooner\n");
  answer(50);
  reg(bypass) = 1u << 9;  // of another pin
  print("as before\n");
  answer(50);
  reg(bypass) = 0;
}

volatile Word nmis, nmi_number;

/// The line of alarm 0, which is not enabled in the NVIC, is forced high (INTF, 4.6.5) between
/// edges of GPIO 2, with interrupts masked.
void show_nmi() {
  constexpr Word mask = syscfg_base, force = timer_base + 0x3c;
  asm volatile("cpsid i");
  reg(force) = 1;
  reg(force) = 0;
  print("masked");
  print_hex(nmis);
  print("\n");
  flush();
  reg(mask) = 1;
  asm volatile(
      ".syntax unified\n"
      "str %[pin], [%[sio], #0x14]\n"
      "str %[one], [%[force]]\n"
      "str %[pin], [%[sio], #0x18]\n" ::[pin] "l"(1u << 2),
      [sio] "l"(sio_base), [one] "l"(1), [force] "l"(force));
  reg(mask) = 0;
  print("nmi");
  print_hex(nmis);
  print_hex(nmi_number);
  asm volatile("cpsie i");
}

// The frequency counter (2.15.6).
enum class Source : Word { rosc = 3, adc = 12, rtc = 13 };

/// In 1/32 kHz.
Word measure(Source which, Word interval) {
  reg(clocks_base + 0x80) = 12'000;
  reg(clocks_base + 0x84) = 0;
  reg(clocks_base + 0x88) = 0x01ff'ffff;
  reg(clocks_base + 0x90) = interval;
  reg(clocks_base + 0x94) = static_cast<Word>(which);
  while ((read(clocks_base + 0x98) & 1u << 4) == 0) {
  }
  return read(clocks_base + 0x9c);
}

/// From PLL_USB.
void start_clock(Word control, Word divider) {
  reg(control) = 0;
  reg(control + 4) = divider;
  reg(control) = 1u << 11;
}

void show_dividers() {
  constexpr Word clk_adc = clocks_base + 0x60, clk_rtc = clocks_base + 0x6c;
  print("\ndivided");
  for (const Word divider : {1u, 2u, 3u}) {
    start_clock(clk_adc, divider << 8);
    print_hex(measure(Source::adc, 10) >> 5);
  }
  start_clock(clk_rtc, 1024u << 8);
  print_hex(measure(Source::rtc, 15));
  start_clock(clk_rtc, 500u << 8 | 128);
  print_hex(measure(Source::rtc, 15) >> 5);
}

bool near(Word one, Word other, Word most) { return one - other + most <= 2 * most; }

void show_ring() {
  constexpr Word divider = rosc_base + 0x10, status = rosc_base + 0x18, pass = 0xaa0;
  constexpr Word shown = 1u << 31 | 1u << 24 | 1u << 16 | 1u << 12;
  print("\nring");
  print_hex(reg(status) & shown);
  const Word by16 = measure(Source::rosc, 10);
  reg(divider) = pass + 8;
  const Word by8 = measure(Source::rosc, 10);
  reg(divider) = pass;
  const Word by32 = measure(Source::rosc, 10);
  reg(divider) = pass + 16;
  print_hex(near(by8, 2 * by16, 3 * 32) ? 1 : 0);
  print_hex(near(by16, 2 * by32, 3 * 32) ? 1 : 0);
  reg(rosc_base) = 0x123;  // neither a frequency range nor ENABLE or DISABLE
  print_hex(reg(status) & shown);
  reg(rosc_base) = 0xfab'aa0;
  reg(status) = 1u << 24;
  print_hex(reg(status) & shown);
}

/// A DMA of 1000 words from SRAM4 to SRAM5, a word per clock, while the core loads 64 times from
/// SRAM4: GPIO 3 is high while the DMA works, GPIO 4 from before the first to after the last load.
/// Returns PERFCTR0.
[[gnu::noinline]] Word contend() {
  constexpr Word control =
      channel::enable | channel::word | channel::chain(0) | channel::request(channel::permanent);
  reg(busctrl_base + 0x0c) = 6;  // SRAM4 contested
  reg(busctrl_base + 0x08) = 0;
  dma_reg(0, 0) = sram4;
  dma_reg(0, 4) = sram5;
  dma_reg(0, 8) = 1000;
  asm volatile(
      ".syntax unified\n"
      "movs r2, #8\n"
      "movs r3, #16\n"
      "movs r4, #64\n"
      "str r2, [%[sio], #0x14]\n"
      "str %[control], [%[dma], #0x0c]\n"
      "nop; nop; nop; nop; nop; nop; nop; nop\n"
      "str r3, [%[sio], #0x14]\n"
      "1: ldr r5, [%[from]]\n"
      "subs r4, #1\n"
      "bne 1b\n"
      "str r3, [%[sio], #0x18]\n"
      "ldr r3, =1 << 24\n"
      "2: ldr r4, [%[dma], #0x0c]\n"
      "tst r4, r3\n"
      "bne 2b\n"
      "str r2, [%[sio], #0x18]\n" ::[sio] "l"(sio_base),
      [dma] "l"(dma_base), [control] "l"(control), [from] "l"(sram4)
      : "r2", "r3", "r4", "r5", "cc", "memory");
  return reg(busctrl_base + 0x08);
}

void show_bus() {
  constexpr Word priority = busctrl_base, acknowledged = busctrl_base + 4;
  print("\nbus");
  print_hex(reg(priority));
  print_hex(reg(busctrl_base + 0x0c));
  print("\n");
  flush();
  const Word contested = contend();
  print("contested");
  print_hex(contested);
  reg(busctrl_base + 0x08) = 0x55;
  print_hex(reg(busctrl_base + 0x08));
  print("\n");
  flush();
  reg(priority) = 1u << 8;  // DMA_R
  while (reg(acknowledged) == 0) {
  }
  static_cast<void>(contend());
  reg(priority) = ~0u;
  print("priority");
  print_hex(reg(priority));
  reg(priority) = 0;
}

void show_cache() {
  constexpr Word flush_cache = xip_control_base + 4, hits = xip_control_base + 0xc,
                 accesses = xip_control_base + 0x10;
  reg(flush_cache) = 1;
  static_cast<void>(read(flush_cache));
  const auto show = [&](Word from, Word words) {
    reg(hits) = 0;
    reg(accesses) = 0;
    for (Word i = 0; i < words; ++i) static_cast<void>(read(from + 4 * i));
    print_hex(reg(accesses));
    print_hex(reg(hits));
  };
  print("\ncache");
  show(xip_base, 16);
  show(xip_base, 16);
  show(xip_past_cache, 4);
  print("\n");
}

}  // namespace

/// 1 + 1 + 1 cycles, and the store of 1.
extern "C" [[gnu::naked]] void nmi() {
  asm volatile(
      ".syntax unified\n"
      "movs r0, #13\n"
      "lsls r0, r0, #28\n"
      "movs r1, #8\n"
      "str r1, [r0, #0x14]\n"
      "str r1, [r0, #0x18]\n"
      "push {r4, lr}\n"
      "bl note_nmi\n"
      "pop {r4, pc}\n");
}

extern "C" void note_nmi() {
  nmis = nmis + 1;
  Word exception = 0;
  asm volatile("mrs %0, ipsr" : "=r"(exception));
  nmi_number = exception;
  reg(timer_base + 0x3c) = 0;
}

int main() {
  start();
  start_uart();
  release(block::busctrl | block::dma | block::syscfg | block::sysinfo | block::tbman);
  for (const unsigned gpio : {2u, 3u, 4u}) make_output(gpio);
  show_identity();
  show_power_stages();
  answer_without_synchroniser();
  show_nmi();
  show_dividers();
  show_ring();
  show_bus();
  show_cache();
  for (;;) {
  }
}
