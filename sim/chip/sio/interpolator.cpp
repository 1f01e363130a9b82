#include "sim/chip/sio/interpolator.hpp"

namespace lamplock::sim::chip {

namespace {

// Bits of CTRL_LANEn: SHIFT 4:0, MASK_LSB 9:5, MASK_MSB 14:10.
constexpr unsigned bit_signed = 15;
constexpr unsigned bit_cross_input = 16;
constexpr unsigned bit_cross_result = 17;
constexpr unsigned bit_add_raw = 18;
constexpr unsigned bit_force_msb = 19;
constexpr unsigned bit_blend = 21;   // CTRL_LANE0 of INTERP0
constexpr unsigned bit_clamp = 22;   // CTRL_LANE0 of INTERP1
constexpr unsigned bit_overf0 = 23;  // CTRL_LANE0, read only; then OVERF1 and OVERF
constexpr std::uint32_t lane_mask = 0x001fffff;

}  // namespace

std::uint32_t Interpolator::lane_input(std::size_t lane) const {
  return accumulator_[control(lane, bit_cross_input) ? 1 - lane : lane];
}

std::uint32_t Interpolator::shifted(std::size_t lane) const {
  return lane_input(lane) >> (control_[lane] & 31u);
}

std::uint32_t Interpolator::masked(std::size_t lane) const {
  const unsigned lsb = control_[lane] >> 5 & 31u;
  const unsigned msb = control_[lane] >> 10 & 31u;
  const std::uint32_t up_to_msb = ~0u >> (31 - msb);
  const std::uint32_t value = shifted(lane) & up_to_msb & (~0u << lsb);
  const bool negative = control(lane, bit_signed) && (value >> msb & 1u) != 0;
  return negative ? value | ~up_to_msb : value;
}

bool Interpolator::overflow(std::size_t lane) const {
  const unsigned msb = control_[lane] >> 10 & 31u;
  return (shifted(lane) & ~(~0u >> (31 - msb))) != 0;
}

Interpolator::Results Interpolator::results() const {
  const std::array<std::uint32_t, 2> value{masked(0), masked(1)};
  Results results;
  for (std::size_t lane = 0; lane < 2; ++lane)
    results.lane[lane] =
        base_[lane] + (control(lane, bit_add_raw) ? lane_input(lane) : value[lane]);
  results.full = base_[2] + value[0] + value[1];

  if (control(0, bit_blend)) {
    const std::uint32_t alpha = value[1] & 0xffu;  // 256ths
    const auto wide = [this](std::uint32_t base) {
      return control(1, bit_signed) ? static_cast<std::int64_t>(static_cast<std::int32_t>(base))
                                    : static_cast<std::int64_t>(base);
    };
    const std::int64_t step = (wide(base_[1]) - wide(base_[0])) * static_cast<std::int64_t>(alpha);
    results.lane[1] = base_[0] + static_cast<std::uint32_t>(step >> 8);
    results.lane[0] = alpha;
    results.full = base_[2] + value[0];
  }
  if (control(0, bit_clamp)) {
    const std::uint32_t sign =
        control(0, bit_signed) ? 0x80000000u : 0u;  // maps signed to unsigned
    results.lane[0] = value[0];
    if ((value[0] ^ sign) < (base_[0] ^ sign)) results.lane[0] = base_[0];
    if ((value[0] ^ sign) > (base_[1] ^ sign)) results.lane[0] = base_[1];
  }
  return results;
}

// What the processor sees: FORCE_MSB goes into bits 29:28 outside the data path.
std::uint32_t Interpolator::presented(const Results& results, std::size_t lane) const {
  return results.lane[lane] | (control_[lane] >> bit_force_msb & 3u) << 28;
}

std::uint32_t Interpolator::status() const {
  const std::uint32_t flags = (overflow(0) ? 1u : 0u) | (overflow(1) ? 2u : 0u);
  return (flags | (flags != 0 ? 4u : 0u)) << bit_overf0;
}

std::uint32_t Interpolator::peek(std::uint32_t offset) const {
  const Results result = results();
  switch (offset / 4) {
    case 0:
    case 1:
      return accumulator_[offset / 4];
    case 2:
    case 3:
    case 4:
      return base_[offset / 4 - 2];
    case 5:
    case 8:
      return presented(result, 0);
    case 6:
    case 9:
      return presented(result, 1);
    case 7:
    case 10:
      return result.full;
    case 11:
      return control_[0] | status();
    case 12:
      return control_[1];
    case 13:
      return masked(0);  // ACCUM0_ADD: the raw shift and mask value
    case 14:
      return masked(1);
    default:
      return 0;  // BASE_1AND0 is write only
  }
}

std::uint32_t Interpolator::read(std::uint32_t offset) {
  const std::uint32_t value = peek(offset);
  const bool is_pop = offset / 4 >= 5 && offset / 4 <= 7;
  if (is_pop) {
    const Results result = results();
    for (std::size_t lane = 0; lane < 2; ++lane)
      accumulator_[lane] = result.lane[control(lane, bit_cross_result) ? 1 - lane : lane];
  }
  return value;
}

void Interpolator::write(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t mode = 1u << (kind_ == Kind::blend ? bit_blend : bit_clamp);
  const auto half = [this](std::uint32_t bits, std::size_t lane) {
    const bool negative = control(lane, bit_signed) && (bits & 0x8000u) != 0;
    return negative ? bits | 0xffff0000u : bits;
  };
  switch (offset / 4) {
    case 0:
    case 1:
      accumulator_[offset / 4] = value;
      break;
    case 2:
    case 3:
    case 4:
      base_[offset / 4 - 2] = value;
      break;
    case 11:
      control_[0] = value & (lane_mask | mode);
      break;
    case 12:
      control_[1] = value & lane_mask;
      break;
    case 13:
      accumulator_[0] += value;
      break;
    case 14:
      accumulator_[1] += value;
      break;
    case 15:
      base_[0] = half(value & 0xffffu, 0);
      base_[1] = half(value >> 16, 1);
      break;
    default:
      break;  // POP and PEEK are read only
  }
}

}  // namespace lamplock::sim::chip
