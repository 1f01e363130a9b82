// Lamps that stop or change frequency, hosts that are too slow: the job takes longer, no point is
// lost.
#include "tests/board/board_cable.hpp"
#include "tests/board/scripted_lamp.hpp"

namespace lamplock::test {
namespace {

constexpr Picoseconds period = 10 * ps_per_ms;

/// A job with a scripted lamp; shots are judged by the script's edges.
class ScriptedLamp : public testing::Test {
 protected:
  void run(const LampScript& script, int seed, JoinMode mode) {
    profile_ = lamp_profile();
    sim::WorldConfig world = dark_world();
    if (seed % 3 == 0) {
      set_lag(profile_, {0, 3000, 150});
      world.drives = world_for(profile_).drives;
    }
    job_ = job_for(histogram_walk(500, static_cast<std::uint64_t>(seed)), profile_, mode);
    rig_ = std::make_unique<Rig>(profile_.settings, world);
    script.connect(rig_->board);
    result_ = run_job(*rig_, job_);
    ASSERT_EQ(result_.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(*rig_, job_, true));
    EXPECT_EQ(rig_->monitor.violation(profile_.settings), "");
    EXPECT_FALSE(rig_->board.controller().runner().underrun());
    const auto delay = rig_->board.controller().fire_timing().delay_clocks * sim::ps_per_clock;
    for (const PinMonitor::Fire& fire : rig_->monitor.fires())
      ASSERT_LE(std::abs(fire.rise - fire.edge - delay), sim::ps_per_clock);
    const auto& reasons = result_.status.beats_by_reason;
    EXPECT_EQ(std::accumulate(reasons.begin(), reasons.end(), 0u), result_.status.beats);
  }
  std::int64_t edges_between_shots() const {
    const auto& edges = rig_->monitor.edges();
    const auto& fires = rig_->monitor.fires();
    return std::count_if(edges.begin(), edges.end(), [&](Picoseconds at) {
      return fires.front().edge <= at && at <= fires.back().edge;
    });
  }

  /// Flashes during the move to a point from rest to rest.
  double flashes_of_way(std::size_t point, Picoseconds flash) const {
    double max_s = 0;
    for (int axis = 0; axis < job_.header.axes; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const std::int32_t from = point == 0 ? 0 : job_.targets[point - 1].steps[a];
      const auto setting = [&](Id id) { return profile_.settings.milli(id, axis) / 1e3; };
      const double way_mm =
          std::abs(job_.targets[point].steps[a] - from) / setting(Id::steps_per_mm_x);
      const double v = setting(Id::max_rate_x) / 60, accel = setting(Id::acceleration_x);
      const double s =
          way_mm < v * v / accel ? 2 * std::sqrt(way_mm / accel) : way_mm / v + v / accel;
      max_s = std::max(max_s, s);
    }
    return std::ceil(max_s * 1e12 / static_cast<double>(flash));
  }

  job::Profile profile_;
  job::Job job_;
  std::unique_ptr<Rig> rig_;
  link::JobResult result_;
};

TEST_F(ScriptedLamp, StopsForASecond) {
  for (int seed = 0; seed < scaled(12); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    LampScript script;
    // The lamp returns at any phase.
    script.flash(period, (900 + 37 * (seed % 60)) * ps_per_ms)
        .dark(ps_per_s + (seed % 500) * 1'234'567 * ps_per_ns)
        .flash(period, 20 * ps_per_s);
    ASSERT_NO_FATAL_FAILURE(run(script, seed, both_modes[seed % 2]));
    EXPECT_EQ(rig_->board.controller().clock().lock_losses(), 1u);
    EXPECT_GT(beats_of(result_.status, BeatReason::not_locked), 0u);
    // Beats are the lamp's periods: every edge counts, except those that the clock missed before it
    // lost the lock.
    EXPECT_EQ(result_.status.beats - beats_of(result_.status, BeatReason::no_edge),
              edges_between_shots());
  }
}

TEST_F(ScriptedLamp, StopsBrieflyWithoutLosingTheLock) {
  for (int seed = 0; seed < scaled(12); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    LampScript script;
    const int missing = 1 + seed % 20;
    script.flash(period, (900 + 37 * (seed % 60)) * ps_per_ms)
        .dark(missing * period)
        .flash(period, 20 * ps_per_s);
    ASSERT_NO_FATAL_FAILURE(run(script, seed, both_modes[seed % 2]));
    EXPECT_EQ(rig_->board.controller().clock().lock_losses(), 0u);
    EXPECT_EQ(beats_of(result_.status, BeatReason::no_edge), static_cast<std::uint32_t>(missing));
    EXPECT_EQ(result_.status.beats, edges_between_shots() + missing);
  }
}

TEST_F(ScriptedLamp, JumpsInFrequency) {
  for (const double jump : {0.985, 1.015, 0.995, 1.005}) {
    for (const JoinMode mode : both_modes) {
      SCOPED_TRACE(testing::Message() << "period x " << jump);
      LampScript script;
      const auto other = static_cast<Picoseconds>(static_cast<double>(period) * jump);
      script.flash(period, 1300 * ps_per_ms)
          .flash(other, 2 * ps_per_s)
          .flash(period, 20 * ps_per_s);
      ASSERT_NO_FATAL_FAILURE(run(script, 3, mode));
      EXPECT_EQ(result_.status.beats, edges_between_shots());
    }
  }
}

TEST_F(ScriptedLamp, JumpsAtAnyMomentAndIsFollowedWithinSixteenFlashes) {
  // Frequencies inside the lock range, from one end to the other.
  std::mt19937_64 random(61);
  const Pick<double> any(random);
  for (int seed = 0; seed < scaled(12); ++seed) {
    const auto first = static_cast<Picoseconds>(static_cast<double>(period) * any(0.975, 1.025));
    const auto second = static_cast<Picoseconds>(static_cast<double>(period) * any(0.975, 1.025));
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << first << " then " << second);
    LampScript script;
    const auto jump = static_cast<Picoseconds>(any(0.5, 4) * 1e12);
    script.flash(first, jump).flash(second, 30 * ps_per_s);
    ASSERT_NO_FATAL_FAILURE(run(script, seed, both_modes[seed % 2]));
    EXPECT_EQ(result_.status.beats, edges_between_shots());
    const auto& fires = rig_->monitor.fires();
    const auto at = std::find_if(fires.begin(), fires.end(), [&](const PinMonitor::Fire& fire) {
      return fire.edge > jump + 20 * period;
    });
    // The machine fires again after it has locked, come to rest and resumed; few moves take more
    // than 16 flashes themselves.
    ASSERT_NE(at, fires.end());
    const double way = flashes_of_way(static_cast<std::size_t>(at - fires.begin()), second);
    EXPECT_LT(at->edge, jump + (20 + std::max(16, static_cast<int>(way))) * period);
  }
}

TEST_F(ScriptedLamp, RunsAtAFrequencyOutsideTheRangeForAWhile) {
  // No shot and no motion at that frequency; the job resumes when the lamp is back.
  const double ratios[] = {0.9, 0.95, 1.05, 1.1, 0.5, 2, 1.5, 3, 1.0 / 3};
  for (int seed = 0; seed < scaled(9); ++seed) {
    const double ratio = ratios[seed % 9];
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", period x " << ratio);
    const Picoseconds leaves = ps_per_s + seed * 7 * ps_per_ms;
    const Picoseconds away = 2 * ps_per_s;
    LampScript script;
    script.flash(period, leaves)
        .flash(static_cast<Picoseconds>(static_cast<double>(period) * ratio), away)
        .flash(period, 20 * ps_per_s);
    ASSERT_NO_FATAL_FAILURE(run(script, seed, both_modes[seed % 2]));
    // The clock needs some flashes to detect a permanent change.
    const Picoseconds noticed =
        leaves +
        25 * std::max(period, static_cast<Picoseconds>(static_cast<double>(period) * ratio));
    EXPECT_EQ(rig_->monitor.fired(noticed, leaves + away), 0u);
    EXPECT_FALSE(rig_->monitor.stepped(noticed, leaves + away));
    EXPECT_GT(beats_of(result_.status, BeatReason::not_locked), 10u);
    EXPECT_GE(rig_->board.controller().clock().lock_losses(), 1u);
    EXPECT_GT(rig_->monitor.fired(leaves + away, leaves + away + 40 * period), 0u);
  }
}

/// A cable to a host that pauses.
class SleepyTransport final : public link::Transport {
 public:
  SleepyTransport(sim::VirtualBoard& board, std::chrono::milliseconds nap)
      : inner_(board), nap_(nap) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    // A dozen points, then a pause.
    const std::size_t taken = inner_.write(bytes.first(std::min<std::size_t>(bytes.size(), 100)));
    if (taken > 80) inner_.wait(nap_);
    return taken;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override { return inner_.read(bytes); }
  void wait(std::chrono::microseconds time) override { inner_.wait(time); }
  std::chrono::microseconds now() const override { return inner_.now(); }
  bool reconnect() override { return true; }

 private:
  link::SimulatedTransport inner_;
  std::chrono::microseconds nap_;
};

TEST(StarvedHost, SlowsDownAndLosesNothing) {
  for (const JoinMode mode : both_modes) {
    for (int seed = 0; seed < scaled(4); ++seed) {
      const job::Profile profile = lamp_profile(200, LampMode::slave, 10);
      const job::Job job =
          job_for(histogram_walk(400, static_cast<std::uint64_t>(seed)), profile, mode);
      Rig rig(profile);
      SleepyTransport transport(rig.board, std::chrono::milliseconds(300));
      const link::JobResult result = link::JobSender(transport, job, session(1)).run();
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      ASSERT_EQ(result.end, JobEnd::done);
      ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
      expect_sound(rig, profile.settings);
      expect_ledger(rig, result.status);
      EXPECT_GT(result.status.starvations, 2u);
      EXPECT_GT(beats_of(result.status, BeatReason::starved), 0u);
    }
  }
}

}  // namespace
}  // namespace lamplock::test
