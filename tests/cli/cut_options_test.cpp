// `lamplock cut`: options of a run beside a description, operations that are off, contours of a
// lathe, programs of other post-processors.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/cut_program.hpp"

namespace lamplock::cli::test::cut_options {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using namespace lamplock::test;

class CutOptions : public CutPart {
 protected:
  /// With 80 % and 600 mm/min.
  Finished cut(const Arguments& more) const {
    return cut_part({"--power", "80", "--feed", "600", "-o", program_}, more);
  }
};

TEST_F(CutOptions, a_description_does_not_lose_a_dry_run) {
  const std::string saved = folder_ / "job.toml";
  for (const Arguments& option :
       {Arguments{"--dry"}, Arguments{"--frame"}, Arguments{"--from", "2"}}) {
    Arguments more = option;
    more.insert(more.end(), {"--save", saved});
    EXPECT_THAT(refused(cut(more)),
                HasSubstr(option.front() + ": is not saved in a description; leave it out"));
    EXPECT_FALSE(std::filesystem::exists(saved));
  }
  ASSERT_EQ(cut({"--save", saved}).status, 0);
  ASSERT_EQ(run({"cut", saved, "--dry", "-o", program_}).status, 0);
  EXPECT_THAT(read(program_), Not(HasSubstr("S800")));
}

TEST_F(CutOptions, options_without_effect_are_refused) {
  EXPECT_THAT(refused(cut({"--surface", "3"})), HasSubstr("surface: has no effect without passes"));
  EXPECT_THAT(refused(cut({"--library", folder_ / "none.db"})),
              HasSubstr("--library: has no effect without a material"));
  for (const Arguments& option : {Arguments{"--baud", "9600"}, Arguments{"--yes"},
                                  Arguments{"--usb", "stream"}, Arguments{"--image", part_}})
    EXPECT_THAT(refused(cut(option)),
                HasSubstr(option.front() + ": has no effect without a board"));
  for (const Arguments& option :
       {Arguments{"--dry"}, Arguments{"--frame"}, Arguments{"--from", "2"}})
    EXPECT_THAT(refused(cut_part({"--list"}, option)),
                HasSubstr(option.front() + ": has no effect on --list"));
  EXPECT_EQ(cut({"--surface", "3", "--infeed", "1", "--final-depth", "2"}).status, 0);
  EXPECT_THAT(read(program_), testing::ContainsRegex("G0 Z3 S0\nM5\n"))
      << "the next program begins on the surface";
}

TEST_F(CutOptions, what_is_no_drawing_is_not_advised) {
  for (const char* name : {"noext", "x.mtl", "x.step", "x.fbx"}) {
    const Finished wrong = run({"cut", folder_.write(name, "x"), "--list"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("; give a drawing (dxf, svg, svgz)\n")) << name;
    EXPECT_EQ(run({"cut", folder_ / name}).err, wrong.err) << "before the missing output";
  }
  EXPECT_THAT(run({"cut", folder_.write("x.ai", "x"), "--list"}).err, HasSubstr("save it as SVG"));
  EXPECT_THAT(run({"points", folder_ / "x.mtl", "-o", folder_ / "x.xyz"}).err,
              HasSubstr("or points ("));
}

TEST_F(CutOptions, an_overlap_is_named_once) {
  drawing(dxf_rectangle(0, 0, 10, 10) + dxf_rectangle(5, 0, 10, 5));
  const std::string warnings = cut({"--kerf", "0.2"}).out;
  const auto first = warnings.find("overlap of two contours");
  EXPECT_NE(first, std::string::npos) << warnings;
  EXPECT_EQ(warnings.find("overlap of two contours", first + 1), std::string::npos) << warnings;
}

/// A post-processor in a file, for a lamplock board.
class CutPosts : public CutOptions {
 protected:
  Finished cut_by(const std::string& lines, Arguments more = {}) const {
    const std::string post = folder_.write(
        "own.toml", "decimals = 3\nchecked = true\n[lines]\n" + lines + "end = \"M2\"\n");
    more.insert(more.end(), {"--post", post});
    return cut(more);
  }
  /// `begin` and the moves, with another text in the place of one.
  static std::string lines(const std::string& old = "", const std::string& replacement = "") {
    std::string text =
        "begin = [\"G21 G90\", \"M4 S0\"]\n"
        "rapid = \"G0 X{x} Y{y} S0\"\n"
        "line = \"G1 X{x} Y{y} F{feed} S{power}\"\n"
        "arc_cw = \"G2 X{x} Y{y} I{i} J{j} F{feed} S{power}\"\n"
        "arc_ccw = \"G3 X{x} Y{y} I{i} J{j} F{feed} S{power}\"\n";
    if (!old.empty()) text.replace(text.find(old), old.size(), replacement);
    return text;
  }
};

TEST_F(CutPosts, a_path_that_is_not_that_of_the_plan_is_refused) {
  const auto wrong = [&](const std::string& old, const std::string& replacement) {
    return refused(cut_by(lines(old, replacement)));
  };
  const auto with_moves = [&](const std::string& moves) {
    return wrong("line = \"G1 X{x} Y{y}", "line = \"" + moves);
  };
  EXPECT_THAT(with_moves("G1 Y{x} X{y}"), HasSubstr("the plan from"));
  EXPECT_THAT(with_moves("G1 X{x}"), HasSubstr("not that of the plan"));
  EXPECT_THAT(wrong("arc_cw = \"G2 X{x} Y{y} I{i} J{j}", "arc_cw = \"G1 X{x} Y{y}"),
              HasSubstr("its moves with a feed have"));
  drawing(dxf_rectangle(0.5, 0.5, 1, 1));  // the machine has room for inches
  const std::string inches = wrong("G21 G90", "G20 G90");
  EXPECT_THAT(inches, HasSubstr("own.toml: the path of its program is not that of the plan: X runs "
                                "from 12.700 to 38.100 mm, the plan from 0.500 to 1.500 mm;"));
  EXPECT_THAT(wrong("G21 G90", "G21 G91"), HasSubstr("not that of the plan"));
}

TEST_F(CutPosts, paths_of_the_plan_are_accepted) {
  EXPECT_EQ(cut_by(lines()).status, 0);
  EXPECT_EQ(cut_by(lines("rapid = \"G0 X{x} Y{y} S0", "rapid = \"G1 X{x} Y{y} F3000 S0")).status, 0)
      << "a controller without rapids";
  EXPECT_EQ(cut_by(lines() + "operation = \"G0 X-40 Y-40\"\n").status, 0) << "a change of tools";
  EXPECT_EQ(cut_by(lines() + "height = \"G0 Z{z}\"\n",
                   {"--kerf", "0.2", "--infeed", "1", "--final-depth", "3", "--overcut", "1",
                    "--lead-in", "arc", "--tabs", "2"})
                .status,
            0);
  EXPECT_EQ(cut_by(lines(), {"--operation", "engrave", "--hatch", "0.5"}).status, 0);
  EXPECT_EQ(cut_by(lines(), {"--frame"}).status, 0);
  EXPECT_EQ(cut({"--kerf", "0.5", "--compensation", "controller", "--passes", "2"}).status, 0);
  drawing(dxf_polyline({{0, 0}, {10, 0}}, false));
  EXPECT_EQ(cut_by(lines()).status, 0) << "a line along an axis";
}

/// With the box and the length of the plan, but another path, feed, power or height.
TEST_F(CutPosts, programs_that_only_look_like_the_plan_are_refused) {
  drawing(dxf_rectangle(5, 5, 20, 20));
  const auto refuses = [&](const std::string& text, const std::string& what) {
    EXPECT_THAT(refused(cut_by(text)), HasSubstr(what)) << text;
  };
  std::string mirrored = lines("rapid = \"G0 X{x} Y{y}", "rapid = \"G0 X{y} Y{x}");
  mirrored.replace(mirrored.find("G1 X{x} Y{y}"), 12, "G1 X{y} Y{x}");
  refuses(mirrored, "runs by (5.000, 25.000) mm, which is not on the plan's edge");
  refuses(lines("G21 G90", "G21 G90 G93"), "has a feed of");
  refuses(lines("G21 G90", "G21 G90 G55"), "changes the coordinate system");
  refuses(lines("S{power}", "S{power} Z-20"), "ends at Z -20.000 mm, the plan at 0.000");
  refuses(lines("S{power}", "S500"), "has S500, the plan S800");
  refuses(lines("F{feed}", "F{feed}0"), "has a feed of 6000.000 mm/min, the plan 600.000");
  refuses(lines("\"M4 S0\"]", "\"M4 S0\", \"G1 X20 F100 S500\", \"G0 X0 S0\"]"),
          "moves with S500 where the plan has no light");
  // Far smaller than the sheet, which decides nothing.
  drawing(dxf_rectangle(5.1, 5.1, 20.1, 20.1));
  refuses(lines("G1 X{x}", "G1 X{x}04"), "(25.204, 5.100) mm");
}

TEST_F(CutPosts, dark_programs_are_proved_to_be_dark) {
  const std::vector<std::string> lit{"shape_begin = [\"M3 S1000\", \"G4 P0.2\", \"M3 S{power}\"]\n",
                                     "shape_begin = [\"m3 s1000\", \"M3 S{power}\"]\n",
                                     "shape_end = [\"M3 S1000\", \"G4 P1\", \"M5\"]\n",
                                     "comment = [\"({text})\", \"M4 S 5\", \"S0\"]\n"};
  for (const std::string checked : {"", "checked = false\n"}) {
    const auto dark = [&](const std::string& text, const char* option) {
      return cut(
          {"--post",
           folder_.write("own.toml", fmt::format("decimals = 3\n{}[lines]\n{}", checked, text)),
           option});
    };
    for (const char* const option : {"--dry", "--frame"}) {
      const std::string end = "end = \"M2\"\n";
      for (const std::string& more : lit)
        EXPECT_THAT(refused(dark(fmt::format("{}{}{}", lines(), more, end), option)),
                    HasSubstr("may switch the light on; write {power} in the place of a fixed "))
            << more;
      for (const auto& [old, fixed] : {std::pair{"M4 S0", "M3 S500\", \"G1 X1 F100\", \"S0"},
                                       std::pair{"S{power}", "S8[{power}]"}})
        EXPECT_THAT(refused(dark(lines(old, fixed) + end, option)), HasSubstr("the light on"));
      EXPECT_THAT(refused(dark(lines() + "end = [\"G1 X0 Y0 M3 S1000\", \"M2\"]\n", option)),
                  HasSubstr("the light on"));
      EXPECT_EQ(dark(lines() + "comment = \"(S1000 {text}) ; M3 S5\"\n" + end, option).status, 0);
      std::filesystem::remove(program_);
    }
  }
  // Another controller may begin with any power.
  const std::string post = folder_.write(
      "own.toml", "checked = false\n[lines]\n" + lines("M4 S0", "M4") + "end = \"M2\"\n");
  EXPECT_THAT(refused(cut({"--post", post, "--dry"})), HasSubstr("'M4', may switch the light on"));
}

/// The rapid has switched the light off without a value of the plan.
TEST_F(CutPosts, a_fixed_word_does_not_leave_the_next_contour_dark) {
  const std::string changed = lines("F{feed} S{power}", "[ F{feed}][ S{power}]");
  ASSERT_EQ(cut_by(changed).status, 0);
  const std::string program = read(program_);
  EXPECT_THAT(program.substr(program.rfind("G0 ")), HasSubstr("S800"));
}

TEST_F(CutPosts, dry_runs_have_no_air) {
  const auto dry = [&](const std::string& post, const Arguments& more) {
    Arguments all{"--post", post, "--dry"};
    all.insert(all.end(), more.begin(), more.end());
    const Finished finished = cut(all);
    EXPECT_EQ(finished.status, 0) << post << finished.err;
    EXPECT_THAT(read(program_), Not(testing::ContainsRegex("[Mm] ?0*[78]([^0-9.]|$)"))) << post;
  };
  dry("grbl", {"--air"});
  dry("cut", {});
  dry("cut", {"--air"});
  dry("mill", {"--air", "--final-depth", "1"});
  const std::string own = folder_.write(
      "own.toml", "decimals = 3\n[lines]\nshape_begin = \"M04m08 (air)\"\n" + lines());
  dry(own, {});
  EXPECT_THAT(read(program_), HasSubstr("\nM04 (air)\n"));
  drawing(dxf_polyline({{0, 5}, {20, 5}}, false));
  dry("lathe", {"--air", "--final-depth", "1"});
  Arguments knife{"cut", part_,           "--feed", "600",   "--post", "knife", "--knife-offset",
                  "0.3", "--final-depth", "1",      "--dry", "-o",     program_};
  ASSERT_EQ(run(knife).status, 0);
  EXPECT_EQ(cut({"--post", "cut"}).status, 0);
  EXPECT_THAT(read(program_), HasSubstr("M3 M8")) << "but a cut has";
}

/// Holes of radius 4 in squares on another layer.
class CutOperations : public CutOptions {
 protected:
  /// The program of the holes. `others`: lines of the operation of the squares; empty: no
  /// operation.
  Finished cut_holes(const std::string& others, const std::string& drawing = "") const {
    const std::string operations =
        "[[operation]]\nlayers = [\"IN\"]\nname = \"holes\"\npower = 80\nfeed = 600\n"
        "kerf = 0.2\n" +
        (others.empty() ? others : "[[operation]]\nlayers = [\"OUT\"]\n" + others);
    const std::string job =
        folder_.write("job.toml", "[drawing]\nfile = \"part.dxf\"\n" + drawing + operations);
    return run({"cut", job, "-o", program_, "--json"});
  }
  json document(const Finished& finished) const {
    EXPECT_EQ(finished.status, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
  void SetUp() override {
    drawing(dxf_rectangle(0, 0, 20, 20, "OUT") + dxf_circle(10, 10, 4, "IN") +
            dxf_rectangle(25, 0, 20, 20, "OUT") + dxf_circle(35, 10, 4, "IN"));
  }
  static constexpr double two_holes_mm = 2 * 2 * 3.14159265358979 * 3.9;
};

TEST_F(CutOperations, one_that_is_off_does_not_turn_holes_into_parts) {
  for (const char* kind : {"cut", "score", "engrave"}) {
    const json on =
        document(cut_holes(fmt::format("power = 10\nfeed = 600\nkind = \"{}\"\n", kind)));
    const json off = document(cut_holes(fmt::format("off = true\nkind = \"{}\"\n", kind)));
    EXPECT_EQ(on["shapes"][1]["kind"], off["shapes"][1]["kind"]) << kind;
  }
  const json off = document(cut_holes("off = true\n"));
  EXPECT_EQ(off["shapes"][1]["kind"], "hole");
  EXPECT_NEAR(off["cut_mm"].get<double>(), two_holes_mm, 1e-3);
  EXPECT_THAT(off["warnings"].dump(), Not(HasSubstr("holes:")));
}

TEST_F(CutOperations, one_that_is_off_does_not_move_the_others) {
  const std::string drawing = "x = -10\ny = -10\n";
  const json on = document(cut_holes("power = 10\nfeed = 600\n", drawing));
  const json off = document(cut_holes("off = true\n", drawing));
  EXPECT_EQ(on["shapes"][1]["bounds"], off["shapes"][1]["bounds"]);
}

TEST_F(CutOperations, contours_that_do_not_count_are_named_where_they_decide_the_side) {
  for (const char* others : {"", "kind = \"ignore\"\n"}) {
    const json made = document(cut_holes(others));
    EXPECT_THAT(made["warnings"].dump(),
                HasSubstr("holes: 2 contours are cut as parts, the first is the contour of 25.133 "
                          "mm at (10.000, 10.000)"));
    EXPECT_THAT(made["warnings"].dump(), HasSubstr("give compensation inside"));
  }
  const auto warnings = [&](const Arguments& more) {
    Arguments all = more;
    all.emplace_back("--json");
    return document(cut(all))["warnings"].dump();
  };
  EXPECT_THAT(warnings({"--layer", "IN"}), Not(HasSubstr("do not count")))
      << "without a kerf and leads the side does not matter";
  EXPECT_THAT(warnings({"--layer", "OUT", "--kerf", "0.2"}), Not(HasSubstr("do not count")))
      << "a part is one, whatever is in it";
}

}  // namespace
}  // namespace lamplock::cli::test::cut_options
