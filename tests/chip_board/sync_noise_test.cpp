// Noise on LAMP SYNC, as a high voltage beside its wire may cause: up to more edges than the board
// can handle. No light, no step and no shot goes wrong; what the board cannot do it ends with an
// alarm.
#include "tests/chip_board/chip_rig.hpp"
#include "tests/figure.hpp"

namespace lamplock::test::sync_noise_test {
namespace {

constexpr Picoseconds noise_time = 150 * ps_per_ms;
/// The edges that end the lock, or ticks handed out ahead, and a margin.
constexpr Picoseconds dark_within = 15 * ps_per_ms;
/// An edge every 25 us leaves the board time for all it does. With one every 4 us its main loop
/// does not run any more, and the watchdog restarts the chip.
constexpr double bearable_hz = 40e3, overload_hz = 250e3;

/// Pulses that are too long to be ignored, from now on.
void make_noise(ChipRig& rig, double hz) {
  constexpr Picoseconds width = 3 * ps_per_us;
  const auto period = static_cast<Picoseconds>(static_cast<double>(ps_per_s) / hz);
  const Picoseconds end = rig.now() + noise_time;
  for (Picoseconds at = rig.now(); at < end; at += period)
    rig.press(sim::Pin::lamp_sync, at, at + width);
}

class SyncNoise : public testing::Test {
 protected:
  /// Runs a job into noise; the gate is opened as if by a fault.
  void run_job(double hz) {
    SCOPED_TRACE(testing::Message() << hz << " Hz");
    rig_ = std::make_unique<ChipRig>(profile_);
    const job::Job job = job::make_job(chip_points(60, 5), profile_, {});
    RunningJob running(*rig_, job, 1);
    ASSERT_TRUE(running.run_until_fired(20));
    open_gate(*rig_);
    make_noise(*rig_, hz);
    const Picoseconds begin = rig_->now();
    rig_->run(noise_time);
    end_ = running.finish();
    ASSERT_NO_FATAL_FAILURE(expect_fired_so_far(*rig_, job));
    EXPECT_FALSE(rig_->energy.high_within(EnergyPads::gate, begin + dark_within, rig_->now()));
    if (end_ == JobEnd::done) {
      EXPECT_EQ(rig_->shots().size(), job.targets.size());
      return;
    }
    EXPECT_TRUE(end_ == JobEnd::alarm || end_ == JobEnd::restarted);
    EXPECT_FALSE(rig_->energy.any_high_within(begin + dark_within, rig_->now()));
    EXPECT_THAT(rig_->status(), StartsWith("<Alarm"));
  }
  /// Runs a program with a continuous laser into noise.
  void run_program(double hz) {
    job::state_setting(profile_, Id::laser_mode, 1, "test");
    rig_ = std::make_unique<ChipRig>(profile_);
    rig_->type("M3 S500\nG1 X10 F3000\nX0\nM5\n");
    rig_->run(50 * ps_per_ms);
    ASSERT_NE(rig_->energy.levels(), 0u);
    make_noise(*rig_, hz);
    noise_began_ = rig_->now();
    rig_->run(600 * ps_per_ms);
    rig_->listen();
  }

  job::Profile profile_ = chip_profile();
  std::unique_ptr<ChipRig> rig_;
  JobEnd end_ = JobEnd::done;
  Picoseconds noise_began_ = 0;
};

TEST_F(SyncNoise, AJobContinuesAfterwards) {
  run_job(bearable_hz);
  EXPECT_EQ(end_, JobEnd::done);
}

TEST_F(SyncNoise, AJobEndsDarkWithMoreThanTheBoardCanHandle) {
  run_job(overload_hz);
  EXPECT_EQ(end_, JobEnd::restarted);
}

TEST_F(SyncNoise, AJobEndsWholeOrWithAnAlarmAtAnyRate) {
  std::mt19937_64 random(6);
  for (int i = 0; i < scaled(2); ++i)
    ASSERT_NO_FATAL_FAILURE(
        run_job(5e3 * std::pow(60, std::uniform_real_distribution<>()(random))));
}

TEST_F(SyncNoise, AProgramRunsOn) {
  ASSERT_NO_FATAL_FAILURE(run_program(bearable_hz));
  EXPECT_THAT(rig_->status(), StartsWith("<Idle"));
  EXPECT_EQ(rig_->user.errors(), 0u);
  const auto& steps = rig_->monitor.steps(0);
  const auto ten_mm = static_cast<std::size_t>(profile_.settings.milli(Id::steps_per_mm_x) / 100);
  EXPECT_EQ(steps.size(), 2 * ten_mm);
  EXPECT_EQ(rig_->board.world().drives().position(), StepPosition{});
}

TEST_F(SyncNoise, AProgramEndsDarkWithMoreThanTheBoardCanHandle) {
  ASSERT_NO_FATAL_FAILURE(run_program(overload_hz));
  expect_figure("last step after the begin of the noise", rig_->last_step() - noise_began_, 0, 5);
  const Picoseconds dark = noise_began_ + dark_within, restarted = noise_began_ + 110 * ps_per_ms;
  for (const unsigned pad : {EnergyPads::q_switch, EnergyPads::gate, EnergyPads::arm})
    EXPECT_FALSE(rig_->energy.high_within(pad, dark, rig_->now())) << "pad " << pad;
  // The power of the laser, which the gate switches, ends with the restart.
  EXPECT_FALSE(rig_->energy.any_high_within(restarted, rig_->now()));
  EXPECT_THAT(rig_->heard, HasSubstr("[MSG:Started by watchdog, programs had run]"));
  EXPECT_THAT(rig_->status(), StartsWith("<Alarm"));
}

}  // namespace
}  // namespace lamplock::test::sync_noise_test
