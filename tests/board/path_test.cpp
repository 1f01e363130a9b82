// Jobs in path mode on the whole machine: straight lines from point to point, in the lamp's beat.
#include "tests/board/rig.hpp"

namespace lamplock::test {
namespace {

/// Outline of a rounded square: dense points on lines and arcs, one sharp corner.
geometry::PointCloud outline(std::size_t count, double spacing_mm) {
  constexpr double side = 8, radius = 2;
  geometry::PointCloud cloud;
  double x = 0, y = 0, heading = 0, way = 0;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.push_back({x, y, 0});
    const bool arc = way > side;
    if (arc) heading += spacing_mm / radius;
    way += spacing_mm;
    if (way > side + radius * 1.5) {
      way = 0;
      heading = std::round(heading * 2) / 2;
    }
    x += spacing_mm * std::cos(heading);
    y += spacing_mm * std::sin(heading);
  }
  return cloud;
}

job::Profile path_profile(double hz, LampMode mode, double accel_m_s2, double jump_mm_s) {
  job::Profile profile = lamp_profile(hz, mode, accel_m_s2);
  for (int axis = 0; axis < 3; ++axis)
    job::state_setting(profile, settings::for_axis(Id::speed_jump_x, axis), jump_mm_s, "test");
  return profile;
}

/// Largest distance of the machine's steps from the straight lines between its shots.
double farthest_from_lines(const Rig& rig, const job::Job& job) {
  const auto& fires = rig.monitor.fires();
  double farthest = 0;
  for (std::size_t i = 1; i < fires.size(); ++i) {
    const StepPosition &from = job.targets[i - 1].steps, &to = job.targets[i].steps;
    double length2 = 0;
    std::array<double, 3> way{};
    for (std::size_t a = 0; a < 3; ++a) {
      way[a] = to[a] - from[a];
      length2 += way[a] * way[a];
    }
    for (int k = 1; k < 8; ++k) {
      const Picoseconds t = fires[i - 1].rise + (fires[i].rise - fires[i - 1].rise) * k / 8;
      std::array<double, 3> at{};
      double along = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        at[a] = rig.monitor.position_at(static_cast<int>(a), t) - from[a];
        along += at[a] * way[a];
      }
      double off = 0;
      for (std::size_t a = 0; a < 3; ++a)
        off = std::max(off, std::abs(at[a] - (length2 == 0 ? 0 : along / length2 * way[a])));
      farthest = std::max(farthest, off);
    }
  }
  return farthest;
}

TEST(PathJob, EachPointOnceOnItsLineWithoutStopping) {
  const job::Profile profile = path_profile(40, LampMode::slave, 0.3, 0.75);
  const job::Job job = job_for(outline(400, 0.125), profile, JoinMode::path);
  Rig rig(profile.settings, world_for(profile));
  rig.monitor.allow_speed_jumps();
  link::JobResult result;
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, false, result));
  EXPECT_EQ(result.status.starvations, 0u);
  EXPECT_LE(result.status.beats, 400 + 20);
  // Counted steps are the true position rounded down, so the line appears half a step off.
  EXPECT_LE(farthest_from_lines(rig, job), 1.5);
}

struct PathCase {
  const char* name;
  double hz, jump_mm_s;
  LampMode mode;
  sim::LampConfig lamp;
  friend void PrintTo(const PathCase& c, std::ostream* out) { *out << c.name; }
};

class PathLamps : public testing::TestWithParam<PathCase> {};

TEST_P(PathLamps, EveryPointOnceInsideTheLimits) {
  const PathCase& c = GetParam();
  const bool jitter = c.lamp.jitter_us != 0;
  for (int seed = 0; seed < scaled(1) + 1; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    sim::LampConfig lamp = c.lamp;
    lamp.seed = number + 1;
    const job::Profile profile = path_profile(c.hz, c.mode, 2, c.jump_mm_s);
    const job::Job job =
        job_for(seed % 2 == 0 ? histogram_walk(200, number) : wild_points(60, number), profile,
                JoinMode::path);
    Rig rig(profile.settings, world_for(profile, lamp));
    rig.monitor.allow_speed_jumps();
    link::JobResult result;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, jitter, result));
  }
}

constexpr auto slave = LampMode::slave;
constexpr auto master = LampMode::master;

INSTANTIATE_TEST_SUITE_P(
    Lamps, PathLamps,
    testing::Values(PathCase{"slave50", 50, 0, slave, {}}, PathCase{"slave200", 200, 5, slave, {}},
                    PathCase{"slave1000", 1000, 2, slave, {}},
                    PathCase{"master4000", 4000, 0, master, {}},
                    PathCase{"jitter100", 100, 20, slave, {.jitter_us = 20, .wander = 0.01}},
                    PathCase{"dropouts100", 100, 5, slave, {.dropout = 0.05}}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace lamplock::test
