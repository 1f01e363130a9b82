// The guard of a job: which inputs trip it, how it recovers, and when the interlock is on.
#include "host/gpio/safety_inputs.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/gpio/model_lines.hpp"
#include "tests/scale.hpp"

namespace lamplock::gpio {
namespace {

using namespace std::chrono_literals;
using test::ModelLines;
using test::ModelPins;
using Time = SafetyInputs::Time;

/// E-stop and door closed to ground, interlock and lamp.
LineTable table(std::chrono::milliseconds debounce = 20ms) {
  LineTable lines;
  lines.estop = LineRequest{.place = "E"};
  lines.door = LineRequest{.place = "D"};
  lines.interlock = LineRequest{.place = "I"};
  lines.lamp = LineRequest{.place = "L"};
  lines.debounce = debounce;
  return lines;
}

struct Bench {
  explicit Bench(const LineTable& of = table(),
                 std::shared_ptr<ModelPins> at = std::make_shared<ModelPins>())
      : pins(std::move(at)), guard(lines, of) {}

  SafetyState poll(Time by = 1ms) {
    now += by;
    return guard.poll(now);
  }
  void settle() {
    for (int i = 0; i < 30; ++i) poll();
  }
  void start(LaserUse work = LaserUse::laser) {
    settle();
    guard.begin(work);
    poll();
  }
  /// True if the level has changed.
  bool move(const std::string& place, bool level) {
    const bool moves = pins->level(place) != level;
    pins->set(place, level);
    return moves;
  }
  bool interlock() { return pins->level("I"); }

  std::shared_ptr<ModelPins> pins;
  ModelLines lines{pins};
  Time now{1s};
  SafetyInputs guard;
};

TEST(SafetyInputs, InterlockIsOnWhileLaserWorkRunsAndAllInputsAreClear) {
  Bench bench;
  bench.settle();
  EXPECT_TRUE(bench.guard.settled());
  EXPECT_FALSE(bench.interlock());
  bench.guard.begin(LaserUse::laser);
  EXPECT_EQ(bench.poll(), SafetyState::clear);
  EXPECT_TRUE(bench.interlock());
  bench.guard.end();
  EXPECT_FALSE(bench.interlock());
  bench.poll();
  EXPECT_FALSE(bench.interlock());
}

TEST(SafetyInputs, MotionAloneNeedsNoInterlock) {
  Bench bench;
  bench.start(LaserUse::motion);
  EXPECT_FALSE(bench.interlock());
  EXPECT_TRUE(bench.pins->level("L"));
  bench.pins->set("E", true);
  EXPECT_EQ(bench.poll(), SafetyState::stop);
}

TEST(SafetyInputs, InputsAreClearOnlyAfterTheDebounceTime) {
  Bench bench;
  bench.poll();
  EXPECT_EQ(bench.guard.unsettled(), "e-stop pressed (E)");
  for (int i = 0; i < 19; ++i) bench.poll();
  EXPECT_FALSE(bench.guard.settled());
  bench.poll();
  EXPECT_TRUE(bench.guard.settled());
}

TEST(SafetyInputs, APulseBetweenTwoLooksIsSeen) {
  Bench bench;
  bench.start();
  bench.pins->set("E", true);
  bench.pins->set("E", false);
  EXPECT_EQ(bench.poll(), SafetyState::stop);
  EXPECT_FALSE(bench.interlock());
  EXPECT_EQ(bench.guard.reason(), "e-stop pressed (E)");
}

/// An FT232H reports levels only: a press that ends before the next poll is not seen.
TEST(SafetyInputs, WithoutEdgesThePollSeesTheLevel) {
  auto pins = std::make_shared<ModelPins>();
  for (const char* place : {"E", "D"}) pins->pins[place].has_edges = false;
  Bench bench(table(), pins);
  bench.start();
  bench.pins->set("E", true);
  bench.pins->set("E", false);
  EXPECT_EQ(bench.poll(), SafetyState::clear) << "documented: shorter than the poll";
  bench.pins->set("D", true);
  EXPECT_EQ(bench.poll(), SafetyState::door);
  EXPECT_FALSE(bench.interlock());
  bench.pins->set("D", false);
  for (int i = 1; i < 20; ++i) EXPECT_EQ(bench.poll(), SafetyState::door) << "still debounced";
  EXPECT_EQ(bench.poll(), SafetyState::clear);
  bench.pins->set("E", true);
  EXPECT_EQ(bench.poll(), SafetyState::stop);
  EXPECT_EQ(bench.guard.reason(), "e-stop pressed (E)");
}

TEST(SafetyInputs, AnEstopIsKeptAfterItsRelease) {
  Bench bench;
  bench.start();
  bench.pins->set("E", true);
  bench.poll();
  bench.pins->set("E", false);
  bench.guard.resume();
  bench.settle();
  EXPECT_EQ(bench.guard.state(), SafetyState::stop);
  EXPECT_FALSE(bench.interlock());
}

TEST(SafetyInputs, AfterADoorTheInterlockWaitsForTheUser) {
  Bench bench;
  bench.start();
  bench.pins->set("D", true);
  EXPECT_EQ(bench.poll(), SafetyState::door);
  EXPECT_EQ(bench.guard.reason(), "door open (D)");
  EXPECT_FALSE(bench.interlock());
  bench.pins->set("D", false);
  EXPECT_EQ(bench.poll(), SafetyState::door) << "it may still bounce";
  bench.settle();
  EXPECT_EQ(bench.guard.state(), SafetyState::clear);
  EXPECT_FALSE(bench.interlock()) << "the user has not resumed";
  bench.guard.resume();
  bench.poll();
  EXPECT_TRUE(bench.interlock());
}

TEST(SafetyInputs, EveryLostLineStops) {
  for (const char* place : {"E", "D", "I", "L"}) {
    Bench bench;
    bench.start();
    bench.pins->unplug(place);
    EXPECT_EQ(bench.poll(), SafetyState::stop) << place;
    EXPECT_EQ(bench.guard.reason(), "line lost (" + std::string(place) + ")");
    if (*place != 'I') {
      EXPECT_FALSE(bench.interlock()) << place;
    }
  }
}

TEST(SafetyInputs, ActiveLowInvertsALine) {
  LineTable lines = table();
  lines.estop->active_low = lines.interlock->active_low = true;
  Bench bench(lines);
  EXPECT_TRUE(bench.interlock()) << "active low: off is high";
  bench.pins->set("E", true);
  bench.start();
  EXPECT_FALSE(bench.interlock()) << "active low: on is low";
  bench.pins->set("E", false);
  EXPECT_EQ(bench.poll(), SafetyState::stop);
  EXPECT_TRUE(bench.interlock());
}

TEST(SafetyInputs, AToggledInterlockStopsWithinOnePeriodOfTheEstop) {
  int changes = 0;  // must outlive the guard, which switches outputs off at its end
  LineTable lines = table();
  lines.interlock_beat = 20ms;
  Bench bench(lines);
  bench.pins->on_output = [&](const std::string& place, bool) { changes += place == "I" ? 1 : 0; };
  bench.start();
  changes = 0;
  for (int i = 0; i < 1000; ++i) bench.poll();
  EXPECT_EQ(changes, 50);
  bench.pins->set("E", true);
  bench.poll();
  EXPECT_FALSE(bench.interlock());
  changes = 0;
  for (int i = 0; i < 1000; ++i) bench.poll();
  EXPECT_EQ(changes, 0);
}

TEST(SafetyInputs, TheLampIsSteadyInNormalWorkAndBlinksForTheUser) {
  int changes = 0;  // must outlive the guard
  Bench bench;
  bench.start();
  bench.pins->on_output = [&](const std::string& place, bool) { changes += place == "L" ? 1 : 0; };
  EXPECT_TRUE(bench.pins->level("L"));
  for (int i = 0; i < 2000; ++i) bench.poll();
  EXPECT_EQ(changes, 0);
  bench.pins->set("D", true);
  for (int i = 0; i < 2000; ++i) bench.poll();
  EXPECT_NEAR(changes, 8, 1) << "2 Hz";
}

TEST(SafetyInputs, OutputsAreOffWhenTheGuardEndsInAnyWay) {
  auto pins = std::make_shared<ModelPins>();
  std::vector<std::string> order;
  pins->on_output = [&](const std::string& place, bool level) {
    if (!level) order.push_back(place);
  };
  try {
    ModelLines lines(pins);
    SafetyInputs guard(lines, table());
    Time now{1s};
    for (int i = 0; i < 30; ++i) guard.poll(now += 1ms);
    guard.begin(LaserUse::laser);
    guard.poll(now);
    EXPECT_TRUE(pins->level("I"));
    throw std::runtime_error("something else");
  } catch (const std::runtime_error&) {
  }
  EXPECT_FALSE(pins->level("I"));
  EXPECT_FALSE(pins->level("L"));
  ASSERT_EQ(order.size(), 2u);
  EXPECT_EQ(order.front(), "I") << "the interlock must switch off first";
  for (const char* place : {"E", "D", "I", "L"}) EXPECT_FALSE(pins->requested(place));
}

/// Computes independently of the guard whether the interlock may be on after a random history.
struct Oracle {
  Time debounce;
  bool working = false, dead = false, waits = false;
  Time estop_quiet{}, door_quiet{};  ///< quiet since

  bool well(Time now) const {
    return working && !dead && !waits && now - estop_quiet >= debounce &&
           now - door_quiet >= debounce;
  }
};

/// Bouncing contacts, pulses, unplugged lines, user actions: the interlock is on only when allowed.
TEST(SafetyInputs, RandomHistoriesNeverLeaveTheInterlockOn) {
  for (int seed = 0; seed < test::scaled(60); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto one_in = [&](int n) { return std::uniform_int_distribution(1, n)(random) == 1; };
    const std::chrono::milliseconds debounce(std::uniform_int_distribution(0, 50)(random));
    Bench bench(table(debounce));
    bench.poll();
    Oracle oracle{.debounce = debounce, .estop_quiet = bench.now, .door_quiet = bench.now};
    for (int round = 0; round < 2000; ++round) {
      bool estop_touched = false, door_touched = false;
      for (int touches = one_in(40) ? 5 : 0; touches > 0; --touches) {
        const bool estop = one_in(20);
        const bool level = one_in(2);
        (estop ? estop_touched : door_touched) |= bench.move(estop ? "E" : "D", level);
      }
      if (one_in(30)) door_touched |= bench.move("D", false);
      if (one_in(30)) estop_touched |= bench.move("E", false);
      if (one_in(20)) {
        bench.guard.resume();
        oracle.waits = false;
      }
      if (one_in(100) && bench.guard.settled()) {
        bench.guard.begin(LaserUse::laser);
        oracle.working = true;
      }
      if (one_in(400)) {
        bench.guard.end();
        oracle.working = false;
      }
      const bool unplugged = one_in(3000);
      if (unplugged) bench.pins->unplug(one_in(2) ? "E" : "D");
      bench.poll(Time(std::uniform_int_distribution(0, 20'000)(random)));
      if (estop_touched || bench.pins->level("E")) oracle.estop_quiet = bench.now;
      if (door_touched || bench.pins->level("D")) oracle.door_quiet = bench.now;
      const bool lost = !bench.pins->pins["E"].plugged || !bench.pins->pins["D"].plugged;
      if (oracle.working && (lost || bench.now - oracle.estop_quiet < debounce ||
                             bench.pins->level("E") || estop_touched))
        oracle.dead = true;
      if (oracle.working &&
          (bench.now - oracle.door_quiet < debounce || bench.pins->level("D") || door_touched))
        oracle.waits = true;
      ASSERT_EQ(bench.interlock(), oracle.well(bench.now)) << "seed " << seed << " round " << round;
    }
  }
}

}  // namespace
}  // namespace lamplock::gpio
