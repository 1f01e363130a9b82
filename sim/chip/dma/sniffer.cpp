#include "sim/chip/dma/sniffer.hpp"

#include <bit>

#include "sim/chip/dma/transfer_data.hpp"

namespace lamplock::sim::chip {

namespace {
/// Values of CALC.
enum Calculation : std::uint32_t {
  crc32 = 0,
  crc32_reversed = 1,
  crc16 = 2,
  crc16_reversed = 3,
  even = 0xe,
  sum = 0xf
};
constexpr std::uint32_t ieee_802_3 = 0x04c1'1db7;
constexpr std::uint32_t ccitt = 0x1021;
}  // namespace

std::uint32_t Sniffer::data() const {
  std::uint32_t value = data_;
  if ((control_ >> 10 & 1u) != 0) value = reverse_bits(value, 32);
  if ((control_ >> 11 & 1u) != 0) value = ~value;
  return value;
}

void Sniffer::shift_in(std::uint32_t value, unsigned bits, std::uint32_t polynomial,
                       unsigned width) {
  for (unsigned i = bits; i-- > 0;) {
    const bool feedback = ((data_ >> (width - 1) ^ value >> i) & 1u) != 0;
    data_ = data_ << 1 ^ (feedback ? polynomial : 0u);
    if (width == 16) data_ &= 0xffffu;
  }
}

void Sniffer::observe(std::uint32_t value, unsigned bits) {
  if ((control_ >> 9 & 1u) != 0) value = swap_bytes(value, bits);
  switch (control_ >> 5 & 0xfu) {
    case crc32:
      shift_in(value, bits, ieee_802_3, 32);
      break;
    case crc32_reversed:
      shift_in(reverse_bits(value, bits), bits, ieee_802_3, 32);
      break;
    case crc16:
      shift_in(value, bits, ccitt, 16);
      break;
    case crc16_reversed:
      shift_in(reverse_bits(value, bits), bits, ccitt, 16);
      break;
    case even:
      data_ ^= static_cast<std::uint32_t>(std::popcount(value)) & 1u;
      break;
    case sum:
      data_ += value;
      break;
    default:
      break;  // reserved: no calculation
  }
}

}  // namespace lamplock::sim::chip
