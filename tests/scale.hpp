// Size of random tests: LAMPLOCK_TEST_SCALE scales every count (toolchain/test: 0.5, under
// sanitizers 0.1; with --full 2 and 0.4).
#pragma once

#include <algorithm>
#include <cstdlib>

namespace lamplock::test {

/// `count` times the scale of this run, at least `min`: the number of cases in alternating rounds.
inline int scaled(int count, int min = 1) {
  const char* text = std::getenv("LAMPLOCK_TEST_SCALE");
  const double scale = text != nullptr ? std::atof(text) : 1.0;
  return std::max(min, static_cast<int>(count * scale));
}

}  // namespace lamplock::test
