// Lines that a thread plans end at the same ticks as those of a LineRun without one.
#include <gtest/gtest.h>

#include <random>

#include "host/program/line_thread.hpp"

namespace lamplock::test::line_thread_test {
namespace {

using program_run::LineRun;
using program_run::LineThread;

/// The same calls for both: bytes, moves of several lengths, dwells, and rests.
template <class Run>
void call(Run& run, unsigned seed, int moves) {
  std::mt19937 random(seed);
  const auto below = [&](int count) {
    return std::uniform_int_distribution<int>(0, count - 1)(random);
  };
  motion::LineTarget target;
  for (int i = 1; i <= moves; ++i) {
    run.receive(static_cast<std::size_t>(below(60)));
    target.line = static_cast<std::uint32_t>(i);
    for (std::size_t axis = 0; axis < 2; ++axis) target.steps[axis] += below(400) - 200;
    target.feed_um_min = static_cast<std::uint32_t>(600'000 + below(5'000'000));
    target.rapid = below(10) == 0;
    run.take(target);
    if (below(200) == 0) run.dwell(static_cast<std::uint32_t>(1000 * below(100)));
    if (below(200) == 0) run.finish();
  }
  run.receive(10);
  run.finish();
}

TEST(LineThread, EndsAreThoseWithoutAThread) {
  const settings::Values values;
  // Fewer calls than a portion, about one, and more than may wait at once.
  for (const int moves : {0, 3, 1000, 1024, 40'000}) {
    LineRun alone(values);
    call(alone, 7, moves);
    LineThread thread(values);
    call(thread, 7, moves);
    const LineRun& run = thread.wait();
    EXPECT_EQ(run.ticks(), alone.ticks()) << moves;
    EXPECT_EQ(run.line_ends(), alone.line_ends()) << moves;
  }
}

TEST(LineThread, ContinuesAfterAWait) {
  const settings::Values values;
  LineRun alone(values);
  LineThread thread(values);
  for (const unsigned seed : {1u, 2u, 3u}) {
    call(alone, seed, 3000);
    call(thread, seed, 3000);
    EXPECT_EQ(thread.wait().ticks(), alone.ticks());
  }
}

/// The destructor ends the thread without planning the calls that are left; otherwise this hangs.
TEST(LineThread, MayBeLeftWithoutAWait) {
  const settings::Values values;
  LineThread thread(values);
  call(thread, 5, 5000);
}

}  // namespace
}  // namespace lamplock::test::line_thread_test
