// Permitted positions of points, and the corresponding positions of the stage.
#include "host/glass/volume.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "host/glass/lens.hpp"
#include "host/glass/material.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"

namespace lamplock::glass::volume_test {
namespace {

using geometry::Bounds;
using geometry::Point;
using lamplock::test::error_of;
using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Bounds work_space{{-50, -50, -50}, {50, 50, 50}};

TEST(Refraction, AStageMoveMovesTheFocusByTheIndexTimesAsMuch) {
  const Refraction k9{1.5168, 30};
  EXPECT_DOUBLE_EQ(k9.stage_z(30), 30);
  EXPECT_DOUBLE_EQ(k9.stage_z(30 - 1.5168), 29);
  EXPECT_NEAR(k9.glass_z(29) - k9.glass_z(28), 1.5168, 1e-12);
  EXPECT_DOUBLE_EQ(k9.stage_z(35), 35);  // in air
  EXPECT_EQ(k9.stage({1, 2, 30}), (Point{1, 2, 30}));
}

TEST(Refraction, ConvertsToTheStageAndBack) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> index(1, 4), mm(-100, 100);
  for (int i = 0; i < lamplock::test::scaled(2000); ++i) {
    const Refraction glass{index(random), mm(random)};
    const Point p{mm(random), mm(random), mm(random)};
    const Point back = glass.glass(glass.stage(p));
    EXPECT_EQ(back.x, p.x);
    EXPECT_EQ(back.y, p.y);
    EXPECT_NEAR(back.z, p.z, 1e-9);
  }
}

TEST(Refraction, WithoutGlassChangesNoBit) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<> mm(-100, 100);
  const Refraction none{1, 12.3};
  for (int i = 0; i < lamplock::test::scaled(1000); ++i) {
    const Point p{mm(random), mm(random), mm(random)};
    EXPECT_EQ(none.stage(p), p);
    EXPECT_EQ(none.glass(p), p);
  }
}

TEST(Materials, HaveTheirIndex) {
  EXPECT_EQ(index_of("k9"), 1.5168);
  EXPECT_EQ(index_of("bk7"), 1.5168);
  EXPECT_EQ(index_of("fused-silica"), 1.458);
  EXPECT_THAT(error_of([] { index_of("butter"); }), HasSubstr("butter"));
  for (const double bad : {0.99, 0.0, -1.5, 4.1, infinity, nan})
    EXPECT_THAT(error_of([=] { require_index(bad, "glass"); }), HasSubstr("index"));
}

TEST(Lenses, RecommendASpacing) {
  EXPECT_EQ(lens_named("f43").spacing_mm, 0.09);
  EXPECT_EQ(lens_named("f70").spacing_mm, 0.13);
  EXPECT_THAT(error_of([] { lens_named("f50"); }), HasSubstr("f50"));
}

TEST(Block, KeepsAMarginInsideItsFaces) {
  const Block block{{10, 20, 30}, {1, 2, 3}, 4};
  EXPECT_EQ(block.outside().low, (Point{-4, -8, -12}));
  EXPECT_EQ(block.outside().high, (Point{6, 12, 18}));
  EXPECT_EQ(block.inside().low, (Point{0, -4, -8}));
  EXPECT_EQ(block.inside().high, (Point{2, 8, 14}));
  EXPECT_EQ(block.entry_mm(), 18);
}

TEST(Block, InvalidBlocksAreRefused) {
  for (const double side : {0.0, -3.0, nan, infinity}) {
    EXPECT_THAT(error_of([=] { require_block({{side, 10, 10}}); }), HasSubstr("no volume"));
    EXPECT_THAT(error_of([=] { require_block({{10, 10, side}}); }), HasSubstr("no volume"));
  }
  EXPECT_THAT(error_of([] {
                require_block({{10, 10, 10}, {nan, 0, 0}});
              }),
              HasSubstr("its middle is not finite"));
  for (const double margin : {-1.0, nan, infinity, 5.0, 7.0})
    EXPECT_THAT(error_of([=] { require_block({{20, 10, 20}, {}, margin}); }), HasSubstr("margin"));
  EXPECT_NO_THROW(require_block({{20, 10, 20}, {}, 4.9}));
}

TEST(Volume, IsTheWorkSpaceByDefault) {
  const Volume volume = volume_of({}, work_space);
  EXPECT_EQ(volume.room().low, work_space.low);
  EXPECT_EQ(volume.room().high, work_space.high);
  EXPECT_FALSE(volume.refraction.bends());
}

TEST(Volume, IsDeeperInGlassThanTheTravelOfTheStage) {
  GlassChoice glass;
  glass.index = 2;
  glass.block_mm = Triple{60, 60, 150};
  glass.block_at_mm = Triple{0, 0, -25};
  const Volume volume = volume_of(glass, work_space);
  EXPECT_EQ(volume.refraction.entry_mm, 50);
  EXPECT_EQ(volume.reach.low.z, -150);
  EXPECT_EQ(volume.room().low.z, -97);
  EXPECT_EQ(volume.room().high.z, 47);
  EXPECT_EQ(volume.room().low.x, -27);
}

TEST(Volume, ImpossibleVolumesAreRefused) {
  GlassChoice glass;
  glass.material = "k9";
  glass.index = 1.5;
  EXPECT_THAT(error_of([&] { volume_of(glass, work_space); }), HasSubstr("both"));
  glass.material.reset();
  glass.index = 0.9;
  EXPECT_THAT(error_of([&] { volume_of(glass, work_space); }), HasSubstr("0.9"));
  glass.index.reset();
  glass.block_mm = Triple{20, 20, 20};
  glass.block_at_mm = Triple{70, 0, 0};
  EXPECT_THAT(error_of([&] { volume_of(glass, work_space); }),
              HasSubstr("outside the machine's travel"));
  glass.block_mm.reset();
  EXPECT_THAT(error_of([&] { volume_of(glass, work_space); }), HasSubstr("no size"));
}

}  // namespace
}  // namespace lamplock::glass::volume_test
