// DMA channels for the images (RP2040 datasheet, 2.5.7).
#pragma once

#include "tests/chip_images/rp2040.hpp"

namespace image {

namespace channel {
inline constexpr Word enable = 1, byte = 0 << 2, half = 1 << 2, word = 2 << 2, count_read = 1 << 4,
                      count_write = 1 << 5, ring_write = 1 << 10, sniff = 1 << 23, busy = 1 << 24;
constexpr Word ring(Word bits) { return bits << 6; }
constexpr Word chain(Word to) { return to << 11; }
constexpr Word request(Word number) { return number << 15; }
/// Requests (2.5.3.1, 2.5.7 for the pacing timers and "permanent").
inline constexpr Word uart0_tx = 20, timer0 = 0x3b, permanent = 0x3f;
}  // namespace channel

inline Register& dma_reg(unsigned number, Word offset) {
  return reg(dma_base + 0x40 * number + offset);
}

inline Word address(const volatile void* of) {
  return static_cast<Word>(reinterpret_cast<std::uintptr_t>(of));
}

/// Starts a channel, unless `control` lacks channel::enable.
inline void start_dma(unsigned number, Word from, Word to, Word count, Word control) {
  dma_reg(number, 0) = from;
  dma_reg(number, 4) = to;
  dma_reg(number, 8) = count;
  dma_reg(number, 12) = control;
}

inline bool dma_busy(unsigned number) { return (dma_reg(number, 12) & channel::busy) != 0; }

}  // namespace image
