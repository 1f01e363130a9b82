// The continuous laser of the simulated world: gate and power, each with its own order of time.
#include "sim/world/beam.hpp"

#include <gtest/gtest.h>

namespace lamplock::sim {
namespace {

TEST(Beam, ShinesWhileTheGateIsOpenAndThereIsPower) {
  PinBus bus;
  const Beam beam(bus);
  EXPECT_TRUE(beam.changes().empty());
  bus.set_power(1000, 5 * ps_per_us);
  bus.set_power(0, 8 * ps_per_us);
  bus.set_power(30'000, 10 * ps_per_us);
  bus.set(Pin::laser_gate, true, 20 * ps_per_us);
  bus.set(Pin::laser_gate, false, 60 * ps_per_us);
  // Sent after its period had ended.
  bus.set_power(65'535, 40 * ps_per_us);
  bus.set_power(0, 50 * ps_per_us);
  const std::vector<BeamChange> wanted{{20 * ps_per_us, true, 30'000},
                                       {40 * ps_per_us, true, 65'535},
                                       {50 * ps_per_us, true, 0},
                                       {60 * ps_per_us, false, 0}};
  EXPECT_EQ(beam.changes(), wanted);
  EXPECT_EQ(beam.openings(), 1u);
  EXPECT_EQ(beam.at(15 * ps_per_us), (BeamChange{15 * ps_per_us, false, 30'000}));
  EXPECT_EQ(beam.at(15 * ps_per_us).light(), 0);
  EXPECT_EQ(beam.at(39 * ps_per_us).light(), 30'000);
  EXPECT_FALSE(beam.shone(0, 20 * ps_per_us));
  EXPECT_TRUE(beam.shone(19 * ps_per_us, 21 * ps_per_us));
  EXPECT_TRUE(beam.shone(45 * ps_per_us, 46 * ps_per_us));
  EXPECT_FALSE(beam.shone(50 * ps_per_us, 90 * ps_per_us));
  EXPECT_NEAR(beam.energy(0, ps_per_ms), 20e-6 * 30'000 / 65'535 + 10e-6, 1e-12);
  EXPECT_NEAR(beam.energy(30 * ps_per_us, 45 * ps_per_us), 10e-6 * 30'000 / 65'535 + 5e-6, 1e-12);
}

}  // namespace
}  // namespace lamplock::sim
