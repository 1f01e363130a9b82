// Drives on a board (TMC2209), set up over their UART: off until all of them are as asked for, with
// one message that names the remedy.
#include "shared/drive_times.hpp"
#include "tests/chip_board/board_bench.hpp"

namespace lamplock::test {
namespace {

/// Drives on a board: set up before they are enabled.
struct DriveBench : Bench {
  explicit DriveBench(bool powered = true)
      : Bench(boards::skr_pico, boards::skr_pico, ChipRig::Power::off) {
    for (sim::Tmc2209& drive : drives()) drive.set_powered(powered);
    start();
  }
  /// With these settings in the flash, as those of another firmware may be.
  explicit DriveBench(const job::Profile& stored)
      : Bench(stored, boards::skr_pico, boards::skr_pico, ChipRig::Power::off) {}
  void start() {
    rig.boot();
    rig.run(150 * ps_per_ms);
  }
  /// All are off, and one message says why.
  void expect_off(const std::string& message) {
    EXPECT_EQ(enables_high(), enables());
    EXPECT_THAT(rig.status(), HasSubstr("Alarm"));
    EXPECT_THAT(rig.heard, HasSubstr(message));
    EXPECT_EQ(rig.heard.find("Drives off"), rig.heard.rfind("Drives off")) << rig.heard;
  }
  std::vector<sim::Tmc2209>& drives() { return rig.board.drive_wire()->drives().drives; }
  std::uint32_t enables() const { return boards::enable_pins(boards::skr_pico); }
  std::uint32_t enables_high() { return rig.board.chip().gpio().pad_levels() & enables(); }
  void move() {
    rig.user.give("G91\nG0 X0.1\n");
    EXPECT_TRUE(rig.user.run_until_idle(rig.now() + ps_per_s));
  }
};

TEST(DrivesOnTheBoard, AreSetUpAndThenEnabledTogether) {
  DriveBench bench;
  for (const sim::Tmc2209& drive : bench.drives()) {
    EXPECT_EQ(drive.written(sim::Tmc2209::nodeconf), 2u << 8) << "replies on a wire of several";
    EXPECT_EQ(drive.microsteps(), 16u);
    EXPECT_NEAR(drive.current_ma(boards::skr_pico.drives->sense_mohm), 490, 1);
  }
  bench.move();
  EXPECT_EQ(bench.enables_high(), 0u);
  ASSERT_THAT(bench.rig.answer("$1093=800"), HasSubstr("ok"));
  ASSERT_THAT(bench.rig.answer("$1096=64"), HasSubstr("ok"));
  // The move waits until the drives hold: the model counts steps that come earlier.
  bench.move();
  EXPECT_NEAR(bench.drives()[2].current_ma(boards::skr_pico.drives->sense_mohm), 796, 30);
  EXPECT_EQ(bench.drives()[1].microsteps(), 64u);
  EXPECT_EQ(bench.enables_high(), 0u);
}

/// Their enable is active low on the board, whatever the settings of another firmware say.
TEST(DrivesOnTheBoard, AreNotEnabledByTheOtherPolarity) {
  job::Profile inverted = profile_of(boards::skr_pico, false);
  inverted.settings.set_milli(Id::enable_invert, 1000);
  DriveBench bench(inverted);
  bench.start();
  EXPECT_THAT(bench.rig.answer("$4=1"), HasSubstr("error:"));
  EXPECT_THAT(bench.rig.answer("$$"), HasSubstr("$4=0\r\n"));
  bench.rig.press(sim::Pin::estop, bench.rig.now() + ps_per_ms, bench.rig.now() + 60 * ps_per_ms);
  bench.rig.run(30 * ps_per_ms);
  EXPECT_EQ(bench.enables_high(), bench.enables());
}

TEST(DrivesOnTheBoard, StayOffWithoutTheirSupply) {
  DriveBench bench(false);
  bench.rig.run(300 * ps_per_ms);
  EXPECT_EQ(bench.enables_high(), bench.enables());
  EXPECT_THAT(bench.rig.status(), HasSubstr("Alarm"));
  EXPECT_THAT(bench.rig.heard, HasSubstr("Drives off: X does not answer; switch the supply"));
  for (sim::Tmc2209& drive : bench.drives()) drive.set_powered(true);
  bench.rig.run(1000 * ps_per_ms);
  EXPECT_THAT(bench.rig.answer("$X"), HasSubstr("ok"));
  bench.move();
  EXPECT_EQ(bench.enables_high(), 0u);
}

TEST(DrivesOnTheBoard, AreDisabledWhenOneHasLostItsSetUp) {
  DriveBench bench;
  bench.move();
  bench.drives()[1].set_powered(false);
  bench.rig.run(600 * ps_per_ms);
  EXPECT_EQ(bench.enables_high(), bench.enables());
  EXPECT_THAT(bench.rig.status(), HasSubstr("Alarm"));
  EXPECT_THAT(bench.rig.heard, HasSubstr("Drives off: Y does not answer"));
}

/// A change of a setting is written with the drives off: what a lost byte left in one of them would
/// be unknown while its motor has current.
TEST(DrivesOnTheBoard, AreOffWhileTheirSettingsChange) {
  DriveBench bench;
  bench.move();
  ASSERT_EQ(bench.enables_high(), 0u);
  struct Enables final : sim::chip::PadListener {
    explicit Enables(DriveBench& of) : bench(of) { of.rig.board.chip().gpio().listen(*this); }
    void pad_changed(unsigned gpio, bool /*level*/, sim::chip::Cycle /*at*/) override {
      if ((bench.enables() >> gpio & 1) == 0) return;
      const std::uint32_t high = bench.enables_high();
      if (high == bench.enables()) were_off = true;
      if (were_off && high == 0) were_set_up = bench.drives()[3].microsteps() == 32;
    }
    DriveBench& bench;
    bool were_off = false, were_set_up = false;
  } enables(bench);
  ASSERT_THAT(bench.rig.answer("$1098=32"), HasSubstr("ok"));
  bench.rig.run(drive_wake_ms * ps_per_ms);
  bench.move();
  EXPECT_TRUE(enables.were_off);
  EXPECT_TRUE(enables.were_set_up) << "on again only as set up";
}

TEST(DrivesOnTheBoard, StayOffWithWrongCrcs) {
  DriveBench bench(profile_of(boards::skr_pico, false));
  bench.rig.board.drive_wire()->disturb = [](std::uint8_t byte) -> std::optional<std::uint8_t> {
    return static_cast<std::uint8_t>(byte ^ 0x10);
  };
  bench.start();
  bench.rig.run(100 * ps_per_ms);
  bench.expect_off("Drives off: X answers with errors; check its supply and the wires near it");
}

TEST(DrivesOnTheBoard, StayOffWithAStoredCurrentAboveTheLimit) {
  job::Profile stored = profile_of(boards::skr_pico, false);
  ASSERT_TRUE(stored.settings.set_milli(Id::drive_current_z, 1'300'000));
  DriveBench bench(stored);
  bench.start();
  bench.expect_off("Drives off: $1093 is not permitted on this board; change it");
  // The remedy of the message works; other settings remain closed in an e-stop.
  EXPECT_THAT(bench.rig.answer("$110=500"), HasSubstr("error:"));
  EXPECT_THAT(bench.rig.answer("$1093=800"), HasSubstr("ok"));
  bench.rig.run(300 * ps_per_ms);
  EXPECT_THAT(bench.rig.answer("$X"), HasSubstr("ok"));
  EXPECT_EQ(bench.enables_high(), 0u);
}

TEST(DrivesOnTheBoard, RefuseSettingsOutOfTheirReach) {
  DriveBench bench;
  EXPECT_THAT(bench.rig.answer("$1091=1300"), HasSubstr("$1091 at most 1200 mA on a board"));
  EXPECT_THAT(bench.rig.answer("$1098=48"), HasSubstr("$1098 is 1, 2, 4"));
  EXPECT_THAT(bench.rig.answer("$900=2"), HasSubstr("$900 of another board"));
}

}  // namespace
}  // namespace lamplock::test
