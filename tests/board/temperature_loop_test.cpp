// The loop that holds a temperature ($1061) on the virtual board: a spot that the laser heats,
// another absorption, a sensor that breaks.
#include <fmt/format.h>

#include "tests/board/heat_profile.hpp"
#include "tests/board/program_host.hpp"
#include "tests/figure.hpp"

namespace lamplock::test::temperature_loop_test {
namespace {

using settings::LoopMode;
using sim::HeatConfig;
using sim::Pin;

constexpr std::string_view cut = "G21 G91 M3 S600\nG1 X45 F3000\nG1 X-45\nM5\n";

struct HeatedMachine {
  explicit HeatedMachine(const job::Profile& profile, const HeatConfig& heat = heat_config())
      : rig(profile.settings, heated_world(profile, heat)) {}
  const sim::HeatSensor& spot() const { return *rig.board.world().heat(); }
  const sim::Beam& beam() const { return rig.board.world().beam(); }
  bool has_light() const { return beam().at(rig.now()).shines(); }

  Rig rig;
  ProgramHost host{rig};
};

/// A line of 90 mm with M3; absorption rises by 10 % during it.
HeatResponse cut_with_step(const job::Profile& profile, HeatConfig heat, int feed_mm_min,
                           std::string_view first_line = "") {
  constexpr Picoseconds step_after = 1500 * ps_per_ms, end_after = 3000 * ps_per_ms;
  HeatedMachine approach(profile, heat);
  approach.host.give("G21 G91 G0 X-45\n");
  EXPECT_TRUE(approach.host.run_until_idle(10 * ps_per_s));
  const Picoseconds begin = approach.rig.now();
  heat.changes = {{.at = begin + step_after, .absorption = 1.1}};
  HeatedMachine machine(profile, heat);
  machine.host.give("G21 G91 G0 X-45\n");
  EXPECT_TRUE(machine.host.run_until_idle(10 * ps_per_s));
  machine.host.give(fmt::format("{}M3 S600\nG1 X90 F{}\nM5\n", first_line, feed_mm_min));
  while (machine.rig.now() < begin + end_after) machine.host.step(ps_per_ms);
  EXPECT_TRUE(machine.has_light());
  EXPECT_EQ(machine.host.errors(), 0u);
  return response_of(machine.spot(), begin + step_after, begin + end_after);
}

void print(const char* what, const HeatResponse& r) {
  std::printf("%s: first %.2f K, settled %.4f s, overshoot %.2f %%, at the end %.2f K\n", what,
              r.first_k, r.settled_s, r.overshoot * 100, r.final_k);
}

TEST(TemperatureLoop, HoldsTheTemperatureByPowerAfterAStepInAbsorption) {
  constexpr int feed_mm_min = 1500;
  const HeatResponse open = cut_with_step(heat_profile(), heat_config(), feed_mm_min);
  EXPECT_NEAR(open.final_k, 330, 1);
  const HeatResponse held =
      cut_with_step(loop_profile(LoopMode::power), heat_config(), feed_mm_min);
  print("power", held);
  EXPECT_NEAR(held.final_k, hot_k, 0.5);
  EXPECT_LE(held.first_k, 6);
  EXPECT_LE(held.settled_s, 0.1);
  EXPECT_LE(held.overshoot, 0.1);
}

/// The override acts after some 40 ms, so the gain is that of an integral controller, slow.
TEST(TemperatureLoop, HoldsTheTemperatureByTheFeed) {
  constexpr int feed_mm_min = 1500;
  HeatConfig heat = heat_config();
  heat.reference_mm_s = feed_mm_min / 60.0;
  for (const char* first_line : {"", "M49\n"}) {  // M49 is about the overrides of the user
    const HeatResponse held =
        cut_with_step(loop_profile(LoopMode::feed, {0, 3}), heat, feed_mm_min, first_line);
    print("feed", held);
    EXPECT_NEAR(held.final_k, hot_k, 5);
    EXPECT_LE(held.first_k, 30);
    EXPECT_LE(held.settled_s, 1.4);
    EXPECT_LE(held.overshoot, 0.2);
  }
}

TEST(TemperatureLoop, ReachesTheSetPointFromTheColdWithoutWindup) {
  HeatedMachine machine(loop_profile(LoopMode::power));
  machine.host.give(cut);
  while (machine.rig.now() < 1000 * ps_per_ms) machine.host.step(ps_per_ms);
  double top = 0;
  Picoseconds first = 0;
  for (const auto& sample : machine.spot().samples()) {
    if (first == 0) first = sample.at;
    top = std::max(top, sample.rise_k);
  }
  std::printf("from the cold: overshoot %.2f %%\n", (top / hot_k - 1) * 100);
  EXPECT_LE(top, hot_k * 1.15);
}

/// A cold spot raises the power of a cut, but not of light at rest.
TEST(TemperatureLoop, KeepsTheLimitOfLightAtRest) {
  job::Profile profile = loop_profile(LoopMode::power);
  profile.settings.set_milli(settings::Id::focus_power, 20'000);
  profile.settings.set_milli(settings::Id::focus_time, 1000);
  HeatedMachine machine(profile);
  const auto power = [&] { return machine.beam().at(machine.rig.now()).light() / 65535.0; };
  machine.host.give("G21 G91 M3 S600\nG1 X1 F3000\nG4 P0.3\nG1 X40\n");
  double moving = 0, resting = 0;
  while (machine.rig.now() < 600 * ps_per_ms) {
    machine.host.step(ps_per_ms);
    (power() > 0.5 ? moving : resting) = std::max(power() > 0.5 ? moving : resting, power());
  }
  EXPECT_GT(moving, 0.65);  // more than S600
  EXPECT_NEAR(resting, 0.2, 0.0005);
}

// --- a sensor that fails ----------------------------------------------------------------------

struct Break {
  const char* what;
  double volts;
};
constexpr Break breaks[] = {{"cut", 0}, {"short to 3.3 V", 3.3}, {"below its range", 0.19}};

/// Runs the cut with a sensor that breaks at `at` and works again at `repaired`.
struct BrokenCut : HeatedMachine {
  static HeatConfig heat_of(double volts, Picoseconds at, Picoseconds repaired) {
    HeatConfig heat = heat_config();
    heat.changes = {{.at = at, .broken_volts = volts}, {.at = repaired}};
    return heat;
  }
  BrokenCut(LoopMode mode, double volts, Picoseconds at, Picoseconds repaired)
      : HeatedMachine(loop_profile(mode), heat_of(volts, at, repaired)) {
    host.give(cut);
    run_to(at);
    EXPECT_TRUE(has_light());
  }
  void run_to(Picoseconds at) {
    while (rig.now() < at) host.step(100 * ps_per_us);
  }
};

TEST(TemperatureLoop, IsDarkWithin5MsOfAFailureAndContinuesWhenTheUserSaysSo) {
  std::mt19937_64 random(7);
  for (const LoopMode mode : {LoopMode::power, LoopMode::feed}) {
    for (const Break& broken : breaks) {
      SCOPED_TRACE(broken.what);
      const Picoseconds at = 300 * ps_per_ms + Pick<Picoseconds>(random)(50 * ps_per_ms);
      const Picoseconds repaired = at + 400 * ps_per_ms;
      BrokenCut c(mode, broken.volts, at, repaired);
      while (c.has_light() && c.rig.now() < at + 20 * ps_per_ms) c.host.run(20 * ps_per_us);
      expect_figure("dark after a failure of the sensor", c.rig.now() - at, 0.7, 5);
      const Picoseconds dark = c.rig.now();
      c.run_to(at + 200 * ps_per_ms);
      EXPECT_EQ(c.rig.state(), MachineState::hold);
      EXPECT_EQ(c.rig.status().hold_reason, wire::HoldReason::sensor);
      EXPECT_THAT(c.host.heard, HasSubstr("[MSG:SENSOR out of range, laser off: check it and "
                                          "$1068, $1069, then '~']"));
      // Not before it works.
      const StepPosition held = c.rig.board.world().drives().position();
      c.host.send("~");
      c.run_to(repaired);
      EXPECT_EQ(c.rig.board.world().drives().position(), held);
      // It works: still the user decides.
      c.run_to(repaired + 100 * ps_per_ms);
      EXPECT_EQ(c.rig.board.world().drives().position(), held);
      EXPECT_FALSE(c.beam().shone(dark, c.rig.now()));
      c.host.send("~");
      EXPECT_TRUE(c.host.run_until_idle(c.rig.now() + 20 * ps_per_s));
      EXPECT_TRUE(c.beam().shone(repaired, c.rig.now()));
      EXPECT_EQ(c.host.errors(), 0u);
      EXPECT_EQ(c.rig.board.world().drives().position(), StepPosition{});
    }
  }
}

TEST(TemperatureLoop, ToleratesDisturbancesBelowAMillisecond) {
  const Picoseconds at = 300 * ps_per_ms;
  BrokenCut c(LoopMode::power, 0, at, at + 600 * ps_per_us);
  EXPECT_TRUE(c.host.run_until_idle(c.rig.now() + 20 * ps_per_s));
  EXPECT_THAT(c.host.heard, Not(HasSubstr("SENSOR")));
}

TEST(TemperatureLoop, ABrokenSensorLetsNoProgramBegin) {
  HeatConfig heat = heat_config();
  heat.changes = {{.at = 0, .broken_volts = 0}};
  HeatedMachine machine(loop_profile(LoopMode::power), heat);
  machine.host.give(cut);
  for (int i = 0; i < 500; ++i) machine.host.step(ps_per_ms);
  EXPECT_EQ(machine.rig.state(), MachineState::hold);
  EXPECT_EQ(machine.beam().openings(), 0u);
  EXPECT_EQ(machine.rig.board.world().drives().position(), StepPosition{});
  machine.host.send("\x18");
  machine.host.run_ms(20);
  // Jogs are dark and need no sensor.
  EXPECT_THAT(machine.host.ask("$J=G91 X1 F600\n"), Contains("ok"));
  EXPECT_TRUE(machine.host.run_until_idle(machine.rig.now() + 5 * ps_per_s));
  EXPECT_EQ(machine.rig.board.world().drives().position()[0], 200);
}

// --- off, refused -----------------------------------------------------------------------------

struct CutTrace {
  PerAxis<std::vector<sim::Picoseconds>> steps;
  std::vector<sim::BeamChange> light;
  friend bool operator==(const CutTrace&, const CutTrace&) = default;
};
CutTrace trace_of(const job::Profile& profile, const HeatConfig& heat) {
  HeatedMachine machine(profile, heat);
  machine.host.give("G21 G91 M3 S600\nG1 X3 Y1 F3000\nG1 X2 S300\nG2 X1 Y-1 I1 J0\nM5\n");
  EXPECT_TRUE(machine.host.run_until_idle(20 * ps_per_s));
  CutTrace trace;
  for (int axis = 0; axis < 3; ++axis)
    for (const auto& step : machine.rig.monitor.steps(axis))
      trace.steps[index(axis)].push_back(step.at);
  trace.light = machine.beam().changes();
  return trace;
}

/// Off, whatever its other settings and the sensor; on, without gains.
TEST(TemperatureLoop, ChangesNothingWhereItIsOff) {
  job::Profile plain = program_profile();
  plain.settings.set_milli(Id::laser_mode, 1000);
  plain.settings.set_milli(Id::pin_map, static_cast<int>(boards::grblhal_pico.first_map) * 1000);
  HeatConfig broken = heat_config();
  broken.changes = {{.at = 30 * ps_per_ms, .broken_volts = 0}};
  const CutTrace today = trace_of(plain, heat_config());
  ASSERT_GT(today.steps[0].size(), 1000u);
  EXPECT_TRUE(today == trace_of(heat_profile(), broken));
  EXPECT_TRUE(today == trace_of(loop_profile(LoopMode::power, {0, 0}), heat_config()));
  EXPECT_TRUE(today == trace_of(loop_profile(LoopMode::feed, {0, 0}), heat_config()));
}

TEST(TemperatureLoop, SettingsOutOfRangeAreRefused) {
  HeatedMachine machine(heat_profile());
  for (const char* line :
       {"$1061=3", "$1061=0.5", "$1062=-1", "$1062=3300.1", "$1063=100.1", "$1064=-1", "$1065=9",
        "$1065=101", "$1066=99", "$1066=201", "$1067=10001", "$1068=49", "$1069=3301"})
    EXPECT_THAT(machine.host.ask(std::string(line) + "\n"), Contains(StartsWith("error:"))) << line;
  EXPECT_THAT(machine.host.ask("$1061=1\n"), Contains("ok"));
}

TEST(TemperatureLoop, ABoardWithoutSensorRefusesIt) {
  for (const int map : {0, 1, 2, 3, 5, 6}) {
    job::Profile profile = program_profile();
    profile.settings.set_milli(Id::pin_map, map * 1000);
    HeatedMachine machine(profile);
    const std::vector<std::string> said = machine.host.ask("$1061=1\n");
    EXPECT_THAT(said, Contains(HasSubstr("$1061 needs SENSOR"))) << map;
    EXPECT_THAT(said, Contains(StartsWith("error:"))) << map;
  }
}

}  // namespace
}  // namespace lamplock::test::temperature_loop_test
