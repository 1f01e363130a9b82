// Compares an estimate with the run of the same job on the virtual board with an ideal lamp; beat
// counts must be equal.
#include "host/estimate/estimate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "host/error.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/report/shot_beats.hpp"
#include "host/units.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"
#include "tests/scale.hpp"

namespace lamplock::estimate {
namespace {

using settings::Id;
using settings::LampMode;

struct Outcome {
  wire::Status status;
  sim::Shots shots;
};

Outcome run(const job::Job& job, const EstimateOptions& options = {}) {
  sim::WorldConfig world;
  world.lamp = sim::lamp_of(job.settings);
  sim::VirtualBoard board(job.settings, world);
  link::SimulatedTransport transport(board);
  link::SenderOptions sending;
  sending.first_index = options.first;
  sending.first_fired = options.fired;
  sending.job_speed = options.job_speed;
  sending.session = link::simulated_session;
  link::JobSender sender(transport, job, sending);
  const link::JobResult result = sender.run();
  EXPECT_EQ(result.end, link::JobEnd::done);
  return {result.status, board.world().laser().shots()};
}

/// Makes random machines and jobs in all combinations.
class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  job::Job make(int points) {
    const job::Profile profile = machine();
    job::JobOptions options;
    options.mode = pick({wire::JoinMode::free, wire::JoinMode::free, wire::JoinMode::path,
                         wire::JoinMode::start_stop});
    options.shots = static_cast<std::uint8_t>(pick({1, 1, 1, 2, 5}));
    job::Job job = job::make_job(cloud(points), profile, options);
    spoil(job);
    return job;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool one_in(int n) { return std::uniform_int_distribution<int>(1, n)(random_) == 1; }
  template <class T>
  T pick(std::initializer_list<T> list) {
    return list.begin()[std::uniform_int_distribution<std::size_t>(0, list.size() - 1)(random_)];
  }

 private:
  job::Profile machine() {
    job::Profile profile = job::default_profile();
    const auto set = [&profile](Id id, double value) {
      job::state_setting(profile, id, value, "test");
    };
    const double hz = pick({10.0, 50.0, 100.0, 100.0, 200.0, 333.3, 1000.0});
    job::set_lamp_hz(profile, hz);
    job::set_acceleration(profile, between(0.5, 12));
    job::set_speed(profile, between(0.05, 1));
    const auto mode =
        pick({LampMode::slave, LampMode::slave, LampMode::master, LampMode::free_beat});
    set(Id::lamp_mode, static_cast<int>(mode));
    set(Id::lamp_energy, 0.1);
    set(Id::max_lamp_frequency, 2000);
    if (one_in(3)) set(Id::period_tolerance, between(0, 10));
    if (one_in(3)) set(Id::shutter_open, between(0, 30));
    if (one_in(3)) set(Id::attenuator_settle, between(0, 30));
    set(Id::sensor_time, 200);
    if (one_in(3) && hz < 500) set(Id::shot_check, pick({1, 2}));
    if (one_in(4)) set(Id::max_shot_rate, hz / between(1, 4));
    if (one_in(5))
      for (int axis = 0; axis < 3; ++axis)
        set(settings::for_axis(Id::jerk_x, axis), between(100, 1000));
    return profile;
  }
  /// A random walk, sometimes in rows, sometimes with long jumps.
  geometry::PointCloud cloud(int count) {
    const double stride = between(0.02, 0.6);
    const bool rows = one_in(4);
    geometry::PointCloud cloud;
    geometry::Point at;
    for (int i = 0; i < count; ++i) {
      if (rows)
        at.x += stride;
      else
        at = {at.x + between(-stride, stride), at.y + between(-stride, stride),
              at.z + between(-stride, stride)};
      if (std::abs(at.x) > 20 || std::abs(at.y) > 20 || std::abs(at.z) > 20 || one_in(200))
        at = {between(-20, 20), between(-20, 20), between(-5, 5)};
      cloud.push_back(at);
    }
    return cloud;
  }
  /// Adds pauses, points without a shot, points of several flashes, several beams.
  void spoil(job::Job& job) {
    const bool pauses = one_in(3), passes = one_in(4), flashes = one_in(4);
    const bool beams = one_in(6);
    for (std::size_t i = 1; i < job.targets.size(); ++i) {
      wire::Target& target = job.targets[i];
      if (pauses && one_in(40)) {
        target = job.targets[i - 1];
        target.shots = 0;
        target.beats = static_cast<std::uint16_t>(between(1, 60));
        continue;
      }
      if (passes && one_in(10)) target.shots = 0;
      if (beams) target.channel = static_cast<std::uint8_t>(i / 50 % 2);
      if (beams) target.energy = static_cast<std::uint16_t>(1000 + i / 80);
      if (flashes && one_in(10)) target.shots = static_cast<std::uint8_t>(between(1, 20));
    }
  }

  std::mt19937_64 random_;
};

/// The error text of `call`; "" if it succeeds.
template <class Call>
std::string refusal_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_same(const job::Job& job, const EstimateOptions& options, const std::string& what) {
  SCOPED_TRACE(what);
  Estimate estimate;
  Outcome real;
  const std::string refused = refusal_of([&] { real = run(job, options); });
  EXPECT_EQ(refusal_of([&] { estimate = estimate_job(job, options); }), refused);
  if (!refused.empty()) return;
  EXPECT_EQ(estimate.shots, real.status.shots);
  EXPECT_EQ(estimate.beats, real.status.beats);
  EXPECT_EQ(estimate.beats_before, real.status.beats_before);
  EXPECT_EQ(estimate.beats_by_reason, real.status.beats_by_reason);
  ASSERT_EQ(estimate.shots, real.shots.size());
  if (real.shots.empty()) return;
  const double time_s = sim::seconds(real.shots.back().at - real.shots.front().at) +
                        1 / in_units(job.settings, Id::lamp_frequency);
  EXPECT_NEAR(estimate.time_s, time_s, 1e-4 + 1e-6 * time_s);
  EXPECT_EQ(estimate.beat_of_shot, report::beats_from_first(real.shots, job.settings));
}

TEST(Estimate, equals_the_run_to_the_beat) {
  const int jobs = test::scaled(40);
  for (int i = 0; i < jobs; ++i) {
    Maker maker(static_cast<std::uint64_t>(i));
    const job::Job job = maker.make(static_cast<int>(maker.between(1, 900)));
    EstimateOptions options;
    if (maker.one_in(4))
      options.first =
          static_cast<std::size_t>(maker.between(0, 0.9) * static_cast<double>(job.size()));
    if (maker.one_in(4)) options.job_speed = static_cast<std::uint32_t>(maker.between(30, 140));
    expect_same(job, options,
                fmt::format("seed {}, {} points, mode {}, {} Hz, lamp mode {}, from {}, speed {}",
                            i, job.size(), static_cast<int>(job.header.mode),
                            in_units(job.settings, Id::lamp_frequency),
                            job.settings.whole(Id::lamp_mode), options.first, options.job_speed));
  }
}

/// Points on a line, so close that the default machine reaches one on every beat.
job::Job line(int points) {
  geometry::PointCloud cloud;
  for (int i = 0; i < points; ++i) cloud.push_back({0.05 * i, 0, 0});
  return job::make_job(cloud, job::default_profile(), {});
}

/// Rows so dense that the need for a run-up depends on points far ahead.
TEST(Estimate, looks_as_far_ahead_as_the_machine) {
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, 4000);
  job::set_acceleration(profile, 10);
  for (const int length : {20, 60, 120, 250, 400}) {
    geometry::PointCloud cloud;
    for (int row = 0; row < 4; ++row) {
      cloud.push_back({-15, 2.0 * row + 1, 0});
      const int middle = length / 2;
      for (int i = 0; i < length; ++i)
        cloud.push_back({(row % 2 == 0 ? 1 : -1) * 0.025 * (i - middle), 2.0 * row, 0});
    }
    expect_same(job::make_job(cloud, profile, {}), {}, fmt::format("rows of {}", length));
  }
}

TEST(Estimate, of_one_point) {
  const Estimate estimate = estimate_job(line(1));
  EXPECT_EQ(estimate.shots, 1u);
  EXPECT_EQ(estimate.beats, 1u);
  EXPECT_NEAR(estimate.time_s, 0.01, 1e-9);
  EXPECT_EQ(estimate.beat_of_shot, std::vector<std::uint32_t>{0});
}

TEST(Estimate, of_a_job_that_fires_nothing) {
  job::Job job = line(20);
  for (wire::Target& target : job.targets) target.shots = 0;
  const Estimate estimate = estimate_job(job);
  const Outcome real = run(job);
  EXPECT_EQ(estimate.shots, 0u);
  EXPECT_EQ(estimate.beats, 0u);
  EXPECT_EQ(estimate.time_s, 0);
  EXPECT_EQ(estimate.beats_before, real.status.beats_before);
}

TEST(Estimate, pauses_are_counted_in_beats) {
  job::Job job = line(100);
  const std::uint64_t without = estimate_job(job).beats;
  wire::Target pause = job.targets[49];
  pause.shots = 0;
  pause.beats = 250;
  job.targets.insert(job.targets.begin() + 50, pause);
  job.header.points_total = static_cast<std::uint32_t>(job.targets.size());
  // The machine comes to rest for the pause and starts from rest after it.
  const std::uint64_t with = estimate_job(job).beats;
  EXPECT_GE(with, without + 250);
  EXPECT_LE(with, without + 260);
}

TEST(Estimate, reports_its_progress) {
  const job::Job job = line(400);
  std::size_t last = 0;
  EstimateOptions options;
  options.progress = [&](std::size_t done) {
    EXPECT_GE(done, last);
    last = done;
  };
  estimate_job(job, options);
  EXPECT_LE(last, job.size());
}

TEST(Estimate, refuses_jobs_it_cannot_run) {
  EstimateOptions options;
  options.first = 5;
  const std::string beyond = refusal_of([&] { estimate_job(line(5), options); });
  EXPECT_NE(beyond.find("--from 5"), std::string::npos) << beyond;
  job::Job rows;
  rows.header.mode = wire::mode_rows;
  EXPECT_NE(refusal_of([&] { estimate_job(rows); }).find("rows"), std::string::npos);
  EXPECT_NE(refusal_of([&] { estimate_job(job::Job{}); }), "");
  job::Profile slow = job::default_profile();
  job::set_speed(slow, 0.0002);
  const job::Job far = job::make_job({{0, 0, 0}, {45, 45, 45}}, slow, {});
  const std::string unreachable = refusal_of([&] { estimate_job(far); });
  EXPECT_NE(unreachable.find("point 1: cannot be reached"), std::string::npos) << unreachable;
  EXPECT_EQ(unreachable.find("--from"), std::string::npos) << "nothing was begun: " << unreachable;
}

}  // namespace
}  // namespace lamplock::estimate
