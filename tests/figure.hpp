// Figures stated in documents: each is measured by a test, which prints it.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>

#include "sim/world/time.hpp"

namespace lamplock::test {

/// Prints a measured time and expects it within two bounds, milliseconds.
inline void expect_figure(const char* what, sim::Picoseconds measured, double min_ms,
                          double max_ms) {
  const double ms = static_cast<double>(measured) / static_cast<double>(sim::ps_per_ms);
  std::printf("%s: %.3f ms, at most %g ms\n", what, ms, max_ms);
  EXPECT_GE(ms, min_ms) << what;
  EXPECT_LE(ms, max_ms) << what;
}

}  // namespace lamplock::test
