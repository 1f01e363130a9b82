// The travel of the board by its own settings: the work space of pages, limits of a motion to
// a place; jogs while a program waits for a tool.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::travel_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Whether the area gets this side in X.
bool has_side(RawClient& client, double low, double high) {
  return comes_true([&] {
    const Json area = client.call("machine.area")["result"];
    return area[0][0] == low && area[1][0] == high;
  });
}

TEST(Travel, is_that_of_the_board) {
  RunningServer server;
  RawClient client = server.controller();
  EXPECT_TRUE(has_side(client, -50, 50)) << "defaults";
  const Json changes{{"travel_x", 70}, {"min_corner_x", -10}};
  EXPECT_EQ(error_of(client.call("settings.set", {{"changes", changes}})), "");
  EXPECT_TRUE(has_side(client, -10, 60)) << "after settings.set";
  client.call("console.send", {{"line", "$130=80"}});
  EXPECT_TRUE(has_side(client, -10, 70)) << "after a line of the console";
  server.add_file("a.ngc", "G21G90\nG1X5F600\n");
  EXPECT_EQ(client.call("path.open", {{"name", "a.ngc"}})["result"]["area"][1][0], 70);
}

TEST(Travel, limits_a_motion_to_a_place) {
  RunningServer server;
  RawClient client = server.client("client");
  client.call("subscribe");
  client.call("control.take");
  ASSERT_TRUE(has_side(client, -50, 50));
  client.watch(150ms);
  const auto go = [&](const Json& place) {
    Json given = place;
    given["feed"] = 3000;
    given["seen"] = client.time();
    return error_of(client.call("jog.go", given));
  };
  EXPECT_THAT(
      go({{"x", 50.5}}),
      HasSubstr("X 50.500 lies outside of the travel of the machine, -50.000 to 50.000 mm"));
  EXPECT_THAT(go({{"x", 1}, {"y", -50.001}}), HasSubstr("Y -50.001"));
  client.watch(300ms);
  EXPECT_EQ(server.machine().view().board.machine_mm.at(0), 0) << "nothing moves";
  EXPECT_EQ(go({{"x", 1}}), "");
}

/// Whether the machine comes to a place of X.
bool comes_to(const RunningServer& server, double x) {
  return comes_true(
      [&] { return std::abs(server.machine().view().board.machine_mm.at(0) - x) < 0.01; });
}

bool waits_for_tool(const RunningServer& server) {
  return comes_true([&] { return server.machine().view().job.word == "tool change"; });
}

TEST(ToolChange, steps_move_the_machine_and_the_program_continues) {
  RunningServer server;
  server.add_file("tool.ngc", "G21G90\nG0X2\nT3M6\nG1X9F3000\n");
  RawClient client = server.client("client"), watcher = server.client("watcher");
  client.call("subscribe");
  client.call("control.take");
  client.call("job.start", {{"name", "tool.ngc"}});
  ASSERT_TRUE(waits_for_tool(server));
  const Json step{{"axis", 0}, {"mm", 3}, {"feed", 1000}};
  EXPECT_THAT(error_of(watcher.call("jog.step", step)), HasSubstr("take control first"));
  EXPECT_EQ(error_of(client.call("jog.step", step)), "");
  EXPECT_TRUE(comes_to(server, 5));
  client.watch(200ms);  // the time of the server
  const Json held{{"direction", {1, 0, 0}}, {"feed", 1000}, {"seen", client.time()}};
  EXPECT_THAT(error_of(client.call("jog.run", held)), HasSubstr("only steps"));
  ASSERT_TRUE(waits_for_tool(server));
  client.call("machine.resume");
  EXPECT_EQ(server.wait_for_end(), "done");
  EXPECT_TRUE(comes_to(server, 9));
}

TEST(ToolChange, lines_of_the_console_touch_off_the_tool) {
  RunningServer server;
  server.add_file("tool.ngc", "G21G90\nG0X2\nT3M6\nG1X9F3000\n");
  RawClient client = server.client("client"), watcher = server.client("watcher");
  client.call("control.take");
  client.call("job.start", {{"name", "tool.ngc"}});
  ASSERT_TRUE(waits_for_tool(server));
  const auto send = [&](RawClient& sender, const char* line) {
    return error_of(sender.call("console.send", {{"line", line}}));
  };
  EXPECT_THAT(send(watcher, "G0X5"), HasSubstr("take control first"));
  EXPECT_EQ(send(client, "G0X5"), "");
  EXPECT_TRUE(comes_to(server, 5));
  ASSERT_TRUE(waits_for_tool(server));
  EXPECT_EQ(error_of(client.call("machine.zero", {{"axes", "X"}})), "");
  client.call("macro.set", {{"name", "two"}, {"lines", "G0X6\nG0X7"}});
  EXPECT_THAT(error_of(client.call("macro.run", {{"name", "two"}})), HasSubstr("one line"));
  EXPECT_THAT(send(client, "G0X1~"), HasSubstr("real-time"));
  for (const char* key : {"!", "+", "-10", "=", "~"})
    EXPECT_NE(send(client, key), "") << "a key of the program is not a line of the board: " << key;
  client.watch(300ms);
  ASSERT_TRUE(waits_for_tool(server));
  client.call("machine.resume");
  EXPECT_EQ(server.wait_for_end(), "done");
  EXPECT_TRUE(comes_to(server, 14)) << "X9 of the work, whose zero is at 5";
  Json lines = client.call("console.lines")["result"];
  const auto is_sent = [](const Json& line) { return line["text"] == "> G0X5"; };
  EXPECT_TRUE(std::ranges::any_of(lines, is_sent));
}

TEST(ToolChange, sends_lines_that_come_before_the_answer_to_others) {
  RunningServer server;
  RawClient client = server.start("tool.ngc", "G21G90\nG0X2\nT3M6\nG1X9F3000\n");
  ASSERT_TRUE(waits_for_tool(server));
  for (const char* line : {"G0X30", "G0X5", "G10L20P1X0"})
    EXPECT_EQ(error_of(client.call("console.send", {{"line", line}})), "");
  client.call("machine.resume");
  EXPECT_EQ(server.wait_for_end(), "done");
  EXPECT_TRUE(comes_to(server, 14))
      << "X9 of the work, whose zero is at 5: resumed after all lines";
}

TEST(ToolChange, stop_ends_a_step) {
  RunningServer server;
  server.add_file("tool.ngc", "G21G90\nT3M6\nG1X9F3000\n");
  RawClient client = server.client("client"), watcher = server.client("watcher");
  client.call("control.take");
  client.call("job.start", {{"name", "tool.ngc"}});
  ASSERT_TRUE(waits_for_tool(server));
  client.call("jog.step", {{"axis", 0}, {"mm", 10}, {"feed", 200}});
  std::this_thread::sleep_for(500ms);
  watcher.call("machine.stop");
  EXPECT_EQ(server.wait_for_end(), "stopped");
  EXPECT_LT(server.machine().view().board.machine_mm.at(0), 8);
}

}  // namespace
}  // namespace lamplock::serve::test::travel_test
