// Jogging on the virtual board by hand: keys that repeat, keys that are released, several
// directions in a row.
#include <fmt/format.h>

#include <random>

#include "tests/board/program_host.hpp"

namespace lamplock::test::jog_test {
namespace {

constexpr double steps_per_mm = 200, accel_mm_s2 = 2000;
constexpr std::uint8_t jog_cancel = 0x85;
/// Repeat period of a key.
constexpr double repeat_ms = 1000.0 / 30;
/// From a key's release to the begin of braking, at most.
constexpr double reaction_s = 0.020;

class Jog : public testing::Test {
 protected:
  Jog() { host_.run_ms(5); }
  double x_mm() const { return rig_.board.world().drives().position()[0] / steps_per_mm; }
  /// Waits until every jog has ended.
  void wait_until_it_stands() {
    host_.run_ms(2);
    EXPECT_TRUE(host_.wait_for_rest());
  }
  /// Holds a key for `repeats`; each repeat requests slightly more than the motion until the next.
  template <class Each>
  void hold_key(double mm_s, int repeats, Each&& every_ms) {
    for (int i = 0; i < repeats; ++i) {
      const double way = mm_s * repeat_ms / 1000 * (i == 0 ? 3 : 1.05);
      host_.send(fmt::format("$J=G91X{:.3f}F{:.0f}\n", way, mm_s * 60));
      for (int part = 0; part < 33; ++part) {
        host_.run_ms(repeat_ms / 33);
        every_ms(i * repeat_ms + (part + 1) * repeat_ms / 33);
      }
    }
  }

  job::Profile profile_ = program_profile();
  Rig rig_{profile_};
  ProgramHost host_{rig_};
};

TEST_F(Jog, AKeyThatRepeatsMovesSmoothly) {
  for (const double mm_s : {5.0, 20.0, 50.0}) {
    // Speed over the last 20 ms, after acceleration.
    std::vector<double> places;
    const double from = x_mm();
    hold_key(mm_s, 20, [&](double) { places.push_back(x_mm() - from); });
    constexpr std::size_t window = 20;
    for (std::size_t i = 100; i + window < places.size(); ++i) {
      const double speed = (places[i + window] - places[i]) / (window * repeat_ms / 33 / 1000);
      EXPECT_NEAR(speed, mm_s, mm_s * 0.02 + 0.5) << "at " << i << " ms";
    }
    host_.send(jog_cancel);
    wait_until_it_stands();
    host_.ask(fmt::format("$J=G90X0F6000\n"), 5);
    wait_until_it_stands();
  }
  EXPECT_THAT(host_.answers(), Each("ok"));
}

TEST_F(Jog, ReleaseStopsAtOnce) {
  std::mt19937_64 random(9);
  for (int round = 0; round < scaled(60); ++round) {
    const double mm_s = 1 + static_cast<double>(random() % 99);
    const double way = random() % 2 == 0 ? 40 : -40;
    host_.ask(fmt::format("$J=G90X{}F{}\n", way, mm_s * 60));
    host_.run_ms(static_cast<double>(random() % 300));
    const double at = x_mm();
    host_.send(jog_cancel);
    wait_until_it_stands();
    EXPECT_LE(std::abs(x_mm() - at), mm_s * mm_s / 2 / accel_mm_s2 + mm_s * reaction_s + 0.01)
        << mm_s << " mm/s";
    EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
    host_.ask("$J=G90X0F6000\n", 5);
    wait_until_it_stands();
  }
  EXPECT_EQ(rig_.board.world().drives().total_faults(), 0u);
}

/// The next direction begins where the machine has come to rest, to the step.
TEST_F(Jog, AnotherKeyAtOnce) {
  std::mt19937_64 random(4);
  const Pick<int> number(random);
  for (int round = 0; round < scaled(40); ++round) {
    host_.send(fmt::format("$J=G91X{}Y{}F6000\n", number(-3, 3), number(1, 3)));
    host_.run_ms(number(0, 60));
    host_.send(jog_cancel);
    host_.send("$J=G91Y-0.5F3000\n");
    host_.run_ms(1);
    wait_until_it_stands();
    EXPECT_EQ(host_.position(), rig_.board.world().drives().position());
    if (round % 10 != 9) continue;
    host_.ask("$J=G90X0Y0F6000\n", 5);
    wait_until_it_stands();
  }
  EXPECT_THAT(host_.answers(), Each("ok"));
  EXPECT_THAT(host_.ask("G90 G0 X0 Y0\nG4 P0\n", 10), ElementsAre("ok", "ok"));
  EXPECT_EQ(rig_.board.world().drives().position(), StepPosition{});
}

/// As in grbl: a jog has the requested feed rate, whatever the override of a program; the override
/// of the program is unchanged.
TEST_F(Jog, IgnoresTheFeedOverrideOfPrograms) {
  constexpr std::uint8_t minus_10 = 0x92, plus_10 = 0x91;
  const auto change = [this](std::uint8_t byte, int times) {
    for (int i = 0; i < times; ++i) host_.send(byte);
  };
  change(minus_10, 5);
  host_.ask("$J=G90X40F3000\n");
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:3000,"));
  change(plus_10, 10);
  host_.run_ms(100);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:3000,"));
  change(minus_10, 10);
  wait_until_it_stands();
  EXPECT_EQ(x_mm(), 40);
  // A cancelled jog too.
  host_.ask("$J=G90X-40F3000\n");
  host_.run_ms(100);
  host_.send(jog_cancel);
  wait_until_it_stands();
  host_.ask("G90G1X0F3000\n");
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:1500,"));
  host_.send(std::uint8_t{0x90});
  host_.run_ms(100);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:3000,"));
  ASSERT_TRUE(host_.wait_for_rest());
}

}  // namespace
}  // namespace lamplock::test::jog_test
