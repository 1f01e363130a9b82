// Status reports, byte for byte as in grbl 1.1.
#include "firmware/machine/console/status_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lamplock::machine {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::uint32_t usual_mask = report_machine_position | report_buffer;

std::string report(StatusReporter& reporter, const ReportedStatus& status,
                   std::uint32_t mask = usual_mask, InchAxes inches = {}) {
  TextLine line;
  reporter.begin(line, status, mask, inches);
  line.add(">");
  return std::string(line.view());
}

ReportedStatus idle() {
  ReportedStatus status;
  status.state = "Idle";
  status.free_lines = 128;
  status.free_bytes = 1024;
  return status;
}

TEST(StatusReport, IsWhatSendersExpect) {
  StatusReporter reporter;
  EXPECT_EQ(report(reporter, idle(), report_machine_position),
            "<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>");
  EXPECT_EQ(report(reporter, idle(), report_machine_position),
            "<Idle|MPos:0.000,0.000,0.000|FS:0,0|Ov:100,100,100>");
  ReportedStatus run = idle();
  run.state = "Run";
  run.busy = true;
  run.machine_e7 = {123'450'000, -4'999, -5'001, 10'000'000};
  run.axes = 4;
  run.free_lines = 3;
  run.free_bytes = 67;
  run.feed_um_min = 6'000'499;
  run.speed_milli = 499'500;
  run.line = 99'999;
  run.pins = 0x1ff;
  run.overrides = {120, 50, 90};
  run.counterclockwise = run.mist = run.flood = true;
  EXPECT_EQ(report(reporter, run),
            "<Run|MPos:12.345,0.000,-0.001,1.000|Bf:3,67|Ln:99999|FS:6000,500|Pn:PXYZADRHS"
            "|Ov:120,50,90|A:CFM>");
}

TEST(StatusReport, WorkPositionIsMachinePositionLessTheOffset) {
  StatusReporter reporter;
  ReportedStatus status = idle();
  status.machine_e7 = {10'000'000, 20'000'000, 30'000'000};
  status.work_offset_e7 = {-5'000'000, 30'000'000, 30'000'000};
  EXPECT_EQ(report(reporter, status, 0),
            "<Idle|WPos:1.500,-1.000,0.000|FS:0,0|WCO:-0.500,3.000,3.000>");
}

TEST(StatusReport, InchesHaveFourDecimals) {
  StatusReporter reporter;
  ReportedStatus status = idle();
  status.machine_e7 = {254'000'000, -12'700, 25'399'999};
  status.feed_um_min = 254'000;
  EXPECT_EQ(report(reporter, status, report_machine_position, {0xf}),
            "<Idle|MPos:1.0000,-0.0001,0.1000|FS:10.0,0|WCO:0.0000,0.0000,0.0000>");
}

TEST(StatusReport, ARotaryAxisIsInDegreesBesideInches) {
  settings::Values values;
  values.set_milli(settings::Id::report_inches, 1000);
  ReportedStatus status = idle();
  status.axes = 4;
  status.machine_e7 = {254'000'000, 0, 0, 900'000'000};
  StatusReporter length;
  EXPECT_THAT(report(length, status, report_machine_position, inch_axes(values)),
              HasSubstr("|MPos:1.0000,0.0000,0.0000,3.5433|"));
  values.set_milli(settings::Id::rotary_axis, 1000);
  status.work_offset_e7[3] = 100'000'000;
  StatusReporter rotary;
  const std::string text = report(rotary, status, report_machine_position, inch_axes(values));
  EXPECT_THAT(text, HasSubstr("|MPos:1.0000,0.0000,0.0000,90.000|"));
  EXPECT_THAT(text, HasSubstr("|WCO:0.0000,0.0000,0.0000,10.000"));
  status.feed_um_min = 254'000;
  EXPECT_THAT(report(rotary, status, report_machine_position, inch_axes(values)),
              HasSubstr("|FS:10.0,0"));
  status.feed_in_degrees = true;
  EXPECT_THAT(report(rotary, status, report_machine_position, inch_axes(values)),
              HasSubstr("|FS:254,0"));
  values.set_milli(settings::Id::report_inches, 0);
  EXPECT_FALSE(inch_axes(values).any());
}

/// Indices of the next reports that contain a field, from 0.
std::vector<int> places(StatusReporter& reporter, const ReportedStatus& status, const char* field,
                        int reports) {
  std::vector<int> found;
  for (int i = 0; i < reports; ++i)
    if (report(reporter, status).find(field) != std::string::npos) found.push_back(i);
  return found;
}

TEST(StatusReport, OffsetsAndOverridesAreSentPeriodically) {
  ReportedStatus busy = idle();
  busy.state = "Run";
  busy.busy = true;
  StatusReporter reporter;
  EXPECT_THAT(places(reporter, idle(), "WCO:", 25), testing::ElementsAre(0, 10, 20));
  reporter.reset();
  EXPECT_THAT(places(reporter, busy, "WCO:", 65), testing::ElementsAre(0, 30, 60));
  reporter.reset();
  EXPECT_THAT(places(reporter, idle(), "Ov:", 25), testing::ElementsAre(1, 11, 21));
  reporter.reset();
  EXPECT_THAT(places(reporter, busy, "Ov:", 45), testing::ElementsAre(1, 21, 41));
}

TEST(StatusReport, AChangeIsReportedAtOnceAndOnce) {
  StatusReporter reporter;
  ReportedStatus status = idle();
  for (int i = 0; i < 4; ++i) report(reporter, status);
  status.work_offset_e7[2] = 1'000'000;
  EXPECT_THAT(report(reporter, status), HasSubstr("|WCO:0.000,0.000,0.100"));
  EXPECT_THAT(report(reporter, status), Not(HasSubstr("WCO")));
  status.overrides.feed = 110;
  EXPECT_THAT(report(reporter, status), HasSubstr("|Ov:110,100,100"));
  EXPECT_THAT(report(reporter, status), Not(HasSubstr("Ov")));
}

TEST(StatusReport, TheLongestTextFitsALine) {
  StatusReporter reporter;
  ReportedStatus status = idle();
  status.state = "Hold:1";
  status.axes = 4;
  status.machine_e7.fill(-program::max_position_e7);
  status.work_offset_e7.fill(-program::max_position_e7);
  status.line = 9'999'999;
  status.feed_um_min = 4'000'000'000;
  status.speed_milli = 4'000'000'000;
  status.pins = 0x1ff;
  status.overrides = {200, 100, 200};
  status.clockwise = status.flood = status.mist = true;
  const std::string text = report(reporter, status);
  EXPECT_EQ(text.back(), '>');
  // Room for the fields of the lamp: two numbers and thirteen counters of ten digits.
  EXPECT_LE(text.size() + 160, TextLine::capacity) << text;
}

}  // namespace
}  // namespace lamplock::machine
