// Drawings with damaged bytes, the same for every format.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
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
  expect_damaged_read_or_refused(scaled(600), whole, bites, [&](const std::string& bytes) {
    const model::Curves curves = read(folder.write(name, bytes));
    EXPECT_TRUE(std::isfinite(model::bounds(curves).max_side()));
    for (const model::Path& p : curves.paths)
      EXPECT_TRUE(std::isfinite(model::ArcLength(p).total()));
  });
}

}  // namespace lamplock::test
