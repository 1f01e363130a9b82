// Cycle counts that the manuals do not give, as parameters, each with what is known of it.
//
// Counts that the manuals give are in the code that uses them. docs/chip-timing.md lists them all:
// documented, measured by others, or assumed.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip {

/// All assumed numbers, in cycles of clk_sys.
struct Timing {
  std::uint32_t exception_return = 13;  ///< not documented for the Cortex-M0+
  /// From the end of one handler, or from a late higher priority, to the first instruction of the
  /// next one: entry (15) without its eight stores. Not documented either.
  std::uint32_t tail_chain = 7;
  /// In addition to the one cycle of data phase that every access has. An APB access takes two
  /// cycles, the bridge adds one to reads and two to writes (RP2040 datasheet, 2.1.3): LDR 4
  /// cycles, STR 5.
  std::uint32_t apb_read_wait = 2;
  std::uint32_t apb_write_wait = 3;
  std::uint32_t ahb_wait = 0;   ///< AHB-Lite blocks: PIO, DMA, USB DPRAM, XIP control
  std::uint32_t dma_start = 2;  ///< from a request to the first read
};

}  // namespace lamplock::sim::chip
