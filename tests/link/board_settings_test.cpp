// Settings of a model board: read, checked, and changed either all or none.
#include "host/link/board_settings.hpp"

#include <gmock/gmock.h>

#include "host/error.hpp"
#include "tests/error_of.hpp"
#include "tests/link/grbl_model.hpp"

namespace lamplock::link {
namespace {

using settings::Id;
using test::error_of;
using test::GrblModel;
using testing::HasSubstr;
using testing::IsEmpty;

/// A board with some settings, one of which is unknown to the program.
struct SettingsOfABoard : testing::Test {
  SettingsOfABoard() {
    board.settings = {{100, "200.000"}, {120, "500.000"}, {901, "100.000"}, {9999, "on"}};
  }
  GrblModel board;
  LinePort port{board};
};

TEST_F(SettingsOfABoard, are_read) {
  board.restart();  // the banner must not be read as a setting
  const BoardSettings read = read_settings(port);
  EXPECT_EQ(read.texts, board.settings);
  EXPECT_TRUE(read.has(Id::acceleration_x));
  EXPECT_EQ(read.values.milli(Id::acceleration_x), 500'000);
  EXPECT_FALSE(read.has(Id::travel_x));
  EXPECT_EQ(read.known.count(), 3u);
}

TEST_F(SettingsOfABoard, a_value_that_the_table_does_not_allow_is_kept_as_text) {
  board.settings[120] = "1e9";
  const BoardSettings read = read_settings(port);
  EXPECT_FALSE(read.has(Id::acceleration_x));
  EXPECT_EQ(read.texts.at(120), "1e9");
}

TEST_F(SettingsOfABoard, only_differing_settings_are_written) {
  const BoardSettings before = read_settings(port);
  const auto changes = differing(
      before,
      {parse_change("$120=500", "-"), parse_change("901=50", "-"), parse_change("9999=off", "-")});
  ASSERT_EQ(changes.size(), 2u);
  const BoardSettings after = change_settings(port, before, changes);
  EXPECT_EQ(after.texts.at(901), "50.000");
  EXPECT_EQ(after.texts.at(9999), "off");
  EXPECT_THAT(board.lines, testing::ElementsAre("$901=50.000", "$9999=off"));
}

TEST_F(SettingsOfABoard, values_of_unknown_numbers_are_compared_as_numbers) {
  board.settings[9999] = "7.000";
  EXPECT_THAT(differing(read_settings(port), {parse_change("9999=7", "-")}), IsEmpty());
}

TEST_F(SettingsOfABoard, a_setting_that_depends_on_another_is_tried_again) {
  // 120 may be above 1000 once 901 is below 60.
  board.allows = [](const auto& s) {
    return std::stod(s.at(120)) < 1000 || std::stod(s.at(901)) < 60;
  };
  const BoardSettings before = read_settings(port);
  const BoardSettings after = change_settings(port, before, {{120, "2000.000"}, {901, "50.000"}});
  EXPECT_EQ(after.texts.at(120), "2000.000");
}

TEST_F(SettingsOfABoard, a_refusal_restores_all_settings) {
  board.allows = [](const auto& s) { return std::stod(s.at(120)) < 1000; };
  const BoardSettings before = read_settings(port);
  try {
    change_settings(port, before, {{100, "100.000"}, {120, "2000.000"}, {901, "50.000"}});
    FAIL() << "nothing thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    EXPECT_THAT(error.what(), HasSubstr("$120 acceleration_x"));
    EXPECT_THAT(error.what(), HasSubstr("nothing was changed"));
  }
  EXPECT_EQ(board.settings, before.texts);
}

TEST_F(SettingsOfABoard, missing_settings_are_reported_before_anything_is_sent) {
  const BoardSettings before = read_settings(port);
  EXPECT_THAT(error_of([&] {
                differing(before, {{100, "1.000"}, {130, "5.000"}});
              }),
              HasSubstr("$130 travel_x: the board has no such"));
  EXPECT_THAT(board.lines, IsEmpty());
}

TEST(Change, by_number_or_name) {
  for (const char* text :
       {"120=500", "$120=500.0", "acceleration_x=500", " acceleration_x = 500 "}) {
    const Change change = parse_change(text, "-");
    EXPECT_EQ(change.number, 120u) << text;
    EXPECT_EQ(change.text, "500.000") << text;
  }
  EXPECT_EQ(parse_change("min_corner_x=-12.5", "-").text, "-12.500");
  EXPECT_EQ(parse_change("lamp_mode=2", "-").text, "2");
}

TEST(Change, is_refused_if_the_table_does_not_allow_it) {
  const auto error = [](const char* text) { return error_of([=] { parse_change(text, "f:3"); }); };
  EXPECT_THAT(error("lamp_mode=3"), HasSubstr("f:3: lamp_mode = 3 is out of range; give 0 to 2"));
  EXPECT_THAT(error("lamp_mode=0.5"), HasSubstr("a whole number"));
  EXPECT_THAT(error("120=fast"), HasSubstr("is not a number"));
  EXPECT_THAT(error("120=1.0001"), HasSubstr("is not a number"));
  EXPECT_THAT(error("120="), HasSubstr("is not a number"));
  EXPECT_THAT(error("acceleration=5"), HasSubstr("no setting 'acceleration'"));
  EXPECT_THAT(error("acceleration_x"), HasSubstr("has no value"));
  EXPECT_THAT(error("9999=a!"), HasSubstr("is not a valid value for $9999"));
}

}  // namespace
}  // namespace lamplock::link
