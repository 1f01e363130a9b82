// The stream of executed blocks: each block once and in order, written at its time.
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

std::vector<Json> events_of(const std::string& text) {
  std::vector<Json> events;
  for (const std::string& line : lines(text)) events.push_back(Json::parse(line, nullptr, false));
  return events;
}

/// At 10 mm/s, reports every 50 ms and a round of the sender of 20 ms: 0.7 mm late at most, and 3
/// ms early.
TEST(SendEvents, BlocksAreWrittenAtTheirTime) {
  const Folder folder;
  std::string program = "G21 G90\nM4 S100\n";
  for (int x = 1; x <= 30; ++x)  // not in a straight line, which would be one line of the planner
    program += "G1 X" + std::to_string(x) + (x % 2 == 0 ? " Y0.5 F600\n" : " Y0 F600\n");
  const Finished sent = run({"send", folder.write("p.ngc", program + "G4 P0.2\nM8\nM5\n"),
                             "--board", "virtual", "--events", "-"});
  ASSERT_EQ(sent.status, 0) << sent.err;
  const std::vector<Json> events = events_of(sent.out);
  ASSERT_EQ(events.size(), 36u);
  for (std::size_t i = 0; i < 35; ++i) EXPECT_EQ(events[i]["line"], i + 1);
  for (int x = 1; x < 30; ++x) {
    const Json& event = events[static_cast<std::size_t>(x) + 1];
    const double late_mm = event["position"][0].get<double>() - x;
    EXPECT_GE(late_mm, -0.03) << x;
    EXPECT_LE(late_mm, 0.75) << x;
    EXPECT_EQ(event["state"], "Run");
    EXPECT_EQ(event["outputs"]["spindle"], "M4");
    EXPECT_EQ(event["outputs"]["s"], 100);
    EXPECT_GE(event["time_s"], events[static_cast<std::size_t>(x)]["time_s"]);
  }
  EXPECT_EQ(events[34]["outputs"]["spindle"], "off");
  EXPECT_EQ(events[35]["event"], "end");
  EXPECT_EQ(events[35]["end"], "done");
  EXPECT_EQ(events[35]["state"], "Idle");
}

TEST(SendEvents, RepeatedAndRefusedLinesHaveTheirEvents) {
  const Folder folder;
  const std::string events = folder / "e.jsonl";
  const std::string loop =
      folder.write("l.ngc", "o1 repeat [3]\nG1 X2 F6000\nX1\no1 endrepeat\nM2\n");
  EXPECT_EQ(run({"send", loop, "--board", "virtual", "--events", events}).status, 0);
  std::vector<int> numbers;
  for (const Json& event : events_of(read(events)))
    if (event["event"] == "block") numbers.push_back(event["line"]);
  EXPECT_THAT(numbers, testing::ElementsAre(2, 3, 2, 3, 2, 3, 5));
  const std::string wrong = folder.write("w.ngc", "G1 X2 F6000\nG1 X1 X2\nX1\n");
  const Finished ended =
      run({"send", wrong, "--board", "virtual", "--events", events, "--ignore-errors"});
  EXPECT_EQ(ended.status, 1);
  const std::vector<Json> blocks = events_of(read(events));
  ASSERT_EQ(blocks.size(), 4u);
  EXPECT_FALSE(blocks[0].contains("error"));
  EXPECT_EQ(blocks[1]["error"], 25);
  EXPECT_FALSE(blocks[2].contains("error"));
}

/// A loop of one line; a line that the board answers while it moves.
TEST(SendEvents, NoBlockIsEarlierThanItsMotion) {
  const Folder folder;
  const std::string program =
      folder.write("p.ngc",
                   "G21 G90\n#1=0\no1 repeat [5]\n#1=[#1+4]\nG1 X#1 Y[[#1/4] mod 2] F1200\n"
                   "o1 endrepeat\n$G\nM5\n");
  const Finished sent = run({"send", program, "--board", "virtual", "--events", "-"});
  ASSERT_EQ(sent.status, 0) << sent.err;
  int at = 0;
  for (const Json& event : events_of(sent.out)) {
    if (event["event"] != "block" || event["line"] != 5) continue;
    at += 4;
    EXPECT_GE(event["position"][0].get<double>(), at - 0.06);
    EXPECT_LE(event["position"][0].get<double>(), at + 1.5);
  }
  EXPECT_EQ(at, 20);
}

/// A reader must know before the operator continues that the motion before a pause has ended.
TEST(SendEvents, BlocksBeforeAWaitAreWrittenAtItsBegin) {
  const Folder folder;
  const std::string program =
      folder.write("p.ngc", "G21 G90\nG1 X5 F600\nM0\nG1 X6\nT1 M6\nG1 X7 F600\nG4 P2\nM2\n");
  const Finished sent = run({"send", program, "--board", "virtual", "--events", "-"});
  ASSERT_EQ(sent.status, 0) << sent.err;
  const std::vector<Json> events = events_of(sent.out);
  ASSERT_EQ(events.size(), 9u);
  EXPECT_EQ(events[1]["state"], "Hold");
  EXPECT_NEAR(events[1]["position"][0], 5, 0.01);
  EXPECT_EQ(events[3]["state"], "Tool");
  EXPECT_NEAR(events[3]["position"][0], 6, 0.01);
  EXPECT_LE(events[5]["time_s"].get<double>(), events[6]["time_s"].get<double>() - 1.8);
}

/// The events of an earlier run must not be taken for those of this one.
TEST(SendEvents, ARefusedProgramReplacesThem) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", "G1 X2 F6000\nX1\nM2\n"),
                    wrong = folder.write("w.ngc", "G1 X2 F6000\nG1 X1 X2\n"), events = folder / "e";
  for (const std::vector<std::string>& refused : std::vector<std::vector<std::string>>{
           {"send", wrong, "--board", "virtual"},
           {"send", file, "--board", "virtual", "--from", "99"},
           {"send", folder / "no.ngc", "--board", "virtual"},
           {"send", file, "--board", "virtual", "--material", "x"},
           {"send", file, "--board", folder / "none"}}) {
    EXPECT_EQ(run({"send", file, "--board", "virtual", "--events", events}).status, 0);
    ASSERT_EQ(events_of(read(events)).back()["end"], "done");
    std::vector<std::string> words = refused;
    words.insert(words.end(), {"--events", events});
    const Finished done = run(words);
    EXPECT_NE(done.status, 0);
    const std::vector<Json> seen = events_of(read(events));
    ASSERT_EQ(seen.size(), 1u) << done.err;
    EXPECT_EQ(seen[0]["end"], "refused");
    EXPECT_EQ("error: " + seen[0]["message"].get<std::string>() + "\n", done.err);
  }
}

TEST(SendEvents, ALostStreamDoesNotEndTheProgram) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", "G1 X2 F6000\nX1\nM2\n");
  const Finished none = run({"send", file, "--board", "virtual", "--events", folder / "no/e"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("folder that does not exist"));
  EXPECT_THAT(run({"send", file, "--board", "virtual", "--events", "-", "--json"}).err,
              HasSubstr("--events -: --json writes to stdout, too"));
  EXPECT_THAT(run({"send", file, "--board", "virtual", "--events", file}).err,
              HasSubstr("is an input of this command"));
  EXPECT_EQ(read(file), "G1 X2 F6000\nX1\nM2\n");
  const std::string command = program_path() + " send " + file + " --board virtual --events - 2>" +
                              (folder / "err") + " >/dev/full";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(read(folder / "err"),
              HasSubstr("warning: --events -: cannot be written (No space left on device); the "
                        "program continues without it"));
  EXPECT_THAT(read(folder / "err"), HasSubstr("3 of 3 lines"));
}

}  // namespace
}  // namespace lamplock::cli::test
