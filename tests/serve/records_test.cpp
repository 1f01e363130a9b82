// Macros of the console, the history of jobs and the material library, by the methods of clients.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::records_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// The history when it has this many jobs; they are written a moment after their end.
Json history_of(RawClient& client, std::size_t jobs) {
  Json history;
  comes_true([&] {
    history = client.call("history.list")["result"];
    return history.size() >= jobs;
  });
  return history;
}

TEST(Macros, are_kept_by_the_server_and_sent_as_lines) {
  RunningServer server;
  RawClient client = server.client("client");
  EXPECT_THAT(error_of(client.call("macro.set", {{"name", "a"}, {"lines", "G91"}})),
              HasSubstr("take control first"));
  client.call("control.take");
  const Json square{{"name", "to the corner"}, {"lines", "G21G90 ; mm\n\nG0X3\nG0Y2\n"}};
  EXPECT_EQ(error_of(client.call("macro.set", square)), "");
  EXPECT_EQ(error_of(client.call("macro.set", {{"name", "zero"}, {"lines", "G0X0Y0"}})), "");
  RawClient other = server.client("other");
  const Json macros = other.call("macro.list")["result"];
  EXPECT_EQ(macros, (Json{{"to the corner", square["lines"]}, {"zero", "G0X0Y0"}}));
  EXPECT_NE(error_of(other.call("macro.run", {{"name", "zero"}})), "") << "without control";
  EXPECT_EQ(error_of(client.call("macro.run", {{"name", "to the corner"}})), "");
  std::this_thread::sleep_for(800ms);
  EXPECT_NEAR(server.machine().view().board.machine_mm.at(0), 3, 0.01);
  EXPECT_NEAR(server.machine().view().board.machine_mm.at(1), 2, 0.01);
  // The lines after a refused one are not sent.
  const Json faulty{{"name", "faulty"}, {"lines", "G0X5\nG1Y\nG0X9\nG0X11"}};
  EXPECT_EQ(error_of(client.call("macro.set", faulty)), "");
  EXPECT_EQ(error_of(client.call("macro.run", {{"name", "faulty"}})), "");
  std::this_thread::sleep_for(800ms);
  EXPECT_NEAR(server.machine().view().board.machine_mm.at(0), 5, 0.01);
  EXPECT_THAT(client.call("console.lines")["result"].dump(),
              HasSubstr("not sent after it: 2 lines"));
  EXPECT_EQ(error_of(client.call("macro.remove", {{"name", "zero"}})), "");
  EXPECT_THAT(error_of(client.call("macro.run", {{"name", "zero"}})),
              HasSubstr("there is no macro of this name"));
  EXPECT_EQ(client.call("job.list")["result"].size(), 0u) << "macros are no files of clients";
}

TEST(Macros, refuse_what_a_board_would_execute_at_once) {
  RunningServer server;
  RawClient client = server.controller();
  const auto refusal = [&](const std::string& lines) {
    return error_of(client.call("macro.set", {{"name", "m"}, {"lines", lines}}));
  };
  EXPECT_THAT(refusal("G0X1\nG0X2~"), HasSubstr("macro m, line 2"));
  EXPECT_THAT(refusal("; nothing\n\n"), HasSubstr("has 0 lines"));
  std::string many;
  for (int i = 0; i < 51; ++i) many += "G0X1\n";
  EXPECT_THAT(refusal(many), HasSubstr("has 51 lines"));
  EXPECT_EQ(client.call("macro.list")["result"], Json::object());
}

TEST(History, has_each_job_with_its_end) {
  RunningServer server;
  std::string text = "G21G90\nM3S500\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("G1X{}F3000\n", i % 2 == 0 ? 40 : -40);
  server.add_file("long.ngc", text);
  server.add_file("short.ngc", "G21G90\nG1X1F3000\n");
  RawClient client = server.controller();
  EXPECT_EQ(client.call("history.list")["result"], Json::array());
  client.call("job.start", {{"name", "short.ngc"}});
  EXPECT_EQ(server.wait_for_end(), "done");
  EXPECT_TRUE(server.wait_for_state("Idle"));
  client.call("job.start", {{"name", "long.ngc"}, {"dry", true}});
  client.watch(500ms);
  client.call("machine.stop");
  EXPECT_EQ(server.wait_for_end(), "stopped");
  const Json history = history_of(client, 2);
  ASSERT_EQ(history.size(), 2u);
  const Json &last = history[0], &first = history[1];
  EXPECT_EQ(first["file"], "short.ngc");
  EXPECT_EQ(first["board"], "virtual");
  EXPECT_EQ(first["result"], "done");
  EXPECT_EQ(first["item"], "line");
  EXPECT_EQ(first["done"], 2);
  EXPECT_EQ(first["total"], 2);
  EXPECT_EQ(first["dry"], false);
  EXPECT_EQ(first["wasted_beats"], Json());
  EXPECT_LE(first["begin"], first["end"]);
  EXPECT_EQ(last["result"], "stopped");
  EXPECT_EQ(last["dry"], true);
  EXPECT_LT(last["done"], last["total"]);
}

TEST(Materials, are_those_of_the_library) {
  RunningServer server;
  const Json rows = server.client("client").call("material.list")["result"];
  ASSERT_FALSE(rows.empty());
  EXPECT_TRUE(rows[0]["feed"].is_number());
  EXPECT_EQ(rows[0]["laser"], "diode-3w");
}

}  // namespace
}  // namespace lamplock::serve::test::records_test
