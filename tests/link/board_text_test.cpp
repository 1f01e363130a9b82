// Texts of boards, and programs as they are sent.
#include "host/link/board_text.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "host/link/program_lines.hpp"
#include "tests/error_of.hpp"

namespace lamplock::link {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(BoardText, status_reports) {
  const auto status = parse_status(
      "<Hold:1|MPos:12.345,0.000,-1.500,2.000|Bf:3,67|FS:6000,500|New:1,2|WCO:1.000,0.000,0.500>");
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, "Hold");
  EXPECT_EQ(status->substate, 1);
  EXPECT_THAT(status->position, ElementsAre(12.345, 0, -1.5, 2));
  EXPECT_FALSE(status->of_work);
  EXPECT_THAT(status->work_offset, ElementsAre(1, 0, 0.5));
  EXPECT_EQ(status->free_bytes, 67u);
  EXPECT_EQ(status->feed, 6000);
  EXPECT_EQ(status->speed, 500);
  EXPECT_THAT(status->overrides, IsEmpty());
  EXPECT_THAT(parse_status("<Idle|Ov:110,100,90>")->overrides, ElementsAre(110, 100, 90));
  const auto idle = parse_status("<Idle|WPos:0.000,0.000,0.000|FS:0,0>");
  ASSERT_TRUE(idle);
  EXPECT_EQ(idle->substate, -1);
  EXPECT_TRUE(idle->of_work);
  EXPECT_FALSE(idle->free_bytes);
}

TEST(BoardText, broken_reports_are_tolerated) {
  EXPECT_FALSE(parse_status("ok"));
  EXPECT_FALSE(parse_status("<>"));
  EXPECT_FALSE(parse_status("<Idle|MPos:0,0,0"));
  const auto odd = parse_status("<Idle|MPos:1,x,3|Bf:|Bf:9|||:>");
  ASSERT_TRUE(odd);
  EXPECT_THAT(odd->position, IsEmpty());
  EXPECT_THAT(parse_status("<Idle|FS:1|Ov:9999999999,x>")->overrides, ElementsAre(0, 0));
  EXPECT_FALSE(odd->free_bytes);
}

TEST(BoardText, states_at_rest) {
  const auto at_rest = [](const char* state) {
    return parse_status(fmt::format("<{}|FS:0,0>", state))->is_at_rest();
  };
  for (const char* state : {"Idle", "Check", "Hold:0", "Door:0", "Door:1", "Alarm", "Sleep"})
    EXPECT_TRUE(at_rest(state)) << state;
  for (const char* state : {"Run", "Hold:1", "Door:2", "Door:3", "Jog", "Home"})
    EXPECT_FALSE(at_rest(state)) << state;
}

TEST(BoardText, answers_alarms_banners) {
  EXPECT_EQ(parse_answer("ok"), 0);
  EXPECT_EQ(parse_answer("error:20"), 20);
  EXPECT_FALSE(parse_answer("error:"));
  EXPECT_FALSE(parse_answer("okay"));
  EXPECT_FALSE(parse_answer(">G54:ok"));
  EXPECT_EQ(parse_alarm("ALARM:9"), 9);
  EXPECT_FALSE(parse_alarm("ALARM:9x"));
  EXPECT_TRUE(is_banner("Grbl 1.1h ['$' for help]"));
  EXPECT_FALSE(is_banner("[MSG:Grbl]"));
}

TEST(BoardText, identity) {
  BoardIdentity identity;
  EXPECT_TRUE(take_identity("[VER:1.1h.20261121:lamplock]", identity));
  EXPECT_TRUE(take_identity("[OPT:VN,35,1024,3,0]", identity));
  EXPECT_FALSE(take_identity("[MSG:x]", identity));
  EXPECT_EQ(identity.version, "1.1h.20261121:lamplock");
  EXPECT_EQ(identity.options, "VN");
  EXPECT_EQ(identity.window_bytes, 1024u);
  BoardIdentity plain;
  EXPECT_TRUE(take_identity("[OPT:V]", plain));
  EXPECT_EQ(plain.window_bytes, 0u);
}

TEST(BoardText, texts_of_numbers) {
  EXPECT_EQ(error_text(22), "error:22 the feed is zero or has not been set");
  EXPECT_EQ(error_text(279), "error:279 unknown to this program");
  EXPECT_EQ(message_text("[MSG:Host lost: program held]"), "Host lost: program held");
  EXPECT_EQ(message_text("ALARM:2"), alarm_text(2));
  EXPECT_EQ(message_text("[PRB:0,0,0:1]"), "[PRB:0,0,0:1]");
  EXPECT_EQ(alarm_text(2), "ALARM:2 the target is outside the work space");
  EXPECT_EQ(alarm_text(99), "ALARM:99 unknown to this program");
  EXPECT_EQ(alarm_text(-1), "ALARM:-1 unknown to this program");
}

TEST(ProgramLines, comments_and_blank_lines_are_not_sent) {
  const auto lines = program_lines(
      "\xEF\xBB\xBF%\r\n(ready? caf\xC3\xA9!)\nG1 (one) X1 (two); three ~\r\r\n  G0 X2\t\n"
      "G1 X3 (open\n$N0=G21 (x)\nM30",
      "a.nc");
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0].text, "G1  X1");
  EXPECT_EQ(lines[0].number, 3u);
  EXPECT_EQ(lines[1].text, "G0 X2");
  EXPECT_EQ(lines[1].number, 5u);
  EXPECT_EQ(lines[2].text, "G1 X3");
  EXPECT_EQ(lines[3].text, "$N0=G21 (x)");
  EXPECT_EQ(lines[4].text, "M30");
  EXPECT_EQ(lines[4].number, 8u);
}

TEST(ProgramLines, bytes_that_command_the_board_are_refused) {
  EXPECT_THAT(error_of([] { program_lines("G21\nG1 X1 !\n", "a.nc"); }),
              HasSubstr("a.nc:2: the byte 0x21"));
  EXPECT_THAT(error_of([] { program_lines("G1\xC2\x90", "a.nc"); }), HasSubstr("a.nc:1"));
  EXPECT_THAT(error_of([] { program_lines("G1\x18", "a.nc"); }), HasSubstr("0x18"));
}

TEST(ProgramLines, pauses_and_dwells) {
  EXPECT_TRUE(is_pause("M0"));
  EXPECT_TRUE(is_pause("G1 X1 m 01"));
  EXPECT_TRUE(is_pause("T2 M00"));
  EXPECT_FALSE(is_pause("M30"));
  EXPECT_FALSE(is_pause("G0 X0"));
  EXPECT_DOUBLE_EQ(max_dwell_s("G4 P2.5"), 2.5);
  EXPECT_DOUBLE_EQ(max_dwell_s("g4p10"), 10);
  EXPECT_DOUBLE_EQ(max_dwell_s("G10 L2 P-1"), 0);
}

}  // namespace
}  // namespace lamplock::link
