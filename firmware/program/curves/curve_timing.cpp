#include "firmware/program/curves/curve_timing.hpp"

#include <bit>

#include "shared/fixed_point.hpp"

namespace lamplock::program {

std::int64_t distance_e7(const Place& a, const Place& b) {
  std::uint64_t largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest |= static_cast<std::uint64_t>(abs64(a[i] - b[i]));
  // Squares of four numbers of 31 bits fit.
  const int bits = 64 - std::countl_zero(largest);
  const int shift = bits > 31 ? bits - 31 : 0;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto part = static_cast<std::uint32_t>(abs64(a[i] - b[i]) >> shift);
    sum += wide_product(part, part);
  }
  return std::int64_t{isqrt(sum)} << shift;
}

void CurveTiming::begin(const Place& start, std::int64_t length_e7, std::uint32_t pieces,
                        std::uint32_t time_us) {
  here_ = start;
  length_e7_ = length_e7 > 0 ? length_e7 : 1;
  done_e7_ = 0;
  left_ = pieces;
  time_us_ = time_us;
  spent_us_ = 0;
}

std::uint32_t CurveTiming::next(const Place& end) {
  done_e7_ += distance_e7(here_, end);
  here_ = end;
  std::uint32_t until = time_us_;
  if (left_ > 1 && done_e7_ < length_e7_) {
    const int bits = 64 - std::countl_zero(static_cast<std::uint64_t>(length_e7_));
    const int shift = bits > 32 ? bits - 32 : 0;
    const auto length = static_cast<std::uint32_t>(length_e7_ >> shift);
    const auto done = static_cast<std::uint32_t>(done_e7_ >> shift);
    if (length != 0) until = static_cast<std::uint32_t>(wide_product(time_us_, done) / length);
  }
  if (left_ > 0) --left_;
  const std::uint32_t share = until - spent_us_;
  spent_us_ = until;
  return share != 0 ? share : 1;
}

}  // namespace lamplock::program
