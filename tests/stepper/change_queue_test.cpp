// The queue of output changes: each is granted with its line, in order, once, even if marks are
// repeated, late, or from before the queue was cleared.
#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "firmware/stepper/change_queue.hpp"
#include "tests/scale.hpp"

namespace lamplock::stepper {
namespace {

using test::scaled;

TEST(ChangeQueue, HasNoMarkWhileEmpty) {
  ChangeQueue queue;
  EXPECT_EQ(queue.mark(), 0);
  queue.push(1);
  const std::uint8_t mark = queue.mark();
  EXPECT_NE(mark, 0);
  EXPECT_FALSE(queue.waits());
  queue.grant(mark, 70);
  EXPECT_TRUE(queue.waits());
  EXPECT_EQ(queue.front().due_tick, 70u);
  EXPECT_EQ(queue.mark(), 0);
}

/// Lines are queued and begun later, some of them twice, some never.
TEST(ChangeQueue, GrantsEachChangeWithItsLineOrTheNext) {
  std::mt19937_64 random(3);
  const auto pick = [&random](std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(0, most)(random);
  };
  struct Line {
    std::uint8_t mark = 0;
    std::uint32_t changes = 0;  ///< total pushed before the line
  };
  for (int run = 0; run < scaled(50); ++run) {
    ChangeQueue queue;
    std::deque<Line> lines;
    std::uint32_t pushed = 0, granted = 0, applied = 0;
    std::deque<std::uint32_t> due;
    std::uint32_t tick = 0xffffff00u;  // wraps during the test
    for (int i = 0; i < 1000; ++i, tick += 7) {
      switch (pick(5)) {
        case 0:
        case 1:
          if (queue.full()) {
            EXPECT_EQ(pushed - applied, ChangeQueue::capacity);
            break;
          }
          queue.push(static_cast<std::uint16_t>(pushed++));
          lines.push_back({queue.mark(), pushed});
          break;
        case 2:
          lines.push_back({queue.mark(), pushed});
          break;
        case 3:
          if (lines.empty()) break;
          if (pick(3) == 0) lines.pop_front();  // never begun
          if (lines.empty()) break;
          for (std::size_t segments = pick(3) + 1; segments != 0; --segments)
            queue.grant(lines.front().mark, tick);
          for (; lines.front().mark != 0 && granted < lines.front().changes; ++granted)
            due.push_back(tick);
          lines.pop_front();
          break;
        case 4:
          if (pick(40) != 0) break;
          queue.clear();
          granted = applied = pushed;
          due.clear();
          if (pick(1) == 0) lines.clear();
          break;
        default:
          ASSERT_EQ(queue.waits(), applied != granted);
          for (; queue.waits(); queue.pop(), due.pop_front()) {
            ASSERT_EQ(queue.front().level, static_cast<std::uint16_t>(applied++));
            ASSERT_EQ(queue.front().due_tick, due.front());
          }
          break;
      }
      ASSERT_EQ(queue.empty(), applied == pushed);
    }
  }
}

}  // namespace
}  // namespace lamplock::stepper
