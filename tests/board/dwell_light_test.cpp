// Light while the machine rests, in dwells (G4 after M3) and between lines (M3, S or G1 without a
// move): its power, its time, and what ends it.
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

/// The setting is the limit at any override.
TEST_F(DwellLight, IsLimitedAfterTheOverride) {
  begin("M3 S150", "G1 X1.001");
  ASSERT_TRUE(host_->wait_for_rest());
  for (int i = 0; i < 10; ++i) host_->send(std::uint8_t{0x9a});  // +10 %
  host_->send("G4 P0.2\n");
  host_->run_ms(100);
  EXPECT_NEAR(power_now(), 0.2, 0.0005);
  host_->run_ms(200);
  host_->send("S80\nM3\n");
  host_->run_ms(100);
  EXPECT_NEAR(power_now(), 0.16, 0.0005);
}

/// Light that shines has a fixed power: a lower override ends it, a higher one acts on the next.
TEST_F(DwellLight, EndsWithALowerOverride) {
  profile_.settings.set_milli(Id::focus_time, 10'000);
  for (const char* line : {"G4 P1", "M3"})
    for (const std::uint8_t lower : {std::uint8_t{0x9b}, std::uint8_t{0x9d}, std::uint8_t{0x99}}) {
      begin("M3 S100", "G1 X1.001");
      ASSERT_TRUE(host_->wait_for_rest());
      if (lower == 0x99) host_->send(std::uint8_t{0x9a});
      host_->send(fmt::format("{}\n", line));
      host_->run_ms(100);
      const double power = power_now();
      EXPECT_NEAR(power, lower == 0x99 ? 0.11 : 0.1, 0.0005);
      host_->send(std::uint8_t{0x9c});  // +1 %
      host_->run_ms(5);
      EXPECT_EQ(power_now(), power);
      if (lower == 0x9d) host_->send(lower);  // -1 %, twice
      host_->send(lower);
      host_->run_ms(5);
      EXPECT_EQ(power_now(), 0) << line << " " << int{lower};
      host_->run_ms(300);
      EXPECT_EQ(power_now(), 0);
    }
}

TEST_F(DwellLight, IsDarkOtherwise) {
  const std::vector<std::pair<std::string, std::string>> dark = {{"M4 S100", "G4 P0.1"},
                                                                 {"M5 S100", "G4 P0.1"},
                                                                 {"M3 S0", "G4 P0.1"},
                                                                 {"M3 S100", "G0\nG4 P0.1"},
                                                                 {"M3 S100", "G80\nG4 P0.1"},
                                                                 {"M3 S100", "G4 P0"},
                                                                 {"M3 S100", "G81 Z0 R0\nG4 P0.1"},
                                                                 {"M3 S100", "M5\nG4 P0.1"},
                                                                 {"M3 S100", "M130 P0\nG4 P0.1"},
                                                                 {"M3 S100", "$C\nG4 P0.1"}};
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

/// A reset in the light loses no position, as one at rest: no alarm, and the next line moves.
TEST_F(DwellLight, AfterAResetTheMachineIsReady) {
  profile_.settings.set_milli(Id::focus_time, 10'000);
  for (const char* line : {"G4 P2", "M3", "S90", "G4 P2\nG1 X3"})
    for (const bool slept : {false, true}) {
      SCOPED_TRACE(line + std::string(slept ? ", then $SLP" : ""));
      begin("M3 S100", line);
      host_->run_ms(100);
      ASSERT_GT(power_now(), 0);
      if (slept) host_->send("$SLP\n");
      host_->run_ms(1);
      host_->send(std::uint8_t{0x18});
      host_->run_ms(50);
      EXPECT_TRUE(host_->has_said("Grbl 1.1h ['$' for help]"));
      EXPECT_FALSE(host_->has_said("ALARM:3"));
      EXPECT_EQ(power_now(), 0);
      EXPECT_THAT(host_->status(), HasSubstr("<Idle"));
      EXPECT_THAT(host_->ask("G90 G1 X2 F6000\n"), Contains("ok"));
      ASSERT_TRUE(host_->wait_for_rest());
      EXPECT_EQ(host_->position()[0], 400);
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

class RestLight : public DwellLight {};

/// Lines after "M3 S100 G1 X1", and the power at rest after them.
TEST_F(RestLight, FollowsTheModalState) {
  const std::vector<std::pair<std::string, double>> lines = {{"M3", 0.1},
                                                             {"S50", 0.05},
                                                             {"S1000", 0.2},
                                                             {"G1", 0.1},
                                                             {"G2 X2 I0.5\nG3 X1 I-0.5\nM3", 0.1},
                                                             {"M5\nM3", 0.1},
                                                             {"G0\nG1", 0.1},
                                                             {"G0\nS20", 0},
                                                             {"G0 X2\nM3", 0},
                                                             {"G0\nM3 S20\nG1", 0.02},
                                                             {"M3\nG0", 0},
                                                             {"M3\nM5", 0},
                                                             {"M3\nS0", 0},
                                                             {"M4", 0},
                                                             {"M4\nS50", 0},
                                                             {"M5\nS50", 0},
                                                             {"M3\nG1 X2", 0},
                                                             {"M3\nG4 P0.01", 0},
                                                             {"M3\nM2", 0},
                                                             {"S50 G1 X2", 0},
                                                             {"G80\nM3", 0},
                                                             {"G81 Z0 R0\nM3", 0},
                                                             {"M130 P0\nM3", 0},
                                                             {"S50 G4 P0.01", 0},
                                                             {"M3\nG90", 0},
                                                             {"$C\nM3", 0},
                                                             {"S50 M2", 0},
                                                             {"M3 M0", 0}};
  for (const auto& [line, power] : lines) {
    begin("M3 S100", line);
    EXPECT_EQ(power_now(), 0);  // M3 alone does not leave light after a move
    host_->run_ms(150);
    EXPECT_NEAR(power_now(), power, 0.0005) << line;
  }
  for (const Id id : {Id::focus_power, Id::focus_time, Id::laser_mode}) {
    profile_.settings.set_milli(id, 0);
    begin("M3 S100", "S50");
    host_->run_ms(150);
    EXPECT_EQ(energy_ms(), 0);
  }
}

TEST_F(RestLight, EndsAfterTheTimeOfTheSetting) {
  begin("M3 S100", "M3");
  host_->run_ms(1000);
  EXPECT_NEAR(energy_ms(), 0.1 * 300, 0.1);
  EXPECT_TRUE(host_->wait_for_rest());
  EXPECT_THAT(host_->ask("G1 X2\n"), Contains("ok"));
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_EQ(host_->position()[0], 400);
}

/// It begins after the moves before it and ends before the moves after it, which keep their power.
TEST_F(RestLight, LiesBetweenMoves) {
  begin("M3 S100", "G1 X2 F600\nS1000");
  host_->run_ms(50);
  EXPECT_NEAR(power_now(), 0.1, 0.0005);
  host_->run_ms(150);
  EXPECT_NEAR(power_now(), 0.2, 0.0005);
  host_->send("G1 X3 F600\n");
  host_->run_ms(50);
  EXPECT_NEAR(power_now(), 1, 0.0005);
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_EQ(power_now(), 0);
  EXPECT_EQ(host_->position()[0], 600);
}

/// Whatever stops the machine ends the light at once, and it does not come back.
TEST_F(RestLight, EndsWithEveryStop) {
  profile_.settings.set_milli(Id::focus_time, 10'000);
  const auto shining = [&] {
    begin("M3 S100", "M3");
    host_->run_ms(100);
    ASSERT_GT(power_now(), 0);
  };
  const auto dark = [&](const std::string& what) {
    host_->run_ms(5);
    EXPECT_EQ(power_now(), 0) << what;
    const double spent = energy_ms();
    host_->run_ms(1000);
    host_->send("~");
    host_->run_ms(1000);
    EXPECT_EQ(energy_ms(), spent) << what;
  };
  for (const std::uint8_t byte : {std::uint8_t{'!'}, std::uint8_t{0x84}, std::uint8_t{0x18}}) {
    shining();
    host_->send(byte);
    dark(fmt::format("byte {}", int{byte}));
  }
  for (const sim::Pin pin : {sim::Pin::door, sim::Pin::estop}) {
    shining();
    rig_->board.world().schedule(pin, true, rig_->now());
    dark(fmt::format("pin {}", static_cast<int>(pin)));
  }
  shining();
  rig_->board.set_host_present(false);
  dark("host gone");
}

}  // namespace
}  // namespace lamplock::test::dwell_light_test
