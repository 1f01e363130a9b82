// Points per second at kilohertz lamps: planned on core 1, streamed over USB meanwhile.
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

/// Most shots on beats one behind the other.
std::size_t longest_run(const sim::Shots& shots) {
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

/// On the virtual board, where planning takes no time.
double virtual_beats(const job::Profile& profile, const job::Job& job) {
  sim::VirtualBoard board(profile.settings, chip_world(profile));
  link::SimulatedTransport transport(board);
  EXPECT_EQ(link::JobSender(transport, job, RunningJob::options(1, 0)).run().end,
            link::JobEnd::done);
  return beats_of(board.world().laser().shots());
}

/// Runs a job; how much of it is left to the caller to judge.
void run(ChipRig& rig, const job::Job& job) {
  const sim::BoardTiming timing(rig.board, flash_image());
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  RunningJob running(rig, job, 1);
  ASSERT_EQ(running.finish(), link::JobEnd::done);
  expect_fired(rig, job);
  expect_no_violations(rig);
  const Picoseconds delay = Picoseconds{5} * ps_per_us;
  std::cout << sim::timing_text(timing.table(delay));
}

TEST(Throughput, ARowIsFiredAtEveryBeatOf4Kilohertz) {
  const job::Profile profile = quick_profile(4000);
  // More than the queue holds. At the end nobody knows of a row that would pay for its speed.
  const std::size_t points = 1400;
  points::PointCloud row;
  for (std::size_t i = 0; i < points; ++i)
    row.push_back({-28 + 0.04 * static_cast<double>(i), 0, 0});
  const job::Job job = job::make_job(row, profile, {});
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(run(rig, job));
  std::cout << longest_run(rig.shots()) << " of " << points << " points at 4000 points/s\n";
  EXPECT_GE(longest_run(rig.shots()), 1000u);
}

TEST(Throughput, UnevenCloudsAreNotWaitedFor) {
  const job::Profile profile = quick_profile(4000);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0, 1);
  points::PointCloud cloud;
  std::array<double, 3> at{};
  for (std::size_t i = 0; i < 320; ++i) {
    const double length = 0.005 * std::pow(6, part(random));
    std::array<double, 3> way{normal(random), normal(random), normal(random)};
    const double norm = std::hypot(way[0], way[1], way[2]);
    for (std::size_t a = 0; a < 3; ++a) at[a] += length * way[a] / norm;
    cloud.push_back({at[0], at[1], at[2]});
  }
  const job::Job job = job::make_job(cloud, profile, {});
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(run(rig, job));
  const double beats = beats_of(rig.shots()), least = virtual_beats(profile, job);
  std::cout << 4000.0 * static_cast<double>(cloud.size()) / beats << " points/s in " << beats
            << " beats; planned in no time " << least << " beats\n";
  EXPECT_LE(beats, 1.1 * least);
}

}  // namespace
}  // namespace lamplock::test
