// Light in dwells (G4 after M3): its power, its time, and what ends it.
#include <fmt/format.h>

#include "tests/board/machine_with_switches.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::dwell_light_test {
namespace {

using settings::Id;

class DwellLight : public testing::Test {
 protected:
  DwellLight() {
    settings::Values& values = profile_.settings;
    values.set_milli(Id::laser_mode, 1000);
    values.set_milli(Id::max_spindle_speed, 1'000'000);
    values.set_milli(Id::focus_power, 20'000);
    values.set_milli(Id::focus_time, 300);
  }
  /// Begins a program up to a dwell, in which the machine is now.
  void begin(const std::string& spindle, const std::string& dwell) {
    rig_.emplace(profile_);
    host_.emplace(*rig_);
    ASSERT_TRUE(host_->stream("G21 G90 " + spindle + " G1 X1 F6000\n"));
    start_ = rig_->now();
    host_->send(dwell + "\n");
  }
  /// Milliseconds of light since begin(), times its share of the full power.
  double energy_ms() const { return rig_->board.world().beam().energy(start_, rig_->now()) * 1e3; }
  double power_now() const { return rig_->board.world().beam().at(rig_->now()).light() / 65535.0; }

  job::Profile profile_ = program_profile();
  std::optional<Rig> rig_;
  std::optional<ProgramHost> host_;
  Picoseconds start_ = 0;
};

TEST_F(DwellLight, HasThePowerOfSForTheTimeOfP) {
  begin("M3 S100", "G4 P0.2");
  host_->run_ms(100);
  EXPECT_NEAR(power_now(), 0.1, 0.001);
  host_->run_ms(200);
  EXPECT_EQ(power_now(), 0);
  EXPECT_NEAR(energy_ms(), 20, 0.1);
  EXPECT_THAT(host_->ask("G1 X2\n"), Contains("ok"));
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_EQ(host_->position()[0], 400);
}

TEST_F(DwellLight, IsLimitedInPowerAndTime) {
  begin("M3 S1000", "G4 P2");
  host_->run_ms(1000);
  EXPECT_NEAR(energy_ms(), 0.2 * 300, 0.5);
  EXPECT_EQ(power_now(), 0);
}

TEST_F(DwellLight, ChangesWithThePowerOverride) {
  begin("M3 S100", "G1 X1.001");
  ASSERT_TRUE(host_->wait_for_rest());
  for (int i = 0; i < 5; ++i) host_->send(std::uint8_t{0x9b});  // -10 %
  start_ = rig_->now();
  host_->send("G4 P0.2\n");
  host_->run_ms(300);
  EXPECT_NEAR(energy_ms(), 0.05 * 200, 0.1);
}

TEST_F(DwellLight, IsDarkOtherwise) {
  const std::vector<std::pair<std::string, std::string>> dark = {
      {"M4 S100", "G4 P0.1"},     {"M5 S100", "G4 P0.1"},      {"M3 S0", "G4 P0.1"},
      {"M3 S100", "G0\nG4 P0.1"}, {"M3 S100", "G80\nG4 P0.1"}, {"M3 S100", "G4 P0"},
      {"M3 S100", "M5\nG4 P0.1"}, {"M3 S100", "$C\nG4 P0.1"}};
  for (const auto& [spindle, dwell] : dark) {
    begin(spindle, dwell);
    host_->run_ms(200);
    EXPECT_EQ(energy_ms(), 0) << spindle << " " << dwell;
  }
  profile_.settings.set_milli(Id::focus_power, 0);
  begin("M3 S100", "G4 P0.1");
  host_->run_ms(200);
  EXPECT_EQ(energy_ms(), 0);
  profile_.settings.set_milli(Id::focus_power, 100'000);
  profile_.settings.set_milli(Id::laser_mode, 0);
  begin("M3 S100", "G4 P0.1");
  host_->run_ms(200);
  EXPECT_EQ(energy_ms(), 0);
}

/// Whatever stops a program ends the light at once, and it does not come back.
TEST_F(DwellLight, EndsWithEveryStop) {
  profile_.settings.set_milli(Id::focus_time, 10'000);
  for (const std::uint8_t byte : {std::uint8_t{'!'}, std::uint8_t{0x84}, std::uint8_t{0x18}}) {
    begin("M3 S100", "G4 P1\nG4 P0.1");
    host_->run_ms(100);
    ASSERT_GT(power_now(), 0);
    host_->send(byte);
    host_->run_ms(5);
    EXPECT_EQ(power_now(), 0) << int{byte};
    const double spent = energy_ms();
    host_->run_ms(1500);
    EXPECT_EQ(energy_ms(), spent) << int{byte};
    if (byte == 0x18) continue;
    // The program continues with the rest of the dwell, dark, and with the next one.
    host_->send("~");
    host_->run_ms(500);
    EXPECT_NEAR(energy_ms(), spent + 10, 0.2) << int{byte};
  }
  for (const sim::Pin pin : {sim::Pin::door, sim::Pin::estop}) {
    begin("M3 S100", "G4 P1");
    host_->run_ms(100);
    ASSERT_GT(power_now(), 0);
    rig_->board.world().schedule(pin, true, rig_->now());
    host_->run_ms(5);
    EXPECT_EQ(power_now(), 0);
    const double spent = energy_ms();
    host_->run_ms(1500);
    EXPECT_EQ(energy_ms(), spent);
  }
}

/// The next move follows the light, and the end of the program waits for it.
TEST_F(DwellLight, IsCompleteBeforeWhatFollows) {
  begin("M3 S100", "G4 P0.1\nG1 X2 F6000\nG4 P0.1\nM2");
  host_->run_ms(600);
  EXPECT_TRUE(host_->has_said("[MSG:Pgm End]"));
  const double moved_ms = 1 / 100.0 * 1e3;  // 1 mm at 100 mm/s, and the ramps
  EXPECT_GT(energy_ms(), 20 + 0.1 * moved_ms);
  EXPECT_LT(energy_ms(), 20 + 0.1 * 10 * moved_ms);
  EXPECT_EQ(power_now(), 0);
}

}  // namespace
}  // namespace lamplock::test::dwell_light_test
