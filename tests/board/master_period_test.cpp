// A lamp that the board triggers: its period varies inside the tolerance when that saves a beat.
#include <algorithm>

#include "tests/board/rig.hpp"

namespace lamplock::test {
namespace {

using settings::LampMode;

job::Profile master_profile(double hz, double tolerance_percent, double accel_m_s2 = 4) {
  job::Profile profile = lamp_profile(hz, LampMode::master, accel_m_s2);
  job::state_setting(profile, Id::period_tolerance, tolerance_percent, "test");
  return profile;
}

/// Time from the first step to the last shot, including the move to the first point.
double seconds(const Rig& rig) {
  sim::Picoseconds first = sim::never;
  for (int axis = 0; axis < 3; ++axis)
    if (!rig.monitor.steps(axis).empty())
      first = std::min(first, rig.monitor.steps(axis).front().at);
  return static_cast<double>(rig.monitor.fires().back().rise - first) * 1e-12;
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
    ASSERT_LE(std::abs(fire.rise - fire.edge -
                       profile.settings.milli(Id::q_switch_delay) * sim::ps_per_ns),
              4 * sim::ps_per_clock);
  outcome.seconds = seconds(rig);
  outcome.beats = result.status.beats;
}

/// A cable that holds and resumes at random moments.
class HoldingTransport final : public link::Transport {
 public:
  HoldingTransport(sim::VirtualBoard& board, std::uint64_t seed)
      : board_(board), inner_(board), random_(seed) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override { return inner_.write(bytes); }
  std::size_t read(std::span<std::uint8_t> bytes) override { return inner_.read(bytes); }
  void wait(std::chrono::microseconds time) override {
    if (board_.now() >= next_) {
      machine::Controller& core = board_.controller();
      if (core.state() == MachineState::run && core.job_unfinished()) {
        core.on_command({wire::Command::hold, 0});
        board_.run_until(board_.now() + static_cast<sim::Picoseconds>(random_() % 80) * ps_per_ms);
        core.on_command({wire::Command::resume, 0});
      }
      next_ = board_.now() + static_cast<sim::Picoseconds>(random_() % 200'000) * ps_per_us;
    }
    inner_.wait(std::min(time, std::chrono::microseconds(5000)));
  }
  std::chrono::microseconds now() const override { return inner_.now(); }
  bool reconnect() override { return true; }

 private:
  sim::VirtualBoard& board_;
  link::SimulatedTransport inner_;
  std::mt19937_64 random_;
  sim::Picoseconds next_ = 300 * ps_per_ms;
};

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
    link::SenderOptions sending;
    sending.session = 1;
    // Holds occur at any moment, in longer ticks too.
    const link::JobResult result = [&] {
      HoldingTransport holding(rig.board, random());
      return link::JobSender(holding, job, sending).run();
    }();
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_EQ(result.end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    expect_sound(rig, profile.settings);
  }
}

}  // namespace
}  // namespace lamplock::test
