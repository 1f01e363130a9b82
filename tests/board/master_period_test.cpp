// A lamp that the board triggers: its period varies inside the tolerance when that saves a beat.
#include <algorithm>

#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

job::Profile master_profile(double hz, double tolerance_percent, double accel_m_s2 = 4) {
  job::Profile profile = lamp_profile(hz, LampMode::master, accel_m_s2);
  job::state_setting(profile, Id::period_tolerance, tolerance_percent, "test");
  return profile;
}

/// Time from the first step to the last shot, including the move to the first point.
double seconds(const Rig& rig) {
  return sim::seconds(rig.monitor.fires().back().rise - rig.monitor.first_step());
}

struct Outcome {
  double seconds = 0;
  std::uint32_t beats = 0;
  bool stretched = false;
};

void run(const job::Profile& profile, const geometry::PointCloud& cloud, JoinMode mode,
         Outcome& outcome) {
  const job::Job job = job_for(cloud, profile, mode);
  Rig rig(profile);
  link::JobResult result;
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, false, result));
  EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
  EXPECT_EQ(result.status.starvations, 0u);
  const double nominal = 1e15 / profile.settings.milli(Id::lamp_frequency);
  const double tolerance = profile.settings.milli(Id::period_tolerance) / 1e5;
  const auto& edges = rig.monitor.edges();
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const auto gap = static_cast<double>(edges[i] - edges[i - 1]);
    // At a change the delay has ticks of one length and the beat ticks of the other: 1 us.
    ASSERT_LE(std::fabs(gap / nominal - 1), tolerance + 1.1e6 / nominal) << "edge " << i;
    outcome.stretched = outcome.stretched || gap > nominal * 1.001;
  }
  // The shot is also right in real time: within 1 us of its lattice tick.
  for (const PinMonitor::Fire& fire : rig.monitor.fires())
    ASSERT_LE(
        std::abs(fire.rise - fire.edge - profile.settings.milli(Id::q_switch_delay) * ps_per_ns),
        4 * sim::ps_per_clock);
  outcome.seconds = seconds(rig);
  outcome.beats = result.status.beats;
}

/// Holds a job and resumes it, again and again at random moments.
void hold_now_and_then(Rig& rig, BoardCable& cable, std::mt19937_64& random) {
  machine::Controller& core = rig.board.controller();
  if (core.state() == MachineState::run && core.job_unfinished()) {
    core.on_command({wire::Command::hold, 0});
    rig.run(static_cast<Picoseconds>(random() % 80) * ps_per_ms);
    core.on_command({wire::Command::resume, 0});
  }
  cable.at(rig.now() + static_cast<Picoseconds>(random() % 200'000) * ps_per_us,
           [&] { hold_now_and_then(rig, cable, random); });
}

/// Steps that take 1.02 beats from rest to rest at 100 Hz and 4 m/s2: A T^2 / 4.
geometry::PointCloud just_too_far(std::size_t count) {
  const double mm = 4000 * 0.0102 * 0.0102 / 4;
  geometry::PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    cloud.push_back({i % 2 == 0 ? 0 : mm, 0.005 * static_cast<double>(i % 7), 0});
  return cloud;
}

TEST(MasterPeriod, OneLongerBeatInsteadOfTwo) {
  Outcome nominal, longer;
  ASSERT_NO_FATAL_FAILURE(
      run(master_profile(100, 0), just_too_far(200), JoinMode::start_stop, nominal));
  ASSERT_NO_FATAL_FAILURE(
      run(master_profile(100, 5), just_too_far(200), JoinMode::start_stop, longer));
  EXPECT_FALSE(nominal.stretched);
  EXPECT_TRUE(longer.stretched);
  EXPECT_EQ(nominal.beats, 2u * 199 + 1);
  EXPECT_EQ(longer.beats, 200u);
  EXPECT_LT(longer.seconds, 0.54 * nominal.seconds);
}

TEST(MasterPeriod, NeverTakesLongerOnRandomWalks) {
  int stretched = 0;
  for (int seed = 0; seed < std::max(12, scaled(12)); ++seed) {
    const double hz = std::array{100.0, 50.0, 200.0, 1000.0}[static_cast<std::size_t>(seed % 4)];
    const double tolerance = std::array{1.0, 3.0, 10.0}[static_cast<std::size_t>(seed % 3)];
    const JoinMode mode = both_modes[seed / 2 % 2];
    const auto cloud = histogram_walk(seed % 5 == 4 ? 12 : 250, static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(testing::Message()
                 << "seed " << seed << ", " << hz << " Hz, " << tolerance << " %");
    Outcome nominal, longer;
    ASSERT_NO_FATAL_FAILURE(run(master_profile(hz, 0), cloud, mode, nominal));
    ASSERT_NO_FATAL_FAILURE(run(master_profile(hz, tolerance), cloud, mode, longer));
    // The time of a start's first step depends on its acceleration.
    EXPECT_LE(longer.seconds, nominal.seconds + 1e-4);
    if (longer.stretched) ++stretched;
  }
  EXPECT_GT(stretched, 0);
}

TEST(MasterPeriod, HoldsAndDropOutsStayInsideTheLimits) {
  std::mt19937_64 random(93);
  for (int seed = 0; seed < scaled(8); ++seed) {
    const job::Profile profile = master_profile(100, 10);
    const job::Job job = job_for(histogram_walk(150, static_cast<std::uint64_t>(seed)), profile,
                                 JoinMode::start_stop);
    Rig rig(profile, {.dropout = 0.03, .seed = static_cast<std::uint64_t>(seed) + 1});
    // Holds occur at any moment, in longer ticks too.
    BoardCable cable(rig);
    cable.at(300 * ps_per_ms, [&] { hold_now_and_then(rig, cable, random); });
    const link::JobResult result = link::JobSender(cable, job, session(1)).run();
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    expect_sound(rig, profile.settings);
  }
}

}  // namespace
}  // namespace lamplock::test
