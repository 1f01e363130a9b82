// A plan made by another core: which side may access it when, and that the other side does not.
#include "firmware/machine/runners/work_exchange.hpp"

#include <atomic>
#include <thread>

#include "tests/board/hand_board.hpp"

namespace lamplock::test {
namespace {

using machine::WorkExchange;

TEST(WorkExchange, OnOneThreadARecallReturnsItAtOnce) {
  std::mt19937_64 random(1);
  WorkExchange it;
  int slices_left = 0, completed = 0, recalled = 0;
  bool asked = false;
  for (int i = 0; i < scaled(20'000); ++i) {
    ASSERT_EQ(it.asked(), asked);
    ASSERT_EQ(it.is_owned(), !asked);
    ASSERT_EQ(it.complete(), asked && slices_left == 0);
    ASSERT_EQ(it.busy(), asked && slices_left != 0);
    ASSERT_EQ(it.waits(), it.busy());
    switch (random() % 4) {
      case 0:
        if (!it.is_owned()) break;
        it.hand_out();
        asked = true;
        slices_left = 1 + static_cast<int>(random() % 3);
        break;
      case 1:
        (it.complete() ? completed : recalled) += asked ? 1 : 0;
        it.recall();
        asked = false;
        break;
      default: {
        bool worked = false;
        const bool more = it.slice([&] {
          worked = true;
          EXPECT_FALSE(it.is_owned());
          EXPECT_FALSE(it.waits());
          return --slices_left != 0;
        });
        ASSERT_EQ(worked || more, worked);
        ASSERT_LE(worked, asked);
        ASSERT_EQ(more, worked && slices_left != 0);
        break;
      }
    }
  }
  EXPECT_GT(completed, 0);
  EXPECT_GT(recalled, 0);
}

TEST(WorkExchange, RecalledInASliceItReturnsAtTheEndOfTheSlice) {
  WorkExchange it;
  it.hand_out();
  EXPECT_FALSE(it.slice([&] {
    it.recall();
    EXPECT_FALSE(it.is_owned());
    EXPECT_TRUE(it.busy());
    return false;
  }));
  EXPECT_TRUE(it.is_owned());
  EXPECT_FALSE(it.complete());
}

/// The shared work: plain memory, which two threads must never access at once.
struct Work {
  std::array<std::uint32_t, 64> words{};
  std::uint32_t left = 0;
};

TEST(WorkExchange, TwoThreadsNeverTouchItAtOnce) {
  WorkExchange it;
  Work work;
  std::atomic<bool> over = false;
  std::uint32_t torn = 0, slices = 0;
  std::thread worker([&] {
    while (!over) {
      it.slice([&] {
        const std::uint32_t first = work.words[0];
        for (std::uint32_t& word : work.words) {
          torn += word != first ? 1 : 0;
          word = first + 1;
        }
        ++slices;
        return --work.left != 0;
      });
    }
  });
  std::mt19937_64 random(2);
  std::uint32_t completed = 0, recalled = 0, wrong = 0;
  const auto wanted = static_cast<std::uint32_t>(scaled(1500));
  while (completed < wanted) {
    const std::uint32_t begin = static_cast<std::uint32_t>(random());
    work.words.fill(begin);
    const std::uint32_t count = work.left = 1 + static_cast<std::uint32_t>(random() % 4);
    it.hand_out();
    const bool impatient = random() % 2 == 0;
    for (std::uint64_t i = 0; !it.complete(); ++i) {
      if (impatient && i > random() % 200) break;
      if (i % 64 == 63) std::this_thread::yield();
    }
    if (it.complete()) {
      ++completed;
      for (const std::uint32_t word : work.words) wrong += word != begin + count ? 1 : 0;
    } else {
      ++recalled;
    }
    it.recall();
    while (!it.is_owned()) std::this_thread::yield();
  }
  over = true;
  worker.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(recalled, 0u);
  EXPECT_GE(slices, completed);
}

/// Plans on a thread of its own, as the second core does.
class PlannerThread {
 public:
  explicit PlannerThread(machine::Controller& core)
      : thread_([this, &core] {
          while (!over_) {
            if (!core.plan_waits()) {
              std::this_thread::yield();
              continue;
            }
            while (core.plan()) ++slices_;
            ++plans_;
          }
        }) {}
  ~PlannerThread() {
    over_ = true;
    thread_.join();
  }
  PlannerThread(const PlannerThread&) = delete;
  PlannerThread& operator=(const PlannerThread&) = delete;

  std::uint64_t plans() const { return plans_; }

 private:
  std::atomic<bool> over_ = false;
  std::atomic<std::uint64_t> slices_ = 0, plans_ = 0;
  std::thread thread_;
};

class PlanOnAnotherCore : public testing::Test {
 protected:
  /// Waits for the planner, sometimes for a short time only.
  static void wait(HandBoard& board, std::mt19937_64& random) {
    const std::uint64_t patience = random() % 4 == 0 ? 1'000'000 : random() % 40;
    for (std::uint64_t i = 0; i < patience && board.core.planning(); ++i) std::this_thread::yield();
  }
  static void run(HandBoard& board, std::mt19937_64& random, int passes) {
    for (int i = 0; i < passes; ++i) {
      board.pass();
      wait(board, random);
    }
  }
};

// Whatever the main loop does meanwhile, each point is fired once. (With a thread sanitizer this
// also proves that the two threads share nothing else.)
TEST_F(PlanOnAnotherCore, OrdersAtRandomMoments) {
  std::mt19937_64 random(3);
  std::uint64_t plans = 0;
  int stops = 0, in_flight = 0, moving = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(10)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(90, seed);
    HandBoard board(job, seed);
    board.plans_itself = false;
    machine::Controller& core = board.core;
    const PlannerThread planner(core);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    for (int order = 0; order < 20 && core.state() == MachineState::run; ++order) {
      run(board, random, 5 + static_cast<int>(random() % 60));
      for (int i = 0; order % 4 != 0 && i < 400 && !core.planning(); ++i) board.pass();
      in_flight += core.planning() ? 1 : 0;
      moving += core.runner().at_rest() ? 0 : 1;
      switch (random() % 6) {
        case 0:
          core.on_realtime('!');
          run(board, random, static_cast<int>(random() % 200));
          core.on_realtime('~');
          break;
        case 1:
          core.on_command({wire::Command::hold});
          core.on_command({wire::Command::resume});
          break;
        case 2:
          core.on_command(
              {wire::Command::job_speed, 40 + static_cast<std::uint32_t>(random() % 101)});
          break;
        case 3:
          core.on_command({wire::Command::lamp_frequency,
                           150'000 + 1000 * static_cast<std::uint32_t>(random() % 100)});
          break;
        default: {
          core.on_command({wire::Command::stop});
          for (int i = 0; i < 100'000 && core.state() != MachineState::idle; ++i) board.pass();
          ASSERT_EQ(core.state(), MachineState::idle);
          ++stops;
          if (random() % 2 == 0) {
            core.on_line("$120=3000");
            core.on_line("$120=" + std::to_string(job.settings.milli(Id::acceleration_x) / 1000));
          }
          if (board.status().first_unfired == job.targets.size()) break;
          run(board, random, static_cast<int>(random() % 3));
          // The job before may still brake, or the lamp may still return to its own frequency.
          for (int i = 0; i < 10'000 && !core.runner().at_rest(); ++i) board.pass();
          ASSERT_NO_FATAL_FAILURE(board.begin(board.status().first_unfired));
          break;
        }
      }
    }
    // A hold may still wait for a resume.
    for (int i = 0; i < 4000 && core.state() != MachineState::idle; ++i) {
      core.on_command({wire::Command::resume});
      run(board, random, 100);
    }
    ASSERT_EQ(core.state(), MachineState::idle);
    ASSERT_EQ(board.fired, std::vector<std::uint32_t>(job.targets.size(), 1));
    plans += planner.plans();
  }
  EXPECT_GT(plans, 0u);
  EXPECT_GT(moving, 0);
  if (scaled(10) >= 10) {
    EXPECT_GT(stops, 0);
    EXPECT_GT(in_flight, 0);
  }
  std::printf("%d stops, %d in flight, %d moving, %llu plans\n", stops, in_flight, moving,
              (unsigned long long)plans);
}

}  // namespace
}  // namespace lamplock::test
