// Drawings with damaged bytes, the same for every format.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <string_view>

#include "host/model/arc_length.hpp"
#include "host/model/curves.hpp"
#include "tests/damaged.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test {

/// Damages `whole` with `bites` many times: if `read(path)` accepts it, its curves must be finite.
template <class Read>
void expect_damaged_drawings_fail_at_most(const TemporaryFolder& folder, const std::string& name,
                                          const std::string& whole, std::string_view bites,
                                          Read&& read) {
  std::mt19937_64 random(2);
  for (int i = 0; i < scaled(600); ++i) {
    const auto path = folder.write(name, damaged(whole, bites, random));
    expect_read_or_refused([&] {
      const model::Curves curves = read(path);
      EXPECT_TRUE(std::isfinite(model::bounds(curves).longest_side()));
      for (const model::Path& p : curves.paths)
        EXPECT_TRUE(std::isfinite(model::ArcLength(p).total()));
    });
  }
}

}  // namespace lamplock::test
