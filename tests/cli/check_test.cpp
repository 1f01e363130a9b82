// `lamplock check`: programs are run without a machine; errors are reported by line and column.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using namespace std::string_literals;

nlohmann::json check(const std::string& file, const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments{"check", file, "--json"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Finished done = run(arguments);
  EXPECT_EQ(done.status, 0) << done.err;
  return nlohmann::json::parse(done.out);
}

TEST(Check, ReportsTimeLengthAndBounds) {
  const Folder folder;
  // 30 mm at 600 mm/min with 4 m/s2: 3 s, and the ramps from and to rest at 10 mm/s.
  const std::string file = folder.write("a.ngc", "G21 G90 G61.1\nG1 X30 F600\nG0 Y-20\nM30\n");
  const nlohmann::json seen = check(file);
  const double rapid = 2 * std::sqrt(0.02 / 4);
  // The planner reserves a little speed and acceleration for rounding.
  const double least = 3 + 0.0025 + rapid;
  EXPECT_GE(seen["time_s"].get<double>(), least);
  EXPECT_LE(seen["time_s"].get<double>(), least * 1.0005);
  EXPECT_EQ(seen["feed_mm"], 30);
  EXPECT_EQ(seen["rapid_mm"], 20);
  EXPECT_EQ(seen["low_mm"], (nlohmann::json{0, -20, 0}));
  EXPECT_EQ(seen["high_mm"], (nlohmann::json{30, 0, 0}));
  EXPECT_EQ(seen["moves"], 2);
  EXPECT_EQ(seen["ended"], true);
  EXPECT_EQ(seen["problems"], nlohmann::json::array());
}

TEST(Check, ABoundThatRoundsToZeroHasNoSign) {
  const Folder folder;
  const Finished done = run({"check", folder.write("a.ngc", "G1 X-0.0003 Y-1 F600\n")});
  EXPECT_THAT(done.out, HasSubstr("X         0.000 to 0.000 mm"));
  EXPECT_THAT(done.out, HasSubstr("Y         -1.000 to 0.000 mm"));
}

TEST(Check, DwellsArePartOfTheTime) {
  const Folder folder;
  EXPECT_NEAR(check(folder.write("a.ngc", "G4 P1.5\r\n\r\nM0\r\nG4 P0.25"))["time_s"].get<double>(),
              1.75, 1e-9);
}

TEST(Check, PointsOnTheBeatAreAccepted) {
  const Folder folder;
  const nlohmann::json seen =
      check(folder.write("a.ngc", "M130 P0\nG1 X10 F6000\nM130 P1\nG1 Y5\nM131\nG0 X0\nM2\n"));
  EXPECT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_EQ(seen["feed_mm"], 15);
  EXPECT_EQ(seen["ended"], true);
}

/// 20 points 0.5 mm apart at 50 mm/s and 100 Hz: a beat each, after a move, the change at rest and
/// a run-up.
TEST(Check, ARowOnTheBeatTakesItsBeats) {
  const Folder folder;
  std::string text = "F3000\nG0 X0.5\nM130 P0\n";
  for (int i = 2; i <= 21; ++i) text += fmt::format("G1 X{:.1f}\n", 0.5 * i);
  const nlohmann::json seen = check(folder.write("a.ngc", text + "M2\n"));
  EXPECT_EQ(seen["shots"], 20);
  EXPECT_GE(seen["time_s"].get<double>(), 19 * 0.010);
  EXPECT_LE(seen["time_s"].get<double>(), 19 * 0.010 + 0.1);
}

TEST(Check, ArcsAreRoundAndAsLongAsTheyShouldBe) {
  const Folder folder;
  const std::string file =
      folder.write("a.ngc", "G1 X10 F6000\nG3 X10 Y0 I-10 J0\nG2 X-10 Y0 R10\n");
  const nlohmann::json seen = check(file);
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(seen["feed_mm"].get<double>(), 10 + 30 * pi, 0.03);
  EXPECT_NEAR(seen["low_mm"][1].get<double>(), -10, 0.003);
  EXPECT_NEAR(seen["high_mm"][1].get<double>(), 10, 0.003);
}

/// Chords of an arc are shorter than it by their distance / (3 radius), as docs/gcode.md says.
TEST(Check, LengthsAreThoseOfTheChords) {
  const Folder folder;
  const double radius_mm = 10, circle_mm = 2 * radius_mm * std::acos(-1.0);
  const std::string file = folder.write("a.ngc", "G0 X10\nG3 I-10 F6000\n");
  for (const double tolerance_mm : {0.001, 0.002, 0.05}) {
    const std::string machine =
        folder.write("m.toml", fmt::format("arc_tolerance = {}\n", tolerance_mm));
    const double feed_mm = check(file, {"--machine", machine})["feed_mm"].get<double>();
    const double max_difference_mm = circle_mm * tolerance_mm / (3 * radius_mm);
    EXPECT_LE(circle_mm - feed_mm, max_difference_mm * 1.01) << tolerance_mm;
    EXPECT_GE(circle_mm - feed_mm, max_difference_mm / 2) << tolerance_mm;
  }
  EXPECT_THAT(run({"check", "--help"}).out, HasSubstr("along the chords"));
}

/// 720 degrees at 3600 degrees a minute, 10 mm at 600 mm/min beside A, 90 degrees as a rapid.
TEST(Check, DegreesAreNoLengths) {
  const Folder folder;
  const std::string file =
      folder.write("a.ngc", "G1 A720 F3600\nG1 X10 A0 F600\nG0 A90\nG0 X16 Y8 A-90\n");
  const auto machine = [&](const std::string& text) {
    return folder.write("m.toml", "axes = 4\n" + text);
  };
  for (const std::string rotary : {"1", "2"}) {
    const nlohmann::json seen =
        check(file, {"--machine", machine("rotary_axis = " + rotary + "\n")});
    EXPECT_NEAR(seen["feed_mm"].get<double>(), 10, 1e-9);
    EXPECT_NEAR(seen["rapid_mm"].get<double>(), 10, 1e-9);
    EXPECT_EQ(seen["rotary"], true);
  }
  const std::string text = run({"check", file, "--machine", machine("rotary_axis = 1\n")}).out;
  EXPECT_THAT(text, HasSubstr("X         0.000 to 16.000 mm"));
  EXPECT_THAT(text, HasSubstr("A         -90.000 to 720.000 degrees"));
  EXPECT_THAT(run({"check", file, "--machine", machine(""), "--max-problems", "1"}).out,
              HasSubstr("A 720.000 mm is outside of the work space"));
}

TEST(Check, ErrorsAreReportedByLineColumnAndNumber) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G1 X1 F100\nG1 X1#\nG33\nG1 Y2\nG1 X1 X2\n");
  const Finished done = run({"check", file});
  EXPECT_EQ(done.status, 2);
  EXPECT_THAT(done.out, HasSubstr(file + ":2:6: error:75 "));
  EXPECT_THAT(done.out, HasSubstr(file + ":3:1: error:20 "));
  EXPECT_THAT(done.out, HasSubstr(file + ":5:7: error:25 "));
  EXPECT_THAT(done.err, MatchesRegex("error: [^\n]*a.ngc: 3 lines are wrong; [^\n]+\n"));
  // Lines without errors are run.
  EXPECT_THAT(done.out, HasSubstr("Y         0.000 to 2.000 mm"));
  EXPECT_THAT(run({"check", file, "--max-problems", "2"}).err,
              HasSubstr("2 lines are wrong, and the check stopped there (--max-problems)"));
}

TEST(Check, AFormerNameOfAnOptionWorksWithANote) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G1 X1\nG1 X2\n");
  const Finished former = run({"check", file, "--most", "1"});
  const Finished present = run({"check", file, "--max-problems=1"});
  EXPECT_EQ(former.status, 2);
  EXPECT_EQ(former.out, present.out);
  EXPECT_EQ(former.err,
            "note: lamplock check: '--most' is now named '--max-problems'\n" + present.err);
  EXPECT_EQ(run({"check", file, "--most=1"}).err, former.err);
  EXPECT_EQ(run({"order", file, "--most=1"}).status, 2);  // it has no such option
}

TEST(Check, AdditionsOfEditorsAndSendersAreIgnored) {
  const Folder folder;
  const nlohmann::json plain = check(folder.write("a.ngc", "G1 X10 F600\n"));
  for (const char* before : {"\xEF\xBB\xBF", "$X\n", "%\n"}) {
    const nlohmann::json seen = check(folder.write("b.ngc", before + "G1 X10 F600\n"s));
    EXPECT_EQ(seen["problems"], plain["problems"]);
    EXPECT_EQ(seen["time_s"], plain["time_s"]);
  }
}

TEST(Check, TheWorkSpaceIsThatOfTheMachine) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G0 X10\nG0 X60\n");
  const Finished done = run({"check", file});
  EXPECT_EQ(done.status, 2);
  EXPECT_THAT(done.out,
              HasSubstr(":2: X 60.000 mm is outside of the work space, -50.000 to 50.000"));
  const std::string wide =
      folder.write("wide.toml", "travel = [200, 100, 100]\nmin_corner = [-100, -50, -50]\n");
  EXPECT_EQ(run({"check", file, "--machine", wide}).status, 0);
}

TEST(Check, DrawsThePathWithPowerInColour) {
  const Folder folder;
  const std::string file =
      folder.write("a & b.ngc", "G0 X5\nM3 S1000\nG1 Y10 F600\nM3 S500\nG1 X0\nM5\nG0 Y0\n");
  const std::string picture = folder / "a.svg";
  const Finished done = run({"check", file, "--picture", picture});
  ASSERT_EQ(done.status, 0) << done.err;
  const std::string drawn = read(picture);
  EXPECT_THAT(drawn, HasSubstr("a &amp; b.ngc</text>"));
  EXPECT_THAT(drawn, EndsWith("</svg>\n"));
  EXPECT_THAT(drawn, HasSubstr("stroke=\"#4b0c5a\""));        // all
  EXPECT_THAT(drawn, HasSubstr("stroke-dasharray=\"4 3\""));  // rapids
  const std::string half = drawn.substr(drawn.find("stroke-dasharray"));
  EXPECT_THAT(half,
              Not(HasSubstr("stroke=\"#f5c85a\"")));  // only rapids have no power
}

/// Number of separate lines that a picture draws with this look.
std::size_t strokes(const std::string& drawn, const std::string& look) {
  const std::size_t at = drawn.find("fill=\"none\" " + look);
  if (at == std::string::npos) return 0;
  const std::size_t begin = drawn.rfind("<path", at);
  const std::string path = drawn.substr(begin, at - begin);
  return static_cast<std::size_t>(std::count(path.begin(), path.end(), 'M'));
}

TEST(Check, MovesWithoutPowerAreDrawnAsRapids) {
  const Folder folder;
  // A rapid, and moves without power by S0 and by M5, each apart from the others.
  const std::string file = folder.write(
      "a.ngc", "G0 X5\nM3 S1000\nG1 Y10 F600\nS0 G1 X0\nS10 G1 Y4\nM5\nG1 X-9\nM3 S1\nG1 Y0\n");
  const std::string picture = folder / "a.svg";
  ASSERT_EQ(run({"check", file, "--picture", picture}).status, 0);
  const std::string drawn = read(picture);
  EXPECT_EQ(strokes(drawn, "stroke=\"#4a7fb5\""), 3u) << drawn;
  EXPECT_EQ(strokes(drawn, "stroke=\"#f5c85a\""), 2u) << "1 % and 0.1 % are light";
}

TEST(Check, BadRequestsAreRefused) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G0 X1\n");
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& names) {
    const auto before = folder.files();
    const Finished done = run(arguments);
    EXPECT_EQ(done.status, 2) << names;
    EXPECT_THAT(done.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(done.err, HasSubstr(names));
    EXPECT_EQ(folder.files(), before);
  };
  refused({"check", folder / "none.ngc"}, "none.ngc");
  refused({"check", file, "--picture", folder / "a.png"}, "a.png");
  refused({"check", file, "--picture", folder / "none/a.svg"}, "none");
  refused({"check", file, "--max-problems", "0"}, "--max-problems");
  refused({"check", folder.write("empty.ngc", "")}, "empty.ngc");
}

TEST(Check, AnyBytesAreReadWithoutHarm) {
  const Folder folder;
  std::string bytes = "G1 X1 F1\n";
  for (int i = 0; i < 5000; ++i) bytes += static_cast<char>((i * 7919) >> 3);
  bytes += "\nG1 " + std::string(300, '1') + "\n";
  const std::string file = folder.write("noise.ngc", bytes);
  EXPECT_EQ(run({"check", file, "--max-problems", "100000"}).status, 2);
}

}  // namespace
}  // namespace lamplock::cli::test
