#include "firmware/motion/line/join.hpp"

#include <type_traits>

namespace lamplock::motion {
namespace {

/// Places have this resolution: 1/16 of a step, in their units.
constexpr int resolution_bits = place_bits - 4;
/// Joined lines are short: products with cosines fit 64 bits with room for the sum of all axes.
constexpr std::uint32_t max_way_q8 = std::uint32_t{1} << 24;
/// Most are shorter: their products with each digit of a cosine fit 32 bits.
constexpr std::uint32_t max_short_q8 = std::uint32_t{1} << 18;
constexpr int digit_bits = 10;
static_assert(max_short_q8 << digit_bits << 2 <= std::uint32_t{1} << 30, "four axes");

/// A cosine as three digits, the upper one with its sign.
struct CosineDigits {
  std::int32_t upper = 0, middle = 0, lower = 0;
};

CosineDigits digits_of(std::int32_t cosine_q30) {
  constexpr std::int32_t mask = (1 << digit_bits) - 1;
  return {cosine_q30 >> (2 * digit_bits), (cosine_q30 >> digit_bits) & mask, cosine_q30 & mask};
}

/// From products with each digit the one with the cosine, rounded down as if it had all bits.
std::int32_t product_of(const CosineDigits& products) {
  const std::int32_t middle = products.middle + (products.lower >> digit_bits);
  return (products.upper + (middle >> digit_bits)) >> digit_bits;
}

}  // namespace

/// A direction, without the axes that do not move.
struct LineJoin::Direction {
  struct Axis {
    std::size_t number = 0;
    std::int32_t cosine_q30 = 0;
    CosineDigits digits;
    std::int32_t max_beside_q8 = 0;  ///< of a place from the line

    /// Part of the axis of a way along the direction.
    std::int32_t part(std::int32_t along_q8) const {
      return product_of(
          {along_q8 * digits.upper, along_q8 * digits.middle, along_q8 * digits.lower});
    }
    std::int64_t part(std::int64_t along_q8) const { return (along_q8 * cosine_q30) >> 30; }
  };
  PerAxis<Axis> axes{};
  std::size_t count = 0;

  /// Part of a way along the direction, Q8.
  template <class Number>
  Number along(const WeightedWay& way_q8) const {
    if constexpr (std::is_same_v<Number, std::int64_t>) {
      std::int64_t sum_q38 = 0;
      for (std::size_t i = 0; i < count; ++i)
        sum_q38 += std::int64_t{way_q8[axes[i].number]} * axes[i].cosine_q30;
      return sum_q38 >> 30;
    } else {
      CosineDigits sums;
      for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t way = way_q8[axes[i].number];
        sums.upper += way * axes[i].digits.upper;
        sums.middle += way * axes[i].digits.middle;
        sums.lower += way * axes[i].digits.lower;
      }
      return product_of(sums);
    }
  }
};

void LineJoin::start(const LinePlace& from, const WayParts& way, const LineLimits& limits) {
  from_ = from;
  last_ = 0;
  size_q8_ = {};
  fits_ = weigh(way, limits, passed_q8_[0]);
}

/// False if the way is too long.
bool LineJoin::weigh(const WayParts& way, const LineLimits& limits, WeightedWay& out_q8) {
  if (way.bits != place_bits) return false;
  for (int a = 0; a < limits.axes; ++a) {
    // Parts have 32 bits and a sign.
    const std::int64_t part = way.parts[index(a)];
    const auto size = static_cast<std::uint32_t>(abs64(part));
    if (size > max_way_q8) return false;
    const std::uint32_t weight_q31 = limits.axis[index(a)].weight_q31;
    const bool is_coarsest = weight_q31 == std::uint32_t{1} << 31;
    const std::uint32_t scaled =
        size == 0 || is_coarsest ? size
                                 : static_cast<std::uint32_t>(wide_product(size, weight_q31) >> 31);
    out_q8[index(a)] =
        part < 0 ? -static_cast<std::int32_t>(scaled) : static_cast<std::int32_t>(scaled);
    size_q8_[index(a)] |= scaled;
  }
  return true;
}

LineJoin::Direction LineJoin::direction_of(const LineShape& shape, std::uint8_t digit_um,
                                           const LineLimits& limits) const {
  Direction direction;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int32_t cosine_q30 = shape.cosine_q30[index(a)];
    if (cosine_q30 == 0 && size_q8_[index(a)] == 0) continue;
    const std::uint32_t max_beside_q8 =
        (limits.axis[index(a)].weight_q31 >> (31 - resolution_bits)) + digit_um * limits.um_q8;
    direction.axes[direction.count++] = {index(a), cosine_q30, digits_of(cosine_q30),
                                         static_cast<std::int32_t>(max_beside_q8)};
  }
  return direction;
}

/// Whether the places come in order along the direction, each close to it.
template <class Number>
bool LineJoin::passes_all(const Direction& direction) const {
  Number before_q8 = 0;
  for (std::uint32_t i = 0; i <= last_; ++i) {
    const WeightedWay& way_q8 = passed_q8_[i];
    const auto along_q8 = direction.along<Number>(way_q8);
    if (along_q8 < before_q8) return false;
    before_q8 = along_q8;
    for (std::size_t k = 0; k < direction.count; ++k) {
      const Direction::Axis& axis = direction.axes[k];
      const Number off_q8 = way_q8[axis.number] - axis.part(along_q8);
      if ((off_q8 < 0 ? -off_q8 : off_q8) > axis.max_beside_q8) return false;
    }
  }
  return before_q8 <= direction.along<Number>(next_q8_);
}

bool LineJoin::reaches(const WayParts& way, const LineShape& shape, std::uint8_t digit_um,
                       const LineLimits& limits) {
  if (!fits_ || last_ + 1 == max_lines || !weigh(way, limits, next_q8_)) return false;
  const Direction direction = direction_of(shape, digit_um, limits);
  std::uint32_t all_q8 = 0;
  for (const std::uint32_t size_q8 : size_q8_) all_q8 |= size_q8;
  return all_q8 < max_short_q8 ? passes_all<std::int32_t>(direction)
                               : passes_all<std::int64_t>(direction);
}

void LineJoin::extend() { passed_q8_[++last_] = next_q8_; }

}  // namespace lamplock::motion
