// Random numbers of the simulators.
//
// In:  a seed. Out: the numbers of std::mt19937_64, whose output the C++ standard fixes, so that
//      every platform draws the same. Works as the generator of the library's distributions.
// Who: lamp, contacts, photosensors, flash: a few draws for each of their changes. The engine is
//      hidden because <random> is long and nearly every file of the project includes the world.
#pragma once

#include <cstdint>
#include <limits>

namespace lamplock::sim {

/// One sequence of random numbers.
class Random {
 public:
  using result_type = std::uint64_t;

  explicit Random(std::uint64_t seed);
  ~Random();
  Random(Random&& other) noexcept : engine_(other.engine_) { other.engine_ = nullptr; }
  Random& operator=(Random&&) = delete;

  /// 64 random bits.
  std::uint64_t operator()();
  /// Uniform in [0, 1), in steps of 2^-53.
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1p-53; }

  static constexpr std::uint64_t min() { return 0; }
  static constexpr std::uint64_t max() { return std::numeric_limits<std::uint64_t>::max(); }

 private:
  struct Engine;
  Engine* engine_;  ///< its own
};

}  // namespace lamplock::sim
