// Random numbers per block of space, not per thread: the generator is cheap to start for every
// block. Called by the discretisers that throw darts.
#pragma once

#include <cstdint>

namespace lamplock::geometry {

/// splitmix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += golden_ratio;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// 0 <= value < 1, all 53 bits of a double.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// The seed of another sequence for each `number`.
  std::uint64_t fork(std::uint64_t number) const {
    return Random(state_ ^ Random(number * golden_ratio + 1).next()).next();
  }

 private:
  static constexpr std::uint64_t golden_ratio = 0x9E3779B97F4A7C15u;
  std::uint64_t state_;
};

}  // namespace lamplock::geometry
