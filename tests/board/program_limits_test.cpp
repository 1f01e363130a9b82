// Random programs on the virtual board, with overrides, holds and resumes at random moments: limits
// of every axis at every tick, end positions and durations.
#include <fmt/format.h>

#include <random>

#include "host/program/program_run.hpp"
#include "tests/board/program_host.hpp"
#include "tests/judges/motion_judge.hpp"

namespace lamplock::test::program_limits_test {
namespace {

constexpr double steps_per_mm = 200;

/// A program of one kind, inside a cube of 40 mm, with its end position.
struct RandomProgram {
  std::string text;
  std::array<double, 3> end{};
};

enum class Kind { lines, arcs, dense, stops, timed, mixed };

class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed) {}

  RandomProgram make(Kind kind, int count) {
    program_.text = kind == Kind::stops ? "G21 G90 G94 G61.1\n" : "G21 G90 G94 G64\n";
    for (int i = 0; i < count; ++i) add(kind == Kind::mixed ? any_kind() : kind);
    program_.text += "G94\n";
    return program_;
  }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool one_of(unsigned n) { return random_() % n == 0; }
  Kind any_kind() {
    constexpr std::array kinds{Kind::lines, Kind::arcs, Kind::dense, Kind::timed};
    return kinds[random_() % kinds.size()];
  }
  static double milli(double mm) { return std::round(mm * 1e3) / 1e3; }
  double& x() { return program_.end[0]; }
  double& y() { return program_.end[1]; }

  void add(Kind kind) {
    switch (kind) {
      case Kind::arcs:
        return arc();
      case Kind::dense:
        return dense();
      case Kind::timed:
        return timed();
      default:
        return line();
    }
  }
  void go(const std::string& code, const std::string& rest) {
    program_.text +=
        fmt::format("{} X{:.3f} Y{:.3f} Z{:.3f}{}\n", code, x(), y(), program_.end[2], rest);
  }
  void line() {
    const bool near = one_of(3);
    for (double& c : program_.end)
      c = milli(near ? std::clamp(c + between(-0.3, 0.3), -20.0, 20.0) : between(-20, 20));
    go(one_of(4) ? "G94 G0" : "G94 G1", fmt::format(" F{:.0f}", between(200, 20'000)));
  }
  /// A half or full circle around a centre beside its begin.
  void arc() {
    const double angle = between(0, 6.28), radius = between(0.5, 8);
    const double i = milli(radius * std::cos(angle)), j = milli(radius * std::sin(angle));
    const bool full = one_of(2);
    const double nx = full ? x() : x() + 2 * i, ny = full ? y() : y() + 2 * j;
    if (std::abs(nx) + 16 > 45 || std::abs(ny) + 16 > 45) return line();
    x() = milli(nx), y() = milli(ny);
    go(one_of(2) ? "G94 G2" : "G94 G3",
       fmt::format(" I{:.3f} J{:.3f} F{:.0f}", i, j, between(500, 12'000)));
  }
  /// Twenty chords of a curve.
  void dense() {
    double angle = between(0, 6.28);
    const double bend = between(-0.2, 0.2), chord = between(0.02, 0.4);
    const std::string feed = fmt::format(" F{:.0f}", between(1000, 15'000));
    for (int k = 0; k < 20; ++k, angle += bend) {
      x() = milli(std::clamp(x() + chord * std::cos(angle), -20.0, 20.0));
      y() = milli(std::clamp(y() + chord * std::sin(angle), -20.0, 20.0));
      go("G94 G1", feed);
    }
  }
  /// F is an inverse time, 1/min.
  void timed() {
    for (double& c : program_.end) c = milli(std::clamp(c + between(-5, 5), -20.0, 20.0));
    go("G93 G1", fmt::format(" F{:.2f}", 1 / between(0.001, 0.02)));
  }

  std::mt19937_64 random_;
  RandomProgram program_;
};

job::Profile machine_of(std::mt19937_64& random, bool jerk, bool core_xy = false) {
  job::Profile profile = program_profile();
  profile.settings.set_milli(Id::kinematics, core_xy ? 1000 : 0);
  for (int a = 0; a < 3; ++a) {
    const auto pick = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    job::state_setting(profile, settings::for_axis(Id::max_rate_x, a),
                       std::round(pick(3000, 30'000)), "test");
    job::state_setting(profile, settings::for_axis(Id::acceleration_x, a),
                       std::round(pick(500, 5000)), "test");
    if (jerk)
      job::state_setting(profile, settings::for_axis(Id::jerk_x, a), std::round(pick(30, 1000)),
                         "test");
  }
  return profile;
}

/// With jerk limits timed lines are left out: not all of them are planned in time.
bool has_times(Kind kind) { return kind == Kind::timed || kind == Kind::mixed; }

StepPosition steps_at(const std::array<double, 3>& mm) {
  StepPosition steps{};
  for (std::size_t a = 0; a < mm.size(); ++a)
    steps[a] = static_cast<std::int32_t>(std::lround(mm[a] * steps_per_mm));
  return steps;
}

StepPosition motors_at(const job::Profile& profile, const RandomProgram& program) {
  return Kinematics(profile.settings).motors_of(steps_at(program.end));
}

constexpr std::array kinds{Kind::lines, Kind::arcs,  Kind::dense,
                           Kind::stops, Kind::timed, Kind::mixed};

/// The i-th of many random programs, and its machine with a judge.
struct LimitedRun {
  LimitedRun(std::mt19937_64& random, int i, bool core_xy)
      : kind(kinds[static_cast<std::size_t>(i) % kinds.size()]),
        profile(machine_of(random, i / 6 % 3 == 1 && !has_times(kind), core_xy)),
        program(Writer(random()).make(kind, kind == Kind::dense ? 6 : 12)) {}
  void expect_at_end(const std::string& script = "") {
    SCOPED_TRACE(script + "\n" + program.text);
    host.run_ms(5);
    EXPECT_EQ(judge.fault(), "");
    EXPECT_EQ(host.position(), steps_at(program.end));
    EXPECT_EQ(rig.board.world().drives().motors(), motors_at(profile, program));
    expect_undisturbed(rig);
  }
  Kind kind;
  job::Profile profile;
  RandomProgram program;
  Rig rig{profile};
  ProgramHost host{rig};
  MotionJudge judge{rig.board, profile.settings, kind != Kind::stops};
};

/// Axes and their limits are the same for both kinematics.
class ProgramLimits : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Kinematics, ProgramLimits, testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "CoreXy" : "Cartesian");
});

TEST_P(ProgramLimits, UndisturbedInTheTimeThatCheckPredicts) {
  std::mt19937_64 random(1);
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(testing::Message() << "program " << i);
    LimitedRun run(random, i, GetParam());
    const auto plan = program_run::run_program(run.program.text, run.profile.settings, 1);
    ASSERT_TRUE(plan.problems.empty()) << plan.problems[0].text << "\n" << run.program.text;
    ASSERT_TRUE(run.host.stream(run.program.text, 20))
        << run.host.answers().size() << " " << run.host.status() << run.program.text;
    run.expect_at_end();
    // The board plans the same segments, so times differ only by ticks.
    EXPECT_NEAR(run.judge.moved_s(), plan.seconds(), 2e-6) << run.program.text;
  }
}

/// On circles the acceleration across the path counts too; over 20 ms corners do not. The planner
/// limits the acceleration along the path and that across it each by itself; where both act on one
/// axis their sum is up to twice the limit.
TEST(ProgramLimitsOfAxes, CirclesKeepTheAccelerationOfTheirAxes) {
  std::mt19937_64 random(2);
  for (int i = 0; i < scaled(6); ++i) {
    const job::Profile profile = machine_of(random, i % 3 == 2);
    const double radius = std::uniform_real_distribution<double>(2, 15)(random);
    const std::string text =
        fmt::format("G21 G90 G1 X{0:.3f} F3000\nG3 I-{0:.3f} F30000\nG3 I-{0:.3f}\n", radius);
    SCOPED_TRACE(text);
    Rig rig(profile);
    ProgramHost host(rig);
    MotionJudge judge(rig.board, profile.settings, true);
    ASSERT_TRUE(host.stream(text));
    EXPECT_EQ(judge.fault(), "");
    EXPECT_THAT(host.answers(), Each("ok"));
    EXPECT_LE(judge.hardest(), 2);
    EXPECT_EQ(host.position(), steps_at({radius, 0, 0}));
  }
}

TEST_P(ProgramLimits, DisturbedAtAnyMoment) {
  std::mt19937_64 random(3);
  constexpr std::array<unsigned, 12> bytes{0x90, 0x91, 0x92, 0x93, 0x94, 0x95,
                                           0x96, 0x97, '!',  '!',  '~',  '~'};
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(testing::Message() << "program " << i);
    LimitedRun run(random, i, GetParam());
    ProgramHost& host = run.host;
    ASSERT_LT(run.program.text.size(), 8000u);
    std::string_view rest = run.program.text;
    const auto lines = static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '\n'));
    std::size_t sent = 0;
    std::string script;
    for (int round = 0; round < 4000 && host.answers().size() < lines; ++round) {
      // One line at a time, some ahead: never more than the window.
      while (!rest.empty() && sent < host.answers().size() + 12) {
        const std::size_t size = rest.find('\n') + 1;
        host.send(rest.substr(0, size));
        rest.remove_prefix(size);
        ++sent;
      }
      if (random() % 4 == 0) {
        const unsigned byte = bytes[random() % bytes.size()];
        script += fmt::format("{:02x} at {} ms, ", byte, run.rig.now() / ps_per_ms);
        host.send(static_cast<std::uint8_t>(byte));
      }
      host.run_ms(std::uniform_real_distribution<double>(0.5, 40)(random));
    }
    EXPECT_EQ(host.answers().size(), lines);
    for (int round = 0; round < 2000; ++round) {
      host.send("~");
      if (host.wait_for_rest(0.05)) break;
    }
    run.expect_at_end(script);
  }
}

/// A dwell begins at rest and takes its programmed time.
TEST(ProgramLimitsOfAxes, DwellsAsLongAsProgrammed) {
  std::mt19937_64 random(4);
  for (int i = 0; i < scaled(8); ++i) {
    const job::Profile profile = machine_of(random, i % 2 == 1);
    const double seconds = std::uniform_real_distribution<double>(0.001, 0.5)(random);
    const std::string text = fmt::format("G1 X5 F3000\nG4 P{:.4f}\nG1 X0\n", seconds);
    SCOPED_TRACE(text);
    const auto plan = program_run::run_program(text, profile.settings, 1);
    Rig rig(profile);
    ProgramHost host(rig);
    MotionJudge judge(rig.board, profile.settings, false);
    ASSERT_TRUE(host.stream(text));
    host.run_ms(5);
    EXPECT_EQ(judge.fault(), "");
    // The time at rest is the dwell and the time to begin the next motion.
    const double stood = judge.moved_s() - static_cast<double>(judge.moving_ticks()) * 1e-6;
    EXPECT_GE(stood, seconds - 1e-4);
    EXPECT_LE(stood, seconds + 0.010);
    EXPECT_NEAR(judge.moved_s(), plan.seconds(), 0.010);
  }
}

}  // namespace
}  // namespace lamplock::test::program_limits_test
