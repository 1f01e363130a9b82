// Size of random tests: LAMPLOCK_TEST_SCALE scales every count (toolchain/test: 0.5, under
// sanitizers 0.1; with --full 2 and 0.4).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace lamplock::test {

inline double scale() {
  const char* text = std::getenv("LAMPLOCK_TEST_SCALE");
  return text != nullptr ? std::atof(text) : 1.0;
}

/// `count` times the scale of this run, at least `min`: the number of cases in alternating rounds.
inline int scaled(int count, int min = 1) {
  return std::max(min, static_cast<int>(count * scale()));
}

/// True if this run tries the cell of this number, of a table that is otherwise tried whole: a run
/// of a fifth of the size or less (sanitizers, every day) takes one of seven.
inline bool tries_cell(std::size_t number) { return scale() > 0.2 || number % 7 == 0; }

}  // namespace lamplock::test
