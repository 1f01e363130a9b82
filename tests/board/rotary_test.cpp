// A rotary axis ($967) on the virtual board: turns without limit of travel, in degrees.
#include <fmt/format.h>

#include "tests/board/program_host.hpp"

namespace lamplock::test::board_rotary_test {
namespace {

using settings::Id;

constexpr std::int32_t steps_per_degree = 20;
constexpr std::size_t a_axis = 3;

/// Four axes; the travel of A as a length would be 20, from 0.
job::Profile profile_with_a(int rotary) {
  job::Profile profile = program_profile();
  const auto set = [&profile](Id id, std::int32_t milli) {
    EXPECT_TRUE(profile.settings.set_milli(id, milli));
  };
  set(Id::pin_map, static_cast<int>(boards::PinMap::cut) * 1000);
  set(Id::axes, 4000);
  set(settings::for_axis(Id::steps_per_mm_x, 3), steps_per_degree * 1000);
  set(settings::for_axis(Id::min_corner_x, 3), 0);
  set(settings::for_axis(Id::travel_x, 3), 20'000);
  set(settings::for_axis(Id::max_rate_x, 3), 600'000'000);  // 10 000 degrees/s
  set(Id::soft_limits, 1000);
  set(Id::rotary_axis, rotary * 1000);
  return profile;
}

TEST(RotaryAxis, HasNoLimitOfTravel) {
  for (const int rotary : {1, 0}) {
    Rig rig(profile_with_a(rotary));
    ProgramHost host(rig);
    const std::vector<std::string> answers = host.ask("G0 A3600\n");
    EXPECT_EQ(answers.back() == "ok", rotary == 1);
    EXPECT_EQ(host.has_said("ALARM:2"), rotary == 0);
    if (rotary == 0) continue;
    ASSERT_TRUE(host.wait_for_rest());
    EXPECT_EQ(host.position()[a_axis], 3600 * steps_per_degree);
    ASSERT_EQ(host.ask("G91 G0 A-7200\n").back(), "ok");
    ASSERT_TRUE(host.wait_for_rest());
    EXPECT_EQ(host.position()[a_axis], -3600 * steps_per_degree);
    EXPECT_EQ(host.ask("G90 G0 X9999\n").back() == "ok", false) << "X has its limits";
  }
}

TEST(RotaryAxis, MovesByDegreesInInchesToo) {
  Rig rig(profile_with_a(1));
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("$13=1\nG20 G0 X0.1 A90\n"), ElementsAre("ok", "ok"));
  ASSERT_TRUE(host.wait_for_rest());
  EXPECT_EQ(host.position()[a_axis], 90 * steps_per_degree);
  EXPECT_THAT(host.status(), HasSubstr("MPos:0.1000,0.0000,0.0000,90.000|"));
  host.ask("G10 L2 P1 A45\n$#\n");
  EXPECT_THAT(host.heard, HasSubstr("[G54:0.0000,0.0000,0.0000,45.000]"));
}

TEST(RotaryAxis, TurnsTheShorterWay) {
  Rig rig(profile_with_a(2));
  ProgramHost host(rig);
  ASSERT_TRUE(host.stream("G0 A10\nA350\n"));
  EXPECT_EQ(host.position()[a_axis], -10 * steps_per_degree);
}

/// 720 degrees at 3600 degrees a minute, beside X which moves 1 mm: 1 mm at 5 mm/min.
TEST(RotaryAxis, TakesTheTimeOfItsFeed) {
  const auto time_of = [](const std::string& line) {
    Rig rig(profile_with_a(1));
    ProgramHost host(rig);
    const Picoseconds begin = rig.now();
    EXPECT_TRUE(host.stream(line));
    return sim::seconds(rig.now() - begin);
  };
  EXPECT_NEAR(time_of("G1 F3600 A720\n"), 12, 0.1);
  EXPECT_NEAR(time_of("G1 F5 X1 A720\n"), 12, 0.1);
}

/// As F means it: of X beside A, of A alone in degrees a minute, which are not divided by 25.4.
TEST(RotaryAxis, ReportsTheFeedAsProgrammed) {
  const auto feed_of = [](int rotary, const std::string& line) {
    Rig rig(profile_with_a(rotary));
    ProgramHost host(rig);
    host.ask(line);
    host.run_ms(1000);
    return host.status();
  };
  EXPECT_THAT(feed_of(1, "G1 F3600 A720\n"), HasSubstr("|FS:3600,0|"));
  EXPECT_THAT(feed_of(1, "$13=1\nG1 F3600 A720\n"), HasSubstr("|FS:3600,0|"));
  EXPECT_THAT(feed_of(1, "$13=1\nG20 G1 F3600 A720\n"), HasSubstr("|FS:3600,0|"));
  EXPECT_THAT(feed_of(1, "G1 F30 X4 A300\n"), HasSubstr("|FS:30,0|"));
  EXPECT_THAT(feed_of(1, "$13=1\nG20 G1 F2 X0.2 A300\n"), HasSubstr("|FS:2.0,0|"));
  EXPECT_THAT(feed_of(0, "$13=1\nG1 F254 A19\n"), HasSubstr("|FS:10.0,0|")) << "A is a length";
}

}  // namespace
}  // namespace lamplock::test::board_rotary_test
