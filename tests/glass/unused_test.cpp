// Options without effect are reported according to the table of parameters, and no others.
#include "host/glass/unused_parameters.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace lamplock::glass::test {
namespace {

using testing::HasSubstr;

const std::vector<std::string> ways{"blue-noise", "slice",         "faces",        "rays",
                                    "solid",      way_of_drawings, way_of_bitmaps, way_of_lists};

/// Changes a parameter to a value other than its default.
struct Change {
  void operator()(double* value) const { *value = *value / 2 + 0.25; }
  void operator()(std::optional<double>* value) const { *value = 0.5; }
  void operator()(int* value) const { ++*value; }
  void operator()(std::optional<int>* value) const { *value = 3; }
  void operator()(bool* value) const { *value = !*value; }
  void operator()(std::optional<bool>* value) const { *value = true; }
  void operator()(std::string* value) const { *value += "x"; }
  void operator()(std::optional<std::string>* value) const { *value = "x"; }
  void operator()(std::optional<Triple>* value) const { *value = Triple{1, 2, 3}; }
  void operator()(std::vector<std::string>* value) const { value->emplace_back("fit"); }
};

TEST(Unused, DefaultsAreNotReported) {
  for (const std::string& way : ways) EXPECT_THAT(unused(Object{}, way), testing::IsEmpty());
  EXPECT_THAT(unused(Description{}, "best"), testing::IsEmpty());
}

TEST(Unused, EveryParameterWithEveryWay) {
  Object untouched;
  const std::size_t count = parameters(untouched).size();
  for (std::size_t i = 0; i < count; ++i)
    for (const std::string& way : ways) {
      Object object;
      const Parameter parameter = parameters(object)[i];
      std::visit(Change{}, parameter.place);
      const bool used = parameter.used_by.empty() ||
                        std::find(parameter.used_by.begin(), parameter.used_by.end(), way) !=
                            parameter.used_by.end();
      EXPECT_EQ(uses(way, parameter.key), used);
      const auto warnings = unused(object, way);
      ASSERT_EQ(warnings.size(), used && parameter.needs.empty() ? 0u : 1u)
          << parameter.key << " " << way;
      if (warnings.empty()) continue;
      EXPECT_THAT(warnings[0], HasSubstr(parameter.option));
      if (used) continue;
      EXPECT_THAT(warnings[0], HasSubstr(way));
      for (const std::string& other : parameter.used_by) EXPECT_THAT(warnings[0], HasSubstr(other));
    }
}

TEST(Unused, WaysAndNeedsExist) {
  Object object;
  const auto all = parameters(object);
  for (const Parameter& parameter : all) {
    for (const std::string& way : parameter.used_by)
      EXPECT_NE(std::find(ways.begin(), ways.end(), way), ways.end()) << parameter.key << way;
    if (parameter.needs.empty()) continue;
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&parameter](const Parameter& other) {
      return other.key == parameter.needs;
    })) << parameter.key;
  }
}

TEST(Unused, OfTheRestOfADescription) {
  Description d;
  d.glass.margin_mm = 5;
  d.order.cone_up = 1;
  d.pause.beats = 9;
  const auto warnings = unused(d, "best");
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_EQ(warnings[0], "--margin does nothing without --block");
  EXPECT_EQ(warnings[1], "--cone-up does nothing with order best; it is for order cone");
  EXPECT_EQ(warnings[2], "--pause-beats (beats) does nothing without --pause-every (every)");
  d.glass.block_mm = Triple{10, 10, 10};
  d.pause.every_points = 5;
  EXPECT_THAT(unused(d, "cone"), testing::IsEmpty());
}

}  // namespace
}  // namespace lamplock::glass::test
