// An interpolator of a core (RP2040 datasheet, 2.3.1.6): two lanes of shift, mask, sign extension
// and addition, with blend mode in the first and clamp mode in the second of a core.
//
// In:  the sixteen registers from ACCUM0 to BASE_1AND0, by offset within the interpolator.
// Out: results, combinatorial: a result read in the cycle after a write is right.
// Who: Sio.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamplock::sim::chip {

/// INTERP0 (with blend mode) or INTERP1 (with clamp mode).
class Interpolator {
 public:
  enum class Kind : std::uint8_t { blend, clamp };
  explicit Interpolator(Kind kind) : kind_(kind) {}

  /// Offsets 0x00 (ACCUM0) to 0x3c (BASE_1AND0).
  std::uint32_t peek(std::uint32_t offset) const;
  /// A read with its side effect: POP puts the results into the accumulators.
  std::uint32_t read(std::uint32_t offset);
  void write(std::uint32_t offset, std::uint32_t value);

 private:
  struct Results {
    std::array<std::uint32_t, 2> lane{};
    std::uint32_t full = 0;
  };
  std::uint32_t lane_input(std::size_t lane) const;
  std::uint32_t shifted(std::size_t lane) const;
  std::uint32_t masked(std::size_t lane) const;
  bool overflow(std::size_t lane) const;
  Results results() const;
  std::uint32_t presented(const Results& results, std::size_t lane) const;
  std::uint32_t status() const;
  bool control(std::size_t lane, unsigned bit) const { return (control_[lane] >> bit & 1u) != 0; }

  Kind kind_;
  std::array<std::uint32_t, 2> accumulator_{};
  std::array<std::uint32_t, 3> base_{};
  std::array<std::uint32_t, 2> control_{};
};

}  // namespace lamplock::sim::chip
