// Lines and arcs of programs on the virtual board, on coarse and fine machines: the staircase of
// pulses is within half a pulse of the true path everywhere, and ends on the nearest step.
#include <fmt/format.h>

#include <random>

#include "tests/board/program_host.hpp"
#include "tests/judges/path_judge.hpp"

namespace lamplock::test {
namespace {

struct StairMachine {
  StepPoint steps_per_mm{};

  job::Profile profile() const {
    job::Profile profile = program_profile();
    for (int axis = 0; axis < 3; ++axis) {
      job::state_setting(profile, settings::for_axis(Id::steps_per_mm_x, axis),
                         steps_per_mm[static_cast<std::size_t>(axis)], "test");
      job::state_setting(profile, settings::for_axis(Id::travel_x, axis), 400, "test");
      job::state_setting(profile, settings::for_axis(Id::min_corner_x, axis), -200, "test");
    }
    return profile;
  }
};
/// 512 pulses on 78 mm, as two AC servo drives in a Polish paper; and present-day stages.
constexpr StairMachine coarse{{6.564, 6.564, 13.128}};
constexpr StairMachine fine{{200, 157.483, 333.333}};

/// The highest speed of the tests; limits an axis's motion in the tick to which a pulse is rounded.
constexpr double fastest_mm_s = 100;
/// Places are rounded to 1/256 step and kept 1/32 step from where a pulse is due.
constexpr double epsilon = 1.0 / 32 + 1.0 / 512;

StepPoint bound_of(const job::Profile& profile, const StairMachine& machine, bool arcs) {
  const double tolerance_mm = arcs ? profile.settings.milli(Id::arc_tolerance) * 1e-3 : 0;
  StepPoint bound{};
  for (std::size_t a = 0; a < 3; ++a)
    bound[a] =
        0.5 + epsilon + machine.steps_per_mm[a] * (tolerance_mm + 2 * fastest_mm_s * 1e-6 + 1e-6);
  return bound;
}

/// A program and its path.
class PathWriter {
 public:
  PathWriter(std::uint64_t seed, const StairMachine& machine)
      : random_(seed), path_(machine.steps_per_mm) {}

  void line() {
    MmPoint to = path_.at_mm();
    const double reach = random_() % 2 == 0 ? 20 : random_() % 2 == 0 ? 1 : 0.1;
    for (double& c : to)
      if (random_() % 4 != 0) c = milli(std::clamp(c + between(-reach, reach), -20.0, 20.0));
    if (to == path_.at_mm()) return;
    go("G1", to, "");
    path_.line(to);
  }
  void arc() {
    const MmPoint from = path_.at_mm();
    const double angle = between(0, 6.28), radius = between(0.3, 12);
    const double i = milli(radius * std::cos(angle)), j = milli(radius * std::sin(angle));
    const bool full = random_() % 2 == 0, left = random_() % 2 == 0;
    MmPoint to = from;
    if (!full) to = {milli(from[0] + 2 * i), milli(from[1] + 2 * j), milli(between(-20, 20))};
    if (std::abs(to[0]) > 60 || std::abs(to[1]) > 60) return line();
    go(left ? "G3" : "G2", to, fmt::format(" I{:.3f} J{:.3f}", i, j));
    path_.arc(to, {from[0] + i, from[1] + j, 0},
              (left ? 1 : -1) * (full ? 2 : 1) * std::numbers::pi);
  }
  /// A stop of some kind.
  void stop() { text_ += random_() % 2 == 0 ? "G4 P0.01\n" : "G61.1\nG64\n"; }

  std::string take_text() { return std::exchange(text_, {}); }
  const IdealPath& path() const { return path_; }
  unsigned pick(unsigned n) { return static_cast<unsigned>(random_() % n); }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  static double milli(double mm) { return std::round(mm * 1e3) / 1e3; }
  void go(const char* code, const MmPoint& to, const std::string& rest) {
    text_ += fmt::format("{} X{:.3f} Y{:.3f} Z{:.3f}{} F{:.0f}\n", code, to[0], to[1], to[2], rest,
                         between(300, fastest_mm_s * 60));
  }

  std::mt19937_64 random_;
  IdealPath path_;
  std::string text_ = "G21 G90 G94 G64\n";
};

void expect_staircases(const StairMachine& machine, bool arcs, int programs) {
  const job::Profile profile = machine.profile();
  for (int program = 0; program < programs; ++program) {
    Rig rig(profile);
    ProgramHost host(rig);
    StepRecord record(rig.board);
    PathWriter writer(static_cast<std::uint64_t>(program) + (arcs ? 500 : 0), machine);
    for (int part = 0; part < 4; ++part) {
      for (int i = 0; i < (arcs ? 4 : 15); ++i) {
        if (arcs && writer.pick(2) == 0)
          writer.arc();
        else
          writer.line();
        if (writer.pick(8) == 0) writer.stop();
      }
      // Between two parts the machine rests on a fraction of a step.
      ASSERT_TRUE(host.stream(writer.take_text()));
      host.run_ms(20);
    }
    ASSERT_THAT(host.answers(), Each("ok"));
    StaircaseFollower follower(writer.path(), bound_of(profile, machine, arcs));
    ASSERT_EQ(follower.follow(record.places()), "") << "program " << program;
    ASSERT_EQ(rig.board.world().drives().total_faults(), 0u);
  }
}

TEST(ProgramStaircase, LinesOnACoarseMachine) { expect_staircases(coarse, false, scaled(20)); }
TEST(ProgramStaircase, LinesOnAFineMachine) { expect_staircases(fine, false, scaled(5)); }
TEST(ProgramStaircase, ArcsOnACoarseMachine) { expect_staircases(coarse, true, scaled(20)); }
TEST(ProgramStaircase, ArcsOnAFineMachine) { expect_staircases(fine, true, scaled(4)); }

/// The two trajectories of the paper: a line, and the shorter arc on either side of its chord.
TEST(ProgramStaircase, TwoTrajectoriesOfTwoServoDrives) {
  const job::Profile profile = coarse.profile();
  constexpr double radius = 150;
  const auto run = [&](const std::string& text, const IdealPath& path, bool arc,
                       const StepPosition& end) {
    Rig rig(profile);
    ProgramHost host(rig);
    StepRecord record(rig.board);
    ASSERT_TRUE(host.stream(text));
    host.run_ms(20);
    ASSERT_THAT(host.answers(), Each("ok"));
    StaircaseFollower follower(path, bound_of(profile, coarse, arc));
    EXPECT_EQ(follower.follow(record.places()), "") << text;
    EXPECT_EQ(rig.board.world().drives().position(), end);
  };
  IdealPath line(coarse.steps_per_mm);
  line.line({100, 150, 0});
  run("G21 G90 G94 G1 X100 Y150 F3000\n", line, false, {656, 985, 0, 0});
  const double chord = std::hypot(100, 120), up = std::sqrt(radius * radius - chord * chord / 4);
  const double sweep = 2 * std::asin(chord / 2 / radius);
  for (const int side : {1, -1}) {
    IdealPath arc(coarse.steps_per_mm);
    arc.arc({100, 120, 0}, {50 - side * up * 120 / chord, 60 + side * up * 100 / chord, 0},
            side * sweep);
    run(fmt::format("G21 G90 G94 {} X100 Y120 R150 F3000\n", side > 0 ? "G3" : "G2"), arc, true,
        {656, 788, 0, 0});
  }
}

/// Points on the beat lie in the middle of steps; lines before and after them do not.
TEST(ProgramStaircase, TheNextMoveStartsInTheMiddleOfAStep) {
  Rig rig(coarse.profile());
  ProgramHost host(rig);
  const auto off_middle = [&] {
    const stepper::MotionState at = rig.board.controller().runner().generator().state();
    return at.axis[0].position_q64 - stepper::middle_of_step(at.axis[0].step());
  };
  const auto off_steps = [&] {
    const Int128 off = off_middle();
    return static_cast<double>(off.hi()) + std::ldexp(static_cast<double>(off.lo()), -64);
  };
  ASSERT_TRUE(host.stream("G21 G90 G94 G1 X10.05 Y3 F2000\n"));  // 65.97 steps
  host.run_ms(20);
  EXPECT_NEAR(off_steps(), 10.05 * 6.564 - 66, 1.0 / 512 + 1e-6);
  EXPECT_EQ(rig.board.world().drives().position()[0], 66);
  ASSERT_TRUE(host.stream("M130 P0\nG0 X10.05\nM131\n"));
  host.run_ms(20);
  EXPECT_EQ(rig.board.world().drives().position()[0], 66);
  EXPECT_EQ(off_middle(), Int128{});
  ASSERT_TRUE(host.stream("G1 X0\n"));
  host.run_ms(20);
  EXPECT_EQ(rig.board.world().drives().position()[0], 0);
  ASSERT_THAT(host.answers(), Each("ok"));
}

}  // namespace
}  // namespace lamplock::test
