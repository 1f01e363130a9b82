// The core's own registers: NVIC, system control (ARMv6-M Architecture Reference Manual,
// B3.2 to B3.4). Word accesses only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct NvicRegisters {
  Register iser;
  Register reserved0[31];
  Register icer;
  Register reserved1[31];
  Register ispr;
  Register reserved2[31];
  Register icpr;
  Register reserved3[95];
  Register ipr[8];
};
static_assert(offsetof(NvicRegisters, icer) == 0x80);
static_assert(offsetof(NvicRegisters, ispr) == 0x100);
static_assert(offsetof(NvicRegisters, icpr) == 0x180);
static_assert(offsetof(NvicRegisters, ipr) == 0x300);
inline NvicRegisters& nvic() { return *reinterpret_cast<NvicRegisters*>(0xe000e100); }

struct ScbRegisters {
  Register cpuid;
  Register icsr;
  Register vtor;
  Register aircr;
  Register scr;
  Register ccr;
  Register reserved;
  Register shpr2;
  Register shpr3;
};
static_assert(offsetof(ScbRegisters, shpr3) == 0x20);
inline ScbRegisters& scb() { return *reinterpret_cast<ScbRegisters*>(0xe000ed00); }

/// External interrupts (RP2040 datasheet, 2.3.2).
enum class Irq : std::uint8_t {
  timer_0 = 0,
  timer_1 = 1,
  timer_2 = 2,
  timer_3 = 3,
  pwm_wrap = 4,
  usbctrl = 5,
  xip = 6,
  pio0_0 = 7,
  pio0_1 = 8,
  pio1_0 = 9,
  pio1_1 = 10,
  dma_0 = 11,
  dma_1 = 12,
  io_bank0 = 13,
  io_qspi = 14,
  sio_proc0 = 15,
  sio_proc1 = 16,
  clocks = 17,
  spi0 = 18,
  spi1 = 19,
  uart0 = 20,
  uart1 = 21,
  adc_fifo = 22,
  i2c0 = 23,
  i2c1 = 24,
  rtc = 25,
  spare_0 = 26,  ///< 26 to 31 have no source; software may pend them
};

constexpr std::uint32_t irq_bit(Irq irq) { return 1u << static_cast<unsigned>(irq); }

/// Priority 0 (highest) to 3: the two upper bits of a byte.
inline void set_priority(Irq irq, std::uint32_t priority) {
  const auto number = static_cast<unsigned>(irq);
  const unsigned shift = 8 * (number % 4) + 6;
  Register& reg = nvic().ipr[number / 4];
  reg = (reg & ~(3u << shift)) | (priority << shift);
}

/// Masks interrupts by PRIMASK for the life of the object; at most 1 us.
class AllMasked {
 public:
  AllMasked() {
    asm volatile("mrs %0, primask" : "=r"(before_));
    asm volatile("cpsid i" ::: "memory");
  }
  ~AllMasked() { asm volatile("msr primask, %0" ::"r"(before_) : "memory"); }
  AllMasked(const AllMasked&) = delete;
  AllMasked& operator=(const AllMasked&) = delete;

 private:
  std::uint32_t before_;
};

/// Sleeps until an interrupt has been handled; returns at once if one has since the last call, so
/// that no interrupt is missed between a check of its data and the sleep. Entry to and return from
/// a handler set the event register that ends WFE (ARMv6-M Architecture Reference Manual, "Wait For
/// Event and Send Event"). The handler that ends the sleep sets it too: SEV and the second WFE
/// clear it, or each call would be followed by one that does not sleep.
inline void wait_for_interrupt() { asm volatile("wfe\n sev\n wfe" ::: "memory"); }

/// Sleeps until the other core has sent an event; returns at once if it has since the last call.
inline void wait_for_event() { asm volatile("wfe" ::: "memory"); }

/// Sends an event to both cores.
inline void send_event() { asm volatile("sev" ::: "memory"); }

}  // namespace lamplock::rp2040
