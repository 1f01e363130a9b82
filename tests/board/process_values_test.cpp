// Process parameters: the lines that a board gets for a material, in both units, and what is
// refused.
#include "host/program/process_values.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>
#include <string>
#include <vector>

#include "host/job/job.hpp"
#include "host/program/program_flow.hpp"
#include "tests/error_of.hpp"

namespace lamplock::program_run::process_values_test {
namespace {

using testing::HasSubstr;

/// With a kerf, without a frequency.
ProcessValues plywood() {
  ProcessValues values;
  values.title = "plywood, 5 mm, cut, laser diode-3w";
  values.edit = "lamplock material edit plywood --kind setting --number 3";
  values.feed_mm_min = 190.5;
  values.power_w = 1.5;
  values.power_share = 0.5;
  values.passes = 7;
  values.kerf_mm = 0.127;
  values.thickness_mm = 5;
  return values;
}

settings::Values machine() {
  settings::Values values = job::default_profile().settings;
  values.set_milli(settings::Id::max_spindle_speed, 1'000'000);
  return values;
}

std::string lines_of(const std::string& text) {
  const ProcessValues values = plywood();
  return with_process_values(text, "p.ngc", &values, machine(), {});
}

std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

/// A line with process values, and what it becomes.
struct Row {
  const char *text, *line;
};

TEST(ProcessValues, AreNumbersOfTheLine) {
  const Row rows[] = {
      {"G1X1F#<_material_feed>", "G1X1F190.5"},
      {"S#<_material_power>", "S500"},
      {"X#<_material_watts>", "X1.5"},
      {"X#< _Mat erial_PASSES >Y2", "X7Y2"},
      {"X-#<_material_kerf>", "X-0.127"},
      {"X[2*#<_material_thickness>]", "X[2*5]"},
      {"##<_material_passes>=#<_material_air>", "#7=0"},
      {"X#<_material_feed>5", "X[190.5]5"},
      {"X5#<_material_feed>", "X5[190.5]"},
      {"X#<_material_feed>.5", "X[190.5].5"},
      {"#1=exists[#<_material_kerf>]", "#1=1"},
      {"#1=EXISTS[#<_material_frequency>]Y1", "#1=0Y1"},
      {"X[EXISTS[#<_material_kerf>]+1]", "X[1+1]"},
      {"#1=EXISTS[#<_other>]", "#1=EXISTS[#<_other>]"},
      {"X#<_materials>", "X#<_materials>"},
      {"(#<_material_feed>)X1", "(#<_material_feed>)X1"},
      {"X1;#<_material_fed>", "X1;#<_material_fed>"},
      {"$#<_material_feed>", "$#<_material_feed>"},
      {"X1(MSG,#<_material_feed>)", "X1(MSG,#<_material_feed>)"},
  };
  for (const auto& row : rows)
    EXPECT_EQ(without_blanks(lines_of(row.text)), std::string(row.line) + "\n") << row.text;
}

TEST(ProcessValues, AreInTheUnitOfTheLine) {
  EXPECT_EQ(without_blanks(lines_of("G20\nF#<_material_feed>\nG21F#<_material_feed>\n"
                                    "G20X#<_material_kerf>S#<_material_power>\nM70\nG21\nM72\n"
                                    "X#<_material_thickness>")),
            "G20\nF7.5\nG21F190.5\nG20X0.005S500\nM70\nG21\nM72\nX0.1968504\n");
}

TEST(ProcessValues, HaveTheFormatOfTheirMessage) {
  const Row rows[] = {
      {"(PRINT, #<_material_feed>)", "(PRINT, 190.500000)\n"},
      {"( debug,%dp #<_material_passes>%.2f #<_material_kerf>)", "( debug,%dp 7%.2f 0.13)\n"},
      {"(PRINT, %.0f a(b #<_material_feed>)", "(PRINT, %.0f a(b 190)\n"},
      {"(PRINT,#5#<_material_passes>#<x>)", "(PRINT,#57.000000#<x>)\n"},
  };
  for (const auto& row : rows) EXPECT_EQ(lines_of(row.text), row.line);
}

/// The host knows the outputs of the board, so it keeps the units of this line.
TEST(ProcessValues, AreInTheUnitOfALineWithAnOutput) {
  const ProcessValues values = plywood();
  settings::Values with_outputs = machine();
  with_outputs.set_milli(settings::Id::pin_map, 2000);
  EXPECT_THAT(
      with_process_values("G20 M64 P0\nF#<_material_feed>", "p.ngc", &values, with_outputs, {}),
      testing::StartsWith("G20 M64 P0\nF7.5 "));
}

/// Errors after the value keep their column.
TEST(ProcessValues, KeepTheColumnsOfTheLine) {
  std::mt19937 random(5);
  const std::vector<std::string> parts{"X1",
                                       "F#<_material_feed>",
                                       "Y[#<_material_kerf>*2]",
                                       " ",
                                       "(text)",
                                       "Z-#< _material_passes>",
                                       "#<n>",
                                       "EXISTS[#<_material_kerf>]"};
  for (int i = 0; i < 300; ++i) {
    std::string line;
    for (int k = 0; k < 6; ++k) line += parts[random() % parts.size()];
    EXPECT_EQ(lines_of(line + "@").find('@'), line.size()) << line;
  }
}

TEST(ProcessValues, AreRefusedWithTheirPlace) {
  const ProcessValues values = plywood();
  const auto refusal = [&](const std::string& text, const ProcessValues* of) {
    return test::error_of([&] {
      check_process_values(text, "p.ngc", of);
      with_process_values(text, "p.ngc", of, machine(), {});
    });
  };
  EXPECT_THAT(
      refusal("G21\nX1 F#<_material_feed>", nullptr),
      HasSubstr(
          "p.ngc:2:5: '#<_material_feed>': no material is chosen; choose one (--material NAME)"));
  EXPECT_THAT(refusal("X#<_material_fed>", &values), HasSubstr("did you mean '#<_material_feed>'"));
  EXPECT_THAT(refusal("X#<_material>", &values), HasSubstr("there is no such process parameter"));
  EXPECT_THAT(refusal("(PRINT, #<_material_x>)", &values), HasSubstr("p.ngc:1:9"));
  EXPECT_THAT(refusal(" # <_material_feed> = 3", &values),
              HasSubstr("p.ngc:1:2: '# <_material_feed>': a process parameter cannot be assigned"));
  EXPECT_THAT(refusal("G21\n\nX#<_material_frequency>", &values),
              HasSubstr("p.ngc:3:2: '#<_material_frequency>': the material library has no "
                        "frequency_hz for plywood, 5 mm, cut, laser diode-3w; add it: lamplock "
                        "material edit plywood --kind setting --number 3 frequency_hz=VALUE"));
  EXPECT_NO_THROW(check_process_values("#1=EXISTS[#<_material_feed>]", "p.ngc", nullptr));
}

std::string flow_of(const std::string& text, const ProcessValues* values) {
  check_process_values(text, "p.ngc", values);
  std::string joined;
  for (const link::ProgramLine& line :
       run_flow(link::program_lines(text, "p.ngc"), "p.ngc", machine(), {}, values))
    joined += line.text + line.messages + " ";
  return joined;
}

TEST(ProcessValues, WorkInOwordsAndSubs) {
  const ProcessValues values = plywood();
  EXPECT_EQ(flow_of("o1 sub\nG1 X#1 F#<_material_feed>\no1 endsub\no2 repeat "
                    "[#<_material_passes>-5]\no1 call [#<_material_kerf>]\nG20\no2 endrepeat\n"
                    "(PRINT,%d#<_material_passes>)\nM2",
                    &values),
            "G1X0.127F190.5 G20 G1X0.005F7.5 G20 M2(MSG,7) ");
  const std::string asks =
      "o1 if [EXISTS[#<_material_frequency>]]\nM127 P#<_material_frequency>\n"
      "o1 else\nG1 X1 F5\no1 endif";
  EXPECT_EQ(flow_of(asks, &values), "G1 X1 F5 ");
  EXPECT_EQ(flow_of(asks, nullptr), "G1 X1 F5 ");
  EXPECT_THAT(
      test::error_of([&] { flow_of("o1 if [1]\nX#<_material_frequency>\no1 endif", &values); }),
      HasSubstr("p.ngc:2:2: '#<_material_frequency>'"));
  EXPECT_THAT(test::error_of([&] { flow_of("o1 if [1]\nX#<_material_feed>\no1 endif", nullptr); }),
              HasSubstr("p.ngc:2:2: '#<_material_feed>': no material is chosen"));
}

}  // namespace
}  // namespace lamplock::program_run::process_values_test
