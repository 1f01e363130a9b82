#include "firmware/motion/line/join.hpp"

namespace lamplock::motion {
namespace {

/// Places have this resolution: 1/16 of a step, in their units.
constexpr std::int64_t resolution_q8 = 1 << (place_bits - 4);
/// Joined lines are short: products with cosines fit 64 bits with room for the sum of all axes.
constexpr std::int64_t max_way_q8 = std::int64_t{1} << 24;

/// A way, per axis in steps of the coarsest axis, Q8; false if it is too long.
bool weighted(const WayParts& way, const LineLimits& limits, PerAxis<std::int32_t>& out_q8) {
  if (way.bits != place_bits) return false;
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t part = way.parts[index(a)];
    if (abs64(part) > max_way_q8) return false;
    const auto size = static_cast<std::uint32_t>(abs64(part));
    const auto scaled =
        static_cast<std::int32_t>(wide_product(size, limits.axis[index(a)].weight_q31) >> 31);
    out_q8[index(a)] = part < 0 ? -scaled : scaled;
  }
  return true;
}

}  // namespace

bool LineJoin::reaches(const LinePlace& end, const LineTarget& to, const LineShape& shape,
                       const LineLimits& limits) const {
  if (count_ == passed_.size()) return false;
  PerAxis<std::int32_t> whole_q8{};
  if (!weighted(way_between(from_, to), limits, whole_q8)) return false;
  const std::int64_t digit_q8 = to.digit_um * limits.um_q8;
  std::int64_t before_q8 = 0;
  for (std::uint32_t i = 0; i <= count_; ++i) {
    const LinePlace& place = i == count_ ? end : passed_[i];
    PerAxis<std::int32_t> way_q8{};
    if (!weighted(way_between(from_, place), limits, way_q8)) return false;
    std::int64_t along_q38 = 0;
    for (int a = 0; a < limits.axes; ++a)
      along_q38 += std::int64_t{way_q8[index(a)]} * shape.cosine_q30[index(a)];
    const std::int64_t along_q8 = along_q38 >> 30;
    if (along_q8 < before_q8) return false;
    before_q8 = along_q8;
    for (int a = 0; a < limits.axes; ++a) {
      const std::int64_t on_line_q8 = (along_q8 * shape.cosine_q30[index(a)]) >> 30;
      const std::int64_t max_q8 =
          ((resolution_q8 * limits.axis[index(a)].weight_q31) >> 31) + digit_q8;
      if (abs64(way_q8[index(a)] - on_line_q8) > max_q8) return false;
    }
  }
  std::int64_t length_q38 = 0;
  for (int a = 0; a < limits.axes; ++a)
    length_q38 += std::int64_t{whole_q8[index(a)]} * shape.cosine_q30[index(a)];
  return before_q8 <= length_q38 >> 30;
}

}  // namespace lamplock::motion
