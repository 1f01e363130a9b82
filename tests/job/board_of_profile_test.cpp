// Profiles that state a pin map: settings that its board does not have are refused by name, all
// others are accepted.
#include "host/job/board_of_profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "host/error.hpp"

namespace lamplock::job {
namespace {

using settings::Id;
using testing::HasSubstr;

/// Empty: accepted.
std::string refusal_of(const std::vector<std::pair<Id, double>>& stated) {
  Profile profile = default_profile();
  for (const auto& [id, value] : stated) state_setting(profile, id, value, "test");
  try {
    require_board_has(profile, "m.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return error.what();
  }
  return "";
}

constexpr double pico = 0, picobob = 3, grblhal_pico = 4, skr_pico = 6;

TEST(BoardOfProfile, RefusesWhatTheBoardLacks) {
  struct Case {
    double map;
    Id id;
    double value;
    const char* what;
  };
  for (const Case& one :
       {Case{skr_pico, Id::enable_invert, 1,
             "enable_invert = 1: the board of pin_map = 6, "
             "skr-pico, has drives that a low level enables"},
        {skr_pico, Id::lamp_mode, 2, "has no LAMP TRIGGER"},
        {skr_pico, Id::drive_current_x, 1300, "has drives with at most 1200 mA"},
        {skr_pico, settings::for_axis(Id::microsteps_x, 3), 3, "has drives with 1, 2, 4"},
        {skr_pico, settings::for_axis(Id::pulse_mode_x, 1), 1, "has STEP and DIR only"},
        {picobob, Id::axes, 4, "has pins for 3 axes"},
        {picobob, Id::channels, 2, "has no shutter of such a channel"},
        {pico, Id::loop, 1, "has no SENSOR"}}) {
    EXPECT_THAT(refusal_of({{Id::pin_map, one.map}, {one.id, one.value}}), HasSubstr(one.what));
    // For any board: the board itself will judge.
    EXPECT_EQ(refusal_of({{one.id, one.value}}), "") << one.what;
  }
  EXPECT_THAT(refusal_of({{Id::pin_map, 63}}), HasSubstr("m.toml: no board has pin_map = 63"));
}

/// Defaults that a board lacks are left to it: it replaces them.
TEST(BoardOfProfile, AcceptsTheRest) {
  for (const double map : {pico, picobob, grblhal_pico, skr_pico}) {
    EXPECT_EQ(refusal_of({{Id::pin_map, map}}), "");
    EXPECT_EQ(
        refusal_of({{Id::pin_map, map}, {Id::axes, 3}, {Id::channels, 1}, {Id::lamp_mode, 1}}), "");
  }
  EXPECT_EQ(refusal_of({{Id::pin_map, grblhal_pico}, {Id::loop, 1}}), "");
  EXPECT_EQ(refusal_of({{Id::pin_map, skr_pico}, {Id::drive_current_x, 1200}, {Id::axes, 4}}), "");
}

}  // namespace
}  // namespace lamplock::job
