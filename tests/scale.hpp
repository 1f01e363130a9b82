// How large random tests are: LAMPLOCK_TEST_SCALE scales every count (1 = everyday run, 20 = full,
// 0.1 = under sanitizers).
#pragma once

#include <algorithm>
#include <cstdlib>

namespace lamplock::test {

/// `count` times the scale of this run, at least 1.
inline int scaled(int count) {
  const char* text = std::getenv("LAMPLOCK_TEST_SCALE");
  const double scale = text != nullptr ? std::atof(text) : 1.0;
  return std::max(1, static_cast<int>(count * scale));
}

}  // namespace lamplock::test
