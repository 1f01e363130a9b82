// `lamplock diagnose`: a table, JSON and a picture of the response of servo drives to a program.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

TEST(Diagnose, RunsTheTwoTrajectoriesOfThePaper) {
  const Folder folder;
  const std::string picture = folder / "errors.svg";
  const Finished done = run({"diagnose", "--json", "--picture", picture});
  ASSERT_EQ(done.status, 0) << done.err;
  const nlohmann::json seen = nlohmann::json::parse(done.out);
  EXPECT_EQ(seen["machine"]["pulses_per_rev"], 512);
  ASSERT_EQ(seen["trajectories"].size(), 2u);
  const int ends[2][2] = {{656, 985}, {656, 788}};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t a = 0; a < 2; ++a) {
      const nlohmann::json& axis = seen["trajectories"][i]["axes"][a];
      EXPECT_EQ(axis["end_pulses"], ends[i][a]);
      EXPECT_LT(axis["max_pulses"], 0.55);
      EXPECT_GT(axis["max_positive_mm"], 0.05);
      EXPECT_LT(axis["max_positive_mm"], 0.3);
      EXPECT_LE(axis["max_negative_mm"], 0);
      EXPECT_GT(axis["max_negative_mm"], -0.1);
    }
  EXPECT_THAT(done.err, HasSubstr("line to (100,150)"));
  EXPECT_THAT(done.err, HasSubstr("arc to (100,120) R150"));
  EXPECT_THAT(read(picture), HasSubstr("arc to (100,120) R150"));
}

TEST(Diagnose, RunsAProgramOnOtherDrives) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G21 G90\nG1 X20 F1200\nG3 X20 Y10 J5\nM2\n");
  const auto most = [&](const char* milliseconds) {
    const Finished done = run({"diagnose", file, "--json", "--pulses", "10000", "--mm-per-rev",
                               "10", "--encoder", "40000", "--time-constant", milliseconds});
    EXPECT_EQ(done.status, 0) << done.err;
    const nlohmann::json row = nlohmann::json::parse(done.out)["trajectories"][0];
    EXPECT_EQ(row["name"], "a.ngc");
    EXPECT_EQ(row["axes"][0]["end_pulses"], 20000);
    EXPECT_NEAR(row["axes"][1]["measured_end_mm"].get<double>(), 10, 1e-3);
    return row["axes"][0]["max_positive_mm"].get<double>();
  };
  // At 20 mm/s the lag is twice the time constant.
  EXPECT_NEAR(most("2"), 0.08, 0.004);
  EXPECT_NEAR(most("10"), 0.4, 0.02);
}

TEST(Diagnose, PrintsATable) {
  const Folder folder;
  const Finished done = run({"diagnose", folder.write("a.ngc", "G1 X2 Y1 F600\n")});
  EXPECT_EQ(done.status, 0);
  EXPECT_THAT(done.out, HasSubstr("largest +"));
  EXPECT_THAT(done.out, HasSubstr("a.ngc       X"));
  EXPECT_THAT(done.out, HasSubstr("beside the path"));
  EXPECT_EQ(done.err, "");
}

TEST(Diagnose, WrongInputIsOneLine) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G1 X2 F600\n");
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& where) {
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 2) << where;
    EXPECT_EQ(lines(done.err).size(), 1u) << done.err;
    EXPECT_THAT(done.err, HasSubstr(where));
    EXPECT_EQ(done.out, "");
  };
  refused({"diagnose", folder / "none.ngc"}, "none.ngc");
  refused({"diagnose", folder.write("b.ngc", "G1 X2\n")}, "b.ngc:1");
  refused({"diagnose", folder.write("c.ngc", "G21\n")}, "c.ngc");
  refused({"diagnose", file, "--picture", folder / "a.png"}, "a.png");
  refused({"diagnose", file, "--pulses", "0"}, "--pulses");
  refused({"diagnose", file, "--feed", "600"}, "--feed");
  refused({"diagnose", file, "--time-constant", "nan"}, "--time-constant");
  refused({"diagnose", file, "--order", "3"}, "--order");
  refused({"diagnose", file, "--pulses", "1e9"}, "steps_per_mm_x");
}

}  // namespace
}  // namespace lamplock::cli::test
