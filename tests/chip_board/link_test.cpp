// The USB cable: garbage moves nothing, pulling and plugging in a job costs only time, and the boot
// loader starts at rest only.
#include "tests/chip_board/cable_trouble.hpp"
#include "tests/figure.hpp"

namespace lamplock::test {
namespace {

TEST(ChipLink, GarbageNeverMovesNorFires) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  std::mt19937_64 random(3);
  const settings::Values before = rig.board.stored_settings();
  std::array<std::uint8_t, 1024> bytes;
  std::size_t sent = 0;
  // The board takes noise more slowly than frames (RealTime::usb_served()).
  const auto wanted = static_cast<std::size_t>(scaled(100)) * 1000;
  for (int i = 0; i < scaled(1000) && sent <= wanted; ++i) {
    fill_with_noise(bytes, random);
    sent += rig.board.write(bytes);
    rig.run(ps_per_ms);
    rig.listen();
  }
  EXPECT_GT(sent, wanted);
  EXPECT_EQ(rig.board.stored_settings(), before);
  expect_garbage_did_nothing(rig);
  const job::Job job = job::make_job(chip_points(30, 1), profile, {});
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job));
}

TEST(ChipLink, PulledAndPluggedInAJobAtRandomMoments) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  sim::chip::UsbHost& host = rig.board.usb_host();
  CableCuts cuts{.seed = 5, .max_wait = 60 * ps_per_ms};
  cuts.pull = [&host](int cut) { cut % 2 == 1 ? host.suspend() : host.unplug(); };
  cuts.plug = [&host] {
    if (host.suspended()) host.resume();
    if (!host.plugged()) host.plug();
  };
  run_jobs_with_cuts(rig, profile, cuts);
}

TEST(ChipLink, AnIncompleteLineIsNotCompletedByANewConnection) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  rig.type("$110=6");
  rig.run(10 * ps_per_ms);
  rig.board.usb_host().unplug();
  rig.run(5 * ps_per_ms);
  rig.board.usb_host().plug();
  ASSERT_TRUE(rig.board.run_until_found(1000 * ps_per_ms));
  EXPECT_THAT(rig.answer("0"), HasSubstr("error:1\r"));
  EXPECT_EQ(rig.board.stored_settings(), profile.settings);
}

TEST(ChipLink, TheBootLoaderStartsAtRestWithEverythingOff) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  rig.is_broken = true;  // the boot loader of the ROM is not modelled whole
  EXPECT_THAT(rig.heard, HasSubstr("[MSG:Started by power on]"));
  RunningJob running(rig, job::make_job(chip_points(40, 4), profile, {}), 1);
  ASSERT_TRUE(running.run_until_fired(5));
  rig.heard.clear();
  EXPECT_THAT(rig.answer("$BOOT"), HasSubstr("error:8"));
  EXPECT_EQ(running.finish(), JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_fired(rig, running.job));
  open_gate(rig);
  rig.run(2 * ps_per_ms);
  const std::size_t shots = rig.shots().size();
  EXPECT_EQ(rig.answer("$BOOT"), "ok\r\n");
  const Picoseconds asked = rig.now();
  while (rig.board.chip().rom().state() != sim::chip::RomState::bootsel &&
         rig.now() < asked + 80 * ps_per_ms)
    rig.run(ps_per_ms / 4);
  expect_figure("boot loader after $BOOT", rig.now() - asked, 0, 60);
  EXPECT_EQ(rig.energy.levels(), 0u);
  const Picoseconds there = rig.now();
  rig.run(200 * ps_per_ms);  // longer than the watchdog's period
  EXPECT_EQ(rig.board.chip().rom().state(), sim::chip::RomState::bootsel);
  EXPECT_FALSE(rig.energy.any_high_within(there, rig.now()));
  EXPECT_FALSE(rig.step_high());
  EXPECT_EQ(rig.shots().size(), shots);
}

}  // namespace
}  // namespace lamplock::test
