// `lamplock material`: the library from the command line, fits as printed, test cards and their
// sheets, wrong input.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test::material_command {
namespace {

using Arguments = std::vector<std::string>;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class MaterialCommand : public testing::Test {
 protected:
  Finished material(Arguments words) const {
    words.insert(words.begin(), "material");
    words.insert(words.end(), {"--library", library_});
    return run(words);
  }
  std::string done(const Arguments& words) const {
    const Finished finished = material(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.out;
  }
  json document(Arguments words) const {
    words.emplace_back("--json");
    return json::parse(done(words), nullptr, false);
  }
  /// The message; nothing in the folder changes.
  std::string refusal(const Arguments& words) const {
    const auto before = folder_.files();
    const std::string records = read(library_);
    const Finished refused = material(words);
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_EQ(folder_.files(), before);
    EXPECT_EQ(read(library_), records);
    return refused.err;
  }
  std::string laser_machine(double travel_mm) const {
    return folder_.write("laser.toml",
                         fmt::format("laser_mode = 1\nmax_spindle_speed = 1000\n"
                                     "travel = [{0}, {0}, 50]\nmin_corner = [0, 0, -50]\n",
                                     travel_mm));
  }

  Folder folder_;
  std::string library_ = folder_ / "library.db";
};

TEST_F(MaterialCommand, fits_and_best_feeds_as_printed) {
  EXPECT_THAT(done({"fit", "pmma-black"}), HasSubstr("B 0.71835  w 0.82350  rms 0.068\n"));
  EXPECT_THAT(done({"fit", "pmma-black", "--rejected"}),
              HasSubstr("B 0.67018  w 0.90940  rms 0.177\n"));
  EXPECT_THAT(done({"fit", "fibreboard"}), HasSubstr("B 0.03511  w 0.92954  rms 0.202\n"));
  const Finished plywood = material({"fit", "plywood"});
  EXPECT_THAT(plywood.out, HasSubstr("B 0.09940  w 0.91338  rms 0.600\n"));
  EXPECT_THAT(plywood.err, HasSubstr("warning  rms 0.600 is above 0.3"));
  const Finished fastest = material({"best", "pmma-black", "--thickness", "6"});
  EXPECT_THAT(fastest.out, HasSubstr("no faster feed was measured"));
  EXPECT_THAT(fastest.err, HasSubstr("a rejected measurement at 600 mm/min has a depth of 0.12"));
  EXPECT_THAT(done({"best", "pmma-black", "--thickness", "6", "--rejected"}),
              testing::AllOf(HasSubstr("feed      360 mm/min\n"),
                             HasSubstr("passes    17, 0.36 mm"), HasSubstr("4.72 min for 100 mm"),
                             HasSubstr("30 to 600 mm/min; other feeds are not considered")));
  EXPECT_EQ(document({"best", "plywood", "--thickness", "5"})["feed_mm_min"], 180);
  EXPECT_THAT(done({"suitable", "pmma-black", "--thickness", "6"}), HasSubstr("fit for cutting"));
  EXPECT_THAT(done({"suitable", "rubber", "--groove", "0.5"}), HasSubstr("fit for engraving"));
  EXPECT_THAT(done({"suitable", "rubber", "--groove", "0.4"}), HasSubstr("unfit"));
  EXPECT_EQ(document({"suitable", "rubber", "--passes", "3"})["verdict"], "fit for cutting");
  const json four = document({"suitable", "rubber", "--passes", "4"});
  EXPECT_EQ(four["verdict"], "unfit");
  EXPECT_EQ(four["reason"],
            "needs 4 passes to cut through, more than 3; the groove after 3 passes is not given");
  EXPECT_THAT(done({"suitable", "rubber", "--passes", "4", "--groove", "0.7"}),
              testing::AllOf(HasSubstr("fit for engraving"),
                             HasSubstr("needs 4 passes to cut through, more than 3, a groove")));
  EXPECT_THAT(done({"suitable", "rubber", "--groove", "0.7"}),
              HasSubstr("not cut through in 3 passes, a groove of 0.7 mm"));
  EXPECT_TRUE(folder_.files().empty()) << "reading makes no library";
}

TEST_F(MaterialCommand, records_are_added_changed_and_removed) {
  done({"add", "oak", "density_g_cm3=0.7", "specific_energy_kj_g=1", "absorption=1"});
  done({"add", "co2", "--kind", "laser", "power_w=40", "beam_width_mm=0.2"});
  done({"edit", "oak", "thickness_mm=3", "note=a b"});
  const json cut = document(
      {"measure", "oak", "--laser", "co2", "--feed", "600", "--power", "50%", "--depth", "1.5"});
  EXPECT_EQ(cut["power_w"], 20);
  done({"measure", "oak", "--laser", "co2", "--feed", "1200", "--power", "20", "--depth", "0.8"});
  const json fit = document({"fit", "oak"});
  EXPECT_EQ(fit["measurements"], 2);
  EXPECT_NEAR(fit["rms"], 0, 1e-9);
  EXPECT_EQ(document({"best", "oak"})["passes"], 2) << "3 mm is the thickness of the material";
  const std::string number = fmt::format("{}", cut["number"].get<int>());
  done({"edit", "oak", "--kind", "measurement", "--number", number, "rejected=true"});
  EXPECT_THAT(refusal({"fit", "oak"}), HasSubstr("has one"));
  const json shown = document({"show", "oak"});
  EXPECT_EQ(shown["note"], "a b");
  EXPECT_EQ(shown["measurements"].size(), 2u);
  EXPECT_THAT(refusal({"remove", "co2", "--kind", "laser"}),
              HasSubstr("it is used by 2 measurements; remove them"));
  EXPECT_THAT(done({"remove", "oak"}), HasSubstr("removed material oak with 0 settings and 2"));
  done({"remove", "co2", "--kind", "laser"});
  EXPECT_THAT(done({"list"}), Not(HasSubstr("oak")));
  EXPECT_THAT(done({"list", "--kind", "laser"}), Not(HasSubstr("co2")));
}

TEST_F(MaterialCommand, exchanges_files) {
  const std::string file = folder_ / "all.toml", one = folder_ / "one.toml";
  done({"export", file});
  done({"export", one, "--material", "plywood"});
  EXPECT_THAT(read(one), testing::AllOf(HasSubstr("[[laser]]"), Not(HasSubstr("pmma"))));
  EXPECT_EQ(document({"import", file})["added"], 0);
  done({"remove", "plywood"});
  const json imported = document({"import", one});
  EXPECT_EQ(imported["added"], 8) << "a material, a setting, six measurements";
  EXPECT_EQ(imported["unchanged"], 1) << "the laser";
  const std::string again = folder_ / "again.toml";
  done({"export", again});
  EXPECT_EQ(read(again).size(), read(file).size());
  const std::string other =
      folder_.write("other.toml", "[[material]]\nname = \"wool\"\n[[material]]\nname = \"new\"\n");
  EXPECT_THAT(refusal({"import", other}), HasSubstr("material wool: is in the library with other"));
  EXPECT_EQ(document({"import", other, "--replace"})["replaced"], 1);
}

TEST_F(MaterialCommand, wrong_input_is_refused_whole) {
  EXPECT_THAT(refusal({"fit", "plywod"}), HasSubstr("did you mean 'plywood'?"));
  EXPECT_THAT(refusal({"add", "oak", "density=1"}), HasSubstr("did you mean 'density_g_cm3'?"));
  EXPECT_THAT(refusal({"add", "oak", "densty=1"}), HasSubstr("did you mean 'density_g_cm3'?"));
  EXPECT_THAT(refusal({"add", "oak", "density_g_cm3=0"}), HasSubstr("'density_g_cm3' is 0"));
  EXPECT_THAT(refusal({"add", "plywood"}), HasSubstr("the library has it already"));
  EXPECT_THAT(refusal({"add", "x", "--kind", "laser", "power_w=3"}), HasSubstr("'beam_width_mm'"));
  EXPECT_THAT(refusal({"measure", "plywood", "--feed", "60"}), HasSubstr("'depth_mm' is missing"));
  EXPECT_THAT(refusal({"measure", "plywood", "--depth", "1"}), HasSubstr("'feed_mm_min'"));
  EXPECT_THAT(refusal({"measure"}), HasSubstr("NAME is missing"));
  for (const char* power : {"0", "4", "101%", "nan", "inf", "much", "%"})
    EXPECT_THAT(refusal({"measure", "plywood", "--feed", "60", "--depth", "1", "--power", power}),
                HasSubstr("the power is"));
  EXPECT_THAT(refusal({"best", "plywood"}), HasSubstr("its thickness is not known"));
  EXPECT_THAT(refusal({"best", "rubber", "--thickness", "3"}), HasSubstr("no measurement"));
  EXPECT_THAT(refusal({"best", "pmma-grey", "--thickness", "3"}), HasSubstr("cannot be cut"));
  EXPECT_THAT(refusal({"add", "oak", "name=birch"}), HasSubstr("a second name is given, 'birch'"));
  EXPECT_THAT(refusal({"add", "oak", "density_g_cm3=nan"}), HasSubstr("'density_g_cm3' is nan"));
  EXPECT_THAT(refusal({"add", "oak", "density_g_cm3=0.7 g/cm3"}), HasSubstr("not a number"));
  EXPECT_THAT(refusal({"edit", "plywood", "name="}),
              HasSubstr("material plywood: 'name' is missing"));
  EXPECT_THAT(refusal({"add", "plywood", "--kind", "setting", "laser=diode-3w", "feed_mm_min=60",
                       "power_w=30"}),
              HasSubstr("'power_w' is 30, more than that of the laser diode-3w; give at most 3"));
  EXPECT_THAT(refusal({"edit", "diode-3w", "--kind", "laser", "power_w=2"}),
              HasSubstr("laser diode-3w: 'power_w' is 2, setting"));
  EXPECT_THAT(refusal({"remove", "plywood", "--kind", "setting"}),
              HasSubstr("the number of the setting of plywood is missing"));
  EXPECT_THAT(refusal({"remove", "plywood", "--number", "3"}), HasSubstr("and no number"));
  EXPECT_THAT(refusal({"measure", "plywood", "--feed", "60", "--result", "cut"}),
              HasSubstr("'thickness_mm' is missing"));
  EXPECT_THAT(refusal({"edit", "plywood", "--kind", "measurement", "--number", "9999", "note=a"}),
              HasSubstr("no measurement with the number 9999"));
  EXPECT_THAT(refusal({"import", folder_ / "none.toml"}), HasSubstr("no such file"));
  EXPECT_THAT(refusal({"export", "/proc/none/a.toml"}), HasSubstr("/proc/none/a.toml"));
  EXPECT_THAT(run({"material", "list", "--library", folder_.write("a.txt", "a text")}).err,
              HasSubstr("it is not a material library"));
}

/// Length of the light path at each feed, by the straight pieces and quarter circles of a program.
double length_at_feed(const std::string& program, const std::string& feed) {
  std::smatch found;
  double x = 0, y = 0, length = 0;
  bool is_wanted = false;
  for (const std::string& line : lines(program)) {
    const auto word = [&](const char* letter, double otherwise) {
      return std::regex_search(line, found, std::regex(std::string(letter) + "(-?[0-9.]+)"))
                 ? std::stod(found[1])
                 : otherwise;
    };
    if (line.starts_with("(")) continue;
    if (line.find(" F") != std::string::npos)
      is_wanted = line.find(" F" + feed + " ") != std::string::npos;
    const double to_x = word("X", x), to_y = word("Y", y);
    if (is_wanted && line.starts_with("G1")) length += std::hypot(to_x - x, to_y - y);
    if (is_wanted && line.starts_with("G3"))
      length += std::hypot(word("I", 0), word("J", 0)) * std::acos(0.0);
    x = to_x;
    y = to_y;
  }
  return length;
}

TEST_F(MaterialCommand, a_depth_card_and_its_figures) {
  const std::string program = folder_ / "card.ngc", sheet = folder_ / "card.toml";
  const json card = document({"card", "plywood", "--feeds", "60:600:4", "--powers", "50,100%",
                              "--passes", "1:2", "--machine", laser_machine(300), "-o", program});
  EXPECT_EQ(card["cuts"], 16);
  // 154.8496 mm, by the two powers, at one and at two passes.
  EXPECT_NEAR(length_at_feed(read(program), "60.000"), 6 * 154.8496, 0.001);
  EXPECT_THAT(read(program), testing::AllOf(HasSubstr("(F240 P1.5 N2)"), HasSubstr("S500.000"),
                                            HasSubstr("S1000.000")));
  EXPECT_EQ(run({"check", program, "--machine", folder_ / "laser.toml"}).status, 0);
  EXPECT_THAT(refusal({"measure", "--card", sheet}), HasSubstr("no measured figure"));
  std::string text = read(sheet);
  std::string filled;
  int number = 0;
  for (std::size_t at = 0; (at = text.find("depth_mm = 0\n")) != std::string::npos;
       text = text.substr(at + 13))
    filled += text.substr(0, at) + fmt::format("depth_mm = {}\n", number++ % 3 == 0 ? 0 : 0.5);
  folder_.write("card.toml", filled + text);
  EXPECT_EQ(document({"measure", "--card", sheet})["added"], 10);
  EXPECT_EQ(document({"measure", "--card", sheet})["added"], 0);
  EXPECT_EQ(document({"show", "plywood"})["measurements"].size(), 16u);
  EXPECT_THAT(refusal({"measure", "wool", "--card", sheet}), HasSubstr("the sheet of plywood"));
  EXPECT_THAT(refusal({"measure", "--card", sheet, "--depth", "1"}), HasSubstr("--depth"));
}

TEST_F(MaterialCommand, grids_and_combs) {
  const std::string machine = laser_machine(300);
  const json grid = document({"card", "plywood", "--kind", "grid", "--feeds", "100:500:5",
                              "--powers", "1:3:3", "--passes", "1:2", "--machine", machine, "-o",
                              folder_ / "grid.ngc", "--label-feed", "777"});
  EXPECT_EQ(grid["cuts"], 30);
  done({"card", "plywood", "--kind", "grid", "--feeds", "60", "--powers", "20:100:4%", "--machine",
        machine, "-o", folder_ / "thirds.ngc"});
  EXPECT_THAT(read(folder_ / "thirds.ngc"), HasSubstr("(F60 P1.4 N1)")) << "46.667 % of 3 W";
  // Squares of 10 mm at three powers, with one and with two passes.
  EXPECT_NEAR(length_at_feed(read(folder_ / "grid.ngc"), "300.000"), 9 * 40, 1e-6);
  EXPECT_GT(length_at_feed(read(folder_ / "grid.ngc"), "777.000"), 100);
  done({"card", "plywood", "--kind", "kerf", "--feeds", "180", "--passes", "7", "--thickness", "5",
        "--machine", machine, "-o", folder_ / "kerf.ngc"});
  EXPECT_NEAR(length_at_feed(read(folder_ / "kerf.ngc"), "180.000"), 7 * (11 * 30 + 2 * 50), 1e-6);
  std::string sheet = read(folder_ / "kerf.toml");
  sheet.replace(sheet.find("together_mm = 0"), 15, "together_mm = 48");
  folder_.write("kerf.toml", sheet);
  // Ten slats between cuts 5 mm apart lost 2 mm.
  EXPECT_NEAR(document({"measure", "--card", folder_ / "kerf.toml"})["kerf_mm"], 0.2, 1e-9);
  const json settings = document({"show", "plywood"})["settings"];
  ASSERT_EQ(settings.size(), 1u) << "the delivered setting for 5 mm has it";
  EXPECT_NEAR(settings[0]["kerf_mm"], 0.2, 1e-9);
  const auto wrong = [&](const std::string& together) {
    std::string text = sheet;
    text.replace(text.find("together_mm = 48"), 16, "together_mm = " + together);
    return refusal({"measure", "--card", folder_.write("kerf.toml", text)});
  };
  EXPECT_THAT(wrong("51"), HasSubstr("without kerf"));
  EXPECT_THAT(wrong("4.8"), HasSubstr("the kerf would be 4.52 mm, wider than the slats of 0.48 mm"))
      << "one slat";
  EXPECT_THAT(wrong("24.9"), HasSubstr("wider than the slats"));
  EXPECT_NEAR(document({"show", "plywood"})["settings"][0]["kerf_mm"], 0.2, 1e-9);
}

TEST_F(MaterialCommand, a_laser_in_use_is_not_removed) {
  EXPECT_THAT(
      refusal({"remove", "diode-3w", "--kind", "laser"}),
      testing::ContainsRegex("used by [0-9]+ settings and [0-9]+ measurements; remove them"));
}

TEST_F(MaterialCommand, cards_that_a_machine_cannot_make_are_not_written) {
  const std::string small = laser_machine(100), out = folder_ / "a.ngc";
  const auto card = [&](const Arguments& more) {
    Arguments words{"card", "plywood", "--machine", small, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    return refusal(words);
  };
  EXPECT_THAT(card({}), HasSubstr("the work space 100 x 100 mm"));
  EXPECT_THAT(card({"--feeds", "60", "--corner", "60,0"}), HasSubstr("test card"));
  EXPECT_THAT(card({"--feeds", "60,1e6"}), HasSubstr("more than the machine's"));
  EXPECT_THAT(card({"--feeds", "60,0.01"}), HasSubstr("0.01 mm/min is less than 1; give"));
  EXPECT_THAT(card({"--feeds", "60", "--label-feed", "0.5"}), HasSubstr("less than 1"));
  EXPECT_THAT(card({"--feeds", "60", "--powers", "3.1"}), HasSubstr("more than that of the laser"));
  for (const char* feeds : {"a", "1:2:3:4", "60:", "0", "-5", "30:600:1", "30:600:2.5", "nan",
                            "1:1e9", "1.5:3", "60,,90", "60:600"})
    EXPECT_THAT(card({"--feeds", feeds}), HasSubstr("feeds")) << feeds;
  EXPECT_THAT(card({"--feeds", "60:600"}), HasSubstr("'60:600' has no count; give FROM:TO:COUNT"));
  EXPECT_THAT(card({"--feeds", "60", "--powers", "1:3"}), HasSubstr("'1:3' has no count"));
  EXPECT_THAT(card({"--kind", "grid", "--feeds", "60", "--cell", "0.1"}),
              HasSubstr("a cell of 0.1 mm is too small for the beam"));
  EXPECT_THAT(card({"--kind", "kerf", "--feeds", "60", "--thickness", "5", "--pitch", "0.05"}),
              HasSubstr("a pitch of 0.05 mm is too small for the beam"));
  EXPECT_THAT(card({"--feeds", "60", "--passes", "1.5"}), HasSubstr("passes"));
  EXPECT_THAT(card({"--kind", "kerf", "--feeds", "60,90"}), HasSubstr("one feed"));
  EXPECT_THAT(card({"--kind", "kerf", "--feeds", "60"}), HasSubstr("its thickness is not known"));
  EXPECT_THAT(card({"--kind", "grid", "--feeds", "1:60:60", "--powers", "1:3:30"}),
              HasSubstr("1800 cuts"));
  EXPECT_THAT(refusal({"card", "plywood", "--feeds", "60", "-o", out}),
              HasSubstr("laser_mode = 0"));
  EXPECT_THAT(card({"--feeds", "60", "--sheet", out}), HasSubstr("a.ngc"));
  folder_.write("a.toml", "figures = 1\n");
  EXPECT_THAT(card({"--feeds", "60"}), HasSubstr("a.toml: it has measured figures"));
}

}  // namespace
}  // namespace lamplock::cli::test::material_command
