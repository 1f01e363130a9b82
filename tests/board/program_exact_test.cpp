// Random programs on the virtual board against an interpreter in exact rational numbers: the drives
// end at the exact place, rounded to steps once.

#include "tests/board/exact_programs.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

/// Nearest whole number of steps, half away from zero.
std::int32_t steps_of(const ExactProgram::Rational& mm, std::int32_t milli_steps_per_mm) {
  using boost::multiprecision::cpp_int;
  const ExactProgram::Rational steps = mm * milli_steps_per_mm / 1000;
  const cpp_int over = 2 * boost::multiprecision::numerator(steps);
  const cpp_int under = boost::multiprecision::denominator(steps);
  const cpp_int magnitude = (abs(over) + under) / (2 * under);
  return (over < 0 ? cpp_int(-magnitude) : magnitude).convert_to<std::int32_t>();
}

/// A large work space and resolutions that round differently on each axis.
job::Profile wide_profile() {
  job::Profile profile = program_profile();
  constexpr std::array<double, 3> steps_per_mm{200, 157.483, 333.333};
  for (int axis = 0; axis < 3; ++axis) {
    const auto set = [&](Id id, double value) {
      job::state_setting(profile, settings::for_axis(id, axis), value, "test");
    };
    set(Id::steps_per_mm_x, steps_per_mm[static_cast<std::size_t>(axis)]);
    set(Id::travel_x, 2000);
    set(Id::min_corner_x, -1000);
    set(Id::acceleration_x, 20'000);
  }
  return profile;
}

/// Runs one program; after each part, which begins with a line of `modes`, the drives are where
/// exact numbers end, rounded to steps. Returns the number of parts that moved.
int expect_exact(const job::Profile& profile, Rig& rig, unsigned seed, int parts, int lines,
                 const std::vector<std::string>& modes = {""}) {
  ProgramHost host(rig);
  ExactProgram exact(seed);
  std::string all;
  int moved = 0;
  for (int part = 0; part < parts; ++part) {
    const std::string& mode = modes[static_cast<std::size_t>(part) % modes.size()];
    std::string text = mode;
    for (int i = 0; i < lines; ++i) text += exact.lines();
    all += text;
    const std::size_t shots = rig.shots().size();
    const StepPosition before = rig.board.world().drives().position();
    EXPECT_TRUE(host.stream(text)) << all;
    EXPECT_THAT(host.answers(), Each("ok")) << all;
    host.run_ms(5);  // until the ticks handed out are over
    const StepPosition at = rig.board.world().drives().position();
    if (at != before) ++moved;
    EXPECT_TRUE(mode.starts_with("M130") || rig.shots().size() == shots);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(at[index(axis)], steps_of(exact.position()[index(axis)],
                                          profile.settings.milli(Id::steps_per_mm_x, axis)))
          << "program " << seed << " axis " << axis << "\n"
          << all;
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  EXPECT_FALSE(rig.board.controller().runner().underrun());
  return moved;
}

TEST(ProgramExact, EndsWhereExactNumbersEnd) {
  const job::Profile profile = wide_profile();
  int moved = 0;
  for (int program = 0; program < scaled(25) && !HasFailure(); ++program) {
    Rig rig(profile);
    moved += expect_exact(profile, rig, static_cast<unsigned>(program), 6, 8);
    EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
  }
  EXPECT_GT(moved, scaled(25) * 5);
}

/// Points on the beat and lines alternate.
TEST(ProgramExact, EndsThereWithAndWithoutBeatLock) {
  job::Profile profile = wide_profile();
  job::set_lamp_hz(profile, 1000);
  std::size_t shots = 0;
  for (int program = 0; program < scaled(15) && !HasFailure(); ++program) {
    Rig rig(profile);
    expect_exact(profile, rig, static_cast<unsigned>(program + 1000), 9, 6,
                 {"M131\n", "M130 P0\n", "M130 P1\n"});
    shots += rig.shots().size();
  }
  EXPECT_GT(shots, static_cast<std::size_t>(scaled(15)) * 10);
}

}  // namespace
}  // namespace lamplock::test
