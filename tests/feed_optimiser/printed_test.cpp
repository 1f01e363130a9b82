// The printed variant reproduces the two tables of patent PL 242312 B1.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/feed_optimiser/optimise.hpp"

namespace lamplock::feed_optimiser {
namespace {

struct Row {
  double jerk, x_mm, y_mm;
};
struct Table {
  JerkLaw law;
  std::size_t accelerate, hold;
  double switch_jerk;
  std::vector<Row> start, braking;
};

constexpr double start_tolerance_mm = 1e-6, braking_tolerance_mm = 5e-6;

const Table first{{2, 7, 0, 0.1},
                  73,
                  14,
                  10'000 * std::numbers::sqrt2,
                  {{0.0, 61.76487, 172.88918},
                   {128.0, 61.764871, 172.889181},
                   {137.187003, 61.764875, 172.889183},
                   {147.033389, 61.764883, 172.889187},
                   {157.586485, 61.764897, 172.889193},
                   {168.897013, 61.764918, 172.889204},
                   {181.019336, 61.764948, 172.889219},
                   {194.011721, 61.764989, 172.889239},
                   {207.936613, 61.765043, 172.889266},
                   {222.860944, 61.765112, 172.8893},
                   {238.856446, 61.765199, 172.889343},
                   {256.0, 61.765306, 172.889396},
                   {274.374006, 61.765436, 172.889461},
                   {294.066779, 61.765592, 172.889538},
                   {315.17297, 61.765776, 172.88963}},
                  {{14014.1356, 62.908336, 173.456896},
                   {14004.9486, 62.948021, 173.476599},
                   {13995.10221, 62.987703, 173.496301},
                   {13984.54912, 63.027379, 173.515999},
                   {13973.23859, 63.067048, 173.535694},
                   {13961.11626, 63.106708, 173.555385},
                   {13948.12388, 63.146357, 173.57507},
                   {13934.19899, 63.185992, 173.594749},
                   {13919.27466, 63.225613, 173.61442},
                   {13903.27915, 63.265216, 173.634082},
                   {13886.1356, 63.304798, 173.653734},
                   {13867.76159, 63.344358, 173.673375},
                   {13848.06882, 63.383892, 173.693003},
                   {13826.96263, 63.423397, 173.712617},
                   {13804.34158, 63.46287, 173.732215},
                   {13780.09693, 63.502307, 173.751795}}};

const Table second{{14, 2, 1, 0},
                   70,
                   15,
                   6889,
                   {{0.0, 61.76487, 172.88918},
                    {196.0, 61.764872, 172.889181},
                    {225.0, 61.764878, 172.889184},
                    {256.0, 61.764891, 172.88919},
                    {289.0, 61.764913, 172.889201},
                    {324.0, 61.764948, 172.889219},
                    {361.0, 61.765, 172.889244},
                    {400.0, 61.765071, 172.88928},
                    {441.0, 61.765168, 172.889328},
                    {484.0, 61.765293, 172.88939},
                    {529.0, 61.765454, 172.88947},
                    {576.0, 61.765654, 172.889569},
                    {625.0, 61.765901, 172.889692},
                    {676.0, 61.766202, 172.889841},
                    {729.0, 61.766563, 172.89002}},
                   {{6693.0, 63.098057, 173.55109},
                    {6664.0, 63.138446, 173.571142},
                    {6633.0, 63.178828, 173.591192},
                    {6600.0, 63.219201, 173.611236},
                    {6565.0, 63.259562, 173.631275},
                    {6528.0, 63.299906, 173.651305},
                    {6489.0, 63.340229, 173.671325},
                    {6448.0, 63.380528, 173.691333},
                    {6405.0, 63.420798, 173.711326},
                    {6360.0, 63.461033, 173.731303},
                    {6313.0, 63.501228, 173.751259},
                    {6264.0, 63.541376, 173.771192},
                    {6213.0, 63.581471, 173.791098},
                    {6160.0, 63.621505, 173.810975},
                    {6105.0, 63.661472, 173.830818}}};

const Point begin{61.76487, 172.88918, 0}, end{65.23753, 174.61331, 0};

Method example(const JerkLaw& law) {
  Method method{Variant::printed, law, example_period_ms / 1e3, {}};
  method.limits.speed_mm_s.fill(example_speed_mm_s);
  method.limits.accel_mm_s2.fill(example_accel_mm_s2);
  method.limits.jerk_mm_s3.fill(example_jerk_mm_s3);
  return method;
}

OptimisedBlock optimised(const Table& table) {
  const Block block = straight_block(begin, end);
  return optimise({{block}}, example(table.law), "table").front();
}

class Printed : public testing::TestWithParam<const Table*> {};

TEST_P(Printed, HasTheStepsOfTheTable) {
  const Profile profile = optimised(*GetParam()).profile;
  EXPECT_EQ(profile.accelerate, GetParam()->accelerate);
  EXPECT_EQ(profile.hold, GetParam()->hold);
  EXPECT_EQ(profile.brake, 68u);
  EXPECT_NEAR(profile.switch_jerk, GetParam()->switch_jerk, 1e-6);
}

TEST_P(Printed, HasTheRowsOfTheTable) {
  const OptimisedBlock block = optimised(*GetParam());
  const std::vector<Point> at = places(block);
  const std::vector<double> jerk = law_values(block.profile, *block.table);
  for (std::size_t i = 0; i < GetParam()->start.size(); ++i) {
    const Row& row = GetParam()->start[i];
    EXPECT_NEAR(at[i].x, row.x_mm, start_tolerance_mm) << i;
    EXPECT_NEAR(at[i].y, row.y_mm, start_tolerance_mm) << i;
    EXPECT_NEAR(i == 0 ? 0 : jerk[i - 1], row.jerk, 1e-5) << i;
  }
  const std::size_t braking = block.profile.accelerate + block.profile.hold;
  for (std::size_t i = 0; i < GetParam()->braking.size(); ++i) {
    const Row& row = GetParam()->braking[i];
    EXPECT_NEAR(at[braking + i + 1].x, row.x_mm, braking_tolerance_mm) << i;
    EXPECT_NEAR(at[braking + i + 1].y, row.y_mm, braking_tolerance_mm) << i;
    EXPECT_NEAR(jerk[braking + i], row.jerk, 1e-4) << i;
  }
}

TEST_P(Printed, SimulatedBrakingMissesTheEndByLessThanTheTolerance) {
  const OptimisedBlock block = optimised(*GetParam());
  EXPECT_LE(block.profile.missed_mm, 0.01);
  EXPECT_GE(block.profile.missed_mm, 0);
  EXPECT_EQ(places(block).back(), end);
}

TEST(PrintedRecipe, BrakesInShortBlocksToo) {
  // At the end of the patent's own segment the last step is that of 5 mm/s, of 17.5.
  for (const double length_mm : {0.001, 0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 50.0}) {
    const Block block = straight_block({0, 0, 0}, {length_mm, 0, 0});
    const Method method = example({2, 7, 0.05, 0.05});
    const auto at = places(optimise({{block}}, method, "short").front());
    double highest = 0;
    for (std::size_t i = 1; i < at.size(); ++i) highest = std::max(highest, at[i].x - at[i - 1].x);
    EXPECT_LT(at.back().x - at[at.size() - 2].x, 0.5 * highest) << length_mm;
  }
}

INSTANTIATE_TEST_SUITE_P(Tables, Printed, testing::Values(&first, &second));

}  // namespace
}  // namespace lamplock::feed_optimiser
