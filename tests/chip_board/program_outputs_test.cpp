// Outputs and inputs of programs on the chip: distance of output changes from their tick, outputs
// after an e-stop, waits for an input, drives at rest.
#include <fmt/format.h>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

using sim::Pin;

job::Profile outputs_profile() {
  job::Profile profile = chip_profile(500);
  profile.settings.set_milli(Id::lamp_mode, 0);
  profile.settings.set_milli(Id::laser_mode, 1000);
  profile.settings.set_milli(Id::pin_map, 2000);
  return profile;
}

class ChipOutputs : public testing::Test {
 protected:
  ChipOutputs() : ChipOutputs(outputs_profile()) {}
  explicit ChipOutputs(const job::Profile& profile)
      : rig_(profile),
        aux_(rig_.board.bus(), Pin::aux_out),
        air_(rig_.board.bus(), Pin::air),
        gate_(rig_.board.bus(), Pin::laser_gate) {}

  bool level(Pin pin) { return rig_.board.bus().level(pin); }
  void set(Pin pin, bool level) {
    rig_.set(pin, level);
    rig_.run(ps_per_us);
  }
  bool run_until(Pin pin, bool wanted, Picoseconds limit) {
    const Picoseconds end = rig_.now() + limit;
    while (level(pin) != wanted && rig_.now() < end) rig_.run(100 * ps_per_us);
    return level(pin) == wanted;
  }

  ChipRig rig_;
  EdgeLog aux_, air_, gate_;
};

/// A hanging Z would fall if its drive were released.
TEST_F(ChipOutputs, ALimitSwitchStopsTheMachineAndDrivesHoldOn) {
  ASSERT_TRUE(level(Pin::enable_z) && level(Pin::enable));
  const EdgeLog z(rig_.board.bus(), Pin::enable_z), drives(rig_.board.bus(), Pin::enable);
  rig_.type("M62 P0\nG91 M3 S1000 F3000\nG1 X20\n");
  rig_.run(200 * ps_per_ms);
  ASSERT_TRUE(level(Pin::aux_out) && level(Pin::laser_gate));
  for (const bool engaged : {true, false, true}) {  // the last one at rest, in the alarm
    set(Pin::limit_x, engaged);
    rig_.run(50 * ps_per_ms);
  }
  rig_.listen();
  EXPECT_THAT(rig_.heard, HasSubstr("ALARM:1\r"));
  EXPECT_FALSE(level(Pin::aux_out) || level(Pin::laser_gate));
  EXPECT_TRUE(z.edges().empty());
  EXPECT_TRUE(drives.edges().empty());
}

/// LASER GATE opens and closes exactly at the tick at which a line begins.
TEST_F(ChipOutputs, ChangeWithin100MicrosecondsOfTheTick) {
  std::string text = "G91 M3 S0 F3000\nG1 X1\n";
  const int lines = scaled(60);
  std::mt19937 random(2);
  // Back and forth: any number of lines stays in the work space.
  for (int i = 0; i < lines; ++i)
    text += fmt::format(
        "M6{} P0\nG1 X{:.2f} S{}\n", i % 2 == 0 ? 2 : 3,
        (i / 60 % 2 == 0 ? 1 : -1) * std::uniform_int_distribution<>(2, 60)(random) / 100.0,
        i % 2 == 0 ? 1000 : 0);
  rig_.user.give(text);
  ASSERT_TRUE(rig_.user.run_until_answered(rig_.now() + 20 * ps_per_s));
  ASSERT_TRUE(rig_.user.run_until_idle(rig_.now() + 20 * ps_per_s));
  EXPECT_EQ(rig_.user.errors(), 0u);
  ASSERT_EQ(aux_.edges().size(), static_cast<std::size_t>(lines));
  ASSERT_EQ(gate_.edges().size(), aux_.edges().size());
  Picoseconds latest = 0, soonest = ps_per_s;
  for (std::size_t i = 0; i < aux_.edges().size(); ++i) {
    EXPECT_EQ(aux_.edges()[i].level, gate_.edges()[i].level);
    const Picoseconds late = aux_.edges()[i].at - gate_.edges()[i].at;
    latest = std::max(latest, late);
    soonest = std::min(soonest, late);
  }
  std::cout << fmt::format("outputs change {:.1f} to {:.1f} us after their tick\n",
                           static_cast<double>(soonest) / ps_per_us,
                           static_cast<double>(latest) / ps_per_us);
  EXPECT_GE(soonest, -2 * ps_per_us);
  EXPECT_LE(latest, 100 * ps_per_us);
}

TEST_F(ChipOutputs, AreOffWithTheEstop) {
  EXPECT_THAT(rig_.answer("M8"), HasSubstr("ok"));
  EXPECT_THAT(rig_.answer("M64 P0"), HasSubstr("ok"));
  rig_.run(2 * ps_per_ms);
  ASSERT_TRUE(level(Pin::air) && level(Pin::aux_out) && level(Pin::enable_z));
  set(Pin::estop, true);
  rig_.run(2 * ps_per_us);
  EXPECT_FALSE(level(Pin::air));
  EXPECT_FALSE(level(Pin::aux_out));
  EXPECT_FALSE(level(Pin::enable_z));
  rig_.run(10 * ps_per_ms);
  EXPECT_FALSE(level(Pin::enable));
  set(Pin::estop, false);
  rig_.run(30 * ps_per_ms);
  EXPECT_THAT(rig_.answer("$X"), HasSubstr("ok"));
  rig_.run(10 * ps_per_ms);
  EXPECT_FALSE(level(Pin::air) || level(Pin::aux_out));
  EXPECT_TRUE(level(Pin::enable) && level(Pin::enable_z));
}

/// Mean level of an analogue output.
TEST_F(ChipOutputs, HaveTheirDutyAsPwm) {
  EXPECT_THAT(rig_.answer("M68 E0 Q30"), HasSubstr("ok"));
  rig_.run(2 * ps_per_ms);
  const std::size_t from = aux_.edges().size();
  rig_.run(10 * ps_per_ms);
  Picoseconds high = 0, rose = 0, begin = 0, end = 0;
  for (std::size_t i = from; i < aux_.edges().size(); ++i) {
    const EdgeLog::Edge& edge = aux_.edges()[i];
    if (edge.level) {
      if (begin == 0) begin = edge.at;
      rose = end = edge.at;
    } else if (begin != 0) {
      high += edge.at - rose;
    }
  }
  ASSERT_GT(end, begin);
  EXPECT_NEAR(static_cast<double>(high) / static_cast<double>(end - begin), 0.3, 0.003);
}

/// The e-stop comes anywhere in the PWM period; the main loop takes a millisecond.
TEST_F(ChipOutputs, AreOffWithTheEstopAsPwm) {
  std::mt19937 random(4);
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(i);
    const int percent = std::uniform_int_distribution<>(1, 99)(random);
    ASSERT_THAT(rig_.answer(fmt::format("M68 E0 Q{}", percent)), HasSubstr("ok"));
    rig_.run(2 * ps_per_ms +
             std::uniform_int_distribution<Picoseconds>(0, 100)(random) * ps_per_us / 3);
    rig_.set(Pin::estop, true);
    rig_.run(2 * ps_per_us);
    ASSERT_FALSE(aux_.edges().empty());
    EXPECT_FALSE(level(Pin::aux_out));
    const std::size_t edges = aux_.edges().size();
    rig_.run(5 * ps_per_ms);
    EXPECT_EQ(aux_.edges().size(), edges);
    set(Pin::estop, false);
    rig_.run(30 * ps_per_ms);
    ASSERT_THAT(rig_.answer("$X"), HasSubstr("ok"));
    rig_.run(5 * ps_per_ms);
    EXPECT_EQ(aux_.edges().size(), edges);
    EXPECT_FALSE(level(Pin::aux_out));
  }
}

TEST_F(ChipOutputs, WaitForTheInput) {
  rig_.type("M8\nM66 P0 L3 Q0.5\nM9\n");
  rig_.run(200 * ps_per_ms);
  EXPECT_TRUE(level(Pin::air));
  set(Pin::aux_in, false);
  EXPECT_TRUE(run_until(Pin::air, false, 5 * ps_per_ms));
  rig_.run(5 * ps_per_ms);  // until the text has arrived by USB
  rig_.listen();
  EXPECT_THAT(rig_.heard, HasSubstr("[MSG:Input 0 on]"));
  set(Pin::aux_in, true);
  rig_.run(5 * ps_per_ms);
  rig_.type("M66 P0 L3 Q0.05\n");
  rig_.run(100 * ps_per_ms);
  rig_.listen();
  EXPECT_THAT(rig_.heard, HasSubstr("[MSG:Input 0 not met: off]"));
  EXPECT_THAT(rig_.status(), HasSubstr("<Hold"));
}

class ChipDrivesAtRest : public ChipOutputs {
 protected:
  ChipDrivesAtRest() : ChipOutputs(with_rest()) {}
  static job::Profile with_rest() {
    job::Profile profile = outputs_profile();
    profile.settings.set_milli(Id::axes, 3000);
    profile.settings.set_milli(Id::idle_delay, 50'000);
    profile.settings.set_milli(Id::idle_release, 3000);
    return profile;
  }
};

TEST_F(ChipDrivesAtRest, AreReleasedAndTakeNoStepBeforeTheyHold) {
  rig_.run(100 * ps_per_ms);
  EXPECT_FALSE(level(Pin::enable));
  EXPECT_TRUE(level(Pin::enable_z));
  rig_.type("G0 X0.5\n");
  ASSERT_TRUE(run_until(Pin::enable, true, 20 * ps_per_ms));
  rig_.run(400 * ps_per_ms);
  EXPECT_EQ(rig_.board.world().drives().position()[0], 100);
  EXPECT_EQ(rig_.board.world().drives().total_faults(), 0u);
  EXPECT_FALSE(level(Pin::enable));
}

TEST(ChipDrives, HoldBeforeAJobOfPoints) {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::idle_delay, 50'000);
  const job::Job job = job::make_job(chip_points(30, 3), profile, {});
  ChipRig rig(profile);
  rig.run(150 * ps_per_ms);
  EXPECT_FALSE(rig.board.bus().level(Pin::enable));
  RunningJob running(rig, job, 1);
  ASSERT_EQ(running.finish(), JobEnd::done);
  EXPECT_EQ(rig.shots().size(), job.targets.size());
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
}

}  // namespace
}  // namespace lamplock::test
