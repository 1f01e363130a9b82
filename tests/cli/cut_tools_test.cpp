// `lamplock cut` for mills, knives and lathes, texts of single strokes, and on a simulated board.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/cut_program.hpp"

namespace lamplock::cli::test::cut_tools {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using namespace lamplock::test;

class CutTools : public CutPart {
 protected:
  /// With 600 mm/min.
  Finished cut(const Arguments& more) const { return cut_part({"--feed", "600"}, more); }
  std::string refused(const Arguments& more) const {
    return CutPart::refused(cut_part({"--feed", "600", "-o", program_}, more));
  }
};

TEST_F(CutTools, small_arcs_survive_few_decimals) {
  std::string entities;
  for (int i = 0; i < 40; ++i)
    entities +=
        dxf_circle(-45 + 8.137 * (i % 10), -45 + 9.003 * std::floor(i / 10.0), 0.013 + 0.0171 * i);
  entities += dxf_rounded(-40, 30, 20.004, 9.996, 0.0337) + dxf_rounded(10, 30, 20, 10, 0.107);
  drawing(entities);
  for (const int decimals : {2, 3, 4}) {
    const std::string post = folder_.write(
        "p.toml",
        fmt::format("name = \"p\"\nmachine = \"laser\"\ndecimals = {}\nchecked = true\n"
                    "[lines]\nbegin = [\"G21 G90\", \"M4 S0\"]\nrapid = \"G0 X{{x}} Y{{y}} S0\"\n"
                    "line = \"G1 X{{x}} Y{{y}} F{{feed}} S{{power}}\"\n"
                    "arc_cw = \"G2 X{{x}} Y{{y}} I{{i}} J{{j}} F{{feed}} S{{power}}\"\n"
                    "arc_ccw = \"G3 X{{x}} Y{{y}} I{{i}} J{{j}} F{{feed}} S{{power}}\"\n"
                    "end = \"M2\"\n",
                    decimals));
    const Finished finished = cut({"--power", "50", "--post", post, "-o", program_});
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(run({"check", program_}).status, 0);
  }
}

/// The interpreter of the firmware has run each of them: it gives their time.
TEST_F(CutTools, programs_of_all_machines_are_checked) {
  const std::vector<Arguments> machines{
      {"--post", "mill", "--power", "50", "--infeed", "1", "--final-depth", "2.5", "--surface",
       "-6", "--kerf", "2", "--tabs", "2"},
      {"--post", "knife", "--knife-offset", "0.3", "--final-depth", "0.5", "--surface", "-6",
       "--overcut", "1"}};
  for (Arguments machine : machines) {
    machine.insert(machine.end(), {"-o", program_, "--json"});
    const Finished finished = cut(machine);
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_GT(json::parse(finished.out)["seconds"].get<double>(), 5);
    EXPECT_EQ(run({"check", program_}).status, 0);
  }
}

TEST_F(CutTools, what_a_machine_does_not_have_is_refused) {
  EXPECT_THAT(refused({"--post", "mill", "--power", "50"}), HasSubstr("has no depth"));
  EXPECT_THAT(refused({"--post", "knife", "--final-depth", "1"}), HasSubstr("knife offset"));
  const Arguments knife{"--post", "knife", "--knife-offset", "0.3", "--final-depth", "1"};
  const auto with = [](Arguments all, const Arguments& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_THAT(refused(with(knife, {"--kerf", "0.2"})), HasSubstr("a knife has no kerf"));
  EXPECT_THAT(refused(with(knife, {"--lead-in", "line"})), HasSubstr("a knife has no leads"));
  EXPECT_THAT(refused({"--power", "50", "--post", "mill", "--final-depth", "1", "--tabs", "2"}),
              HasSubstr("give the diameter as kerf"));
  EXPECT_THAT(refused({"--power", "50", "--ramp-angle", "5"}), HasSubstr("ramp angle"));
  EXPECT_THAT(refused({"--power", "50", "--post", "lathe", "--tabs", "2"}),
              HasSubstr("a lathe has no tabs"));
  EXPECT_THAT(refused({"--power", "50", "--post", "lathe", "--board", "virtual", "--yes"}),
              HasSubstr("not for a lamplock board"));
}

TEST_F(CutTools, texts_are_lines_of_single_strokes) {
  const std::string file =
      folder_.write("text.dxf", dxf_drawing("0\nTEXT\n8\nT\n10\n1\n20\n2\n40\n6\n1\nHi\n", 4));
  const Finished listed = run({"cut", file, "--list", "--text", "stroke", "--json"});
  ASSERT_EQ(listed.status, 0) << listed.err;
  const json shapes = json::parse(listed.out)["shapes"];
  ASSERT_EQ(shapes.size(), 5U) << "three strokes of H, two of i";
  for (const json& shape : shapes) EXPECT_EQ(shape["kind"], "open");
  EXPECT_NEAR(shapes[0]["length_mm"].get<double>(), 6, 1e-9) << "as high as the text";
}

TEST_F(CutTools, runs_on_a_simulated_board) {
  const Finished finished =
      cut({"--power", "50", "--kerf", "0.2", "--board", "virtual", "--yes", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json document = json::parse(finished.out);
  EXPECT_EQ(document["run"]["end"], "done");
  EXPECT_NEAR(document["run"]["seconds"].get<double>(), document["seconds"].get<double>(), 0.5);
  EXPECT_FALSE(std::filesystem::exists(program_));
}

TEST_F(CutTools, a_run_on_a_board_has_a_report) {
  const std::string folder = folder_ / "report";
  const auto report = [&](const Arguments& more) {
    Arguments all{"--power", "50", "--kerf", "0.2", "--report", folder};
    all.insert(all.end(), more.begin(), more.end());
    return cut(all);
  };
  const Finished without = report({"-o", program_});
  EXPECT_EQ(without.status, 2);
  EXPECT_THAT(without.err, HasSubstr("--report: has no effect without a board; give --board NAME"));
  EXPECT_EQ(report({"--board", "virtual", "--yes", "--feed", "1e9"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder)) << "nothing was run";
  const Finished finished = report({"--board", "virtual", "--yes"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json numbers = json::parse(read(folder + "/report.json"));
  EXPECT_EQ(numbers["board"], "virtual");
  EXPECT_EQ(numbers["cuts"], 2);
  EXPECT_EQ(numbers["run"]["end"], "done");
  EXPECT_NEAR(numbers["run"]["seconds"].get<double>(), numbers["seconds"].get<double>(), 0.5);
  const std::string page = read(folder + "/report.html");
  EXPECT_THAT(page, testing::AllOf(HasSubstr("Time of the run"), HasSubstr("<svg")));
}

TEST_F(CutTools, a_frame_runs_around_the_cuts_without_light) {
  const Finished finished = cut({"--power", "50", "--frame", "-o", program_});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const std::string program = read(program_);
  for (const char* corner : {"X5 Y5", "X30", "Y25", "X5", "Y5"})
    EXPECT_THAT(program, HasSubstr(corner));
  EXPECT_THAT(program, Not(HasSubstr("G3")));
  EXPECT_THAT(program, Not(testing::ContainsRegex("S[1-9]")));
  EXPECT_THAT(program, HasSubstr("frame around the cuts"));
  EXPECT_THAT(program, HasSubstr(" F3000")) << "not the feed of a cut";
}

TEST_F(CutTools, rapids_are_those_of_the_cuts_that_are_made) {
  const auto rapids = [&](const std::string& from) {
    const Finished finished = cut({"--power", "50", "--from", from, "-o", program_, "--json"});
    return json::parse(finished.out)["rapid_mm"].get<double>();
  };
  // The second cut is the rectangle, from its corner that is the nearest to the circle.
  EXPECT_GT(rapids("1"), 0);
  const std::string text = (rapids("2"), read(program_));
  const auto first = text.substr(text.find("\nG0 X") + 1);
  double x = 0, y = 0;
  ASSERT_EQ(std::sscanf(first.c_str(), "G0 X%lf Y%lf", &x, &y), 2) << first;
  EXPECT_NEAR(rapids("2"), std::hypot(x, y), 0.01);
}

TEST_F(CutTools, heights_outside_of_the_work_space_name_what_sets_them) {
  const std::string error = refused({"--power", "50", "--post", "mill", "--final-depth", "900"});
  EXPECT_THAT(error, HasSubstr("final depth"));
  EXPECT_THAT(error, Not(HasSubstr("beam")));
}

TEST_F(CutTools, equal_contours_on_two_layers_of_one_operation_are_cut_once) {
  drawing(dxf_rectangle(5, 5, 25, 20, "A") + dxf_rectangle(5, 5, 25, 20, "B") +
          dxf_rectangle(-40, 5, 25, 20, "B"));
  const Finished finished = cut({"--power", "50", "-o", program_, "--json"});
  EXPECT_EQ(json::parse(finished.out)["cuts"], 2);
  EXPECT_THAT(finished.err, HasSubstr("duplicate, left out"));
}

TEST_F(CutTools, values_without_effect_are_refused) {
  const auto is_refused = [&](Arguments more) {
    more.insert(more.end(), {"--power", "50"});
    EXPECT_THAT(refused(more), testing::AnyOf(HasSubstr("has no effect"), HasSubstr("genetic")));
  };
  is_refused({"--lead-in-mm", "5"});
  is_refused({"--lead-out-angle", "45"});
  is_refused({"--lead-in", "line", "--lead-out-mm", "5"});
  is_refused({"--tab-width", "3"});
  is_refused({"--tab-power", "0.5"});
  is_refused({"--tab-corner", "3"});
  is_refused({"--population", "10"});
}

TEST_F(CutTools, a_power_without_an_effect_is_refused) {
  const std::string laser = refused({"--power", "1e-9"});
  EXPECT_THAT(laser, HasSubstr("a power of 1e-09 % is S0 in the program, without light; give at"));
  EXPECT_THAT(refused({"--power", "1e-9", "--post", "mill", "--final-depth", "1", "--infeed", "1"}),
              HasSubstr("a speed of 1e-09 % is S0 in the program, and the spindle would stop"));
  // The power that the message names is enough, and a run without light needs none.
  const auto at = laser.find("at least ") + 9;
  const std::string least = laser.substr(at, laser.find(" %", at) - at);
  EXPECT_EQ(cut({"--power", least, "-o", program_}).status, 0);
  EXPECT_EQ(cut({"--power", "1e-9", "--dry", "-o", program_}).status, 0);
  EXPECT_EQ(cut({"--power", "1e-9", "--frame", "-o", program_}).status, 0);
}

TEST_F(CutTools, a_drawing_of_dots_has_nothing_to_cut) {
  drawing("0\nLINE\n8\nCUT\n10\n5\n20\n5\n11\n5\n21\n5\n");
  EXPECT_THAT(refused({"--power", "50"}), HasSubstr("has no curve longer than the tolerance"));
}

}  // namespace
}  // namespace lamplock::cli::test::cut_tools
