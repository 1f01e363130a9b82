// The USB cable: garbage moves nothing, pulled and plugged in a job it costs only time; the boot
// loader starts at rest only.
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

using testing::HasSubstr;

TEST(ChipLink, GarbageNeverMovesNorFires) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  std::mt19937_64 random(3);
  const settings::Values before = rig.board.stored_settings();
  std::array<std::uint8_t, 1024> bytes;
  std::size_t sent = 0;
  for (int i = 0; i < scaled(300); ++i) {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    sent += rig.board.write(bytes);
    rig.run(ps_per_ms);
    rig.listen();
  }
  EXPECT_GT(sent, static_cast<std::size_t>(scaled(100)) * 1000);
  EXPECT_TRUE(rig.monitor.nothing_happened());
  EXPECT_FALSE(rig.energy.any_high_within(0, rig.now()));
  EXPECT_EQ(rig.board.stored_settings(), before);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
  // And it still listens.
  for (int i = 0; i < 500 && rig.board.usb_host().unsent() != 0; ++i) {
    rig.run(ps_per_ms);
    rig.listen();
  }
  rig.run(20 * ps_per_ms);
  rig.answer("$I");  // ends whatever line or frame the garbage has begun
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[VER:"));
  const job::Job job = job::make_job(chip_points(30, 1), profile, {});
  RunningJob running(rig, job, 1);
  EXPECT_EQ(running.finish(), link::JobEnd::done);
  expect_fired(rig, job);
  expect_no_violations(rig);
}

TEST(ChipLink, PulledAndPluggedInAJobAtRandomMoments) {
  const job::Profile profile = chip_profile();
  std::mt19937_64 random(5);
  const auto up_to = [&random](Picoseconds most) {
    return std::uniform_int_distribution<Picoseconds>(0, most)(random);
  };
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  int cuts = 0;
  for (int round = 0; round < scaled(4); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const job::Job job = job::make_job(chip_points(80, random()), profile, {});
    const std::size_t fired = rig.shots().size();
    RunningJob running(rig, job, static_cast<std::uint32_t>(round + 1));
    // From the very begin of the job on.
    Picoseconds at = rig.now() + up_to(60 * ps_per_ms);
    for (int i = 0; i < 3; ++i) {
      const bool suspend = (round + i) % 2 == 1;
      running.cable.at(at, [&rig, &cuts, suspend] {
        if (!rig.board.usb_host().enumerated()) return;
        ++cuts;
        suspend ? rig.board.usb_host().suspend() : rig.board.usb_host().unplug();
      });
      at += 5 * ps_per_ms + up_to(40 * ps_per_ms);
      running.cable.at(at, [&rig] {
        if (rig.board.usb_host().suspended()) rig.board.usb_host().resume();
        if (!rig.board.usb_host().plugged()) rig.board.usb_host().plug();
      });
      at += 30 * ps_per_ms + up_to(60 * ps_per_ms);
    }
    ASSERT_EQ(running.finish(), link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job, fired));
    EXPECT_EQ(rig.monitor.violation(profile.settings), "");
  }
  EXPECT_GT(cuts, scaled(4));
  expect_no_violations(rig);
}

TEST(ChipLink, HalfALineIsNotFinishedByANewConnection) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  rig.type("$110=6");
  rig.run(10 * ps_per_ms);
  rig.board.usb_host().unplug();
  rig.run(5 * ps_per_ms);
  rig.board.usb_host().plug();
  ASSERT_TRUE(rig.board.run_until_found(1000 * ps_per_ms));
  EXPECT_THAT(rig.answer("0"), HasSubstr("error:1\r"));
  EXPECT_EQ(rig.board.stored_settings(), profile.settings);
  expect_no_violations(rig);
}

TEST(ChipLink, TheBootLoaderStartsAtRestWithEverythingOff) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  EXPECT_THAT(rig.heard, HasSubstr("[MSG:Started by power on]"));
  RunningJob running(rig, job::make_job(chip_points(40, 4), profile, {}), 1);
  ASSERT_TRUE(running.run_until_fired(5));
  rig.heard.clear();
  EXPECT_THAT(rig.answer("$BOOT"), HasSubstr("error:8"));
  EXPECT_EQ(running.finish(), link::JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_fired(rig, running.job));
  open_gate(rig);
  rig.run(2 * ps_per_ms);
  const std::size_t shots = rig.shots().size();
  EXPECT_EQ(rig.answer("$BOOT"), "ok\r\n");
  rig.run(80 * ps_per_ms);
  EXPECT_EQ(rig.board.chip().rom().state(), sim::chip::RomState::bootsel);
  EXPECT_EQ(rig.energy.levels(), 0u);
  const Picoseconds there = rig.now();
  rig.run(200 * ps_per_ms);  // longer than the watchdog waits
  EXPECT_EQ(rig.board.chip().rom().state(), sim::chip::RomState::bootsel);
  EXPECT_FALSE(rig.energy.any_high_within(there, rig.now()));
  EXPECT_FALSE(rig.step_high());
  EXPECT_EQ(rig.shots().size(), shots);
}

}  // namespace
}  // namespace lamplock::test
