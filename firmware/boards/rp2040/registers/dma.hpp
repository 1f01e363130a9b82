// Direct memory access (RP2040 datasheet, 2.5.7).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct DmaChannelRegisters {
  Register read_addr;
  Register write_addr;
  Register trans_count;
  Register ctrl_trig;
  Register al1_ctrl;
  Register al1_read_addr;
  Register al1_write_addr;
  Register al1_trans_count_trig;
  Register al2_ctrl;
  Register al2_trans_count;
  Register al2_read_addr;
  Register al2_write_addr_trig;
  Register al3_ctrl;
  Register al3_write_addr;
  Register al3_trans_count;
  Register al3_read_addr_trig;
};
static_assert(sizeof(DmaChannelRegisters) == 0x40);

struct DmaRegisters {
  DmaChannelRegisters ch[12];
  Register reserved0[64];
  Register intr;
  Register inte0;
  Register intf0;
  Register ints0;
  Register reserved1;
  Register inte1;
  Register intf1;
  Register ints1;
  Register timer[4];
  Register multi_chan_trigger;
  Register sniff_ctrl;
  Register sniff_data;
  Register reserved2;
  Register fifo_levels;
  Register chan_abort;
  Register n_channels;
};
static_assert(offsetof(DmaRegisters, intr) == 0x400);
static_assert(offsetof(DmaRegisters, timer) == 0x420);
static_assert(offsetof(DmaRegisters, multi_chan_trigger) == 0x430);
static_assert(offsetof(DmaRegisters, chan_abort) == 0x444);

inline DmaRegisters& dma() { return *reinterpret_cast<DmaRegisters*>(0x50000000); }

namespace dma_ctrl {
inline constexpr std::uint32_t en = 1u << 0;
inline constexpr std::uint32_t high_priority = 1u << 1;
inline constexpr std::uint32_t size_half = 1u << 2;
inline constexpr std::uint32_t size_word = 2u << 2;
inline constexpr std::uint32_t incr_read = 1u << 4;
inline constexpr std::uint32_t incr_write = 1u << 5;
/// Addresses wrap at 2^bits bytes, on the side that `ring_write` chooses.
constexpr std::uint32_t ring_size(unsigned bits) { return bits << 6; }
inline constexpr std::uint32_t ring_write = 1u << 10;
constexpr std::uint32_t chain_to(unsigned channel) { return channel << 11; }
constexpr std::uint32_t treq(unsigned request) { return request << 15; }
inline constexpr std::uint32_t irq_quiet = 1u << 21;
inline constexpr std::uint32_t sniff_en = 1u << 23;
inline constexpr std::uint32_t busy = 1u << 24;
}  // namespace dma_ctrl

/// The sniffer: a checksum of the data of one channel (2.5.5.2).
namespace dma_sniff {
inline constexpr std::uint32_t en = 1u << 0;
constexpr std::uint32_t channel(unsigned number) { return number << 1; }
/// CRC-32 of IEEE 802.3, lowest bit first.
inline constexpr std::uint32_t crc32_reversed = 1u << 5;
}  // namespace dma_sniff

/// Data requests (2.5.3.1).
namespace dreq {
constexpr unsigned pio_tx(unsigned block, unsigned sm) { return 8 * block + sm; }
constexpr unsigned pio_rx(unsigned block, unsigned sm) { return 8 * block + 4 + sm; }
inline constexpr unsigned permanent = 0x3f;
}  // namespace dreq

}  // namespace lamplock::rp2040
