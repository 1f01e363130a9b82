#include "sim/world/world.hpp"

#include <gtest/gtest.h>

#include "tests/world/recorder.hpp"

namespace lamplock::sim {
namespace {

using test::Change;
using test::Recorder;

void fire(PinBus& bus, Picoseconds at, Picoseconds width = 150 * ps_per_us) {
  bus.set(Pin::q_switch, true, at);
  bus.set(Pin::q_switch, false, at + width);
}

void step(PinBus& bus, Pin pin, Picoseconds at) {
  bus.set(pin, true, at);
  bus.set(pin, false, at + 500 * ps_per_ns);
}

TEST(Laser, RecordsBeatTimePositionAndWidth) {
  PinBus bus;
  World world({.lamp = {.frequency_hz = 100, .phase_us = 100}}, bus);
  for (int n = 0; n < 50; ++n) {
    const Picoseconds edge = 100 * ps_per_us + n * (10 * ps_per_ms);
    step(bus, Pin::step_x, edge - ps_per_us);
    world.advance(edge);
    fire(bus, edge + 5 * ps_per_us, (150 + n) * ps_per_us);
  }
  const auto& shots = world.laser().shots();
  ASSERT_EQ(shots.size(), 50u);
  for (int n = 0; n < 50; ++n) {
    const Shot& shot = shots[static_cast<std::size_t>(n)];
    EXPECT_EQ(shot.index, static_cast<std::uint32_t>(n));
    EXPECT_EQ(shot.beat, n + 1);
    EXPECT_EQ(shot.at, 105 * ps_per_us + n * (10 * ps_per_ms));
    EXPECT_EQ(shot.steps, (StepPosition{n + 1, 0, 0, 0}));
    EXPECT_EQ(shot.width, (150 + n) * ps_per_us);
  }
  EXPECT_EQ(world.laser().narrow_pulses(), 0u);
  EXPECT_EQ(world.laser().late_pulses(), 0u);
  EXPECT_EQ(world.laser().unlit_pulses(), 0u);
}

TEST(Laser, ChecksTheTimingOfItsSignal) {
  PinBus bus;
  World world({.lamp = {.frequency_hz = 100, .phase_us = 5000}}, bus);
  fire(bus, ps_per_ms);  // no flash yet
  EXPECT_EQ(world.laser().unlit_pulses(), 1u);
  EXPECT_EQ(world.laser().shots()[0].beat, 0);
  world.advance(5 * ps_per_ms);
  fire(bus, 5 * ps_per_ms + 20 * ps_per_us, 100 * ps_per_us + 1);  // exactly at both limits
  EXPECT_EQ(world.laser().late_pulses() + world.laser().narrow_pulses(), 0u);
  world.advance(15 * ps_per_ms);
  fire(bus, 15 * ps_per_ms + 20 * ps_per_us + 1, 100 * ps_per_us);  // just beyond both limits
  EXPECT_EQ(world.laser().late_pulses(), 1u);
  EXPECT_EQ(world.laser().narrow_pulses(), 1u);
  EXPECT_EQ(world.laser().unlit_pulses(), 1u);
}

TEST(Laser, NoFlashInADropout) {
  PinBus bus;
  World world({.lamp = {.frequency_hz = 100, .dropout = 1}}, bus);
  world.advance(ps_per_s);
  fire(bus, ps_per_s);
  EXPECT_EQ(world.laser().unlit_pulses(), 1u);
}

TEST(Laser, PositionIsThatOfTheShotForAnyOrderWithinASlice) {
  // A slice of 1 ms with a step in every 10 us on two axes, and one shot in its middle.
  const Picoseconds start = 10 * ps_per_ms, shot_at = start + 505 * ps_per_us;
  const auto deliver = [&](PinBus& bus, Pin pin) {
    for (int n = 1; n <= 100; ++n) step(bus, pin, start + n * (10 * ps_per_us));
  };
  for (int order = 0; order < 3; ++order) {
    PinBus bus;
    World world({}, bus);
    world.advance(start);
    world.advance(start + ps_per_ms);  // the lamp's part of the slice comes first
    if (order == 0) fire(bus, shot_at);
    deliver(bus, Pin::step_x);
    if (order == 1) fire(bus, shot_at);
    deliver(bus, Pin::step_y);
    if (order == 2) fire(bus, shot_at);
    world.advance(start + 2 * ps_per_ms);
    EXPECT_EQ(world.laser().shots().at(0).steps, (StepPosition{50, 50, 0, 0})) << order;
    for (int n = 0; n < 5000; ++n)  // later steps have no effect on it
      step(bus, Pin::step_x, start + 3 * ps_per_ms + n * ps_per_us);
    world.advance(start + 20 * ps_per_ms);
    EXPECT_EQ(world.laser().shots().at(0).steps, (StepPosition{50, 50, 0, 0})) << order;
  }
}

TEST(World, HandlesSwitchesAndFlashesInOrderOfTime) {
  PinBus bus;
  World world({.lamp = {.frequency_hz = 100, .phase_us = 1000}}, bus);
  Recorder recorder(bus, {Pin::lamp_sync, Pin::estop, Pin::door, Pin::limit_y});
  world.schedule(Pin::door, false, 30 * ps_per_ms);
  world.schedule(Pin::estop, true, 500 * ps_per_us);
  world.schedule(Pin::door, true, 5 * ps_per_ms);
  world.schedule(Pin::limit_y, true, 5 * ps_per_ms);
  EXPECT_EQ(world.next_event(), 500 * ps_per_us);
  world.advance(500 * ps_per_us - 1);
  EXPECT_TRUE(recorder.changes.empty());
  world.advance(12 * ps_per_ms);
  const std::vector<Change> expected{
      {Pin::estop, true, 500 * ps_per_us},        {Pin::lamp_sync, true, 1000 * ps_per_us},
      {Pin::lamp_sync, false, 1020 * ps_per_us},  {Pin::door, true, 5 * ps_per_ms},
      {Pin::limit_y, true, 5 * ps_per_ms},        {Pin::lamp_sync, true, 11'000 * ps_per_us},
      {Pin::lamp_sync, false, 11'020 * ps_per_us}};
  EXPECT_EQ(recorder.changes, expected);
  EXPECT_EQ(world.next_event(), 21 * ps_per_ms);
}

TEST(World, NeverGoesBackInTime) {
  PinBus bus;
  World world({}, bus);
  Recorder recorder(bus, {Pin::estop});
  world.advance(ps_per_s);
  world.schedule(Pin::estop, true, ps_per_ms);
  world.advance(ps_per_s);
  ASSERT_EQ(recorder.changes.size(), 1u);
  EXPECT_EQ(recorder.changes[0].at, ps_per_s);
}

}  // namespace
}  // namespace lamplock::sim
