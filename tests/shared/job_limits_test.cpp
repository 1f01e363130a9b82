// Limits of the settings that a job brings: each rule, and which settings have it.
#include "shared/job_limits.hpp"

#include <gtest/gtest.h>

namespace lamplock::settings {
namespace {

TEST(JobLimits, EveryRuleComparesWithTheMachinesValue) {
  EXPECT_FALSE(oversteps(Id::lamp_frequency, 5'000'000, 1'000));  // any
  EXPECT_TRUE(oversteps(Id::steps_per_mm_x, 199'999, 200'000));   // equal
  EXPECT_TRUE(oversteps(Id::steps_per_mm_x, 200'001, 200'000));
  EXPECT_TRUE(oversteps(Id::lamp_warm_up, 9'000, 10'000));  // not_less
  EXPECT_FALSE(oversteps(Id::lamp_warm_up, 11'000, 10'000));
  EXPECT_TRUE(oversteps(Id::max_rate_y, 10'001, 10'000));  // not_more
  EXPECT_FALSE(oversteps(Id::max_rate_y, 9'999, 10'000));
  EXPECT_TRUE(oversteps(Id::jerk_z, 0, 10'000));  // not_more_zero_unlimited
  EXPECT_TRUE(oversteps(Id::jerk_z, 10'001, 10'000));
  EXPECT_FALSE(oversteps(Id::jerk_z, 9'999, 10'000));
  EXPECT_FALSE(oversteps(Id::jerk_z, 10'000, 0));
  EXPECT_TRUE(oversteps(Id::channels, 7'000, 11'000));  // subset
  EXPECT_FALSE(oversteps(Id::channels, 9'000, 11'000));
}

TEST(JobLimits, TheMachinesOwnValueIsAlwaysPermitted) {
  for (std::size_t i = 0; i < setting_count; ++i)
    for (const std::int32_t value :
         {table[i].min_milli, table[i].max_milli, table[i].default_milli})
      EXPECT_FALSE(oversteps(static_cast<Id>(i), value, value)) << table[i].name;
}

TEST(JobLimits, OnlySettingsOfJobsHaveARule) {
  for (const Row& row : table)
    EXPECT_TRUE(row.scope == Scope::jobs || row.rule == Rule::any) << row.name;
}

/// What protects the machine must never become looser by a job.
TEST(JobLimits, ProtectionsCannotBeLoosened) {
  for (const Id id : {Id::soft_limits, Id::hard_limits, Id::lamp_warm_up, Id::lamp_energy,
                      Id::shutter_open, Id::shutter_close, Id::attenuator_settle})
    EXPECT_EQ(row(id).rule, Rule::not_less) << row(id).name;
  for (const Id id : {Id::max_shot_rate, Id::lamp_power, Id::period_tolerance})
    EXPECT_EQ(row(id).rule, Rule::not_more) << row(id).name;
  for (const Id x_row : {Id::max_rate_x, Id::acceleration_x, Id::travel_x, Id::speed_jump_x})
    for (int axis = 0; axis < max_axes; ++axis)
      EXPECT_EQ(row(for_axis(x_row, axis)).rule, Rule::not_more);
  for (const Id id : {Id::max_lamp_frequency, Id::max_lamp_energy, Id::laser_mode})
    EXPECT_FALSE(of_jobs(id)) << row(id).name;
}

TEST(JobLimits, TheWorkSpaceOfAJobIsInsideTheMachines) {
  const Values own;
  Values job;
  EXPECT_TRUE(inside_work_space(job, own, 1));
  ASSERT_TRUE(job.set_milli(Id::min_corner_y, -49'999));  // the upper end is 1 um outside
  EXPECT_FALSE(inside_work_space(job, own, 1));
  ASSERT_TRUE(job.set_milli(Id::travel_y, 99'999));
  EXPECT_TRUE(inside_work_space(job, own, 1));
  ASSERT_TRUE(job.set_milli(Id::min_corner_y, -50'001));
  EXPECT_FALSE(inside_work_space(job, own, 1));
}

TEST(JobLimits, OnAMachineWithALampFreeBeatsOnlyMove) {
  wire::JobHeader header;
  Values own, job;  // master
  EXPECT_EQ(misused_lamp(header, job, own), 0);
  ASSERT_TRUE(job.set_milli(Id::lamp_mode, 0));
  EXPECT_EQ(misused_lamp(header, job, own), 900);
  header.dry = true;
  EXPECT_EQ(misused_lamp(header, job, own), 0);
  ASSERT_TRUE(job.set_milli(Id::lamp_frequency, own.milli(Id::max_lamp_frequency) + 1));
  EXPECT_EQ(misused_lamp(header, job, own), 901);
}

}  // namespace
}  // namespace lamplock::settings
