// Handlers and priorities of all interrupts: the one table for vectors, priorities and masks.
// toolchain/arm/rp2040_entries.txt lists the same handlers for the gates.
#pragma once

#include <array>

#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/machine/interrupt_mask.hpp"

extern "C" {
void estop_irq();
void edge_irq();
void beat_irq();
void usb_irq();
void uart_irq();
void fill_irq();
}

namespace lamplock::rp2040 {

/// 0 is the highest.
enum class Level : std::uint8_t { estop = 0, beat = 1, link = 2, fill = 3 };

struct InterruptEntry {
  Irq irq;
  Level level;
  void (*handler)();
};

/// Switch; result of FIRE; lengths of ticks and tokens; links; fill, pended by software.
inline constexpr std::array interrupt_entries{
    InterruptEntry{Irq::io_bank0, Level::estop, estop_irq},
    InterruptEntry{Irq::pio0_0, Level::beat, edge_irq},
    InterruptEntry{Irq::timer_1, Level::beat, beat_irq},
    InterruptEntry{Irq::usbctrl, Level::link, usb_irq},
    InterruptEntry{Irq::uart0, Level::link, uart_irq},
    InterruptEntry{Irq::spare_0, Level::fill, fill_irq},
};

constexpr std::uint32_t irqs_of(Level level) {
  std::uint32_t bits = 0;
  for (const InterruptEntry& entry : interrupt_entries)
    if (entry.level == level) bits |= irq_bit(entry.irq);
  return bits;
}

/// Beat and fill, to be masked at the NVIC while the main loop uses data shared with them. E-stop
/// and links stay enabled.
inline machine::InterruptMask core_mask() {
  return {&nvic().icer, &nvic().iser, irqs_of(Level::beat) | irqs_of(Level::fill)};
}

}  // namespace lamplock::rp2040
