// The machine profile: accepted files, errors, and the written text.
#include "host/job/profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "host/error.hpp"
#include "host/job/read_profile.hpp"
#include "shared/units.hpp"
#include "tests/error_of.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::job {
namespace {

using settings::Id;
using testing::HasSubstr;

Profile read(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_profile(folder.write("profile.toml", text));
}

std::string error_of(const std::string& text) {
  return test::error_of([&] { read(text); });
}

TEST(Profile, DefaultEqualsTheDesign) {
  const settings::Values values = default_profile().settings;
  EXPECT_EQ(values.whole(Id::axes), 3);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(values.whole(settings::for_axis(Id::steps_per_mm_x, axis)), 200);
    EXPECT_EQ(values.whole(settings::for_axis(Id::max_rate_x, axis)), 60'000);
    EXPECT_EQ(values.whole(settings::for_axis(Id::acceleration_x, axis)), 4'000);
    EXPECT_EQ(values.whole(settings::for_axis(Id::travel_x, axis)), 100);
    EXPECT_EQ(values.whole(settings::for_axis(Id::min_corner_x, axis)), -50);
  }
  EXPECT_EQ(values.whole(Id::lamp_frequency), 100);
}

TEST(Profile, AFormerNameWorksWithANote) {
  testing::internal::CaptureStderr();
  const Profile profile = read("axes = 3\nhighest_speed = 255\n");
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::MatchesRegex("note: [^\n]*profile.toml:2: 'highest_speed' is now named "
                                    "'max_spindle_speed'\n"));
  EXPECT_EQ(profile.settings.whole(Id::max_spindle_speed), 255);
  EXPECT_TRUE(profile.stated.test(static_cast<std::size_t>(Id::max_spindle_speed)));
  EXPECT_THAT(error_of("highest_speed = 255\nmax_spindle_speed = 1000\n"),
              HasSubstr("profile.toml:1: 'highest_speed' is the former name of "
                        "'max_spindle_speed', which is given too"));
}

TEST(Profile, ReadsArraysScalarsAndNames) {
  const Profile profile = read(R"(
name = "glass engraver"
axes = 4
steps_per_mm = [160, 160.5, 400, 8]
travel_z = 60
lamp_frequency = 62.5
soft_limits = false
)");
  EXPECT_EQ(profile.name, "glass engraver");
  EXPECT_EQ(profile.settings.milli(Id::steps_per_mm_x), 160'000);
  EXPECT_EQ(profile.settings.milli(Id::steps_per_mm_y), 160'500);
  EXPECT_EQ(profile.settings.milli(Id::steps_per_mm_a), 8'000);
  EXPECT_EQ(profile.settings.milli(Id::travel_x), 100'000);
  EXPECT_EQ(profile.settings.milli(Id::travel_z), 60'000);
  EXPECT_EQ(profile.settings.milli(Id::lamp_frequency), 62'500);
  EXPECT_EQ(profile.settings.milli(Id::soft_limits), 0);
  EXPECT_TRUE(profile.stated[static_cast<std::size_t>(Id::steps_per_mm_z)]);
  EXPECT_FALSE(profile.stated[static_cast<std::size_t>(Id::travel_x)]);
  EXPECT_EQ(profile.stated.count(), 8u);
}

TEST(Profile, ErrorsNameFileLineKeyAndRange) {
  const std::string unknown = error_of("axes = 3\n\nlamp_freqency = 100\n");
  EXPECT_THAT(unknown, HasSubstr(".toml:3"));
  EXPECT_THAT(unknown, HasSubstr("'lamp_freqency'"));
  const std::string range = error_of("axes = 3\nlamp_frequency = 9000\n");
  EXPECT_THAT(range, HasSubstr(".toml:2"));
  EXPECT_THAT(range, HasSubstr("9000"));
  EXPECT_THAT(range, HasSubstr("1 to 8000 Hz"));
  EXPECT_THAT(error_of("axes = 2.5\n"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("travel_x = \"100\"\n"), HasSubstr("must be a number"));
  EXPECT_THAT(error_of("travel = 100\n"), HasSubstr("array"));
  EXPECT_THAT(error_of("travel = []\n"), HasSubstr("array"));
  EXPECT_THAT(error_of("travel = [1, 2, 3, 4, 5]\n"), HasSubstr("1 to 4"));
  EXPECT_THAT(error_of("travel = [1, \"b\"]\n"), HasSubstr("must be a number"));
  EXPECT_THAT(error_of("travel = [1, -2]\n"), HasSubstr("travel_y"));
  EXPECT_THAT(error_of("name = 3\n"), HasSubstr("'name'"));
  EXPECT_THAT(error_of("[section]\naxes = 3\n"), HasSubstr("'section'"));
  EXPECT_THAT(error_of("axes = nan\n"), HasSubstr("out of range"));
  EXPECT_THAT(error_of("axes = 1e300\n"), HasSubstr("out of range"));
  EXPECT_THAT(error_of("axes = = 3\n"), HasSubstr(".toml:1"));
}

TEST(Profile, ValuesTooSmallToStoreAreRefusedWhere0MeansNone) {
  EXPECT_THAT(error_of("jerk = [0.0004, 1, 1]\n"),
              HasSubstr("jerk_x = 0.0004 would be rounded to 0"));
  EXPECT_THAT(error_of("lamp_energy = 1e-300\n"), HasSubstr("would be rounded to 0"));
  EXPECT_NO_THROW(read("jerk = [0.001, 0, 1]\n"));
}

TEST(Profile, MissingFileIsAnError) {
  EXPECT_THROW(read_profile("/nowhere/machine.toml"), Error);
  EXPECT_THROW(read_profile(std::filesystem::temp_directory_path()), Error);
}

/// The example states the defaults and mentions every setting, so that it cannot become outdated.
TEST(Profile, TheExampleIsTheDefaultAndNamesEverySetting) {
  const std::filesystem::path path = test::in_repository("examples/machine.toml");
  const Profile example = read_profile(path);
  EXPECT_EQ(example.settings, settings::Values{});
  std::ifstream in(path);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  std::string all;
  // With the commented settings uncommented, all but those of the fourth axis are stated.
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    all += (line.rfind("# ", 0) == 0 && line.find(" = ") < 24 ? line.substr(2) : line) + "\n";
  const Profile everything = read(all);
  EXPECT_EQ(everything.settings, settings::Values{});
  constexpr std::size_t settings_of_an_axis = 11;
  EXPECT_EQ(everything.stated.count(), settings::setting_count - settings_of_an_axis);
}

TEST(Profile, CommandLineSetsEveryAxis) {
  Profile profile;
  set_acceleration(profile, 10);
  set_speed(profile, 0.1);
  for (int axis = 0; axis < lamplock::max_axes; ++axis) {
    EXPECT_EQ(profile.settings.whole(settings::for_axis(Id::acceleration_x, axis)), 10'000);
    EXPECT_EQ(profile.settings.whole(settings::for_axis(Id::max_rate_x, axis)), 6'000);
  }
  EXPECT_THROW(set_lamp_hz(profile, 0), Error);
  EXPECT_THROW(set_acceleration(profile, -1), Error);
  EXPECT_THROW(set_speed(profile, 1e12), Error);
}

}  // namespace
}  // namespace lamplock::job
