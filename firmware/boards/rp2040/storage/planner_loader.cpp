#include "firmware/boards/rp2040/storage/planner_loader.hpp"

#include <cstring>

#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/registers/dma.hpp"

// From the linker script.
extern "C" {
extern std::uint8_t planner_memory[];
extern std::uint8_t planner_memory_end[];
extern const std::uint8_t planner_lines_in_flash[];
extern const std::uint8_t planner_path_in_flash[];
extern const std::uint8_t planner_free_in_flash[];
extern const std::uint8_t image_in_flash[];
}

namespace lamplock::rp2040 {
namespace {

using machine::PlannerKind;

/// A multiple of a line of the cache. A miss costs 144 clocks for eight bytes (base/xip.hpp).
constexpr std::uint32_t piece_bytes = 2048;
/// Each half of the word is the instruction UDF (ARMv6-M Architecture Reference Manual, A6.7.72).
constexpr int undefined_instructions = 0xde;
/// One wrong copy may be a disturbance on the wires of the flash.
constexpr std::uint32_t max_wrong_copies = 3;
/// Result of a CRC-32 over data that ends with its own CRC, before the last inversion, in the order
/// of bits of the DMA (RP2040 datasheet, 2.5.5.2).
constexpr std::uint32_t right_crc = 0xc704dd7b;

struct FlashPart {
  const std::uint8_t* begin;
  const std::uint8_t* end;
};

/// The planners follow each other in flash, before the image.
FlashPart part_of(PlannerKind kind) {
  switch (kind) {
    case PlannerKind::lines:
      return {planner_lines_in_flash, planner_path_in_flash};
    case PlannerKind::path:
      return {planner_path_in_flash, planner_free_in_flash};
    case PlannerKind::free:
      return {planner_free_in_flash, image_in_flash};
    default:
      return {};
  }
}

}  // namespace

void PlannerLoader::clear() {
  kind_ = PlannerKind::none;
  copied_bytes_ = 0;
  std::memset(planner_memory, undefined_instructions,
              static_cast<std::size_t>(planner_memory_end - planner_memory));
}

PlannerKind PlannerLoader::load(PlannerKind kind) {
  const FlashPart part = part_of(kind);
  const auto bytes = static_cast<std::uint32_t>(part.end - part.begin);
  if (kind != kind_) clear();
  kind_ = kind;
  const std::uint32_t left = bytes - copied_bytes_;
  const std::uint32_t piece = left < piece_bytes ? left : piece_bytes;
  std::memcpy(planner_memory + copied_bytes_, part.begin + copied_bytes_, piece);
  copied_bytes_ += piece;
  if (copied_bytes_ != bytes) return PlannerKind::none;
  if (copy_is_right(bytes)) {
    wrong_copies_ = 0;
    return kind;
  }
  clear();
  if (++wrong_copies_ == max_wrong_copies)
    __builtin_trap();  // the fault handler restarts the board
  return PlannerKind::none;
}

/// DMA reads the copy and calculates the CRC on the way: 0.2 ms.
bool PlannerLoader::copy_is_right(std::uint32_t bytes) {
  // The copy is complete before the first word is read, and before its first instruction.
  asm volatile("dsb\n isb" ::: "memory");
  dma().sniff_ctrl = dma_sniff::en | dma_sniff::channel(check_channel) | dma_sniff::crc32_reversed;
  dma().sniff_data = ~0u;
  DmaChannelRegisters& channel = dma().ch[check_channel];
  channel.read_addr = reinterpret_cast<std::uintptr_t>(planner_memory);
  channel.write_addr = reinterpret_cast<std::uintptr_t>(&sink_);
  channel.trans_count = bytes / sizeof(std::uint32_t);
  channel.ctrl_trig = dma_ctrl::en | dma_ctrl::size_word | dma_ctrl::incr_read |
                      dma_ctrl::chain_to(check_channel) | dma_ctrl::treq(dreq::permanent) |
                      dma_ctrl::irq_quiet | dma_ctrl::sniff_en;
  while ((channel.ctrl_trig & dma_ctrl::busy) != 0) {
  }
  const std::uint32_t crc = dma().sniff_data;
  channel.al1_ctrl = 0;
  dma().sniff_ctrl = 0;
  return crc == right_crc;
}

}  // namespace lamplock::rp2040
