// Probing with G38.2 to G38.5 on the virtual board: the reported place against the contact's place,
// the program after the probe, contacts that are closed before, never made, or bounce.
#include <fmt/format.h>

#include <random>

#include "tests/board/machine_with_switches.hpp"

namespace lamplock::test::probe_test {
namespace {

constexpr std::int32_t steps_per_mm = 200;

/// A plate that the tool touches at `z` steps and below.
sim::WireConfig plate(std::int32_t z, sim::BounceConfig bounce = {}) {
  sim::ContactConfig contact = sim::ContactConfig::below(2, z);
  contact.bounce = bounce;
  return {.pin = sim::Pin::probe, .contacts = {contact}, .normally_closed = false};
}

job::Profile profile_without_homing() {
  job::Profile profile = program_profile();
  profile.settings.set_milli(Id::laser_mode, 1000);
  return profile;
}

struct Probing {
  explicit Probing(std::vector<sim::WireConfig> wires = {plate(-3 * steps_per_mm)},
                   const job::Profile& profile = profile_without_homing())
      : m(profile, {.switches = {100'000, 100'000, 100'000, 100'000}}, std::move(wires)) {}
  std::vector<std::string> ask(std::string_view lines) { return m.host.ask(lines, 30); }
  MachineWithSwitches m;
};

TEST(Probe, ReportsWhereItTouched) {
  Probing p;
  EXPECT_THAT(p.ask("G38.2 Z-10 F600\n"), ElementsAre("[PRB:0.000,0.000,-3.000:1]", "ok"));
  EXPECT_THAT(p.ask("$#\n"), Contains("[PRB:0.000,0.000,-3.000:1]"));
  // At 10 mm/s: 5 ms until it reacts, then 25 um to brake.
  EXPECT_GT(p.m.loads()[2], -3 * steps_per_mm - 20);
  EXPECT_LT(p.m.loads()[2], -3 * steps_per_mm);
}

/// The program continues from where the machine stopped, not from the probe's target.
TEST(Probe, ProgramsContinueFromThere) {
  Probing p;
  EXPECT_THAT(p.ask("G38.2 Z-10 F600\nG10 L20 P1 Z0\nG0 Z5\nG91 G0 X1\nG90 G1 X0 Z0 F600\nG4 P0\n"),
              Contains("ok").Times(6));
  const std::int32_t stood = p.m.loads()[2];
  EXPECT_LT(stood, -3 * steps_per_mm);
  EXPECT_GT(stood, -3 * steps_per_mm - 20);
  EXPECT_EQ(p.m.loads()[0], 0);
}

TEST(Probe, AwayFromTheContact) {
  Probing p;
  EXPECT_THAT(p.ask("G0 Z-5\nG38.4 Z5 F600\n"),
              ElementsAre("ok", "[PRB:0.000,0.000,-2.995:1]", "ok"));
  EXPECT_LT(p.m.loads()[2], -3 * steps_per_mm + 20);
  EXPECT_THAT(p.ask("G38.3 Z-10\n"), ElementsAre("[PRB:0.000,0.000,-3.000:1]", "ok"));
}

/// As in grbl: a probe's result depends on its speed, so it runs at the programmed feed rate. The
/// program after it obeys the override.
TEST(Probe, IgnoresTheFeedOverride) {
  Probing p;
  const auto fastest = [&p](std::string_view lines) {
    double highest = 0;
    std::int32_t before = p.m.loads()[2];
    p.m.host.send(lines);
    for (int i = 0; i < 1000; ++i) {
      p.m.host.run_ms(5);
      highest = std::max(highest, std::abs(p.m.loads()[2] - before) / (5e-3 * steps_per_mm));
      before = p.m.loads()[2];
    }
    return highest;
  };
  for (int i = 0; i < 5; ++i) p.m.host.send(std::uint8_t{0x92});  // -10 %
  EXPECT_NEAR(fastest("G38.2 Z-10 F1200\n"), 20, 2);
  EXPECT_NEAR(fastest("G1 Z5 F1200\n"), 10, 2);
}

TEST(Probe, AtItsOwnAngle) {
  Probing p;
  EXPECT_THAT(p.ask("G38.2 X6 Y-2 Z-6 F1200\n"), ElementsAre("[PRB:3.000,-1.000,-3.000:1]", "ok"));
}

TEST(Probe, NothingMet) {
  Probing p;
  EXPECT_THAT(p.ask("G38.3 Z-1 F600\n"), ElementsAre("[PRB:0.000,0.000,-1.000:0]", "ok"));
  EXPECT_THAT(p.ask("G38.2 Z-2 F600\n"),
              ElementsAre("[PRB:0.000,0.000,-2.000:0]", "ALARM:5", "error:9"));
  EXPECT_THAT(p.m.host.status(), StartsWith("<Alarm|MPos:0.000,0.000,-2.000|"));
  EXPECT_THAT(p.ask("$X\nG0 Z0\nG4 P0\n"), Contains("ok").Times(3));
  EXPECT_EQ(p.m.loads()[2], 0);
}

TEST(Probe, InItsFinalStateBefore) {
  Probing p;
  EXPECT_THAT(p.ask("G38.4 Z-1 F600\n"), ElementsAre("ALARM:4", "error:9"));
  EXPECT_EQ(p.m.loads()[2], 0);
  EXPECT_THAT(p.ask("$X\nG0 Z-4\nG38.2 Z-6 F600\n"),
              ElementsAre("[MSG:Caution: Unlocked]", "ok", "ok", "ALARM:4", "error:9"));
  EXPECT_EQ(p.m.loads()[2], -4 * steps_per_mm);
}

TEST(Probe, WithoutOneTheCircuitIsOpen) {
  Probing p(std::vector<sim::WireConfig>{});
  EXPECT_THAT(p.ask("G38.2 Z-1 F600\n"),
              ElementsAre("[PRB:0.000,0.000,-1.000:0]", "ALARM:5", "error:9"));
}

/// A probe that opens its circuit on contact ($6): a broken wire stops it.
TEST(Probe, NormallyClosed) {
  sim::WireConfig wire = plate(-3 * steps_per_mm);
  wire.normally_closed = true;
  job::Profile profile = profile_without_homing();
  profile.settings.set_milli(Id::probe_invert, 1000);
  Probing p({wire}, profile);
  EXPECT_THAT(p.m.host.status(), Not(HasSubstr("Pn:")));
  p.m.host.send("G38.2 Z-10 F60\n");
  ASSERT_TRUE(p.m.wait_for([&] { return p.m.loads()[2] <= -steps_per_mm; }));
  p.m.switches().break_wire(sim::Pin::probe, p.m.rig.now());
  ASSERT_TRUE(p.m.wait_for([&] { return !p.m.host.answers().empty(); }));
  EXPECT_THAT(p.m.host.said(), Contains(StartsWith("[PRB:0.000,0.000,-1.0")));
  EXPECT_THAT(p.m.host.status(), HasSubstr("|Pn:P"));
}

TEST(Probe, CheckModeAndOutside) {
  Probing p;
  EXPECT_THAT(p.ask("$C\nG38.2 Z-10 F600\n"), ElementsAre("[MSG:Enabled]", "ok", "ok"));
  EXPECT_EQ(p.m.loads()[2], 0);
  EXPECT_THAT(p.ask("$C\n"), Contains("ok"));
  EXPECT_THAT(p.ask("G38.2 Z-100 F600\n"), Contains("ALARM:2"));
  EXPECT_EQ(p.m.loads()[2], 0);
}

/// A hold does not end a probe; a contact while the machine brakes does.
TEST(Probe, HoldsAndResumes) {
  std::mt19937_64 random(5);
  for (int round = 0; round < scaled(20); ++round) {
    Probing p;
    p.m.host.send("G38.2 Z-10 F3000\n");
    p.m.host.run_ms(static_cast<double>(random() % 80));
    p.m.host.send("!");
    p.m.host.run_ms(200);
    if (p.m.host.answers().empty()) {
      EXPECT_THAT(p.m.host.status(), StartsWith("<Hold:0|"));
    }
    p.m.host.send("~");
    ASSERT_TRUE(p.m.wait_for([&] { return !p.m.host.answers().empty(); }));
    EXPECT_THAT(p.m.host.said(), Contains("[PRB:0.000,0.000,-3.000:1]"));
    EXPECT_THAT(p.m.host.answers(), ElementsAre("ok"));
    EXPECT_TRUE(p.m.host.wait_for_rest());
  }
}

/// At any feed rate and with any contact bounce the place is that of the first contact, to a step.
TEST(Probe, IsExactAtAnyFeed) {
  std::mt19937_64 random(11);
  const Pick<int> pick(random);
  for (int round = 0; round < scaled(20); ++round) {
    const std::int32_t z = -pick(20, 8000);
    Probing p({plate(
        z, {.make_us = pick(0, 3000) * 1.0, .break_us = pick(0, 3000) * 1.0, .seed = random()})});
    const int feed = pick(1, 6000);
    const double deepest = z / 200.0 - 1;
    const auto said = p.m.host.ask(fmt::format("G0 Z{:.3f}\nG38.2 Z{:.3f} F{}\n",
                                               std::min(0.0, z / 200.0 + 0.3), deepest, feed),
                                   60);
    SCOPED_TRACE(fmt::format("z {} feed {}", z, feed));
    ASSERT_THAT(said, Contains(StartsWith("[PRB:0.000,0.000,")));
    const std::string& report = said[said.size() - 2];
    const double reported = std::stod(report.substr(report.rfind(',') + 1));
    EXPECT_NEAR(reported, z / 200.0, 0.0051);
  }
}

TEST(Probe, TheLaserIsOff) {
  Probing p;
  p.m.host.send("M3 S1000\nG1 X1 F600\nG38.2 Z-10\n");
  bool shone = false, shone_on_the_way = false;
  ASSERT_TRUE(p.m.wait_for([&] {
    const bool shines = p.m.rig.board.world().beam().at(p.m.rig.now()).shines();
    shone = shone || shines;
    shone_on_the_way = shone_on_the_way || (shines && p.m.loads()[2] < -1);
    return p.m.host.answers().size() == 3;
  }));
  EXPECT_TRUE(shone);
  EXPECT_FALSE(shone_on_the_way);
}

}  // namespace
}  // namespace lamplock::test::probe_test
