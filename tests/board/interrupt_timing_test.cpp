// The core with interrupts at the worst places: a lamp edge between any two calls of the main loop
// must be visible to the next call. The virtual board has no such moments; a board with real
// interrupts has them in every pass.
#include "tests/board/hand_board.hpp"

namespace lamplock::test {
namespace {

constexpr int job_points = 40;

/// Runs boards one after the other, each with a job that has begun.
class InterruptTiming : public testing::Test {
 protected:
  using Body = std::function<void(HandBoard&)>;
  void on_boards(int count, const Body& body, int points = job_points) {
    for (seed_ = 0; seed_ < static_cast<std::uint64_t>(count); ++seed_) {
      SCOPED_TRACE(testing::Message() << "seed " << seed_);
      const job::Job job = jumping_row(points, seed_);
      HandBoard board(job, seed_);
      ASSERT_NO_FATAL_FAILURE(board.begin(0));
      ASSERT_NO_FATAL_FAILURE(body(board));
    }
  }
  /// Calls `pass` while the job runs.
  template <class Pass>
  static void run_job(HandBoard& board, Pass&& pass) {
    for (int i = 0; i < 40'000 && board.core.state() == MachineState::run; ++i) pass();
  }
  static void expect_each_fired_once(const HandBoard& board) {
    EXPECT_EQ(board.fired, std::vector<std::uint32_t>(job_points, 1));
  }
  std::uint64_t seed_ = 0;
};

TEST_F(InterruptTiming, IdleAfterAStopHasEveryShot) {
  int unfinished = 0;
  on_boards(scaled(300), [&](HandBoard& board) {
    // Half of the stops occur in a pass with an edge.
    while (!board.stop_due() || (seed_ % 2 == 0 && !board.edge_ahead())) board.pass();
    board.pass([&] { board.core.on_command({wire::Command::stop}); });
    while (board.core.state() != MachineState::idle) board.pass();
    ASSERT_EQ(board.status().first_unfired, board.shots());
    for (int i = 0; i < 4000 && !board.core.runner().at_rest(); ++i) board.pass();
    if (board.shots() == job_points) return;
    ++unfinished;
    ASSERT_NO_FATAL_FAILURE(board.begin(board.status().first_unfired));
    run_job(board, [&] { board.pass(); });
    expect_each_fired_once(board);
  });
  EXPECT_GT(unfinished, 0);
}

/// The flash in progress when the machine brakes counts, although its point returns to the queue
/// and the next window is searched before the flash is judged.
TEST_F(InterruptTiming, AHoldThatEndsAtOnceFiresNoPointTwice) {
  int held = 0;
  on_boards(scaled(100), [&](HandBoard& board) {
    std::mt19937_64 random(seed_);
    run_job(board, [&] {
      // Exactly the ticks before the edge have been handed out.
      const bool hold = board.shots() % 4 == 3 && board.edge_ahead() && random() % 2 == 0;
      held += hold ? 1 : 0;
      board.pass([&] {
        if (!hold) return;
        board.core.on_command({wire::Command::hold});
        board.core.on_command({wire::Command::resume});
      });
    });
    expect_each_fired_once(board);
  });
  EXPECT_GT(held, 0);
}

/// If planning exceeds its margin, the start is delayed by whole beats, for the whole plan, staged
/// or not.
TEST_F(InterruptTiming, ALatePlanStartsLaterAsAWhole) {
  on_boards(scaled(20), [&](HandBoard& board) {
    board.plans_itself = false;
    run_job(board, [&] {
      board.pass();
      if (!board.core.plan_waits()) return;
      for (int late = 0; late < 100; ++late) board.pass();
      while (board.core.plan()) {
      }
    });
    ASSERT_EQ(board.core.state(), MachineState::idle);
    expect_each_fired_once(board);
  });
}

/// The mark that a board stores for a crash has every shot, read by the main loop or not.
TEST_F(InterruptTiming, TheMarkOfAJobHasEveryShotAtOnce) {
  on_boards(4, [&](HandBoard& board) {
    for (int i = 0; i < 40'000 && board.shots() < job_points; ++i) {
      board.pass();
      if (board.core.state() != MachineState::run) break;
      ASSERT_EQ(board.core.job_mark().first_unfired, board.shots());
    }
    ASSERT_EQ(board.shots(), static_cast<std::uint32_t>(job_points));
  });
}

TEST_F(InterruptTiming, AnImmediateStopReportsTheShotThatTheBoardFound) {
  int found = 0;
  on_boards(scaled(100), [&](HandBoard& board) {
    while (!board.stop_due() || !board.edge_ahead()) board.pass();
    const std::uint32_t before = board.shots();
    board.pass([&] {
      board.core.input_changed(machine::Input::limit_x, true);
      board.interrupt();  // the pulse had begun
      board.core.stopped_at({});
      ASSERT_EQ(board.status().first_unfired, board.shots());
    });
    found += board.shots() > before ? 1 : 0;
  });
  EXPECT_GT(found, 0);
}

/// A fault while parts of a plan wait to be handed out: no part is handed out, no call waits for
/// them, and the next pass raises the alarm.
class FaultBetweenParts : public InterruptTiming {
 protected:
  void at_each(const Body& fault) {
    int faults = 0;
    const auto run = [&](HandBoard& board) {
      bool broken = false;
      const auto breaks = [&] {
        if (broken) return;
        broken = true;
        fault(board);
        EXPECT_FALSE(board.core.part_waits());
      };
      // Between parts of the first plan, which all have room, or in motion while the next plan
      // waits for room.
      const bool at_start = seed_ % 2 == 0;
      if (at_start) board.while_parts_wait = breaks;
      for (int i = 0; i < 40'000 && !broken; ++i) {
        ASSERT_NO_FATAL_FAILURE(board.pass([&] {
          if (!at_start && board.shots() == job_points) breaks();
        }));
      }
      ASSERT_NO_FATAL_FAILURE(board.pass());
      faults += broken ? 1 : 0;
      const std::uint32_t shots = board.shots();
      EXPECT_EQ(board.core.state(), MachineState::alarm);
      EXPECT_EQ(board.status().alarm, 3);
      EXPECT_FALSE(board.core.outputs().fire_enable);
      for (int i = 0; i < 1000; ++i) ASSERT_NO_FATAL_FAILURE(board.pass());
      EXPECT_TRUE(board.core.runner().at_rest());
      EXPECT_EQ(board.shots(), shots);
      EXPECT_FALSE(board.core.part_waits());
      board.core.on_line("$X");
      EXPECT_EQ(board.core.state(), MachineState::idle);
    };
    on_boards(scaled(40), run, 3 * job_points);
    EXPECT_EQ(faults, scaled(40));
  }
};

TEST_F(FaultBetweenParts, TheBoardsTicksHaveRunOut) {
  at_each([](HandBoard& board) {
    board.core.lattice_stopped();
    board.core.stopped_at({});
  });
}

/// The core never ends motion at speed, so the test forces it: axes that are suddenly much further
/// ahead are too late for the queued segments.
TEST_F(FaultBetweenParts, MotionEndsWithSpeed) {
  at_each([](HandBoard& board) {
    const machine::JobRunner& runner = board.core.runner();
    const_cast<machine::JobRunner&>(runner).generator().set_leads({1'000'000});
    stepper::TickBlock block;
    for (int i = 0; i < 1000 && !runner.underrun(); ++i) board.core.fill(block, 1024);
    EXPECT_TRUE(runner.underrun());
  });
}

}  // namespace
}  // namespace lamplock::test
