#include "sim/world/switches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "sim/world/world.hpp"
#include "tests/scale.hpp"
#include "tests/world/recorder.hpp"

namespace lamplock::sim::switches_test {
namespace {

using test::Change;
using test::Recorder;

void step(PinBus& bus, int axis, bool negative, Picoseconds at) {
  bus.set(dir_pin(axis), negative, at - 400 * ps_per_ns);
  bus.set(step_pin(axis), true, at);
  bus.set(step_pin(axis), false, at + 500 * ps_per_ns);
}

/// Steps an axis every 10 us, beginning at `at`. Returns the time after the last step.
Picoseconds walk(PinBus& bus, int axis, int steps, Picoseconds at) {
  for (int n = 0; n < std::abs(steps); ++n, at += 10 * ps_per_us) step(bus, axis, steps < 0, at);
  return at;
}

TEST(Switches, ChangeWithTheStepThatActuatesThem) {
  PinBus bus;
  World world({.switches = {{.pin = Pin::limit_x, .contacts = {ContactConfig::above(0, 100)}},
                            {.pin = Pin::limit_y, .contacts = {ContactConfig::below(1, -50)}}}},
              bus);
  Recorder recorder(bus, {Pin::limit_x, Pin::limit_y});
  walk(bus, 0, 99, ps_per_ms);
  walk(bus, 1, -49, ps_per_ms);
  world.advance(10 * ps_per_ms);
  EXPECT_TRUE(recorder.changes.empty());
  walk(bus, 0, 1, 20 * ps_per_ms);
  walk(bus, 1, -1, 20 * ps_per_ms - 7);
  EXPECT_EQ(world.switches().next_event(), 20 * ps_per_ms - 7);
  world.advance(20 * ps_per_ms);
  walk(bus, 0, -1, 30 * ps_per_ms);
  walk(bus, 1, 1, 30 * ps_per_ms + 7);
  world.advance(40 * ps_per_ms);
  EXPECT_EQ(recorder.changes, (std::vector<Change>{{Pin::limit_y, true, 20 * ps_per_ms - 7},
                                                   {Pin::limit_x, true, 20 * ps_per_ms},
                                                   {Pin::limit_x, false, 30 * ps_per_ms},
                                                   {Pin::limit_y, false, 30 * ps_per_ms + 7}}));
}

TEST(Switches, FollowTheLagOfTheDrive) {
  PinBus bus;
  World world({.drives = {.lag_us = {750, 0, 0, 0}},
               .switches = {{.pin = Pin::limit_x, .contacts = {ContactConfig::above(0, 3)}}}},
              bus);
  Recorder recorder(bus, {Pin::limit_x});
  walk(bus, 0, 3, ps_per_ms);
  const Picoseconds due = ps_per_ms + 20 * ps_per_us + 750 * ps_per_us;
  EXPECT_EQ(world.switches().next_event(), due);
  world.advance(due - 1);
  EXPECT_FALSE(bus.level(Pin::limit_x));
  EXPECT_EQ(world.drives().position_at(due - 1)[0], 2);
  world.advance(due);
  EXPECT_EQ(recorder.changes, (std::vector<Change>{{Pin::limit_x, true, due}}));
  EXPECT_EQ(world.drives().position_at(due)[0], 3);
}

TEST(Switches, ReleaseBeyondTheirHysteresis) {
  for (const int side : {1, -1}) {
    PinBus bus;
    World world({.switches = {{.pin = Pin::limit_z,
                               .contacts = {side > 0 ? ContactConfig::above(2, 50, 8)
                                                     : ContactConfig::below(2, -50, 8)}}}},
                bus);
    Picoseconds now = ps_per_ms;
    int place = 0;
    bool engaged = false;
    std::mt19937_64 random(3);
    for (int n = 0; n < lamplock::test::scaled(2000); ++n) {
      const int way = place <= 30 ? 1 : place >= 60 ? -1 : random() % 2 == 0 ? 1 : -1;
      now = walk(bus, 2, way * side, now);
      place += way;
      world.advance(now);
      engaged = engaged ? place >= 42 : place >= 50;
      ASSERT_EQ(bus.level(Pin::limit_z), engaged) << place;
      ASSERT_EQ(world.switches().engaged(Pin::limit_z), engaged);
    }
  }
}

TEST(Switches, StartAtTheMachinesPosition) {
  PinBus bus;
  World world({.drives = {.start = {-200, 0, 0, 0}},
               .switches = {{.pin = Pin::limit_x, .contacts = {ContactConfig::below(0, -100)}}}},
              bus);
  EXPECT_EQ(world.drives().position_at(0)[0], -200);
  EXPECT_EQ(world.switches().next_event(), 0);
  world.advance(0);
  EXPECT_TRUE(bus.level(Pin::limit_x));
  Recorder recorder(bus, {Pin::limit_x});
  walk(bus, 0, 101, ps_per_ms);
  world.advance(ps_per_s);
  EXPECT_EQ(world.drives().position()[0], -99);
  EXPECT_EQ(recorder.changes,
            (std::vector<Change>{{Pin::limit_x, false, ps_per_ms + 1000 * ps_per_us}}));
}

TEST(Switches, ChainOpensWithAnyOfItsContacts) {
  // Both ends of two axes in series on one wire; random walks against the places.
  PinBus bus;
  World world(
      {.switches = {{.pin = Pin::limit_x,
                     .contacts = {ContactConfig::above(0, 20), ContactConfig::below(0, -20),
                                  ContactConfig::above(1, 15), ContactConfig::below(1, -25)}}}},
      bus);
  std::mt19937_64 random(9);
  Picoseconds now = ps_per_ms;
  StepPosition place{};
  int high = 0;
  for (int n = 0; n < lamplock::test::scaled(5000); ++n, now += 20 * ps_per_us) {
    for (const int axis : {0, 1}) {
      const int way = random() % 2 == 0 ? 1 : -1;
      walk(bus, axis, way, now);
      place[index(axis)] += way;
    }
    world.advance(now);
    const bool open = place[0] >= 20 || place[0] <= -20 || place[1] >= 15 || place[1] <= -25;
    ASSERT_EQ(bus.level(Pin::limit_x), open) << place[0] << ' ' << place[1];
    high += open ? 1 : 0;
  }
  EXPECT_GT(high, 0);
}

TEST(Switches, TwoMotorsOfOneAxisHaveOneEach) {
  // The gantry is skewed: one motor is 5 steps ahead of the other.
  PinBus bus;
  World world({.drives = {.start = {0, -10, 0, -15}},
               .switches = {{.pin = Pin::limit_y, .contacts = {ContactConfig::below(1, -40)}},
                            {.pin = Pin::limit_a, .contacts = {ContactConfig::below(3, -40)}}}},
              bus);
  Recorder recorder(bus, {Pin::limit_y, Pin::limit_a});
  walk(bus, 1, -30, ps_per_ms);
  walk(bus, 3, -30, ps_per_ms);
  world.advance(10 * ps_per_ms);
  EXPECT_EQ(recorder.changes,
            (std::vector<Change>{{Pin::limit_a, true, ps_per_ms + 240 * ps_per_us},
                                 {Pin::limit_y, true, ps_per_ms + 290 * ps_per_us}}));
}

TEST(Switches, ProbeTouchesTheTopOfABoxOnly) {
  // A box of X 10..20, Y -5..5 with its top at -30, crossed in random order of axes.
  ContactConfig box;
  box.place[0] = {10, 20};
  box.place[1] = {-5, 5};
  box.place[2].high = -30;
  PinBus bus;
  World world({.drives = {.start = {15, 0, -28, 0}},
               .switches = {{.pin = Pin::probe, .contacts = {box}, .normally_closed = false}}},
              bus);
  std::mt19937_64 random(4);
  Picoseconds now = ps_per_ms;
  StepPosition place{15, 0, -28, 0};
  int touched = 0;
  for (int n = 0; n < lamplock::test::scaled(20'000); ++n, now += 20 * ps_per_us) {
    const int axis = static_cast<int>(random() % 3);
    const int way = random() % 2 == 0 ? 1 : -1;
    if (axis == 2 && (place[2] + way > -27 || place[2] + way < -33)) continue;
    walk(bus, axis, way, now);
    place[index(axis)] += way;
    world.advance(now);
    const bool touches =
        place[0] >= 10 && place[0] <= 20 && place[1] >= -5 && place[1] <= 5 && place[2] <= -30;
    ASSERT_EQ(bus.level(Pin::probe), !touches);
    touched += touches ? 1 : 0;
  }
  EXPECT_GT(touched, 0);
}

TEST(Switches, AxesOfASliceAreEvaluatedInOrderOfTime) {
  // X passes the box while Z is still above it, and Z goes down past the box; the board sends all
  // steps of Z first. There is no contact.
  ContactConfig box;
  box.place[0] = {10, 20};
  box.place[2].high = -5;
  PinBus bus;
  World world({.switches = {{.pin = Pin::probe, .contacts = {box}, .normally_closed = false}}},
              bus);
  Recorder recorder(bus, {Pin::probe});
  walk(bus, 2, -10, 10 * ps_per_ms);
  walk(bus, 0, 40, ps_per_ms);
  world.advance(20 * ps_per_ms);
  EXPECT_TRUE(recorder.changes.empty());
  // X leaves at the same moment as Z would enter: no contact either.
  walk(bus, 2, 10, 30 * ps_per_ms);
  walk(bus, 0, -20, 40 * ps_per_ms);
  world.advance(50 * ps_per_ms);
  walk(bus, 2, -4, 60 * ps_per_ms);
  step(bus, 2, true, 70 * ps_per_ms);
  step(bus, 0, false, 70 * ps_per_ms);
  world.advance(80 * ps_per_ms);
  EXPECT_TRUE(recorder.changes.empty());
}

TEST(Switches, ProbeIsHighIfThereIsNone) {
  PinBus bus;
  World world({}, bus);
  EXPECT_TRUE(bus.level(Pin::probe));
  EXPECT_EQ(world.next_look(5), never);
}

TEST(Bounces, BeginWithTheCauseEndInTimeAtTheRightLevelAndRepeat) {
  const auto run = [](std::uint64_t seed) {
    PinBus bus;
    ContactConfig contact = ContactConfig::above(0, 10);
    contact.bounce = {.make_us = 300, .break_us = 800, .seed = seed};
    World world({.switches = {{.pin = Pin::limit_x, .contacts = {contact}}}}, bus);
    Recorder recorder(bus, {Pin::limit_x});
    std::size_t seen = 0;
    for (int n = 0; n < 200; ++n) {
      const bool engages = n % 2 == 0;
      const Picoseconds first = (n + 1) * 10 * ps_per_ms;
      const Picoseconds cause = walk(bus, 0, engages ? 10 : -1, first) - 10 * ps_per_us;
      if (!engages) walk(bus, 0, -9, first + 10 * ps_per_us);
      // A normally closed contact breaks when it is engaged.
      const Picoseconds longest = (engages ? 800 : 300) * ps_per_us;
      world.advance(first + 9 * ps_per_ms);
      EXPECT_EQ(bus.level(Pin::limit_x), engages);
      EXPECT_EQ(recorder.changes.at(seen).at, cause);
      EXPECT_GE(recorder.changes.size(), seen + 3);  // at least one bounce
      EXPECT_LE(recorder.changes.back().at, cause + longest);
      for (; seen < recorder.changes.size(); ++seen) {
        EXPECT_EQ(recorder.changes[seen].level, engages == ((recorder.changes.size() - seen) % 2));
        if (seen > 0) {
          EXPECT_GE(recorder.changes[seen].at, recorder.changes[seen - 1].at);
        }
      }
    }
    return recorder.changes;
  };
  const std::vector<Change> one = run(1);
  EXPECT_EQ(one, run(1));
  EXPECT_NE(one, run(2));
}

TEST(Bounces, OfAContactThatReversesAtOnceEndWithTheLastChange) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    PinBus bus;
    ContactConfig contact = ContactConfig::above(0, 1);
    contact.bounce = {.make_us = 500, .break_us = 500, .seed = seed};
    World world({.switches = {{.pin = Pin::limit_x, .contacts = {contact}}}}, bus);
    std::mt19937_64 random(seed);
    Picoseconds now = ps_per_ms;
    for (int n = 0; n < 20; ++n) {
      step(bus, 0, n % 2 != 0, now);
      world.advance(now);
      ASSERT_EQ(bus.level(Pin::limit_x), n % 2 == 0) << "seed " << seed << ", change " << n;
      now += static_cast<Picoseconds>(2 + random() % 600) * ps_per_us;
    }
    world.advance(now + ps_per_ms);
    EXPECT_FALSE(bus.level(Pin::limit_x));
    EXPECT_EQ(world.switches().next_event(), never);
  }
}

TEST(Faults, OfWiresAndContacts) {
  PinBus bus;
  ContactConfig bridged = ContactConfig::above(0, 10);
  bridged.bridged_from = 2 * ps_per_ms;
  World world(
      {.switches = {{.pin = Pin::limit_x, .contacts = {bridged, ContactConfig::above(1, 10)}},
                    {.pin = Pin::limit_z,
                     .contacts = {ContactConfig::above(0, 10)},
                     .broken_from = 5 * ps_per_ms},
                    {.pin = Pin::limit_a,
                     .contacts = {ContactConfig::above(0, 10)},
                     .shorted_from = 5 * ps_per_ms},
                    {.pin = Pin::probe,
                     .contacts = {ContactConfig::above(0, 10)},
                     .normally_closed = false}}},
      bus);
  Recorder recorder(bus, {Pin::limit_x, Pin::limit_z, Pin::limit_a, Pin::probe});
  walk(bus, 0, 10, ps_per_ms);
  const Picoseconds cause = ps_per_ms + 90 * ps_per_us;
  world.advance(3 * ps_per_ms);
  world.switches().break_wire(Pin::probe, 4 * ps_per_ms);
  world.advance(6 * ps_per_ms);
  walk(bus, 0, -5, 7 * ps_per_ms);  // the broken wire stays high, the others do not change
  walk(bus, 0, 10, 8 * ps_per_ms);
  world.advance(9 * ps_per_ms);
  walk(bus, 1, 10, 10 * ps_per_ms);  // the rest of the chain works
  world.advance(11 * ps_per_ms);
  world.switches().short_wire(Pin::limit_x, 12 * ps_per_ms);
  world.advance(13 * ps_per_ms);
  const std::vector<Change> expected{
      {Pin::limit_x, true, cause},          {Pin::limit_z, true, cause},
      {Pin::limit_a, true, cause},          {Pin::probe, false, cause},
      {Pin::limit_x, false, 2 * ps_per_ms}, {Pin::probe, true, 4 * ps_per_ms},
      {Pin::limit_a, false, 5 * ps_per_ms}, {Pin::limit_x, true, 10 * ps_per_ms + 90 * ps_per_us},
      {Pin::limit_x, false, 12 * ps_per_ms}};
  EXPECT_EQ(recorder.changes, expected);
}

TEST(Faults, BrokenFromTheStart) {
  PinBus bus;
  World world({.switches = {{.pin = Pin::limit_x,
                             .contacts = {ContactConfig::above(0, 10)},
                             .broken_from = 0}}},
              bus);
  world.advance(0);
  EXPECT_TRUE(bus.level(Pin::limit_x));
}

TEST(Switches, SwitchesWithoutAPlaceAreOperatedByHand) {
  PinBus bus;
  World world({.switches = {{.pin = Pin::door, .contacts = {{.bounce = {.break_us = 100}}}}}}, bus);
  Recorder recorder(bus, {Pin::door});
  world.switches().work_by_hand(Pin::door, true, ps_per_ms);
  world.switches().work_by_hand(Pin::door, false, 2 * ps_per_ms);
  world.advance(3 * ps_per_ms);
  EXPECT_GE(recorder.changes.size(), 4u);
  EXPECT_EQ(recorder.changes.front(), (Change{Pin::door, true, ps_per_ms}));
  EXPECT_EQ(recorder.changes.back(), (Change{Pin::door, false, 2 * ps_per_ms}));
}

TEST(Switches, NextLookIsNeverPastAContact) {
  // A board with slices steps at the drives' maximum rate and ends each slice at the given time.
  std::mt19937_64 random(8);
  PinBus bus;
  World world({.switches = {{.pin = Pin::limit_x, .contacts = {ContactConfig::above(0, 300, 20)}},
                            {.pin = Pin::limit_y, .contacts = {ContactConfig::below(0, -250)}}}},
              bus);
  const Picoseconds period = world.drives().min_period();
  Recorder recorder(bus, {Pin::limit_x, Pin::limit_y});
  Picoseconds now = ps_per_ms, next_step = now;
  bool negative = false;
  std::size_t looks = 0, seen = 0;
  while (recorder.changes.size() < 40) {
    const Picoseconds look = std::min(world.next_look(now), now + ps_per_ms);
    ASSERT_GT(look, now);
    for (; next_step <= look; next_step += period) step(bus, 0, negative, next_step);
    world.advance(look);
    for (; seen < recorder.changes.size(); ++seen) {
      ASSERT_LE(look - recorder.changes[seen].at, period);
      if (random() % 2 == 0) negative = !negative;
      if (recorder.changes[seen].level) negative = recorder.changes[seen].pin == Pin::limit_x;
    }
    now = look;
    ++looks;
  }
  EXPECT_LT(looks, 60'000u);
}

TEST(Switches, RefuseInvalidConfigurations) {
  const auto build = [](const WireConfig& wire) {
    PinBus bus;
    World world({.switches = {wire}}, bus);
  };
  EXPECT_THROW(build({.pin = Pin::limit_x, .contacts = {}}), std::invalid_argument);
  EXPECT_THROW(build({.pin = Pin::limit_x, .contacts = {ContactConfig::above(0, 5, -1)}}),
               std::invalid_argument);
  ContactConfig contact;
  contact.place[1] = {5, 4};
  EXPECT_THROW(build({.pin = Pin::limit_x, .contacts = {contact}}), std::invalid_argument);
  contact.place[1] = {4, 4};
  EXPECT_NO_THROW(build({.pin = Pin::limit_x, .contacts = {contact}}));
  contact.bounce.make_us = -1;
  EXPECT_THROW(build({.pin = Pin::limit_x, .contacts = {contact}}), std::invalid_argument);
}

}  // namespace
}  // namespace lamplock::sim::switches_test
