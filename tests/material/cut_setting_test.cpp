// Settings for a cut by laser, material, thickness and operation; what the library lacks is named.
#include "host/material/cut_setting.hpp"

#include <gmock/gmock.h>

#include <string>

#include "host/error.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::material::cut_setting_test {
namespace {

using testing::HasSubstr;

Setting setting_with(const char* laser, std::optional<double> thickness_mm, double feed_mm_min) {
  Setting one;
  one.material = "plywood";
  one.laser = laser;
  one.thickness_mm = thickness_mm;
  one.feed_mm_min = feed_mm_min;
  one.power_w = 2;
  return one;
}

class CutSettings : public testing::Test {
 protected:
  CutSettings() {
    Library::change(folder_.file("a.db"), [](Library& library) {
      Laser second = library.laser("diode-3w");
      second.name = "diode-10w";
      second.power_w = 10;
      library.add(second);
      library.add(setting_with("diode-10w", 3, 600));
      library.add(setting_with("diode-10w", std::nullopt, 100));
      Setting score = setting_with("diode-10w", 4, 900);
      score.operation = "score";
      score.air = true;
      score.kerf_mm = 0.15;
      score.frequency_hz = 2e4;
      library.add(score);
      library.add(setting_with("diode-3w", 3, 240));
    });
  }
  CutSetting found(const CutQuery& query) {
    Library library = Library::for_reading(folder_.file("a.db"));
    return cut_setting(library, query);
  }
  std::string refusal(const CutQuery& query) {
    return test::error_of([&] { found(query); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(CutSettings, are_those_of_the_thickness_or_of_any) {
  const CutSetting cut = found({"plywood", "diode-10w", 3});
  EXPECT_EQ(cut.feed_mm_min, 600);
  EXPECT_EQ(cut.power_w, 2);
  EXPECT_EQ(cut.power_share, 0.2);
  EXPECT_EQ(cut.passes, 1);
  EXPECT_EQ(found({"plywood", "diode-10w", 2.9}).feed_mm_min, 100);
  EXPECT_EQ(found({"plywood", "diode-10w", {}}).feed_mm_min, 100);
  EXPECT_EQ(found({"plywood", "diode-3w", 5}).feed_mm_min, 180) << "delivered";
  EXPECT_EQ(found({"plywood", "diode-3w", 5}).passes, 7);
  const CutSetting score = found({"plywood", "", 4, "score"});
  EXPECT_EQ(score.laser, "diode-10w") << "the only one with a setting to score";
  EXPECT_TRUE(score.air);
  EXPECT_EQ(score.kerf_mm, 0.15);
  EXPECT_EQ(score.frequency_hz, 2e4);
}

TEST_F(CutSettings, use_the_thickness_of_the_material) {
  Library::change(folder_.file("a.db"), [](Library& library) {
    Material plywood = library.material("plywood");
    plywood.thickness_mm = 3;
    library.replace(plywood);
  });
  EXPECT_EQ(found({"plywood", "diode-10w", {}}).feed_mm_min, 600);
  EXPECT_EQ(found({"plywood", "diode-10w", {}}).thickness_mm, 3);
}

TEST_F(CutSettings, name_what_the_library_lacks) {
  EXPECT_THAT(refusal({"plywod", "", 3}), HasSubstr("did you mean 'plywood'?"));
  EXPECT_THAT(refusal({"plywood", "diode-3v", 3}), HasSubstr("laser diode-3v: the library has no"));
  EXPECT_THAT(refusal({"plywood", "", 3}), HasSubstr("name the laser: diode-10w, diode-3w"));
  EXPECT_THAT(refusal({"plywood", "diode-3w", 4}),
              HasSubstr("material plywood: there is no setting for 4 mm; add one, or use one of "
                        "the settings for 3, 5 mm"));
  EXPECT_THAT(refusal({"plywood", "diode-3w", {}}), HasSubstr("its thickness is not known"));
  EXPECT_THAT(refusal({"plywood", "diode-3w", 3, "engrave"}),
              HasSubstr("no setting for the operation engrave with the laser diode-3w"));
  EXPECT_THAT(refusal({"plywood", "", 3, "engarve"}), HasSubstr("did you mean 'engrave'?"));
  EXPECT_THAT(refusal({"pmma-yellow", "", 3}), HasSubstr("it cannot be cut"));
}

}  // namespace
}  // namespace lamplock::material::cut_setting_test
