// The minimum time of a line of pixels, against all windows of its runs.
#include "shared/wire/run_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "shared/wire/runs.hpp"
#include "tests/scale.hpp"

namespace lamplock::wire {
namespace {

TEST(RunPace, IsThatOfTheDensest32Runs) {
  std::mt19937_64 random(1);
  RunPace pace;
  for (int i = 0; i < test::scaled(2000); ++i) {
    pace.begin_list();
    std::vector<std::uint32_t> runs(1 + random() % 300);
    for (std::uint32_t& run : runs) {
      run = random() % 4 == 0 ? 1 + static_cast<std::uint32_t>(random() % 200) : 1;
      pace.add(run);
    }
    const double cells = std::accumulate(runs.begin(), runs.end(), 0.0);
    double expected = min_run_us * static_cast<double>(std::min<std::size_t>(runs.size(), 32));
    for (std::size_t first = 0; first + 32 <= runs.size(); ++first) {
      const auto begin = runs.begin() + static_cast<std::ptrdiff_t>(first);
      const double in_window = std::accumulate(begin, begin + 32, 0.0);
      expected = std::max(expected, cells / in_window * 32 * min_run_us);
    }
    ASSERT_NEAR(pace.min_us(), expected, 1) << runs.size() << " runs";
  }
}

TEST(RunPace, OfNoRunsIsZero) { EXPECT_EQ(RunPace().min_us(), 0u); }

}  // namespace
}  // namespace lamplock::wire
