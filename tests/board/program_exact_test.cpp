// Random programs on the virtual board against an interpreter in exact rational numbers: the drives
// end at the exact place, rounded to steps once.
#include <gmock/gmock.h>

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

/// A large work area and resolutions that round differently on each axis.
job::Profile wide_profile() {
  job::Profile profile = lamp_profile(100, settings::LampMode::free_beat);
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

TEST(ProgramExact, EndsWhereExactNumbersEnd) {
  const job::Profile profile = wide_profile();
  std::size_t moved = 0;
  for (int program = 0; program < scaled(25); ++program) {
    Rig rig(profile);
    ProgramHost host(rig);
    ExactProgram exact(static_cast<unsigned>(program));
    std::string all;
    StepPosition before{};
    for (int part = 0; part < 6; ++part) {
      std::string text;
      for (int i = 0; i < 8; ++i) text += exact.lines();
      all += text;
      ASSERT_TRUE(host.stream(text)) << all;
      ASSERT_THAT(host.answers(), testing::Each("ok")) << all;
      host.run_ms(5);  // until the ticks handed out are over
      const StepPosition at = rig.board.world().drives().position();
      if (at != before) ++moved;
      before = at;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        ASSERT_EQ(at[a],
                  steps_of(exact.position()[a], profile.settings.milli(Id::steps_per_mm_x, axis)))
            << "program " << program << " axis " << axis << "\n"
            << all;
      }
    }
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
    EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
    EXPECT_FALSE(rig.board.controller().runner().generator().underrun());
    EXPECT_EQ(rig.shots().size(), 0u);
  }
  EXPECT_GT(moved, static_cast<std::size_t>(scaled(25)) * 5);
}

/// Points on the beat and lines alternate.
TEST(ProgramExact, EndsThereWithAndWithoutBeatLock) {
  job::Profile profile = wide_profile();
  job::set_lamp_hz(profile, 1000);
  std::size_t shots = 0;
  for (int program = 0; program < scaled(15); ++program) {
    Rig rig(profile);
    ProgramHost host(rig);
    ExactProgram exact(static_cast<unsigned>(program + 1000));
    std::string all;
    const auto wanted = [&](int axis) {
      return steps_of(exact.position()[static_cast<std::size_t>(axis)],
                      profile.settings.milli(Id::steps_per_mm_x, axis));
    };
    for (int part = 0; part < 9; ++part) {
      std::string text = part % 3 == 0 ? "M131\n" : part % 3 == 1 ? "M130 P0\n" : "M130 P1\n";
      for (int i = 0; i < 6; ++i) text += exact.lines();
      all += text;
      const std::size_t before = rig.shots().size();
      ASSERT_TRUE(host.stream(text)) << all;
      ASSERT_THAT(host.answers(), testing::Each("ok")) << all;
      host.run_ms(5);  // until the ticks handed out are over
      EXPECT_TRUE(part % 3 != 0 || rig.shots().size() == before);
      shots += rig.shots().size() - before;
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(rig.board.world().drives().position()[static_cast<std::size_t>(axis)],
                  wanted(axis))
            << "program " << program << " axis " << axis << "\n"
            << all;
    }
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
    EXPECT_FALSE(rig.board.controller().runner().generator().underrun());
  }
  EXPECT_GT(shots, static_cast<std::size_t>(scaled(15)) * 10);
}

}  // namespace
}  // namespace lamplock::test
