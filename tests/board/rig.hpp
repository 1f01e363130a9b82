// A test machine: board, world and monitor, jobs for it, and checks that must hold afterwards.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "host/error.hpp"
#include "host/job/job.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/drive_settings.hpp"
#include "tests/judges/pin_monitor.hpp"
#include "tests/matchers.hpp"
#include "tests/scale.hpp"
#include "tests/step_histogram.hpp"

namespace lamplock::test {

using link::JobEnd;
using settings::Id;
using settings::LampMode;
using settings::PulseMode;
using sim::Picoseconds;
using sim::ps_per_ms;
using sim::ps_per_ns;
using sim::ps_per_s;
using sim::ps_per_us;
using wire::HoldReason;
using wire::JoinMode;
using wire::MachineState;

inline constexpr JoinMode both_modes[] = {JoinMode::free, JoinMode::start_stop};

/// Picks numbers, all with the same probability.
template <class Number>
class Pick {
 public:
  explicit Pick(std::mt19937_64& random) : random_(random) {}
  Number operator()(Number from, Number to) const {
    if constexpr (std::is_integral_v<Number>)
      return std::uniform_int_distribution<Number>(from, to)(random_);
    else
      return std::uniform_real_distribution<Number>(from, to)(random_);
  }
  Number operator()(Number most) const { return (*this)(0, most); }

 private:
  std::mt19937_64& random_;
};

/// The machine of the measured object: 100 Hz, 2 m/s2.
inline job::Profile lamp_profile(double hz = 100,
                                 settings::LampMode mode = settings::LampMode::slave,
                                 double accel_m_s2 = 2) {
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, hz);
  job::set_acceleration(profile, accel_m_s2);
  profile.settings.set_milli(Id::lamp_mode, static_cast<int>(mode) * 1000);
  if (mode == settings::LampMode::master) {
    profile.settings.set_milli(Id::lamp_energy, 100);  // must be known
    const std::int32_t milli_hz = profile.settings.milli(Id::lamp_frequency);
    profile.settings.set_milli(Id::max_lamp_frequency, std::max(200'000, 11 * (milli_hz / 10)));
  }
  return profile;
}

/// A machine for programs: no lamp gives its beat.
inline job::Profile program_profile() { return lamp_profile(100, LampMode::free_beat); }

/// The world that matches this machine.
inline sim::WorldConfig world_for(const job::Profile& profile, sim::LampConfig lamp = {}) {
  lamp.frequency_hz = profile.settings.milli(Id::lamp_frequency) / 1000.0;
  lamp.triggered = profile.settings.whole(Id::lamp_mode) != 1;
  sim::WorldConfig world;
  world.lamp = lamp;
  world.drives = sim::drives_of(profile.settings);
  for (int axis = 0; axis < max_axes; ++axis)
    world.drives.lag_us[static_cast<std::size_t>(axis)] =
        profile.settings.milli(Id::drive_lag_x, axis) / 1000.0;
  return world;
}

/// Sets the drives' lags, X first.
inline void set_lag(job::Profile& profile, std::initializer_list<double> lag_us) {
  Id id = Id::drive_lag_x;
  for (const double us : lag_us) {
    job::state_setting(profile, id, us, "test");
    id = settings::for_axis(id, 1);
  }
}

/// Demanding points: long moves through the whole work space, its corners, repeated points, single
/// steps.
inline geometry::PointCloud wild_points(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Pick<int> pick(random);
  geometry::PointCloud cloud{{0, 0, 0}};
  while (cloud.size() < count) {
    geometry::Point p = cloud.back();
    const auto change = [&](double& v) {
      switch (pick(0, 9)) {
        case 0:
          v = pick(-50'000, 50'000) / 1000.0;
          break;
        case 1:
          v = pick(0, 1) == 0 ? -50 : 50;
          break;
        case 2:
          break;
        default:
          v = std::clamp(v + pick(-200, 200) / 1000.0, -50.0, 50.0);
      }
    };
    change(p.x), change(p.y), change(p.z);
    cloud.push_back(p);
  }
  return cloud;
}

/// A job with this join mode.
inline job::Job job_for(const geometry::PointCloud& points, const job::Profile& profile,
                        JoinMode mode) {
  job::JobOptions options;
  options.mode = mode;
  return job::make_job(points, profile, options);
}

/// Board with its monitor.
struct Rig {
  explicit Rig(const job::Profile& profile, const sim::LampConfig& lamp = {})
      : board(profile.settings, world_for(profile, lamp)),
        monitor(board.bus(), board.world().lamp()) {}
  Rig(const settings::Values& stored, const sim::WorldConfig& world)
      : board(stored, world), monitor(board.bus(), board.world().lamp()) {}

  sim::VirtualBoard board;
  PinMonitor monitor;

  MachineState state() const { return board.controller().state(); }
  wire::Status status() const {
    wire::Status status;
    board.controller().fill_status(status);
    return status;
  }
  const sim::Shots& shots() const { return board.world().laser().shots(); }
  Picoseconds now() const { return board.now(); }
  void run(Picoseconds time) { board.run_until(now() + time); }
  /// Changes an input of the board now.
  void set(sim::Pin pin, bool level) { board.world().schedule(pin, level, now()); }
  /// An input is active for some time.
  void press(sim::Pin pin, Picoseconds from, Picoseconds to) {
    board.world().schedule(pin, true, from);
    board.world().schedule(pin, false, to);
  }
};

inline link::SenderOptions session(std::uint32_t number) {
  link::SenderOptions options;
  options.session = number;
  return options;
}

/// Runs a job over a good cable.
inline link::JobResult run_job(Rig& rig, const job::Job& job, link::SenderOptions options = {}) {
  if (options.session == 0) options.session = 0x5EED;
  link::SimulatedTransport transport(rig.board);
  return link::JobSender(transport, job, options).run();
}

/// The host's error for a job that the machine must refuse; "taken" if it accepts the job.
inline std::string refusal(Rig& rig, const job::Job& job) {
  try {
    run_job(rig, job);
  } catch (const Error& error) {
    EXPECT_TRUE(rig.monitor.nothing_happened());
    return error.what();
  }
  return "taken";
}

/// A program lost no step, starved nowhere, and its ticks never ran out.
inline void expect_undisturbed(const Rig& rig) {
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
  EXPECT_FALSE(rig.board.controller().runner().underrun());
}

/// Permitted deviation of the counted steps at a shot: the true position is within the tolerance of
/// the middle of the wanted step, and the count is the true position rounded down.
struct ShotReach {
  std::int32_t low, high;
};
inline ShotReach shot_reach(const settings::Values& values, int axis) {
  const double um = values.milli(Id::shot_tolerance) / 1000.0;
  const double steps = (um != 0 ? um : 5.0) * values.milli(Id::steps_per_mm_x, axis) / 1e6;
  const double tolerance = um != 0 ? steps : std::max(0.5, steps);
  return {static_cast<std::int32_t>(std::floor(0.5 - tolerance)),
          static_cast<std::int32_t>(std::ceil(0.5 + tolerance)) - 1};
}

/// Every point was fired once, in order, at its place, and nothing else. `jitter`: the lamp's edges
/// move, so shots may be off by the tolerance.
inline void expect_each_once(const Rig& rig, const job::Job& job, bool jitter) {
  const sim::Shots& shots = rig.shots();
  ASSERT_EQ(shots.size(), job.targets.size());
  ASSERT_EQ(rig.board.lattice_shots().size(), shots.size());
  for (int axis = 0; axis < job.header.axes; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const ShotReach reach = jitter ? shot_reach(job.settings, axis) : ShotReach{0, 0};
    for (std::size_t i = 0; i < shots.size(); ++i) {
      const std::int32_t wanted = job.targets[i].steps[a];
      ASSERT_EQ(rig.board.lattice_shots()[i].steps[a], wanted)
          << "point " << i << " axis " << axis << ", at the shot " << shots[i].steps[a] << ", "
          << static_cast<double>(shots[i].at) * 1e-12 << " s";
      const std::int32_t off = shots[i].steps[a] - wanted;
      ASSERT_TRUE(reach.low <= off && off <= reach.high)
          << "shot " << i << " axis " << axis << " off by " << off << " steps at "
          << static_cast<double>(shots[i].at) * 1e-12 << " s";
    }
  }
}

/// Holds after every run, whatever happened: limits, and only good pulses in the lamp's light.
inline void expect_sound(const Rig& rig, const settings::Values& values) {
  EXPECT_EQ(rig.monitor.violation(values), "");
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  const sim::Laser& laser = rig.board.world().laser();
  EXPECT_EQ(laser.narrow_pulses(), 0u);
  EXPECT_EQ(laser.late_pulses(), 0u);
  EXPECT_EQ(laser.unlit_pulses(), 0u);
  EXPECT_EQ(rig.board.controller().shots().stray_shots(), 0u);
  EXPECT_FALSE(rig.board.controller().runner().underrun());
}

/// Compares the ledger with the lamp's own count of periods.
inline void expect_ledger(const Rig& rig, const wire::Status& status) {
  const auto& fires = rig.monitor.fires();
  ASSERT_FALSE(fires.empty());
  const auto& reasons = status.beats_by_reason;
  EXPECT_EQ(std::accumulate(reasons.begin(), reasons.end(), 0u), status.beats);
  EXPECT_EQ(reasons[static_cast<std::size_t>(BeatReason::fired)], fires.size());
  EXPECT_EQ(status.shots, fires.size());
  const std::int64_t periods = fires.back().period - fires.front().period;
  EXPECT_EQ(std::int64_t{status.beats}, periods + 1);
  const std::int64_t flashes = rig.shots().back().beat - rig.shots().front().beat;
  EXPECT_EQ(reasons[static_cast<std::size_t>(BeatReason::no_edge)], periods - flashes);
}

/// Runs a job to its end and makes all these checks.
inline void run_to_the_end(Rig& rig, const job::Job& job, bool jitter, link::JobResult& result) {
  result = run_job(rig, job);
  ASSERT_EQ(result.end, link::JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, jitter));
  expect_sound(rig, job.settings);
  expect_ledger(rig, result.status);
}

inline std::uint32_t beats_of(const wire::Status& status, BeatReason reason) {
  return status.beats_by_reason[static_cast<std::size_t>(reason)];
}

}  // namespace lamplock::test
