// How a contact bounces: it makes or breaks at once, then bounces for a while.
//
// In:  the moment of a change.
// Out: the times of further changes, an even number of them within the set time, so that the
//      contact ends in its new state.
// Who: switches, at each change. Every contact has its own generator and draws the same amount for
//      every change, so that bounces are repeatable for each run and each contact.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/world/random.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim {

/// Maximum duration; 0 = a contact that does not bounce.
struct BounceConfig {
  double make_us = 0;
  double break_us = 0;
  std::uint64_t seed = 1;
};

/// The bounces of one contact.
class BounceMaker {
 public:
  static constexpr std::size_t max_bounces = 6;

  explicit BounceMaker(const BounceConfig& config) : config_(config), random_(config.seed) {}

  /// Times of a burst after a change at `at`, in order; empty if it does not bounce.
  std::span<const Picoseconds> burst(bool makes, Picoseconds at) {
    const std::size_t bounces = 1 + random_() % max_bounces;
    const double length = (makes ? config_.make_us : config_.break_us) * double{ps_per_us};
    for (Picoseconds& time : times_) {
      const double share = random_.uniform();
      time = at + 1 + static_cast<Picoseconds>(share * (length - 1));
    }
    if (length < 1) return {};
    const std::span<Picoseconds> used = std::span(times_).first(2 * bounces);
    std::sort(used.begin(), used.end());
    return used;
  }

 private:
  BounceConfig config_;
  Random random_;
  std::array<Picoseconds, 2 * max_bounces> times_{};
};

}  // namespace lamplock::sim
