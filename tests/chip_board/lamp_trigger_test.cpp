// A lamp that the machine triggers: every edge of its LAMP SYNC reaches the pad in its cycle,
// however long the simulator's slices are.
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

TEST(ChipLampTrigger, EchoEndsInItsCycle) {
  job::Profile profile = chip_profile(100);
  profile.settings.set_milli(Id::lamp_mode, static_cast<int>(LampMode::master) * 1000);
  profile.settings.set_milli(Id::lamp_energy, 1'000);
  sim::WorldConfig world = world_for(profile);
  world.lamp.triggered = true;
  ChipRig rig(profile.settings, world);
  struct Sync final : sim::PinListener {
    void pin_changed(sim::Pin, bool level, Picoseconds) override {
      edges.emplace_back(level, chip.time());
    }
    explicit Sync(sim::chip::Chip& watched) : chip(watched) {}
    sim::chip::Chip& chip;
    std::vector<std::pair<bool, Picoseconds>> edges;
  } sync(rig.board.chip());
  rig.board.bus().listen(sim::Pin::lamp_sync, sync);
  // The lamp is triggered only while a job keeps the beat running.
  const job::Job job = job::make_job(chip_points(20, 5), profile, {});
  RunningJob running(rig, job, 1);
  ASSERT_TRUE(running.run_until_fired(5));
  rig.run(50 * ps_per_ms);
  ASSERT_GT(sync.edges.size(), 6u);
  const auto pulse = static_cast<Picoseconds>(world.lamp.pulse_us * ps_per_us);
  for (std::size_t i = 0; i + 1 < sync.edges.size(); i += 2) {
    ASSERT_TRUE(sync.edges[i].first);
    EXPECT_NEAR(static_cast<double>(sync.edges[i + 1].second - sync.edges[i].second),
                static_cast<double>(pulse), 2.0 * 8 * ps_per_ns)
        << i;
  }
}

}  // namespace
}  // namespace lamplock::test
