// Pulses per distance on the virtual board: the place where each begins, across line ends, ramps,
// corners and holds; their length; and where the laser is dark.
#include <fmt/format.h>

#include <cmath>

#include "tests/board/program_host.hpp"
#include "tests/board/raster.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

constexpr double mm_per_step = 0.005;

struct Pulse {
  Picoseconds at = 0, ends = 0;
  std::uint16_t power = 0;
};

std::vector<Pulse> pulses_of(const sim::Beam& beam) {
  std::vector<Pulse> pulses;
  bool shone = false;
  for (const sim::BeamChange& change : beam.changes()) {
    if (change.shines() && !shone) pulses.push_back({change.at, 0, change.power});
    if (!change.shines() && shone) pulses.back().ends = change.at;
    shone = change.shines();
  }
  return pulses;
}

/// Distance that an axis has moved up to a time, both directions added, steps.
double way_at(const std::vector<PinMonitor::Step>& steps, Picoseconds at) {
  const auto next = std::partition_point(
      steps.begin(), steps.end(), [at](const PinMonitor::Step& step) { return step.at <= at; });
  const auto done = static_cast<double>(next - steps.begin());
  if (next == steps.begin() || next == steps.end()) return done - 0.5;
  const double part =
      static_cast<double>(at - (next - 1)->at) / static_cast<double>(next->at - (next - 1)->at);
  return done + part - 0.5;
}

/// Lines along X, one after the other, forwards and backwards.
struct Way {
  std::string program;
  double mm = 0;
  int lines = 0;
};

Way some_way(std::mt19937_64& random, const char* feeds) {
  Way way;
  double x = 0;
  for (int i = 0; i < 30; ++i) {
    double to = x;
    while (std::abs(to - x) < 0.02)
      to = random() % 3 != 0 ? x + static_cast<double>(random() % 200) / 100
                             : static_cast<double>(random() % 2000) / 100 - 10;
    way.program += fmt::format(
        "G1 X{:.2f}{}\n", to,
        random() % 4 == 0 ? fmt::format(" F{}", 600 + random() % 12'000) : std::string(feeds));
    way.mm += std::abs(to - x);
    x = to;
    ++way.lines;
  }
  return way;
}

/// Every pulse begins at half a distance plus a whole number of distances, within a step: a step
/// occurs half a step before its place.
void expect_pulses(const std::vector<Pulse>& pulses, const std::vector<PinMonitor::Step>& steps,
                   double way_mm, double per_mm) {
  const auto count = static_cast<std::size_t>(std::floor(way_mm * per_mm + 0.5));
  // A pulse at the very end may be too short to appear.
  ASSERT_GE(pulses.size() + 1, count);
  ASSERT_LE(pulses.size(), count);
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    const double wanted = (static_cast<double>(i) + 0.5) / per_mm / mm_per_step;
    ASSERT_NEAR(way_at(steps, pulses[i].at), wanted, 1) << "pulse " << i << " of " << count;
    ASSERT_EQ(pulses[i].power, 32'768) << i;
  }
}

TEST(PulsesPerDistance, AreEvenlySpacedAlongTheWay) {
  for (int i = 0; i < scaled(8); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const double per_mm = 1 + static_cast<double>(random() % 90) / 10;
    const Way way = some_way(random, "");
    Rig rig(raster_machine());
    ProgramHost host(rig);
    ASSERT_TRUE(
        host.stream(fmt::format("G21 G90 {} S500 F6000\nM126 P1\nM127 P{}\nM128 P40\n{}M2\n",
                                i % 2 == 0 ? "M3" : "M4", per_mm, way.program)));
    for (const std::string& answer : host.answers()) ASSERT_EQ(answer, "ok");
    host.run_ms(20);
    const auto pulses = pulses_of(rig.board.world().beam());
    ASSERT_NO_FATAL_FAILURE(expect_pulses(pulses, rig.monitor.steps(0), way.mm, per_mm)) << i;
    // The last pulse may be cut at the end.
    for (std::size_t k = 0; k + 1 < pulses.size(); ++k)
      ASSERT_EQ(pulses[k].ends - pulses[k].at, 40 * ps_per_us);
    EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
  }
}

TEST(PulsesPerDistance, HoldsAndOverridesChangeNothing) {
  for (int i = 0; i < scaled(6); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i + 100));
    const double per_mm = 1 + static_cast<double>(random() % 90) / 10;
    const Way way = some_way(random, "");
    Rig rig(raster_machine());
    rig.run(ps_per_ms);
    ProgramSender sender(rig.board);
    sender.give(fmt::format("G21 G90 M3 S500 F6000\nM126 P1\nM127 P{}\nM128 P40\n{}M2\n", per_mm,
                            way.program));
    send_with_holds(rig, sender, random);
    ASSERT_NO_FATAL_FAILURE(
        expect_pulses(pulses_of(rig.board.world().beam()), rig.monitor.steps(0), way.mm, per_mm))
        << i;
  }
}

/// A circle of short chords: the angle between pulses is constant.
TEST(PulsesPerDistance, ContinueOverTheChordsOfAnArc) {
  Rig rig(raster_machine());
  ProgramHost host(rig);
  constexpr double radius = 5, per_mm = 2;
  ASSERT_TRUE(host.stream("G21 G90 M3 S500 F3000\nM126 P1\nM127 P2\nM128 P30\nG3 X0 Y0 I-5\nM2\n"));
  for (const std::string& answer : host.answers()) ASSERT_EQ(answer, "ok");
  host.run_ms(20);
  const auto pulses = pulses_of(rig.board.world().beam());
  ASSERT_EQ(pulses.size(), static_cast<std::size_t>(std::lround(2 * M_PI * radius * per_mm)));
  const auto place = [&rig](int axis, Picoseconds at) {
    return rig.monitor.position_at(axis, at) * mm_per_step;
  };
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    double angle = std::atan2(place(1, pulses[i].at), place(0, pulses[i].at) + radius);
    if (angle < 0 && i > 3) angle += 2 * M_PI;
    ASSERT_NEAR(angle * radius, (static_cast<double>(i) + 0.5) / per_mm, 2 * mm_per_step) << i;
  }
}

/// Rapids have no pulses, and the first pulse after a rapid follows after half a distance; dark
/// lines count; lines without pulse mode have continuous light.
TEST(PulsesPerDistance, RestartAfterARapid) {
  Rig rig(raster_machine());
  ProgramHost host(rig);
  ASSERT_TRUE(
      host.stream("G21 G90 M3 S500 F3000\nM126 P1\nM127 P1\nM128 P100\nG1 X3.3\nG0 X5.5\n"
                  "G1 X8.5\nX9.6 S0\nX12.5 S500\nM126 P0\nX13.5\nM5\nM2\n"));
  for (const std::string& answer : host.answers()) ASSERT_EQ(answer, "ok");
  host.run_ms(20);
  const double wanted[] = {0.5, 1.5, 2.5, 6, 7, 8, 10, 11, 12, 12.5};
  const auto pulses = pulses_of(rig.board.world().beam());
  ASSERT_EQ(pulses.size(), std::size(wanted));
  for (std::size_t i = 0; i < pulses.size(); ++i)
    EXPECT_NEAR(way_at(rig.monitor.steps(0), pulses[i].at) * mm_per_step, wanted[i], mm_per_step);
  // The last light is continuous.
  EXPECT_GT(pulses.back().ends - pulses.back().at, 19 * ps_per_ms);
}

/// Pulses longer than the time between them merge into one light.
TEST(PulsesPerDistance, ThatOverlapAreOneLight) {
  Rig rig(raster_machine());
  ProgramHost host(rig);
  ASSERT_TRUE(
      host.stream("G21 G90 M3 S500 F6000\nM126 P1\nM127 P10\nM128 P1500\nG1 X10\nM5\nM2\n"));
  host.run_ms(20);
  const auto pulses = pulses_of(rig.board.world().beam());
  // At the ends, where the machine is slow, they are separate.
  const auto longest = std::max_element(
      pulses.begin(), pulses.end(), [](auto& a, auto& b) { return a.ends - a.at < b.ends - b.at; });
  EXPECT_GT(longest->ends - longest->at, 60 * ps_per_ms);
  EXPECT_GT(pulses.size(), 4u);
  EXPECT_GT(rig.board.controller().runner().generator().beam().merged(), 60u);
}

/// Pulses by the settings only.
TEST(PulsesPerDistance, AreAsTheSettingsSay) {
  job::Profile machine = raster_machine();
  job::state_setting(machine, settings::Id::pulses_per_mm, 2, "test");
  job::state_setting(machine, settings::Id::pulse_length, 55, "test");
  Rig rig(machine);
  ProgramHost host(rig);
  ASSERT_TRUE(host.stream("G21 G90 M3 S500 F3000\nG1 X10\nM5\nM2\n"));
  host.run_ms(20);
  const auto pulses = pulses_of(rig.board.world().beam());
  ASSERT_NO_FATAL_FAILURE(expect_pulses(pulses, rig.monitor.steps(0), 10, 2));
  for (const Pulse& pulse : pulses) EXPECT_EQ(pulse.ends - pulse.at, 55 * ps_per_us);
}

/// The light goes off at once, even during a pulse.
TEST(PulsesPerDistance, EndWithADoorAResetAndAnEStop) {
  for (int kind = 0; kind < 3; ++kind) {
    Rig rig(raster_machine());
    ProgramHost host(rig);
    host.send("G21 G90 M3 S500 F3000\nM126 P1\nM127 P0.1\nM128 P1000000\nG1 X50\n");
    host.run_ms(300);
    ASSERT_TRUE(rig.board.bus().level(sim::Pin::laser_gate));
    const Picoseconds now = rig.now();
    if (kind == 0) host.send(std::uint8_t{0x18});
    if (kind == 1) rig.board.world().schedule(sim::Pin::door, true, now + ps_per_us);
    if (kind == 2) rig.board.world().schedule(sim::Pin::estop, true, now + ps_per_us);
    host.run_ms(200);
    EXPECT_FALSE(rig.board.world().beam().shone(now + 2 * ps_per_ms, rig.now())) << kind;
  }
}

}  // namespace
}  // namespace lamplock::test
