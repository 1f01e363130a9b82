// Points per second at kilohertz lamps, planned on core 1 while streamed over USB.
#include <algorithm>
#include <cmath>

#include "host/link/simulated_transport.hpp"
#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// A machine with 5 um steps, 10 m/s2, 1 m/s.
job::Profile quick_profile(double lamp_hz) {
  job::Profile profile = chip_profile(lamp_hz);
  job::set_acceleration(profile, 10);
  job::set_speed(profile, 1);
  return profile;
}

/// Largest number of shots on consecutive beats.
std::size_t max_run(const sim::Shots& shots) {
  std::size_t longest = 0;
  for (std::size_t i = 0, run = 0; i < shots.size(); ++i) {
    run = i != 0 && shots[i].beat == shots[i - 1].beat + 1 ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  return longest;
}

double beats_of(const sim::Shots& shots) {
  return static_cast<double>(shots.back().beat - shots.front().beat);
}

/// Beats on the virtual board, where planning takes no time.
double virtual_beats(const job::Profile& profile, const job::Job& job) {
  sim::VirtualBoard board(profile.settings, world_for(profile));
  link::SimulatedTransport transport(board);
  EXPECT_EQ(link::JobSender(transport, job, RunningJob::options(1, 0)).run().end, JobEnd::done);
  return beats_of(board.world().laser().shots());
}

/// Runs a job; the caller judges its speed. With `flooded`, status queries and invalid lines arrive
/// as fast as the board accepts them.
void run(ChipRig& rig, const job::Job& job, bool flooded = false) {
  const sim::BoardTiming timing(rig.board, flash_image());
  RunningJob running(rig, job, 1);
  std::mt19937_64 random(4);
  std::size_t junk = 0;
  while (flooded && running.sender.step() && rig.now() < running.limit()) {
    if (rig.board.usb_host().unsent() != 0) continue;
    rig.type(random() % 4 == 0 ? std::string(random() % 200, 'j') + "\n" : "?");
    ++junk;
  }
  ASSERT_EQ(running.finish(), JobEnd::done);
  expect_fired(rig, job);
  const Picoseconds delay = Picoseconds{5} * ps_per_us;
  std::cout << sim::timing_text(timing.table(delay));
  if (flooded) std::cout << junk << " requests and lines of junk\n";
}

/// Regular rows there and back along x.
job::Job rows(const job::Profile& profile, std::size_t count, std::size_t points,
              double spacing_mm = 0.04) {
  geometry::PointCloud cloud;
  for (std::size_t row = 0; row < count; ++row)
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t at = row % 2 == 0 ? i : points - 1 - i;
      cloud.push_back(
          {-28 + spacing_mm * static_cast<double>(at), 0.2 * static_cast<double>(row), 0});
    }
  return job::make_job(cloud, profile, {});
}

/// Moves of random length in random directions.
job::Job uneven_cloud(const job::Profile& profile, std::size_t points, double min_mm,
                      double max_mm) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0, 1);
  geometry::PointCloud cloud;
  std::array<double, 3> at{};
  for (std::size_t i = 0; i < points; ++i) {
    const double length = min_mm * std::pow(max_mm / min_mm, part(random));
    std::array<double, 3> way{normal(random), normal(random), normal(random)};
    const double norm = std::hypot(way[0], way[1], way[2]);
    for (std::size_t a = 0; a < 3; ++a) at[a] += length * way[a] / norm;
    cloud.push_back({at[0], at[1], at[2]});
  }
  return job::make_job(cloud, profile, {});
}

/// The queue holds fewer points than a row has. At the end of the last row there is no further row
/// that would use its speed.
TEST(Throughput, ARowIsFiredAtEveryBeatOf4Kilohertz) {
  const job::Profile profile = quick_profile(4000);
  const std::size_t points = 1400;
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(run(rig, rows(profile, 1, points)));
  std::cout << max_run(rig.shots()) << " of " << points << " points at 4000 points/s\n";
  EXPECT_GE(max_run(rig.shots()), points - 32);
}

TEST(Throughput, RowsFollowEachOtherWithABusyLink) {
  const job::Profile profile = quick_profile(4000);
  ChipRig rig(profile);
  const job::Job job = rows(profile, 2, 1100);
  ASSERT_NO_FATAL_FAILURE(run(rig, job, true));
  const double beats = beats_of(rig.shots()), least = virtual_beats(profile, job);
  std::cout << max_run(rig.shots()) << " of 1100 points at 4000 points/s, " << beats
            << " beats; planned in no time and a quiet link " << least << " beats\n";
  EXPECT_GE(max_run(rig.shots()), 1000u);
  EXPECT_LE(beats, 1.1 * least);
}

/// A row 20 um apart of which all points but the last ones are fired on consecutive beats.
void expect_a_row_on_every_beat(const job::Profile& profile) {
  const std::size_t points = 1400;
  ChipRig rig(profile);
  const job::Job job = rows(profile, 1, points, 0.02);
  ASSERT_NO_FATAL_FAILURE(run(rig, job));
  std::cout << max_run(rig.shots()) << " of " << points << " points at "
            << profile.settings.milli(Id::lamp_frequency) / 1000 << " points/s\n";
  EXPECT_GE(max_run(rig.shots()), points - 32);
}

/// A machine with a free beat.
job::Profile free_profile(double lamp_hz) {
  job::Profile profile = quick_profile(lamp_hz);
  profile.settings.set_milli(Id::lamp_mode, static_cast<int>(settings::LampMode::free_beat));
  profile.settings.set_milli(Id::max_shot_rate, profile.settings.milli(Id::lamp_frequency));
  job::state_setting(profile, Id::q_switch_width, 60, "test");
  return profile;
}

TEST(Throughput, ARowIsFiredAtEveryFreeBeatOf4500Hertz) {
  expect_a_row_on_every_beat(free_profile(4500));
}

/// Rows with a step of noise across and along, at accelerations that give a high step rate: the
/// fill interrupt must keep up, or the ticks run out.
TEST(Throughput, NoisyRowsOverloadNothing) {
  struct Machine {
    double lamp_hz, steps_per_mm;
  };
  for (const auto& [lamp_hz, steps_per_mm] : {Machine{5000, 2000}, Machine{3000, 8000}}) {
    SCOPED_TRACE(testing::Message() << lamp_hz << " Hz, " << steps_per_mm << " steps/mm");
    job::Profile profile = chip_profile(lamp_hz);
    job::set_acceleration(profile, 30);
    job::set_speed(profile, 0.05);
    for (int axis = 0; axis < 3; ++axis)
      job::state_setting(profile, settings::for_axis(Id::steps_per_mm_x, axis), steps_per_mm,
                         "test");
    std::mt19937_64 random(5);
    const auto noise = [&] { return static_cast<double>(random() % 3) / steps_per_mm; };
    geometry::PointCloud cloud;
    for (int i = 0; i < 400; ++i) {
      const double along = 32 / lamp_hz * i + noise(), y = noise(), z = noise();
      cloud.push_back({along, y, z});
    }
    ChipRig rig(profile);
    rig.heard.clear();
    const sim::BoardTiming timing(rig.board, flash_image());
    const job::Job job = job::make_job(cloud, profile, {});
    RunningJob running(rig, job, 1);
    EXPECT_TRUE(running.run_until_fired(150));
    rig.run(20 * ps_per_ms);
    rig.listen();
    EXPECT_THAT(rig.heard, Not(HasSubstr("ALARM")));
    EXPECT_THAT(rig.status(), Not(HasSubstr("<Alarm")));
    expect_fired_so_far(rig, job);
    double max_us = 0;
    for (const sim::chip::ProfileEntry& entry : timing.profile().exceptions())
      if (entry.name == "exception 42") max_us = static_cast<double>(entry.longest) / 125;
    std::cout << "fill at most " << max_us << " us\n";
    EXPECT_GT(max_us, 0);
    EXPECT_LE(max_us, 2000);
  }
}

/// 1500 irregular points per second.
TEST(Throughput, IrregularCloudsCostNoWaiting) {
  job::Profile profile = quick_profile(5000);
  job::set_acceleration(profile, 20);
  const job::Job job = uneven_cloud(profile, 400, 0.001, 0.008);
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(run(rig, job, true));
  const double beats = beats_of(rig.shots()), least = virtual_beats(profile, job);
  const double rate = 5000.0 * static_cast<double>(job.targets.size()) / beats;
  std::cout << rate << " points/s in " << beats << " beats; planned in no time " << least
            << " beats\n";
  EXPECT_LE(beats, 1.02 * least);
  EXPECT_GE(rate, 1500.0);
}

// With the image for 200 MHz alone.

TEST(ThroughputAt200Megahertz, ARowIsFiredAtEveryBeatOf5Kilohertz) {
  expect_a_row_on_every_beat(quick_profile(5000));
}

TEST(ThroughputAt200Megahertz, ARowIsFiredAtEveryFreeBeatOf8Kilohertz) {
  expect_a_row_on_every_beat(free_profile(8000));
}

/// 160 m/s2 would permit 3360 points a second: the planner limits them.
TEST(ThroughputAt200Megahertz, ThePlannerPlans3000IrregularPointsASecond) {
  job::Profile profile = quick_profile(5000);
  job::set_acceleration(profile, 160);
  const job::Job job = uneven_cloud(profile, 1000, 0.001, 0.008);
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(run(rig, job));
  const double rate = 5000.0 * static_cast<double>(job.targets.size()) / beats_of(rig.shots());
  std::cout << rate << " points/s\n";
  EXPECT_GE(rate, 3000.0);
}

/// The token of a shot is loaded half a beat before its edge, however long the delay from the edge
/// to the shot is.
TEST(Throughput, ALongShotDelayMissesNoBeat) {
  job::Profile profile = quick_profile(4000);
  job::state_setting(profile, Id::q_switch_delay, 150, "test");
  job::state_setting(profile, Id::q_switch_width, 20, "test");
  ChipRig rig(profile);
  const job::Job job = rows(profile, 1, 400);
  ASSERT_NO_FATAL_FAILURE(run(rig, job));
  EXPECT_GE(max_run(rig.shots()), 300u);
}

/// With a delay of most of a beat the flash after one that fails comes before the lattice tick of
/// that shot.
TEST(Throughput, AfterAFailedFlashALongShotDelayFiresNoOtherPoint) {
  job::Profile profile = quick_profile(4000);
  job::state_setting(profile, Id::lamp_mode, static_cast<int>(settings::LampMode::slave), "test");
  job::state_setting(profile, Id::q_switch_delay, 210, "test");
  job::state_setting(profile, Id::q_switch_width, 20, "test");
  ChipRig rig(profile.settings, world_for(profile, {.dropout = 0.03, .seed = 2}));
  ASSERT_NO_FATAL_FAILURE(run(rig, rows(profile, 1, 200, 0.01)));
}

}  // namespace
}  // namespace lamplock::test
