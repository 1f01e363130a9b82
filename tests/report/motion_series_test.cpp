// Series for plots: values of the ticks within limits, compared with the output of the pins.
#include "host/report/motion_series.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/report/traced_run.hpp"

namespace lamplock::test {
namespace {

using report::AxisSeries;
using report::Curve;
using report::MotionSeries;
using settings::LampMode;

constexpr JoinMode all_modes[] = {JoinMode::free, JoinMode::path, JoinMode::start_stop};

job::Job wild_job(const job::Profile& profile, std::uint64_t seed, JoinMode mode,
                  std::size_t points = 40) {
  job::JobOptions options;
  options.mode = mode;
  return job::make_job(wild_points(points, seed), profile, options);
}

/// Value of a curve, linearly interpolated between its vertices.
double at(const Curve& curve, double beat) {
  const auto after = std::upper_bound(curve.begin(), curve.end(), beat,
                                      [](double b, const report::Vertex& v) { return b < v.beat; });
  if (after == curve.begin()) return curve.front().value;
  if (after == curve.end()) return curve.back().value;
  const report::Vertex &a = after[-1], &b = *after;
  return a.value + (b.value - a.value) * (beat - a.beat) / (b.beat - a.beat);
}

/// Time with a perfectly stable lamp, s.
double seconds_of(double beats, const MotionSeries& series) {
  return beats * series.beat_ms * 1e-3;
}

TEST(MotionSeries, SpeedsAndAccelerationsStayInsideTheLimits) {
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(8)); ++seed)
    for (const JoinMode mode : all_modes) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      const job::Profile profile = lamp_profile(seed % 2 == 0 ? 100 : 1000, LampMode::slave, 3);
      sim::LampConfig lamp;
      lamp.jitter_us = 10;
      lamp.dropout = 0.02;
      lamp.seed = seed + 1;
      const TracedRun run(profile, wild_job(profile, seed, mode), all_beats, lamp);
      const MotionSeries series = run.series(all_beats);
      ASSERT_EQ(series.axes.size(), 3u);
      // A tick may be stretched or shrunk by the slew limit while the machine moves.
      const double slew = 1 + 2 * profile.settings.milli(Id::slew_limit) * 1e-5;
      double most = 0;
      for (const AxisSeries& axis : series.axes) {
        EXPECT_DOUBLE_EQ(axis.max_speed_m_s, 1);
        EXPECT_DOUBLE_EQ(axis.max_accel_m_s2, 3);
        for (const report::Vertex& v : axis.speed_m_s) ASSERT_LE(std::fabs(v.value), slew);
        for (const report::Vertex& v : axis.accel_m_s2) {
          ASSERT_LE(std::fabs(v.value), 3 * slew * slew);
          most = std::max(most, std::fabs(v.value));
        }
      }
      EXPECT_GT(most, 2.5) << "these jobs need high accelerations: are they scaled wrongly?";
    }
}

TEST(MotionSeries, EachCurveIsTheSlopeOfTheOneAbove) {
  for (const JoinMode mode : all_modes) {
    const job::Profile profile = lamp_profile(200, LampMode::free_beat);
    const TracedRun run(profile, wild_job(profile, 7, mode), all_beats);
    const MotionSeries series = run.series(all_beats);
    for (const AxisSeries& axis : series.axes) {
      const Curve &v = axis.speed_m_s, &a = axis.accel_m_s2, &x = axis.position_mm;
      ASSERT_EQ(v.size(), a.size());
      for (std::size_t i = 0; i + 1 < v.size(); i += 2) {
        ASSERT_EQ(v[i].beat, a[i].beat);
        const double time = seconds_of(v[i + 1].beat - v[i].beat, series);
        ASSERT_NEAR(v[i + 1].value - v[i].value, (a[i].value + a[i + 1].value) / 2 * time, 1e-9);
        const double way = at(x, v[i + 1].beat) - at(x, v[i].beat);
        ASSERT_NEAR(way, (v[i].value + v[i + 1].value) / 2 * time * 1e3, 1e-6);
        if (i == 0) continue;
        ASSERT_NEAR(v[i].beat, v[i - 1].beat, 1e-9) << "a gap";
        // Unless a speed jump is set, paths have full stops at their corners.
        ASSERT_NEAR(v[i].value, v[i - 1].value, 1e-9) << "a jump in speed";
      }
    }
  }
}

TEST(MotionSeries, PositionsMatchThePins) {
  const job::Profile profile = lamp_profile(200, LampMode::free_beat);
  const TracedRun run(profile, wild_job(profile, 8, JoinMode::free), all_beats);
  const MotionSeries series = run.series({0, 100});
  const sim::Picoseconds zero = run.trace.beats()[*run.trace.zero()].at;
  std::size_t compared = 0;
  for (const AxisSeries& axis : series.axes)
    for (const PinMonitor::Step& step : run.rig.monitor.steps(axis.number)) {
      const double beat = sim::seconds(step.at - zero) * 1e3 / series.beat_ms;
      if (beat < 0 || beat > 100) continue;
      // A step is output at the beginning of the tick that crosses its edge: upwards the edge below
      // the new position, downwards the edge above it.
      const double steps = at(axis.position_mm, beat) * 200 + 0.5;
      const double edge = std::round(steps);
      ASSERT_TRUE(edge == step.position || edge == step.position + 1) << beat;
      ASSERT_NEAR(steps, edge, 0.25) << beat;  // distance of a tick at 1 m/s
      ++compared;
    }
  EXPECT_GT(compared, 10'000u);
}

TEST(MotionSeries, ShotsAreAtTheirPointsAndBeats) {
  const job::Profile profile = lamp_profile();
  sim::LampConfig lamp;
  lamp.dropout = 0.1;
  const TracedRun run(profile, wild_job(profile, 9, JoinMode::free), all_beats, lamp);
  const MotionSeries series = run.series(all_beats);
  ASSERT_EQ(series.shots.size(), run.rig.shots().size());
  EXPECT_EQ(series.shots.front().beat, 0);
  for (std::size_t i = 0; i < series.shots.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      ASSERT_NEAR(series.shots[i].position_mm[a] * 200, run.rig.board.lattice_shots()[i].steps[a],
                  1e-3);
  const auto count = [&series](auto which) {
    return static_cast<std::size_t>(std::count_if(series.beats.begin(), series.beats.end(), which));
  };
  EXPECT_EQ(count([](const auto& b) { return b.shot; }), series.shots.size());
  EXPECT_EQ(count([](const auto& b) { return b.beat >= 0 && !b.flash; }),
            beats_of(run.rig.status(), BeatReason::no_edge));
  EXPECT_GT(beats_of(run.rig.status(), BeatReason::no_edge), 0u);
}

TEST(MotionSeries, TicksFollowTheLamp) {
  job::Profile profile = lamp_profile(5);
  sim::LampConfig lamp;
  lamp.wander = 0.009;
  const job::Job job = wild_job(profile, 10, JoinMode::free, 30);
  EXPECT_LT(TracedRun(profile, job, all_beats).series(all_beats).tick_spread(), 2e-4);
  const double spread = TracedRun(profile, job, all_beats, lamp).series(all_beats).tick_spread();
  EXPECT_GT(spread, 0.004);
  EXPECT_LT(spread, 0.012);
}

TEST(MotionSeries, AWindowEqualsThatPartOfTheWhole) {
  const job::Profile profile = lamp_profile();
  const job::Job job = wild_job(profile, 11, JoinMode::free, 300);
  constexpr sim::BeatWindow part{200, 220};
  const TracedRun all(profile, job, all_beats), cut(profile, job, part);
  const TracedRun from_start(profile, job, {0, 220});
  EXPECT_LT(from_start.trace.pieces().size(), all.trace.pieces().size());
  EXPECT_LT(cut.trace.pieces().size(), from_start.trace.pieces().size() / 5);
  const MotionSeries whole = all.series(part, report::Fit::window);
  const MotionSeries window = cut.series(part, report::Fit::window);
  EXPECT_EQ(window.from, 200);
  EXPECT_EQ(window.to, 220);
  ASSERT_EQ(window.axes.size(), whole.axes.size());
  for (std::size_t a = 0; a < window.axes.size(); ++a)
    for (int part_of_beat = 0; part_of_beat <= 400; ++part_of_beat) {
      const double beat = 200 + part_of_beat / 20.0;
      EXPECT_NEAR(at(window.axes[a].position_mm, beat), at(whole.axes[a].position_mm, beat), 1e-4);
      EXPECT_NEAR(at(window.axes[a].speed_m_s, beat), at(whole.axes[a].speed_m_s, beat), 1e-9);
    }
  EXPECT_EQ(window.shots.size(), whole.shots.size());
  EXPECT_EQ(window.beats.size(), 21u);
}

TEST(MotionSeries, AHoldLastsAsLongAsTheWindow) {
  const job::Profile profile = lamp_profile();
  Rig rig(profile);
  const sim::MotionTrace trace(rig.board, all_beats, sim::MotionTrace::Zero::first_shot);
  link::SimulatedTransport transport(rig.board);
  const job::Job job = wild_job(profile, 14, JoinMode::free, 300);
  link::JobSender sender(transport, job, {});
  while (sender.points_fired() < 100) ASSERT_TRUE(sender.step());
  sender.pause();
  const auto resume = transport.now() + std::chrono::seconds(1);
  while (transport.now() < resume) ASSERT_TRUE(sender.step());
  sender.resume();
  while (sender.step()) {
  }
  const MotionSeries whole = motion_series(trace, profile.settings, all_beats, report::Fit::motion);
  ASSERT_EQ(whole.bands.size(), 1u);
  EXPECT_NEAR(whole.bands[0].to - whole.bands[0].from, 100, 15);
  // A window that ends in the middle of the hold.
  const auto middle = static_cast<std::int64_t>((whole.bands[0].from + whole.bands[0].to) / 2);
  for (const report::Fit fit : {report::Fit::motion, report::Fit::window}) {
    const MotionSeries part = motion_series(trace, profile.settings, {0, middle}, fit);
    EXPECT_EQ(part.to, static_cast<double>(middle));
    ASSERT_EQ(part.bands.size(), 1u);
    EXPECT_GE(part.bands[0].to, part.to);
    for (const AxisSeries& axis : part.axes) {
      EXPECT_GE(axis.speed_m_s.back().beat, part.to);
      EXPECT_EQ(axis.speed_m_s.back().value, 0);
    }
  }
}

TEST(MotionSeries, DryRunsCountFromTheFirstMotion) {
  const job::Profile profile = lamp_profile();
  job::JobOptions options;
  options.dry = true;
  const job::Job job = job::make_job(wild_points(20, 12), profile, options);
  EXPECT_TRUE(TracedRun(profile, job, all_beats).series(all_beats).axes.empty());
  const TracedRun run(profile, job, all_beats, {}, sim::MotionTrace::Zero::first_motion);
  const MotionSeries series = run.series(all_beats);
  EXPECT_EQ(series.axes.size(), 3u);
  EXPECT_TRUE(series.shots.empty());
  EXPECT_GE(series.from, -1);
  EXPECT_LE(series.from, 0);
}

TEST(MotionSeries, AnEStopEndsMotionAtItsTime) {
  const job::Profile profile = lamp_profile();
  Rig rig(profile);
  const sim::MotionTrace trace(rig.board, all_beats, sim::MotionTrace::Zero::first_shot);
  rig.board.world().schedule(sim::Pin::estop, true, 700 * ps_per_ms);
  EXPECT_EQ(run_job(rig, wild_job(profile, 13, JoinMode::free, 300)).end, link::JobEnd::alarm);
  rig.run(100 * ps_per_ms);
  EXPECT_FALSE(trace.pieces().back().moves());
  EXPECT_EQ(trace.pieces().back().state, wire::MachineState::estop);
  const MotionSeries series =
      motion_series(trace, profile.settings, all_beats, report::Fit::motion);
  const double stop = sim::seconds(700 * ps_per_ms - trace.beats()[*trace.zero()].at) * 100;
  for (const AxisSeries& axis : series.axes) EXPECT_NEAR(axis.speed_m_s.back().beat, stop, 0.02);
}

}  // namespace
}  // namespace lamplock::test
