// Which instruction a halfword is (ARMv6-M Architecture Reference Manual, A5.2).
//
// Ten bits (15..6) distinguish all 16-bit Thumb instructions; the rest (register lists,
// should-be-zero bits, hints, second halfwords) is decoded where it is executed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamplock::sim::chip {

enum class Op : std::uint8_t {
  undefined,
  lsl_imm,
  lsr_imm,
  asr_imm,
  add_reg,
  sub_reg,
  add_imm3,
  sub_imm3,
  mov_imm,
  cmp_imm,
  add_imm8,
  sub_imm8,
  and_reg,
  eor_reg,
  lsl_reg,
  lsr_reg,
  asr_reg,
  adc_reg,
  sbc_reg,
  ror_reg,
  tst_reg,
  rsb_imm,
  cmp_reg,
  cmn_reg,
  orr_reg,
  mul_reg,
  bic_reg,
  mvn_reg,
  add_high,
  cmp_high,
  mov_high,
  bx,
  blx,
  ldr_literal,
  str_reg,
  strh_reg,
  strb_reg,
  ldrsb_reg,
  ldr_reg,
  ldrh_reg,
  ldrb_reg,
  ldrsh_reg,
  str_imm,
  ldr_imm,
  strb_imm,
  ldrb_imm,
  strh_imm,
  ldrh_imm,
  str_sp,
  ldr_sp,
  adr,
  add_sp_imm8,
  add_sp,
  sub_sp,
  sxth,
  sxtb,
  uxth,
  uxtb,
  push,
  cps,
  rev,
  rev16,
  revsh,
  pop,
  bkpt,
  hint,
  stm,
  ldm,
  b_eq,
  b_ne,
  b_cs,
  b_cc,
  b_mi,
  b_pl,
  b_vs,
  b_vc,
  b_hi,
  b_ls,
  b_ge,
  b_lt,
  b_gt,
  b_le,
  svc,
  b,
  wide
};

/// The instruction that bits 15..6 of a halfword encode.
constexpr Op decode_bits(unsigned bits) {
  const auto from = [](Op first, unsigned index) {
    return static_cast<Op>(static_cast<unsigned>(first) + index);
  };
  const unsigned top8 = bits >> 2, top7 = bits >> 3, top5 = bits >> 5, top4 = bits >> 6;
  if (top5 < 3) return from(Op::lsl_imm, top5);
  if (top5 == 3) return from(Op::add_reg, top7 & 3);
  if (top5 < 8) return from(Op::mov_imm, top5 & 3);
  if (top8 < 0x44) return from(Op::and_reg, bits & 15);
  if (top8 < 0x47) return from(Op::add_high, top8 & 3);
  if (top8 == 0x47) return (bits & 2) != 0 ? Op::blx : Op::bx;
  if (top5 == 9) return Op::ldr_literal;
  if (top4 == 5) return from(Op::str_reg, top7 & 7);
  if (top5 < 20) return from(Op::str_imm, top5 - 12);
  if (top5 == 20) return Op::adr;
  if (top5 == 21) return Op::add_sp_imm8;
  switch (top8) {
    case 0xb0:
      return (bits & 2) != 0 ? Op::sub_sp : Op::add_sp;
    case 0xb2:
      return from(Op::sxth, bits & 3);
    case 0xb4:
    case 0xb5:
      return Op::push;
    case 0xb6:
      return (bits & 3) == 1 ? Op::cps : Op::undefined;
    case 0xba:
      return (bits & 3) == 2 ? Op::undefined : from(Op::rev, (bits & 3) == 3 ? 2 : bits & 3);
    case 0xbc:
    case 0xbd:
      return Op::pop;
    case 0xbe:
      return Op::bkpt;
    case 0xbf:
      return Op::hint;
    default:
      break;
  }
  if (top5 == 24) return Op::stm;
  if (top5 == 25) return Op::ldm;
  if (top4 == 13) {
    if (top8 == 0xdf) return Op::svc;
    return top8 == 0xde ? Op::undefined : from(Op::b_eq, top8 & 15);
  }
  if (top5 == 28) return Op::b;
  if (top5 == 30) return Op::wide;
  return Op::undefined;
}

inline constexpr std::array<Op, 1024> decode_table = [] {
  std::array<Op, 1024> table{};
  for (unsigned bits = 0; bits < table.size(); ++bits) table[bits] = decode_bits(bits);
  return table;
}();

constexpr Op decode(std::uint16_t instruction) {
  return decode_table[static_cast<std::size_t>(instruction >> 6)];
}

}  // namespace lamplock::sim::chip
