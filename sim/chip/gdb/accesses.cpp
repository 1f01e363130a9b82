#include "sim/chip/gdb/accesses.hpp"

#include <bit>
#include <cstring>

#include "sim/chip/cpu/decode.hpp"

namespace lamplock::sim::chip::gdb {

namespace {

constexpr std::uint32_t exception_frame = 32;  // ARMv6-M ARM, B1.5.6: eight words, aligned to 8

std::uint32_t words_in(unsigned list) {
  return 4 * static_cast<std::uint32_t>(std::popcount(list));
}

std::optional<std::uint16_t> instruction_at(std::uint32_t address, Bus& bus) {
  const auto memory = bus.memory_at(address);
  if (memory.size() < 2) return std::nullopt;
  std::uint16_t instruction = 0;
  std::memcpy(&instruction, memory.data(), sizeof instruction);
  return instruction;
}

/// Loads and stores of one register (ARMv6-M ARM, A5.2.4), and LDR of a literal.
std::optional<StepAccess> single_access(const Core& core, unsigned op) {
  const std::uint32_t base = core.reg(op >> 3 & 7);
  const std::uint32_t sum = base + core.reg(op >> 6 & 7);
  const std::uint32_t imm5 = op >> 6 & 31, imm8 = op & 0xff;
  switch (decode(static_cast<std::uint16_t>(op))) {
    case Op::ldr_literal:
      return StepAccess{((core.reg(15) + 4) & ~3u) + 4 * imm8, 4, false};
    case Op::str_reg:
      return StepAccess{sum, 4, true};
    case Op::strh_reg:
      return StepAccess{sum, 2, true};
    case Op::strb_reg:
      return StepAccess{sum, 1, true};
    case Op::ldr_reg:
      return StepAccess{sum, 4, false};
    case Op::ldrh_reg:
    case Op::ldrsh_reg:
      return StepAccess{sum, 2, false};
    case Op::ldrb_reg:
    case Op::ldrsb_reg:
      return StepAccess{sum, 1, false};
    case Op::str_imm:
      return StepAccess{base + 4 * imm5, 4, true};
    case Op::ldr_imm:
      return StepAccess{base + 4 * imm5, 4, false};
    case Op::strb_imm:
      return StepAccess{base + imm5, 1, true};
    case Op::ldrb_imm:
      return StepAccess{base + imm5, 1, false};
    case Op::strh_imm:
      return StepAccess{base + 2 * imm5, 2, true};
    case Op::ldrh_imm:
      return StepAccess{base + 2 * imm5, 2, false};
    case Op::str_sp:
      return StepAccess{core.reg(13) + 4 * imm8, 4, true};
    case Op::ldr_sp:
      return StepAccess{core.reg(13) + 4 * imm8, 4, false};
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<StepAccess> next_access(const Core& core, Bus& bus) {
  if (core.exception_waits())
    return StepAccess{(core.reg(13) - exception_frame) & ~4u, exception_frame, true};
  const auto op = instruction_at(core.reg(15), bus);
  if (!op) return std::nullopt;
  const unsigned low_list = *op & 0xffu, long_list = *op & 0x1ffu;
  switch (decode(*op)) {
    case Op::push:
      return StepAccess{core.reg(13) - words_in(long_list), words_in(long_list), true};
    case Op::pop:
      return StepAccess{core.reg(13), words_in(long_list), false};
    case Op::stm:
      return StepAccess{core.reg(*op >> 8 & 7u), words_in(low_list), true};
    case Op::ldm:
      return StepAccess{core.reg(*op >> 8 & 7u), words_in(low_list), false};
    default:
      return single_access(core, *op);
  }
}

std::uint32_t canonical_address(std::uint32_t address) {
  const std::uint32_t region = address >> 24;
  if (region >= 0x10 && region <= 0x13) return (address & 0x00ff'ffff) | 0x1000'0000;
  if ((address >> 18) == (0x2100'0000u >> 18)) {
    const std::uint32_t bank = address >> 16 & 3, word = (address & 0xffff) >> 2;
    return 0x2000'0000 | (word << 2 | bank) << 2 | (address & 3);
  }
  // The DPRAM of USB has no aliases, and covers their address bits.
  const bool registers = region == 0x40 || (region == 0x50 && address >> 16 != 0x5010);
  return registers ? address & ~0x3000u : address;
}

}  // namespace lamplock::sim::chip::gdb
