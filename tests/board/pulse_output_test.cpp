// Drives of every kind on the virtual board: they lose no step, the steps occur at the same ticks
// in every pulse mode, and the position is known after an immediate stop.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "tests/board/exact_programs.hpp"
#include "tests/board/program_host.hpp"
#include "tests/board/turning_job.hpp"

namespace lamplock::test {
namespace {

constexpr PerAxis<PulseMode> all_step_dir{};

/// Times from 200 ns to 20 us, evenly distributed on a logarithmic scale.
std::int32_t random_ns(std::mt19937_64& random) {
  const double exponent = std::uniform_real_distribution<>(0, 2)(random);
  return static_cast<std::int32_t>(200 * std::pow(10.0, exponent));
}

void set_random_times(settings::Values& values, std::mt19937_64& random) {
  values.set_milli(Id::direction_setup, random_ns(random));
  values.set_milli(Id::direction_hold, random_ns(random));
}

void set_random_pulses(settings::Values& values, std::mt19937_64& random) {
  PerAxis<PulseMode> modes{};
  for (PulseMode& mode : modes) mode = static_cast<PulseMode>(random() % 3);
  set_pulses(values, modes, static_cast<int>(random() % 16), static_cast<int>(random() % 16),
             values.milli(Id::direction_setup), values.milli(Id::direction_hold));
}

void expect_same_steps(const StepLog& one, const StepLog& other) {
  ASSERT_EQ(one.total(), other.total());
  for (std::size_t a = 0; a < one.steps().size(); ++a)
    for (std::size_t i = 0; i < one.steps()[a].size(); ++i) {
      ASSERT_EQ(one.steps()[a][i].position, other.steps()[a][i].position) << a << " step " << i;
      ASSERT_EQ(one.steps()[a][i].at, other.steps()[a][i].at) << a << " step " << i;
    }
}

/// A board with a log of the steps that drives read from its outputs.
struct LoggedRig : Rig {
  explicit LoggedRig(const job::Profile& profile)
      : Rig(profile), log(profile.settings, board.bus()) {}
  StepLog log;

  void expect_drives_followed() {
    EXPECT_EQ(board.world().drives().total_faults(), 0u);
    EXPECT_FALSE(board.controller().runner().underrun());
  }
};

void run_points(LoggedRig& rig, const job::Job& job) {
  ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
  expect_each_once(rig, job, false);
  rig.expect_drives_followed();
}

/// Point clouds: at every shot the machine is on its point, with or without a guard time.
TEST(PulseModes, JobsStepAtTheSameTicksInEveryModeAndLoseNothing) {
  std::mt19937_64 random(1);
  std::size_t reversals = 0;
  for (int run = 0; run < scaled(12); ++run) {
    job::Profile plain =
        lamp_profile(run % 2 == 0 ? 100 : 400, LampMode::slave, run % 3 == 0 ? 50 : 4);
    set_random_times(plain.settings, random);
    job::Profile other = plain;
    set_random_pulses(other.settings, random);
    const auto points = wild_points(60, random());
    const JoinMode mode = both_modes[run % 2];
    LoggedRig first(plain), second(other);
    ASSERT_NO_FATAL_FAILURE(run_points(first, job_for(points, plain, mode))) << "run " << run;
    ASSERT_NO_FATAL_FAILURE(run_points(second, job_for(points, other, mode))) << "run " << run;
    EXPECT_EQ(first.monitor.violation(plain.settings), "");
    ASSERT_NO_FATAL_FAILURE(expect_same_steps(first.log, second.log)) << "run " << run;
    for (int axis = 0; axis < 3; ++axis) reversals += first.log.reversals(axis).size();
  }
  EXPECT_GT(reversals, static_cast<std::size_t>(scaled(12)) * 50);
}

job::Profile jumping_profile(double lamp_hz, LampMode lamp) {
  job::Profile profile = lamp_profile(lamp_hz, lamp);
  let_speed_jump(profile);
  return profile;
}

/// Number of steps that are later than with the shortest times.
std::size_t late_steps(const StepLog& log, const StepLog& quick) {
  std::size_t late = 0;
  for (std::size_t a = 0; a < log.steps().size(); ++a)
    for (std::size_t i = 0; i < std::min(log.steps()[a].size(), quick.steps()[a].size()); ++i)
      late += log.steps()[a][i].at > quick.steps()[a][i].at ? 1u : 0u;
  return late;
}

/// Turns on a point at speed: steps wait for their drives, and the machine is still on its point at
/// the beat.
TEST(PulseModes, PathsThatTurnAtSpeedHitTheirPointsAndLoseNothing) {
  std::mt19937_64 random(4);
  std::size_t late = 0;
  for (int run = 0; run < scaled(10); ++run) {
    job::Profile plain = jumping_profile(1000, LampMode::slave), quick = plain;
    set_random_times(plain.settings, random);
    job::Profile other = plain;
    set_random_pulses(other.settings, random);
    const std::uint64_t seed = random();
    LoggedRig first(plain), second(other), third(quick);
    ASSERT_NO_FATAL_FAILURE(run_points(first, turning_job(plain, seed))) << "run " << run;
    ASSERT_NO_FATAL_FAILURE(run_points(second, turning_job(other, seed))) << "run " << run;
    ASSERT_NO_FATAL_FAILURE(run_points(third, turning_job(quick, seed))) << "run " << run;
    ASSERT_NO_FATAL_FAILURE(expect_same_steps(first.log, second.log)) << "run " << run;
    late += late_steps(first.log, third.log);
  }
  EXPECT_GT(late, static_cast<std::size_t>(scaled(10)) * 20);
}

/// Random moves back and forth on all axes, fast and slow, some steps long.
std::string zigzag(std::mt19937_64& random, int lines) {
  std::string text = "G21 G91 G1\n";
  const Pick<double> pick(random);
  int way = 1;
  for (int i = 0; i < lines; ++i, way = -way)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f} F{:.0f}\n", way * pick(0, 0.3),
                        -way * pick(-0.05, 0.3), pick(-0.02, 0.02), pick(10, 9000));
  return text;
}

TEST(PulseModes, ProgramsStepAtTheSameTicksInEveryModeAndLoseNothing) {
  std::mt19937_64 random(2);
  std::size_t reversals = 0;
  for (int run = 0; run < scaled(12); ++run) {
    job::Profile plain = jumping_profile(100, LampMode::free_beat);
    set_random_times(plain.settings, random);
    job::Profile other = plain;
    set_random_pulses(other.settings, random);
    ExactProgram exact(static_cast<unsigned>(run));
    std::string text = zigzag(random, 60) + "G90\n";
    for (int i = 0; i < 12; ++i) text += exact.lines();
    text += zigzag(random, 30) + "$J=G91 X0.4 F5000\n$J=G91 X-0.2 Y0.1 F5000\n";
    LoggedRig first(plain), second(other);
    for (LoggedRig* rig : {&first, &second}) {
      ProgramHost host(*rig);
      ASSERT_TRUE(host.stream(text)) << text;
      host.run_ms(5);
      rig->expect_drives_followed();
      EXPECT_EQ(rig->board.world().drives().position(), host.position());
    }
    EXPECT_EQ(first.board.world().drives().position(), second.board.world().drives().position());
    ASSERT_NO_FATAL_FAILURE(expect_same_steps(first.log, second.log)) << "run " << run;
    for (int axis = 0; axis < 3; ++axis) reversals += first.log.reversals(axis).size();
  }
  EXPECT_GT(reversals, static_cast<std::size_t>(scaled(12)) * 50);
}

/// The position of an axis at this time.
std::int32_t place_at(const std::vector<PinMonitor::Step>& steps, Picoseconds at) {
  const auto next = std::partition_point(
      steps.begin(), steps.end(), [at](const PinMonitor::Step& step) { return step.at <= at; });
  return next == steps.begin() ? 0 : std::prev(next)->position;
}

/// Also while steps are delayed: only steps that were output count, and levels continue from there.
TEST(PulseModes, AnImmediateStopKeepsTheDrivesPositions) {
  std::mt19937_64 random(3);
  job::Profile profile = jumping_profile(1000, LampMode::slave);
  LoggedRig quick(profile);
  ASSERT_EQ(run_job(quick, turning_job(profile, 1)).end, JobEnd::done);
  const std::vector<Picoseconds> reversals = quick.log.reversals(0);
  ASSERT_GT(reversals.size(), 100u);
  set_pulses(profile.settings, all_step_dir, 0, 0, 20'000, 20'000);
  int owed = 0;
  for (int run = 0; run < scaled(60); ++run) {
    set_random_pulses(profile.settings, random);
    LoggedRig rig(profile);
    // Shortly before or after a step in the other direction, which has to wait.
    const Picoseconds stop = reversals[random() % reversals.size()] +
                             (static_cast<Picoseconds>(random() % 60) - 20) * ps_per_us +
                             ps_per_us / 2;
    rig.press(sim::Pin::estop, stop, stop + 5 * ps_per_ms);
    ASSERT_EQ(run_job(rig, turning_job(profile, 1)).end, JobEnd::alarm);
    const StepPosition stopped = rig.board.world().drives().position();
    owed += stopped[0] != place_at(quick.log.steps()[0], stop) ? 1 : 0;
    ProgramHost host(rig);
    host.run_ms(60);
    ASSERT_EQ(host.position(), stopped) << "run " << run;
    ASSERT_EQ(rig.board.world().drives().position(), stopped) << "run " << run;
    host.ask("$X\n");
    ASSERT_TRUE(host.stream(zigzag(random, 10))) << "run " << run;
    host.run_ms(5);
    EXPECT_NE(host.position(), stopped);
    EXPECT_EQ(rig.board.world().drives().position(), host.position()) << "run " << run;
    rig.expect_drives_followed();
  }
  EXPECT_GT(owed, scaled(60) / 10);
}

}  // namespace
}  // namespace lamplock::test
