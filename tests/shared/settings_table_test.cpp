// The settings table and the reasons of beats: rules that every reader of them relies on.
#include "shared/settings_table.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "shared/beat_reason.hpp"
#include "shared/work_space.hpp"

namespace lamplock::settings {
namespace {

TEST(SettingsTable, NumbersAscendAndAreUnique) {
  for (std::size_t i = 1; i < setting_count; ++i)
    EXPECT_LT(table[i - 1].number, table[i].number) << table[i].name;
}

TEST(SettingsTable, NamesAreUniqueAndDescribed) {
  std::set<std::string_view> names;
  for (const Row& r : table) {
    EXPECT_TRUE(names.insert(r.name).second) << r.name;
    EXPECT_FALSE(r.name.empty());
    EXPECT_FALSE(r.unit.empty()) << r.name;
    EXPECT_FALSE(r.description.empty()) << r.name;
  }
}

TEST(SettingsTable, DefaultsAndBoundsAreValidValues) {
  for (std::size_t i = 0; i < setting_count; ++i) {
    const Row& r = table[i];
    Values values;
    const Id id = static_cast<Id>(i);
    EXPECT_LE(r.min_milli, r.max_milli) << r.name;
    for (const std::int32_t milli : {r.min_milli, r.max_milli, r.default_milli}) {
      EXPECT_TRUE(values.set_milli(id, milli)) << r.name << " " << milli;
      EXPECT_EQ(values.milli(id), milli) << r.name;
    }
    EXPECT_FALSE(values.set_milli(id, r.min_milli - 1)) << r.name;
    EXPECT_FALSE(values.set_milli(id, r.max_milli + 1)) << r.name;
    EXPECT_EQ(values.milli(id), r.default_milli) << r.name << " changed by a refused value";
    if (r.whole) {
      EXPECT_FALSE(values.set_milli(id, r.min_milli + 1)) << r.name;
    }
  }
}

TEST(SettingsTable, AxesFollowEachOtherWithConsecutiveNumbers) {
  for (const Id x_row : {Id::steps_per_mm_x, Id::max_rate_x, Id::acceleration_x, Id::travel_x,
                         Id::min_corner_x, Id::speed_jump_x}) {
    const std::string stem(row(x_row).name.substr(0, row(x_row).name.size() - 1));
    for (int axis = 0; axis < max_axes; ++axis) {
      const Row& r = row(for_axis(x_row, axis));
      EXPECT_EQ(r.name, stem + "xyza"[axis]);
      EXPECT_EQ(r.number, row(x_row).number + axis);
      EXPECT_EQ(r.unit, row(x_row).unit);
      EXPECT_EQ(r.min_milli, row(x_row).min_milli);
      EXPECT_EQ(r.max_milli, row(x_row).max_milli);
    }
  }
}

TEST(SettingsTable, FindsByNumberAndName) {
  for (std::size_t i = 0; i < setting_count; ++i) {
    EXPECT_EQ(find_number(table[i].number), static_cast<Id>(i));
    EXPECT_EQ(find_name(table[i].name), static_cast<Id>(i));
  }
  EXPECT_EQ(find_number(7), Id::count);
  EXPECT_EQ(find_number(65535), Id::count);
  EXPECT_EQ(find_name("no_such_setting"), Id::count);
  EXPECT_EQ(find_name(""), Id::count);
}

TEST(SettingsTable, HashDistinguishesEverySettingForJobs) {
  std::set<std::uint32_t> hashes{Values().hash()};
  for (std::size_t i = 0; i < setting_count; ++i) {
    Values values;
    const Row& r = table[i];
    ASSERT_TRUE(values.set_milli(static_cast<Id>(i),
                                 r.default_milli == r.min_milli ? r.max_milli : r.min_milli));
    EXPECT_EQ(hashes.insert(values.hash()).second, of_jobs(static_cast<Id>(i))) << r.name;
  }
  EXPECT_EQ(Values().hash(), Values().hash());
}

TEST(WorkSpace, RoundsHalfAwayFromZeroAndKeepsMissingAxesAtZero) {
  EXPECT_EQ(steps_from_milli(2, 250'000), 1);    // 0.5 step
  EXPECT_EQ(steps_from_milli(-2, 250'000), -1);  // -0.5 step
  EXPECT_EQ(steps_from_milli(1, 250'000), 0);    // 0.25 step
  EXPECT_EQ(steps_from_milli(50'000, 200'000), 10'000);
  const StepLimits space = work_space(Values());
  EXPECT_EQ(space.min, (StepPosition{-10'000, -10'000, -10'000, 0}));
  EXPECT_EQ(space.max, (StepPosition{10'000, 10'000, 10'000, 0}));
  EXPECT_TRUE(space.contains(0, -10'000));
  EXPECT_TRUE(space.contains(0, 10'000));
  EXPECT_FALSE(space.contains(0, 10'001));
  EXPECT_FALSE(space.contains(3, 1));
}

TEST(BeatReason, EveryReasonHasItsOwnName) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < beat_reason_count; ++i) {
    const std::string_view text = name(static_cast<BeatReason>(i));
    EXPECT_FALSE(text.empty()) << i;
    EXPECT_TRUE(names.insert(text).second) << text;
  }
  EXPECT_EQ(name(BeatReason::fired), "fired");
  EXPECT_EQ(name(BeatReason::dry), "dry");
}

}  // namespace
}  // namespace lamplock::settings
