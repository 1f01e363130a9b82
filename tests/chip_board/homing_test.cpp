// Homing, probing and jogs on the chip: switch places are found to a step, with one input for each
// axis or one for all, bouncing.
#include <fmt/format.h>

#include <random>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test::homing_test {
namespace {

constexpr std::int32_t steps_per_mm = 200, end_steps = 50 * steps_per_mm;
const std::string jog_cancel = "\x85";

job::Profile homing_profile(bool cut_map) {
  job::Profile profile = chip_profile();
  settings::Values& s = profile.settings;
  s.set_milli(Id::lamp_mode, 0);
  s.set_milli(Id::pin_map, cut_map ? 1000 : 0);
  s.set_milli(Id::homing, 1000);
  s.set_milli(Id::homing_seek, 3'000'000);
  s.set_milli(Id::homing_feed, 120'000);
  s.set_milli(Id::homing_debounce, 30'000);
  s.set_milli(Id::homing_pull_off, 300);
  return profile;
}

sim::WireConfig bouncing_limit(int axis, std::int32_t place, std::uint64_t seed) {
  sim::ContactConfig contact = sim::ContactConfig::above(axis, place, 10);
  contact.bounce = {.make_us = 3000, .break_us = 3000, .seed = seed};
  return {.pin = sim::limit_pin(axis), .contacts = {contact}};
}

sim::WorldConfig world_with(const job::Profile& profile, const StepPosition& places) {
  sim::WorldConfig world = world_for(profile);
  for (int axis = 0; axis < 3; ++axis)
    world.switches.push_back(
        bouncing_limit(axis, places[index(axis)], static_cast<std::uint64_t>(axis) + 1));
  return world;
}

void expect_homed(ChipRig& rig, const settings::Values& values, const StepPosition& places) {
  const StepPosition reported = rig.reported_position(values);
  const StepPosition loads = rig.board.world().drives().position();
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LE(
        std::abs(reported[index(axis)] - loads[index(axis)] - (end_steps - places[index(axis)])), 1)
        << "axis " << axis;
}

/// A machine and the places of its switches.
struct Homes {
  const char* name;
  Id id;  ///< a setting
  std::int32_t milli;
  StepPosition places;
  bool cut_map = true;  ///< else one circuit has all switches
  friend void PrintTo(const Homes& c, std::ostream* out) { *out << c.name; }
};

class ChipHomes : public testing::TestWithParam<Homes> {};

/// From power-up to "ok". In any pulse mode the place is found in the ticks that were output; in a
/// CoreXY both motors turn for either axis.
TEST_P(ChipHomes, ToAStep) {
  job::Profile profile = homing_profile(GetParam().cut_map);
  for (int axis = 0; axis < (GetParam().id == Id::pulse_mode_x ? 3 : 1); ++axis)
    profile.settings.set_milli(settings::for_axis(GetParam().id, axis), GetParam().milli);
  ChipRig rig(profile.settings, world_with(profile, GetParam().places));
  EXPECT_THAT(rig.status(), StartsWith("<Alarm|"));
  EXPECT_THAT(rig.answer("$H", 6000 * ps_per_ms), EndsWith("ok\r\n"));
  expect_homed(rig, profile.settings, GetParam().places);
  EXPECT_THAT(rig.status(), StartsWith("<Idle|MPos:49.700,49.700,49.700|"));
}

/// At 400 mm/s on two axes at once nearly every word in the rings has steps: searching them takes
/// long, and ticks must not run out meanwhile.
constexpr std::int32_t full_speed = 24'000'000;

INSTANTIATE_TEST_SUITE_P(
    Machines, ChipHomes,
    testing::Values(Homes{"StepDir", Id::pulse_mode_x, 0, {700, 400, 500, 0}},
                    Homes{"CwCcw", Id::pulse_mode_x, 1000, {700, 400, 500, 0}},
                    Homes{"Quadrature", Id::pulse_mode_x, 2000, {700, 400, 500, 0}},
                    Homes{"CoreXy", Id::kinematics, 1000, {700, 400, 500, 0}},
                    Homes{"FullSpeed", Id::homing_seek, full_speed, {8000, 8100, 4000, 0}},
                    Homes{"OneCircuit", Id::homing, 1000, {300, 600, 400, 0}, false}),
    [](const auto& c) { return std::string(c.param.name); });

/// Two motors of Y, no Z: the second side's switch uses the input of Z. Either side may be ahead.
TEST(ChipHoming, SquaresAGantry) {
  constexpr int side = Kinematics::gang_motor;
  constexpr std::int32_t place = 600;
  job::Profile profile = homing_profile(true);
  profile.settings.set_milli(Id::axes, 2000);
  profile.settings.set_milli(Id::ganged_axis, 2000);
  for (const std::int32_t skew : {-160, 160}) {  // 0.8 mm
    sim::WorldConfig world = world_for(profile);
    world.drives.start[side] = skew;
    sim::WireConfig second = bouncing_limit(side, place, 3);
    second.pin = sim::Pin::limit_z;
    world.switches = {bouncing_limit(0, 300, 1), bouncing_limit(1, place, 2), second};
    ChipRig rig(profile.settings, world);
    EXPECT_THAT(rig.answer("$H", 6000 * ps_per_ms), EndsWith("ok\r\n"));
    const StepPosition loads = rig.board.world().drives().position();
    EXPECT_NEAR(loads[1], place - 60, 1);
    EXPECT_NEAR(loads[side], place - 60, 1);
    EXPECT_THAT(rig.status(), StartsWith("<Idle|MPos:49.700,49.700"));
    rig.answer("G0 Y40", 3000 * ps_per_ms);
    rig.run(500 * ps_per_ms);
    const StepPosition moved = rig.board.world().drives().position();
    EXPECT_EQ(moved[1] - loads[1], 40 * steps_per_mm - (end_steps - 60));
    EXPECT_EQ(moved[side] - loads[side], moved[1] - loads[1]);
  }
}

TEST(ChipHoming, ABrokenWireNeverOpens) {
  const job::Profile profile = homing_profile(true);
  sim::WorldConfig world = world_with(profile, {300, 300, 300, 0});
  world.switches[2].broken_from = 0;
  ChipRig rig(profile.settings, world);
  EXPECT_THAT(rig.answer("$HZ", 3000 * ps_per_ms), HasSubstr("ALARM:8\r\nerror:9\r\n"));
}

TEST(ChipProbe, ReportsWhereItTouched) {
  job::Profile profile = homing_profile(true);
  profile.settings.set_milli(Id::homing, 0);
  std::mt19937_64 random(2);
  for (int round = 0; round < 5; ++round) {
    const auto z = static_cast<std::int32_t>(-100 - static_cast<int>(random() % 300));
    sim::WorldConfig world = world_for(profile);
    sim::ContactConfig contact = sim::ContactConfig::below(2, z);
    const double rattles_us = round % 2 == 0 ? 0 : 2000;
    contact.bounce = {.make_us = rattles_us, .break_us = rattles_us, .seed = random()};
    world.switches.push_back(
        {.pin = sim::Pin::probe, .contacts = {contact}, .normally_closed = false});
    ChipRig rig(profile.settings, world);
    // 2000 steps/s: exact within the polling period of 100 us, which may miss the first bounces.
    const double max_steps = 1.1 + rattles_us * 2000 / 1e6;
    const std::string said = rig.answer("G38.2 Z-5 F600", 3000 * ps_per_ms);
    const std::size_t at = said.find("[PRB:0.000,0.000,");
    ASSERT_NE(at, std::string::npos) << said;
    EXPECT_THAT(said, HasSubstr(":1]\r\nok\r\n"));
    EXPECT_NEAR(std::stod(said.substr(at + 17)) * steps_per_mm, z, max_steps);
    // Braking from 10 mm/s at 4 m/s2, after 8 ms of reaction.
    EXPECT_GT(rig.board.world().drives().position()[2], z - 3 - 16 - max_steps);
  }
}

TEST(ChipJog, ReleaseStopsAtOnce) {
  job::Profile profile = homing_profile(true);
  profile.settings.set_milli(Id::homing, 0);
  ChipRig rig(profile);
  const auto x = [&rig] { return rig.board.world().drives().position()[0]; };
  for (const double mm_s : {10.0, 40.0}) {
    rig.answer(fmt::format("$J=G91X20F{}", mm_s * 60));
    rig.run(130 * ps_per_ms);
    const std::int32_t at = x();
    rig.type(jog_cancel);
    rig.run(60 * ps_per_ms);
    const double max_mm = mm_s * mm_s / 2 / 4000 + mm_s * 0.020;
    EXPECT_GT(x(), at);
    EXPECT_LE(x() - at, max_mm * steps_per_mm + 2);
    EXPECT_THAT(rig.status(), StartsWith("<Idle|"));
    EXPECT_EQ(rig.reported_position(profile.settings)[0], x());
  }
}

}  // namespace
}  // namespace lamplock::test::homing_test
