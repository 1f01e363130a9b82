// The core with its interrupts at the worst places: an edge of the lamp that comes between two
// calls of the main loop, whichever two, is told to whoever asks next. The virtual board has no
// such moments; a board with real interrupts has them in every pass.
#include "tests/board/hand_board.hpp"

namespace lamplock::test {
namespace {

TEST(InterruptTiming, IdleAfterAStopKnowsEveryShot) {
  int unfinished = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(300)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(40, seed);
    HandBoard board(job, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    // Half of the stops in a pass that has an edge.
    while (!board.stop_due() || (seed % 2 == 0 && !board.edge_ahead())) board.pass();
    board.pass([&] { board.core.on_command({wire::Command::stop}); });
    while (board.core.state() != MachineState::idle) board.pass();
    ASSERT_EQ(board.status().first_unfired, board.shots());
    for (int i = 0; i < 4000 && !board.core.runner().at_rest(); ++i) board.pass();
    unfinished += board.shots() < job.targets.size() ? 1 : 0;
    if (board.shots() == job.targets.size()) continue;
    ASSERT_NO_FATAL_FAILURE(board.begin(board.status().first_unfired));
    for (int i = 0; i < 40'000 && board.core.state() == MachineState::run; ++i) board.pass();
    ASSERT_EQ(board.fired, std::vector<std::uint32_t>(job.targets.size(), 1));
  }
  EXPECT_GT(unfinished, 0);
}

/// The flash that is on its way when the machine brakes counts, although it is put back among the
/// points to come, and the next window is looked for before it is judged.
TEST(InterruptTiming, AHoldThatEndsAtOnceFiresNoPointTwice) {
  int held = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(100)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(40, seed);
    HandBoard board(job, seed);
    std::mt19937_64 random(seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    for (int i = 0; i < 40'000 && board.core.state() == MachineState::run; ++i) {
      // The ticks before the edge have been filled, and no more.
      const bool hold = board.shots() % 4 == 3 && board.edge_ahead() && random() % 2 == 0;
      held += hold ? 1 : 0;
      board.pass([&] {
        if (!hold) return;
        board.core.on_command({wire::Command::hold});
        board.core.on_command({wire::Command::resume});
      });
    }
    ASSERT_EQ(board.fired, std::vector<std::uint32_t>(job.targets.size(), 1));
  }
  EXPECT_GT(held, 0);
}

/// A start moves on by whole beats where planning has outlasted its margin: all of the plan does,
/// whether it has been staged or not.
TEST(InterruptTiming, APlanThatComesLateStartsLaterAsAWhole) {
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(20)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(40, seed);
    HandBoard board(job, seed);
    board.plans_itself = false;
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    for (int i = 0; i < 40'000 && board.core.state() == MachineState::run; ++i) {
      board.pass();
      if (!board.core.plan_waits()) continue;
      for (int late = 0; late < 100; ++late) board.pass();
      while (board.core.plan()) {
      }
    }
    ASSERT_EQ(board.core.state(), MachineState::idle);
    ASSERT_EQ(board.fired, std::vector<std::uint32_t>(job.targets.size(), 1));
  }
}

/// What a board notes for the case that it crashes: every shot, read by the main loop or not.
TEST(InterruptTiming, TheMarkOfAJobKnowsEveryShotAtOnce) {
  const job::Job job = jumping_row(40, 5);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    HandBoard board(job, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    for (int i = 0; i < 40'000 && board.shots() < job.targets.size(); ++i) {
      board.pass();
      if (board.core.state() != MachineState::run) break;
      ASSERT_EQ(board.core.job_mark().first_unfired, board.shots()) << "seed " << seed;
    }
    ASSERT_EQ(board.shots(), job.targets.size());
  }
}

TEST(InterruptTiming, ADeadStopTellsTheShotThatTheBoardHasFound) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(100)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(40, seed);
    HandBoard board(job, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    while (!board.stop_due() || !board.edge_ahead()) board.pass();
    const std::uint32_t before = board.shots();
    board.pass([&] {
      board.core.input_changed(machine::Input::limit_x, true);
      board.interrupt();  // the pulse had begun
      board.core.stopped_at({});
      ASSERT_EQ(board.status().first_unfired, board.shots());
    });
    found += board.shots() > before ? 1 : 0;
  }
  EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace lamplock::test
