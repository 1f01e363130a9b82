// `lamplock material card`: the program of a test card and the sheet for its figures.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/command_material.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/duration_text.hpp"
#include "host/number_text.hpp"
#include "host/run/material_card.hpp"

namespace lamplock::cli {
namespace {

struct CardCommandOptions : run::CardOptions {
  bool json = false;
};

Exit make_card(const CardCommandOptions& options) {
  Console console(options.json);
  const run::CardResult card = run::make_card(options);
  console.say("card      {} on {:.1f} x {:.1f} mm", lamplock::count_text(card.cuts, "cut"),
              card.width_mm, card.height_mm);
  console.say("time      {}", duration_text(card.seconds));
  console.say("program   {}", options.output);
  console.say("sheet     {}", card.sheet);
  console.say("next      write the measured figures into the sheet, then:");
  console.say("          lamplock material measure --card {}", card.sheet);
  console.document({{"output", options.output},
                    {"sheet", card.sheet},
                    {"cuts", card.cuts},
                    {"width_mm", card.width_mm},
                    {"height_mm", card.height_mm},
                    {"time_s", card.seconds}});
  return Exit::done;
}

void add_ranges(Command& sub, CardCommandOptions& options) {
  sub.add_option("--kind", &options.kind,
                 "depth: rounded rectangles of 60 x 20 mm; grid: squares; kerf: slats")
      .value_name("depth|grid|kerf")
      .check(one_of({"depth", "grid", "kerf"}))
      .show_default()
      .common();
  sub.add_option("--feeds", &options.feeds,
                 "Feeds in mm/min: a list, or FROM:TO:COUNT; default: 11 feeds from 30 to 600")
      .value_name("LIST")
      .common();
  sub.add_option("--powers", &options.powers,
                 "Powers in W, or with % in percent of the laser's power; default: 100%")
      .value_name("LIST")
      .common();
  sub.add_option("--passes", &options.passes, "Numbers of passes: a list, or FROM:TO; default: 1")
      .value_name("LIST")
      .common();
  sub.add_option("--label-feed", &options.label_feed_mm_min,
                 "Feed of the engraved labels; default: 600")
      .check(number_in({0, 1'000'000, false}))
      .value_name("MM_MIN");
  sub.add_option("--label-power", &options.label_power,
                 "Power of the engraved labels, W or with %; default: 50%")
      .value_name("POWER");
  sub.add_option("--air", &options.air, "Switch the air on for the cuts (M8)").common();
}

void add_sizes(Command& sub, CardCommandOptions& options) {
  constexpr glass::Range card_size{0, 1000, false};
  sub.add_option("--cell", &options.cell_mm, "Side of a square of the grid")
      .check(number_in(card_size))
      .value_name("MM")
      .show_default();
  sub.add_option("--slats", &options.slats, "Number of slats of a kerf card")
      .check(number_in({1, 100}))
      .value_name("N")
      .show_default();
  sub.add_option("--pitch", &options.pitch_mm, "Distance of the cuts of a kerf card")
      .check(number_in(card_size))
      .value_name("MM")
      .show_default();
  sub.add_option("--slat-length", &options.slat_length_mm, "Length of the slats")
      .check(number_in(card_size))
      .value_name("MM")
      .show_default();
  sub.add_option("--thickness", &options.thickness_mm,
                 "Thickness of the sheet; default: that of the material")
      .check(number_in({0, 10'000, false}))
      .value_name("MM")
      .common();
  sub.add_option("--corner", &options.corner_mm,
                 "Lower left corner of the card; default: the card is in the middle")
      .count({2, 2})
      .check(number_in({-100'000, 100'000}))
      .value_name("X,Y")
      .common();
}

}  // namespace

void add_material_card(Command& app) {
  Command& sub = app.add_command(
      "card", "Make the program of a test card for a material, and a sheet for its figures");
  sub.footer(
      "The labels F, P and N are feed, power in W and number of passes. The interpreter of the\n"
      "firmware runs the program before it is written.\n"
      "Kerf: the slats pushed together are narrower than their cuts are apart, by a kerf each.\n"
      "Example:\n"
      "  lamplock material card plywood --feeds 60:600:4 --machine examples/laser.toml -o "
      "card.ngc\n"
      "  lamplock material card plywood --kind grid --feeds 100:600:5 --powers 20:100:4% \\\n"
      "      --machine examples/laser.toml -o grid.ngc\n"
      "  lamplock material card plywood --kind kerf --feeds 180 --passes 7 --thickness 5 \\\n"
      "      --machine examples/laser.toml -o kerf.ngc");
  const auto options = std::make_shared<CardCommandOptions>();
  sub.add_option("NAME", &options->material, "Name of the material").required();
  sub.add_option("-o,--output", &options->output, "G-code program to write")
      .required()
      .value_name("FILE")
      .file(FileUse::write)
      .common();
  sub.add_option("--sheet", &options->sheet,
                 "Sheet (TOML) to write; default: the name of the program with .toml")
      .value_name("FILE")
      .file(FileUse::write, ".toml")
      .common();
  sub.add_option("--laser", &options->laser,
                 "Name of the laser; default: the one of the measurements, or the only one")
      .value_name("NAME")
      .common();
  add_ranges(sub, *options);
  add_sizes(sub, *options);
  add_machine(sub, options->machine);
  sub.add_json(options->json);
  add_library(sub, options->library);
  sub.action([options] { return make_card(*options); });
}

}  // namespace lamplock::cli
