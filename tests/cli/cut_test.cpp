// `lamplock cut`: lengths of the document, operations, descriptions, and what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/cut_program.hpp"

namespace lamplock::cli::test::cut {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using namespace lamplock::test;

/// Power and feed, which every cut needs.
Arguments cut(const std::string& drawing, const Arguments& more) {
  Arguments all{"cut", drawing, "--power", "80", "--feed", "600"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

class Cut : public CutProgram {
 protected:
  json made(const std::string& drawing, const Arguments& more) const {
    Arguments all = cut(drawing, more);
    all.insert(all.end(), {"-o", program_, "--json"});
    const Finished finished = run(all);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
  std::string refused(const Arguments& arguments) const {
    return CutProgram::refused(run(arguments));
  }
  std::string refused(const std::string& drawing, Arguments more) const {
    more.insert(more.end(), {"-o", program_});
    return refused(cut(drawing, more));
  }
};

const std::string rounded = dxf_rounded(-30, -10, 60, 20, 3);
const std::string square = dxf_rectangle(0, 0, 10, 10, "SQUARE");
const std::string ell =
    dxf_polyline({{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}}, true);

TEST_F(Cut, lengths_of_the_document) {
  const auto length = [&](const std::string& entities, const std::string& compensation) {
    return made(drawing(entities), {"--kerf", "0.5", "--compensation", compensation})["cut_mm"]
        .get<double>();
  };
  constexpr double printed = 0.00005;
  EXPECT_NEAR(length(rounded, "none"), 154.8496, printed);
  EXPECT_NEAR(length(rounded, "outside"), 156.4204, printed);
  EXPECT_NEAR(length(rounded, "inside"), 153.2788, printed);
  EXPECT_NEAR(length(dxf_circle(0, 0, 4), "inside"), 23.5619, printed);
  EXPECT_NEAR(length(square, "right"), 41.5708, printed);
  EXPECT_NEAR(length(square, "left"), 38, printed);
  EXPECT_NEAR(length(ell, "outside"), 81.4635, printed);
  EXPECT_NEAR(length(ell, "inside"), 77.8927, printed);
  EXPECT_NEAR(length(rounded + dxf_circle(0, 0, 4), "auto"), 156.4204 + 23.5619, 2 * printed);
}

TEST_F(Cut, the_program_is_that_of_grbl_with_arcs) {
  made(drawing(rounded + dxf_circle(0, 0, 4)), {"--kerf", "0.5", "--lead-in", "arc"});
  const std::string text = read(program_);
  EXPECT_THAT(text, HasSubstr("M4 S0\n"));
  EXPECT_THAT(text, HasSubstr(" F600 S800\n"));
  EXPECT_THAT(text, HasSubstr("\nG3 "));
  EXPECT_THAT(text, HasSubstr("\nG2 ")) << "holes are cut clockwise";
  EXPECT_LT(text.find("cut hole"), text.find("cut outside"));
  for (const std::string& line : lines(text))
    if (line.starts_with("G0 ")) {
      EXPECT_TRUE(line.ends_with(" S0")) << line;
    }
  EXPECT_EQ(run({"check", program_}).status, 0);
}

TEST_F(Cut, the_laser_is_dark_for_a_time_at_both_ends) {
  // 600 mm/min: 1 mm at the begin, 2 mm at the end.
  made(drawing(square), {"--on-late", "0.1", "--off-early", "0.2"});
  EXPECT_THAT(read(program_),
              HasSubstr("\nG1 X1 F600\nG1 X10 S800\nG1 Y10\nG1 X0\nG1 Y2\nG1 Y0 S0\n"));
}

TEST_F(Cut, dark_times_without_a_lit_part_between_them_are_refused) {
  EXPECT_THAT(refused(drawing(square), {"--on-late", "0.1", "--pierce", "1"}),
              HasSubstr("pierce time"));
  EXPECT_THAT(refused({"cut", drawing(square), "--power", "80", "--feed", "3000", "--off-early",
                       "1", "-o", program_}),
              HasSubstr("contour of 40.000 mm"));
}

TEST_F(Cut, the_controller_compensates) {
  const json host = made(drawing(square), {"--kerf", "0.5"});
  const json controller = made(drawing(square), {"--kerf", "0.5", "--compensation", "controller"});
  EXPECT_NEAR(controller["cut_mm"].get<double>(), host["cut_mm"].get<double>(), 1e-6);
  const std::string text = read(program_);
  EXPECT_THAT(text, HasSubstr("\nG42.1 D0.5\n"));
  EXPECT_THAT(text, HasSubstr("\nG40\n"));
  EXPECT_THAT(text, HasSubstr("\nG1 X10 F600 S800\nG1 Y10\nG1 X0\nG1 Y0\n"))
      << "the corners of the drawing";
  EXPECT_EQ(run({"check", program_}).status, 0);
}

TEST_F(Cut, list_shows_every_contour) {
  const std::string file =
      drawing(rounded + dxf_circle(0, 0, 4, "HOLES", 1) + dxf_polyline({{0, 30}, {9, 42}}, false));
  const Finished listed = run({"cut", file, "--list", "--json"});
  ASSERT_EQ(listed.status, 0) << listed.err;
  const json shapes = json::parse(listed.out)["shapes"];
  ASSERT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes[0]["kind"], "outside");
  EXPECT_EQ(shapes[0]["direction"], "ccw");
  EXPECT_NEAR(shapes[0]["length_mm"].get<double>(), 154.8496, 5e-5);
  EXPECT_NEAR(shapes[0]["area_mm2"].get<double>(), 1200 - (4 - 3.14159265) * 9, 1e-4);
  EXPECT_EQ(shapes[1]["layer"], "HOLES");
  EXPECT_EQ(shapes[1]["colour"], "#ff0000");
  EXPECT_EQ(shapes[1]["kind"], "hole");
  EXPECT_EQ(shapes[1]["direction"], "cw");
  EXPECT_EQ(shapes[2]["kind"], "open");
  EXPECT_EQ(shapes[2]["area_mm2"], 0);
  const std::string table = run({"cut", file, "--list"}).out;
  EXPECT_THAT(table, HasSubstr("HOLES"));
  EXPECT_THAT(table, HasSubstr("154.850"));
  EXPECT_EQ(folder_.files(), Arguments{"part.dxf"});
}

/// The delivered library: 5 mm plywood with a 3 W diode needs 180 mm/min, 7 passes and air.
TEST_F(Cut, a_material_gives_what_the_user_does_not) {
  const std::string file = drawing(square);
  const auto material = [&](const Arguments& more) {
    Arguments all{"cut", file, "--library", folder_ / "none.db", "-o", program_};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const Finished plywood = run(material({"--material", "plywood", "--thickness", "5"}));
  ASSERT_EQ(plywood.status, 0) << plywood.err;
  EXPECT_THAT(plywood.out, HasSubstr("plywood, 5 mm, laser diode-3w: 100 %, 180 mm/min, 7 passes"));
  const std::string text = read(program_);
  EXPECT_THAT(text, HasSubstr(" F180 S1000\n"));
  EXPECT_THAT(text, HasSubstr("M8\n"));
  ASSERT_EQ(
      run(material({"--material", "plywood", "--thickness", "5", "--feed", "200", "--passes", "1"}))
          .status,
      0);
  EXPECT_THAT(read(program_), HasSubstr(" F200 S1000\n"));
  std::filesystem::remove(program_);
  EXPECT_THAT(refused(material({"--material", "plywod"})), HasSubstr("plywod"));
  EXPECT_THAT(refused(material({"--material", "plywood", "--thickness", "3.21"})),
              HasSubstr("5 mm"));
  EXPECT_THAT(refused(material({"--thickness", "5", "--power", "9", "--feed", "60"})),
              HasSubstr("a thickness is given without a material; give"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.db")) << "reading makes no library";
}

TEST_F(Cut, continues_at_a_cut_and_runs_dark) {
  const std::string file = drawing(rounded + dxf_circle(0, 0, 4));
  made(file, {"--from", "2"});
  EXPECT_THAT(read(program_), Not(HasSubstr("cut hole")));
  EXPECT_THAT(read(program_), HasSubstr("(2: cut outside")) << "the number of the whole plan";
  made(file, {"--dry"});
  EXPECT_THAT(read(program_), Not(HasSubstr("S800")));
  std::filesystem::remove(program_);
  EXPECT_THAT(refused(file, {"--from", "3"}), HasSubstr("the plan has 2 cuts"));
  EXPECT_THAT(refused(file, {"--board", "nosuch", "--yes"}), HasSubstr("no board 'nosuch'"));
}

TEST_F(Cut, command_line_and_description_write_the_same_bytes) {
  const std::string file =
      drawing(rounded + dxf_circle(0, 0, 4) + dxf_rectangle(0, 20, 10, 10, "SQUARE"));
  const std::string saved = folder_ / "cut.toml", again = folder_ / "again.ngc";
  const std::vector<Arguments> variants{
      {},
      {"--kerf", "0.2", "--lead-in", "line", "--lead-in-mm", "0.8", "--tabs", "2"},
      {"--layer", "CUT", "--passes", "3", "--air", "--direction", "cw"},
      {"--infeed", "0.7", "--final-depth", "3", "--surface", "2", "--x", "-30", "--y", "-20"},
      {"--operation", "engrave", "--hatch", "0.5", "--hatch-angle", "30"},
      {"--post", "cut", "--overcut", "1.25", "--name", "a \"b\""}};
  for (const Arguments& more : variants) {
    Arguments all = more;
    all.insert(all.end(), {"--save", saved});
    made(file, all);
    const std::string program = read(program_);
    const Finished second = run({"cut", saved, "-o", again});
    ASSERT_EQ(second.status, 0) << second.err << read(saved);
    EXPECT_EQ(read(again), program) << read(saved);
    std::filesystem::remove(program_);
  }
  EXPECT_THAT(refused({"cut", saved, "--power", "3", "-o", program_}),
              HasSubstr("--power: has its place in the description"));
}

TEST_F(Cut, layers_and_colours_are_operations) {
  drawing(dxf_rectangle(0, 0, 30, 20) + dxf_rectangle(5, 5, 5, 5, "FILL", 3) +
          dxf_polyline({{15, 5}, {25, 5}}, false, "MARK", 5) + dxf_circle(20, 12, 3, "REST"));
  const std::string job = folder_.write("job.toml", R"([drawing]
file = "part.dxf"
[[operation]]
layers = ["CUT"]
name = "through"
power = 90
feed = 300
[[operation]]
colours = ["#00f"]
kind = "score"
power = 20
feed = 2000
[[operation]]
colours = ["lime"]
kind = "engrave"
power = 10
feed = 3000
hatch = 1
)");
  const Finished finished = run({"cut", job, "-o", program_, "--list", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json shapes = json::parse(finished.out)["shapes"];
  EXPECT_EQ(shapes[0]["operation"], "through");
  EXPECT_EQ(shapes[1]["operation_kind"], "engrave");
  EXPECT_EQ(shapes[2]["operation_kind"], "score");
  EXPECT_EQ(shapes[3]["operation"], "") << "no operation is for it";
  const std::string text = read(program_);
  const std::size_t fill = text.find("(1: engrave"), mark = text.find("(2: score");
  EXPECT_LT(fill, mark);
  EXPECT_LT(mark, text.find("(3: cut outside, layer CUT)"));
  EXPECT_THAT(text, HasSubstr(" F3000\n"));  // in the run-up, which is dark
  EXPECT_THAT(text, HasSubstr(" S100\n"));
  EXPECT_THAT(text, HasSubstr(" F2000 S200\n"));
  EXPECT_THAT(text, HasSubstr(" F300 S900\n"));
}

TEST_F(Cut, units_are_never_guessed) {
  const std::string file = drawing(square, 0);
  EXPECT_THAT(refused(file, {}), HasSubstr("names no unit ($INSUNITS); give its unit"));
  EXPECT_THAT(refused(file, {}), HasSubstr("--units"));
  EXPECT_THAT(refused({"cut", file, "--list"}), HasSubstr("--units"));
  EXPECT_NEAR(made(file, {"--units", "mm"})["cut_mm"].get<double>(), 40, 1e-9);
  const std::string inch = drawing(dxf_rectangle(0, 0, 1, 1), 1);
  EXPECT_NEAR(made(inch, {})["cut_mm"].get<double>(), 101.6, 1e-9);
  EXPECT_NEAR(made(inch, {"--units", "cm"})["cut_mm"].get<double>(), 40, 1e-9);
  std::filesystem::remove(program_);
  const std::string svg = folder_.write(
      "part.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' height='20mm' viewBox='0 0 40 20'>"
      "<g id='one'><rect x='5' y='5' width='10' height='10' stroke='red' fill='none'/></g></svg>");
  EXPECT_THAT(refused(svg, {"--units", "mm"}), HasSubstr("units of its own"));
  const json document = made(svg, {});
  EXPECT_NEAR(document["cut_mm"].get<double>(), 40, 1e-6);
  EXPECT_EQ(document["shapes"][0]["colour"], "#ff0000");
  EXPECT_EQ(document["shapes"][0]["layer"], "one");
}

TEST_F(Cut, units_replace_one_that_is_unknown) {
  const std::string file = drawing(dxf_rectangle(0, 0, 1, 1), 99);
  EXPECT_THAT(refused(file, {}), HasSubstr("$INSUNITS is 99, not a usable unit of length"));
  EXPECT_THAT(refused(file, {}), HasSubstr("--units"));
  EXPECT_NEAR(made(file, {"--units", "cm"})["cut_mm"].get<double>(), 40, 1e-9);
}

TEST_F(Cut, hatches_are_counted) {
  const std::string area =
      "0\nHATCH\n8\nFILL\n2\nSOLID\n70\n1\n71\n0\n91\n1\n92\n2\n72\n0\n73\n1\n93\n3\n10\n0\n20\n0\n"
      "10\n30\n20\n0\n10\n0\n20\n40\n97\n0\n";
  const json document = made(drawing(area), {});
  EXPECT_NEAR(document["cut_mm"].get<double>(), 120, 1e-6);
  EXPECT_THAT(document["warnings"].dump(),
              HasSubstr("1 HATCH is taken as the outline of its area"));
  EXPECT_THAT(made(drawing(square), {})["warnings"].dump(), Not(HasSubstr("HATCH")));
}

TEST_F(Cut, bad_input_is_one_line_and_no_file) {
  const std::string open = dxf_polyline({{0, 0}, {10, 0}, {10, 10}}, false);
  EXPECT_THAT(refused(drawing(open), {"--kerf", "0.2", "--compensation", "inside"}),
              HasSubstr("open contour"));
  EXPECT_THAT(
      refused(drawing(dxf_circle(0, 0, 0.1)), {"--kerf", "0.3", "--compensation", "inside"}),
      HasSubstr("smaller than the beam"));
  EXPECT_THAT(refused(drawing(dxf_rectangle(0, 0, 20, 20) + dxf_circle(10, 10, 2)),
                      {"--kerf", "0.2", "--lead-in", "line", "--lead-in-mm", "9"}),
              HasSubstr("does not fit"));
  EXPECT_THAT(refused(drawing(square), {"--tabs", "2", "--tab-width", "12"}),
              HasSubstr("tabs of 12 mm do not fit"));
  EXPECT_THAT(refused(drawing(square), {"--compensation", "controller"}),
              HasSubstr("needs the width of the beam"));
  EXPECT_THAT(refused(drawing(square),
                      {"--kerf", "0.2", "--compensation", "controller", "--lead-in", "arc"}),
              HasSubstr("has no leads"));
  EXPECT_THAT(refused(drawing(square), {"--kerf", "0.2", "--compensation", "controller", "--post",
                                        "mill", "--infeed", "1", "--final-depth", "2"}),
              HasSubstr("compensation by the controller"));
  EXPECT_THAT(refused(drawing(square), {"--x", "45"}), HasSubstr("would leave the work space"));
  EXPECT_THAT(refused(drawing(dxf_rectangle(-45, -45, 120, 120)), {}), HasSubstr("too large"));
  EXPECT_THAT(refused(drawing(square), {"--layer", "SQUAR"}), HasSubstr("did you mean 'SQUARE'"));
  EXPECT_THAT(refused(drawing(square), {"--layer", "nosuch", "--list"}),
              HasSubstr("give one of its layers: 'SQUARE'"));
  EXPECT_THAT(refused(drawing(square), {"--colour", "lime", "--list"}),
              HasSubstr("leave the colour out: its curves have none"));
  const std::string blue = dxf_rectangle(5, 5, 5, 5, "FILL", 5);
  EXPECT_THAT(refused(drawing(square + blue), {"--colour", "lime", "--list"}),
              HasSubstr("give one of its colours: '#0000ff'"));
  EXPECT_THAT(refused(drawing(square), {"--colour", "blue"}), HasSubstr("no curves of the colour"));
  EXPECT_THAT(refused(drawing(square), {"--colour", "blau"}), HasSubstr("colour"));
  EXPECT_THAT(refused(drawing(square), {"--compensation", "left"}), HasSubstr("kerf"));
  EXPECT_THAT(refused(drawing(square), {"--infeed", "1"}), HasSubstr("final depth"));
  EXPECT_THAT(refused(drawing(square), {"--infeed", "1", "--final-depth", "3", "--passes", "2"}),
              HasSubstr("leave out one"));
  EXPECT_THAT(refused(drawing(square), {"--infeed", "0.001", "--final-depth", "30"}),
              HasSubstr("infeed"));
  EXPECT_THAT(refused(drawing(square), {"--post", "gbrl"}), HasSubstr("did you mean 'grbl'"));
  EXPECT_THAT(refused(drawing(open), {"--operation", "engrave"}), HasSubstr("no area"));
  EXPECT_THAT(refused(drawing(square), {"--operation", "ignore"}), HasSubstr("no curve"));
  const std::string file = drawing(square);
  EXPECT_THAT(refused({"cut", file, "--feed", "600", "-o", program_}), HasSubstr("has no power"));
  EXPECT_THAT(refused({"cut", file, "--power", "60", "-o", program_}), HasSubstr("has no feed"));
  EXPECT_THAT(refused({"cut", file, "--power", "60", "--feed", "60001", "-o", program_}),
              HasSubstr("give at most 60000 mm/min"));
  EXPECT_THAT(refused({"cut", file, "--power", "60", "--feed", "0.01", "-o", program_}),
              HasSubstr("--feed"));
  EXPECT_THAT(refused(file, {"--operation", "engrave", "--hatch", "0.00001"}),
              HasSubstr("--hatch"));
  EXPECT_THAT(refused({"cut", file, "--power", "101", "--feed", "60", "-o", program_}),
              HasSubstr("--power"));
  EXPECT_THAT(refused({"cut", file, "--power", "60", "--feed", "60"}), HasSubstr("-o FILE.ngc"));
  EXPECT_THAT(refused(cut(file, {"-o", folder_ / "no/part.ngc"})), HasSubstr("folder"));
  EXPECT_THAT(refused(cut(file, {"-o", folder_ / "part.llj"})), HasSubstr(".ngc"));
  EXPECT_THAT(refused(cut(file, {"-o", program_, "--page", folder_ / "part.txt"})),
              HasSubstr("name it something.html"));
  EXPECT_THAT(refused(cut(file, {"-o", program_, "--picture", folder_ / "part.txt"})),
              HasSubstr(".svg"));
  EXPECT_THAT(refused(folder_.write("photo.png", "x"), {}), HasSubstr("photo.png"));
  EXPECT_THAT(refused(folder_.write("list.xyz", "0 0 0\n"), {}), HasSubstr("not a drawing"));
  EXPECT_THAT(refused(folder_.write("empty.dxf", ""), {}), HasSubstr("empty"));
  EXPECT_THAT(refused(folder_ / "none.dxf", {}), HasSubstr("none.dxf"));
}

TEST_F(Cut, values_that_a_kind_of_operation_does_not_use_are_refused) {
  const std::string file = drawing(square);
  const std::vector<std::pair<Arguments, std::string>> of_cuts{{{"--tabs", "2"}, "tabs"},
                                                               {{"--lead-in", "line"}, "leads"},
                                                               {{"--lead-out", "arc"}, "leads"},
                                                               {{"--overcut", "1"}, "overcut"},
                                                               {{"--kerf", "0.2"}, "kerf"}};
  for (const auto& [kind, name] :
       {std::pair{"score", "a score"}, std::pair{"engrave", "an engraving"}})
    for (const auto& [values, what] : of_cuts) {
      Arguments more = values;
      more.insert(more.end(), {"--operation", kind});
      EXPECT_THAT(refused(file, more),
                  HasSubstr(fmt::format("operation 1: {} has no {}", name, what)));
    }
  for (const Arguments& values :
       {Arguments{"--compensation", "left"}, Arguments{"--direction", "cw"},
        Arguments{"--pierce", "1"}, Arguments{"--on-late", "0.01"},
        Arguments{"--off-early", "0.01"}}) {
    Arguments more = values;
    more.insert(more.end(), {"--operation", "engrave"});
    EXPECT_THAT(refused(file, more), HasSubstr("an engraving has no"));
  }
  for (const Arguments& values : {Arguments{"--hatch", "0.3"}, Arguments{"--hatch-angle", "30"},
                                  Arguments{"--overscan", "0"}})
    EXPECT_THAT(refused(file, values), HasSubstr("a cut has no"));
  EXPECT_THAT(
      refused({"cut",
               folder_.write("job.toml",
                             "[drawing]\nfile = \"part.dxf\"\n[[operation]]\nname = "
                             "\"marks\"\nkind = \"score\"\npower = 1\nfeed = 9\ntabs = 2\n"),
               "-o", program_}),
      HasSubstr("marks: a score has no tabs"));
  EXPECT_NEAR(
      made(file, {"--operation", "score", "--kerf", "1", "--compensation", "inside"})["cut_mm"]
          .get<double>(),
      36, 1e-6);
}

TEST_F(Cut, descriptions_are_refused_at_their_line) {
  drawing(square);
  const auto wrong = [&](const std::string& text) {
    return refused({"cut", folder_.write("job.toml", text), "-o", program_});
  };
  const std::string head = "[drawing]\nfile = \"part.dxf\"\n";
  EXPECT_THAT(wrong(head), HasSubstr("no operation"));
  EXPECT_THAT(wrong("[[operation]]\npower = 1\nfeed = 1\n"), HasSubstr("no drawing"));
  EXPECT_THAT(wrong(head + "[[operation]]\npover = 1\n"), HasSubstr("job.toml:4: unknown key"));
  EXPECT_THAT(wrong(head + "[[operation]]\npower = 101\n"),
              HasSubstr("job.toml:4: 'power' is out"));
  EXPECT_THAT(wrong(head + "[[operation]]\nkind = \"cutt\"\n"), HasSubstr("did you mean 'cut'"));
  EXPECT_THAT(wrong(head + "[operation]\npower = 1\n"), HasSubstr("[[operation]]"));
  EXPECT_THAT(wrong(head + "[tool]\nx = 1\n"), HasSubstr("unknown section"));
  EXPECT_THAT(wrong(head + "[[operation]]\npower = \n"), HasSubstr("job.toml:4"));
  EXPECT_THAT(wrong("[drawing]\nfile = \"no.dxf\"\n[[operation]]\npower = 1\nfeed = 1\n"),
              HasSubstr("no.dxf"));
}

TEST_F(Cut, a_user_writes_a_post_processor) {
  const std::string file = drawing(square);
  const std::string post = folder_.write("mine.toml", R"(name = "mine"
decimals = 2
checked = false
[lines]
begin = ["%", "LASER READY"]
rapid = "MOVE {x},{y}"
line = "BURN {x},{y} AT {feed}[ POWER {power}]"
arc_cw = "CW {x},{y} {i},{j}"
arc_ccw = "CCW {x},{y} {i},{j}"
end = "%"
)");
  const json document = made(file, {"--post", post});
  EXPECT_FALSE(document.contains("seconds"));
  EXPECT_EQ(read(program_),
            "%\nLASER READY\nMOVE 0,0\nBURN 10,0 AT 600 POWER 800\nBURN 10,10 AT 600\n"
            "BURN 0,10 AT 600\nBURN 0,0 AT 600\n%\n");
  std::filesystem::remove(program_);
  const auto wrong = [&](const std::string& text) {
    return refused(file, {"--post", folder_.write("wrong.toml", text)});
  };
  EXPECT_THAT(wrong("[lines]\nrapid = \"G0 {xx}\"\n"), HasSubstr("wrong.toml:2: 'rapid' is not"));
  EXPECT_THAT(wrong("[lines]\nrapids = \"\"\n"), HasSubstr("did you mean 'rapid'"));
  EXPECT_THAT(wrong("[lines]\nrapid = 3\n"), HasSubstr("must be a line"));
  EXPECT_THAT(wrong("decimals = 9\n"), HasSubstr("2 to 7"));
  EXPECT_THAT(wrong("name = \"x\"\n"), HasSubstr("has no 'rapid'"));
  // The interpreter of the firmware checks the others.
  EXPECT_THAT(wrong("[lines]\nrapid = \"G0 X{x} Y{y}\"\nline = \"G1 X{x} Q\"\narc_cw = \"G2\"\n"
                    "arc_ccw = \"G3\"\n"),
              HasSubstr("the interpreter refuses line"));
}

/// Without its line a thing that was asked for would be missing, or the light would be on.
TEST_F(Cut, a_post_processor_has_the_lines_that_a_job_needs) {
  const std::string file = drawing(square + dxf_circle(20, 20, 3, "SQUARE"));
  const auto post = [&](const std::string& lines) {
    return folder_.write("own.toml",
                         "checked = false\n[lines]\nrapid = \"G0 X{x} Y{y}\"\n"
                         "line = \"G1 X{x} Y{y}[ F{feed}]\"\narc_cw = \"G2 X{x} Y{y} I{i} "
                         "J{j}[ F{feed}]\"\narc_ccw = \"G3 X{x} Y{y} I{i} J{j}[ F{feed}]\"\n" +
                             lines);
  };
  const std::string fixed = "shape_begin = \"M3 S1000\"\nshape_end = \"M5\"\n",
                    power = "power = \"S{power}\"\n", operation = "operation = \"S{power}\"\n";
  struct Case {
    Arguments more;
    std::string lines, missing, added;
  };
  const std::vector<Case> cases{
      {{"--infeed", "1", "--final-depth", "3"},
       operation,
       "'height' with {z}",
       "height = \"G0 Z{z}\"\n"},
      {{"--air"}, operation + "air_on = \"M8\"\n", "'air_off'", "air_off = \"M9\"\n"},
      {{"--air"}, operation, "'air_on'", "air_on = \"\"\nair_off = \"\"\n"},
      {{"--pierce", "0.5"},
       operation + "",
       "'pierce' with {seconds}",
       "pierce = \"G4 P{seconds}\"\n"},
      {{"--tabs", "2"}, operation + "shape_begin = \"M3\"\n", "'power' with {power}", power},
      {{"--dry"}, power + "shape_begin = \"M3\"\n", "a program without light", operation},
      {{"--frame"}, power + "shape_begin = \"M3\"\n", "a program without light", operation}};
  for (const Case& one : cases) {
    Arguments more = one.more;
    more.insert(more.end(), {"--post", post(one.lines)});
    EXPECT_THAT(refused(file, more),
                testing::AllOf(HasSubstr("own.toml: [lines] has no"), HasSubstr(one.missing)));
    post(one.lines + one.added);
    EXPECT_TRUE(made(file, more).contains("cuts")) << one.lines + one.added;
    std::filesystem::remove(program_);
  }
  // A fixed power is on again at each shape.
  const std::string with_power = post(fixed + operation + power);
  for (const Arguments& more : {Arguments{"--dry"}, Arguments{"--tabs", "2"}}) {
    Arguments all = more;
    all.insert(all.end(), {"--post", with_power});
    EXPECT_THAT(refused(file, all), HasSubstr("the light would"));
  }
  EXPECT_THAT(made(file, {"--post", post(fixed)})["warnings"].dump(),
              HasSubstr("writes the power"));
  for (const Arguments& more : {Arguments{"--air", "--tabs", "1"}, Arguments{"--dry"}})
    for (const char* const name : {"grbl", "cut"}) {
      Arguments all = more;
      all.insert(all.end(), {"--post", name});
      EXPECT_TRUE(made(file, all).contains("cuts")) << name;
    }
}

TEST_F(Cut, texts_are_outlines_unless_they_are_left_out) {
  const std::string text = "0\nTEXT\n8\nTXT\n62\n3\n10\n1\n20\n2\n40\n6\n1\nBi\n";
  const std::string svg = folder_.write(
      "text.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' height='20mm' viewBox='0 0 40 20'>"
      "<g id='TXT'><text x='1' y='18' font-size='8' fill='lime'>Bi</text></g></svg>");
  for (const std::string& file : {drawing(text), svg}) {
    const Finished listed = run({"cut", file, "--list", "--json"});
    ASSERT_EQ(listed.status, 0) << listed.err;
    const json shapes = json::parse(listed.out)["shapes"];
    ASSERT_EQ(shapes.size(), 5u) << "B has two holes, i a dot";
    for (const json& shape : shapes) {
      EXPECT_EQ(shape["layer"], "TXT");
      EXPECT_EQ(shape["colour"], "#00ff00");
    }
    EXPECT_EQ(run({"cut", file, "--list", "--text", "none"}).status, 2) << "nothing is left";
    EXPECT_THAT(refused({"cut", file, "--list", "--font", folder_ / "no.ttf"}),
                HasSubstr("no.ttf"));
  }
  const Finished plain = run({"cut", drawing(text + square), "--list", "--text", "none"});
  EXPECT_THAT(plain.err + plain.out, HasSubstr("left out: 1 TEXT"));
}

TEST_F(Cut, names_what_it_does_not_cut_as_drawn) {
  const auto remarks = [&](const std::string& entities) {
    const Finished done = run({"cut", drawing(entities), "--list"});
    EXPECT_EQ(done.status, 0) << done.err;
    return done.err + done.out;
  };
  EXPECT_THAT(remarks(square + "0\nPOINT\n8\n0\n10\n5\n20\n5\n"), HasSubstr("left out: 1 POINT"));
  const std::string tilted = "not parallel to the XY plane";
  for (const char* const entity :
       {"0\nLINE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n3\n21\n0\n31\n4\n",
        "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n210\n1\n220\n0\n230\n0\n",
        "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n210\n0.6\n220\n0\n230\n0.8\n"})
    EXPECT_THAT(remarks(square + entity), HasSubstr("1 curve is " + tilted)) << entity;
  // A drawing at another height has the same outlines from above.
  EXPECT_THAT(remarks(square + "0\nCIRCLE\n8\n0\n10\n50\n20\n0\n30\n7\n40\n5\n"),
              Not(HasSubstr(tilted)));
}

TEST_F(Cut, warns_of_what_the_machine_does_not_permit) {
  const std::string file = drawing(square);
  const auto warnings = [&](const Arguments& more, const std::string& machine) {
    Arguments all = more;
    all.insert(all.end(), {"--machine", folder_.write("m.toml", machine)});
    return made(file, all)["warnings"].dump();
  };
  const std::string laser = "laser_mode = 1\n";
  EXPECT_EQ(warnings({}, laser), "[]");
  EXPECT_EQ(warnings({"--tabs", "2", "--kerf", "0.2"}, laser), "[]");
  EXPECT_THAT(warnings({"--tabs", "2"}, laser), HasSubstr("tabs are narrower than 0.5 mm"));
  EXPECT_THAT(warnings({}, "laser_mode = 0\n"), HasSubstr("pulsed laser"));
  EXPECT_THAT(warnings({"--pierce", "0.5"}, laser), HasSubstr("light at rest with 0 %"));
  EXPECT_EQ(warnings({"--pierce", "0.5"}, laser + "focus_power = 80\n"), "[]");
  EXPECT_THAT(warnings({"--pierce", "11"}, laser + "focus_power = 80\n"), HasSubstr("for 10 s"));
}

TEST_F(Cut, the_picture_is_an_svg) {
  const std::string picture = folder_ / "part.svg";
  made(drawing(rounded + dxf_circle(0, 0, 4)), {"--kerf", "0.5", "--picture", picture});
  EXPECT_THAT(read(picture), HasSubstr("<svg "));
  EXPECT_THAT(read(picture), HasSubstr(">2</text>"));
}

TEST_F(Cut, the_page_has_the_path_and_the_times_of_each_cut) {
  const std::string page = folder_ / "part.html";
  const double seconds = made(drawing(rounded + dxf_circle(-10, 0, 4) + dxf_circle(10, 0, 4)),
                              {"--page", page, "--pierce", "0.5"})["seconds"];
  const std::string text = read(page), begin = "id=\"data\">";
  const std::size_t from = text.find(begin) + begin.size();
  const json data = json::parse(text.substr(from, text.find("</script>", from) - from));
  EXPECT_THAT(text, HasSubstr("<svg "));
  ASSERT_EQ(data["cuts"].size(), 3u);
  EXPECT_EQ(data["cuts"][2]["name"], "cut outside, layer CUT");
  // Holes of 25 mm and an outline of 155 mm at 10 mm/s, after 0.5 s without motion each.
  const auto lasts = [&](std::size_t i) {
    return data["cuts"][i]["end_s"].get<double>() - data["cuts"][i]["begin_s"].get<double>();
  };
  EXPECT_NEAR(lasts(0), lasts(1), 0.5);
  EXPECT_NEAR(lasts(2), 15.5 + 0.5, 0.6);
  EXPECT_NEAR(data["cuts"][2]["end_s"], seconds, 0.1);
  // Five numbers a piece: the last one is its end.
  const std::vector<double> path = data["path"];
  ASSERT_EQ(path.size() % 5, 0u);
  for (std::size_t i = 9; i < path.size(); i += 5) EXPECT_GE(path[i], path[i - 5]);
  EXPECT_NEAR(path.back(), seconds, 0.1);
}

}  // namespace
}  // namespace lamplock::cli::test::cut
