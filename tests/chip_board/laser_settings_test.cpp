// Settings of a continuous laser, measured at the pad of LASER GATE of the flash image: each is in
// force with its answer, without a restart.
#include <fmt/format.h>

#include "tests/board/raster.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test::laser_settings_test {
namespace {

using settings::Id;

/// Times in which LASER GATE is high.
class GateWatch final : public sim::chip::PadListener {
 public:
  struct Pulse {
    Picoseconds begin, end;
    Picoseconds length() const { return end - begin; }
  };
  explicit GateWatch(sim::chip::Chip& chip) : chip_(chip) { chip.gpio().listen(*this); }
  GateWatch(const GateWatch&) = delete;
  GateWatch& operator=(const GateWatch&) = delete;
  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle at) override {
    if (gpio != EnergyPads::gate) return;
    const Picoseconds time = chip_.wheel().time_of(at);
    if (level)
      pulses.push_back({time, sim::never});
    else if (!pulses.empty())
      pulses.back().end = time;
  }
  std::vector<Pulse> pulses;

 private:
  sim::chip::Chip& chip_;
};

class LaserSettings : public testing::Test {
 protected:
  void set(Id id, double value) {
    const std::string line = fmt::format("${}={}", settings::number(id), value);
    EXPECT_EQ(rig_.answer(line), "ok\r\n") << line;
  }
  /// Runs a program from the start of X, and forgets what was before.
  void run(const std::string& lines) {
    user("G0 X0\n");
    gate_.pulses.clear();
    first_step_ = rig_.monitor.steps(0).size();
    user(lines);
  }
  /// When X has made so many steps in this program.
  Picoseconds time_of_step(std::size_t number) const {
    return rig_.monitor.steps(0).at(first_step_ + number - 1).at;
  }

  ChipRig rig_{raster_machine()};
  GateWatch gate_{rig_.board.chip()};

 private:
  void user(const std::string& lines) {
    rig_.user.give(lines);
    const Picoseconds end = rig_.now() + 5 * ps_per_s;
    ASSERT_TRUE(rig_.user.run_until_answered(end) && rig_.user.run_until_idle(end));
    rig_.run(20 * ps_per_ms);
  }
  std::size_t first_step_ = 0;
};

/// $931: the light changes in a move of constant speed.
TEST_F(LaserSettings, LeadMovesBothEdges) {
  constexpr std::size_t on_step = 1000, off_step = 2000;  // 5 and 10 mm
  Picoseconds on_without = 0, off_without = 0;
  for (const double lead_us : {0.0, 700.0, -450.0}) {
    set(Id::laser_lead, lead_us);
    run("G21G90M3F6000\nG1X5S0\nX10S500\nX15S0\nM5\n");
    ASSERT_EQ(gate_.pulses.size(), 1u) << lead_us;
    const Picoseconds on = time_of_step(on_step) - gate_.pulses[0].begin,
                      off = time_of_step(off_step) - gate_.pulses[0].end;
    if (lead_us == 0) on_without = on, off_without = off;
    const auto wanted = static_cast<Picoseconds>(lead_us * ps_per_us);
    EXPECT_LE(std::abs(on - on_without - wanted), 2 * ps_per_tick) << lead_us;
    EXPECT_LE(std::abs(off - off_without - wanted), 2 * ps_per_tick) << lead_us;
    // Without a lead the light changes at the place, within a step (50 us).
    EXPECT_LE(std::abs(on_without), 51 * ps_per_us);
  }
}

/// $932 and $933: pulses per distance.
TEST_F(LaserSettings, PulsesHaveTheirNumberAndLength) {
  for (const auto& [per_mm, length_us] : {std::pair{2.0, 55.0}, {0.5, 1000.0}}) {
    set(Id::pulses_per_mm, per_mm);
    set(Id::pulse_length, length_us);
    run("G21G90M3S500F3000\nG1X10\nM5\n");
    EXPECT_EQ(gate_.pulses.size(), static_cast<std::size_t>(10 * per_mm));
    const Picoseconds length = std::llround(length_us * ps_per_us);
    for (const GateWatch::Pulse& pulse : gate_.pulses)
      EXPECT_LE(std::abs(pulse.length() - length), 2 * rig_.clock()) << length_us;
  }
  set(Id::pulses_per_mm, 0);
  run("G21G90M3S500F3000\nG1X10\nM5\n");
  EXPECT_EQ(gate_.pulses.size(), 1u);
}

/// $936 and $937: light at rest.
TEST_F(LaserSettings, LightAtRestHasItsPowerAndTime) {
  const std::string program = "G21G90M3S1000F6000\nG1X1\nG4P0.2\nM5\n";
  run(program);
  ASSERT_EQ(gate_.pulses.size(), 1u);
  const Picoseconds moving = gate_.pulses[0].length();
  for (const auto& [percent, seconds] : {std::pair{20.0, 0.1}, {60.0, 0.05}, {20.0, 5.0}}) {
    set(Id::focus_power, percent);
    set(Id::focus_time, seconds);
    const Picoseconds before = rig_.now();
    run(program);
    const Picoseconds lit = std::llround(std::min(seconds, 0.2) * ps_per_s);
    Picoseconds sum = 0;
    for (const GateWatch::Pulse& pulse : gate_.pulses) sum += pulse.length();
    EXPECT_LE(std::abs(sum - moving - lit), 5 * ps_per_ms) << seconds;
    const double energy_s = rig_.board.world().beam().energy(before, rig_.now());
    const double move_s = static_cast<double>(moving) / ps_per_s;
    EXPECT_NEAR(energy_s - move_s, percent / 100 * static_cast<double>(lit) / ps_per_s, 0.005);
  }
}

}  // namespace
}  // namespace lamplock::test::laser_settings_test
