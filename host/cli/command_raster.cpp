// `lamplock raster`: a picture becomes rows of pixels for a continuous laser.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/model/input.hpp"
#include "host/run/raster.hpp"

namespace lamplock::cli {
namespace {

struct RasterOptions : run::RasterOptions {
  bool json = false;
};

constexpr const char* burning_group = "Burning";

Json document(const RasterOptions& options, const run::RasterResult& result) {
  Json json = {{"input", options.input},
               {"columns", result.size.columns},
               {"rows", result.size.rows},
               {"pitch_mm", result.size.pitch_mm},
               {"overscan_mm", result.overscan_mm},
               {"lines", result.lines},
               {"runs", result.runs},
               {"bounds", bounds_json(result.box)}};
  if (result.job_bytes != 0)
    json["output"] = {{"file", options.output}, {"bytes", result.job_bytes}};
  if (result.gcode_bytes != 0)
    json["gcode"] = {{"file", options.gcode}, {"bytes", result.gcode_bytes}};
  json["seconds"] = result.seconds;
  return json;
}

void check_options(const RasterOptions& options) {
  if (options.output.empty() && options.gcode.empty()) {
    check_is_file(options.input);
    throw Error(Exit::bad_input, "lamplock raster", "no output file is given",
                "give -o FILE.llj or --gcode FILE.ngc");
  }
  if (options.power_lists && options.gcode.empty())
    throw Error(Exit::bad_input, "--power-lists", "needs --gcode",
                "add --gcode FILE.ngc, or leave it out");
}

Exit make_raster(const RasterOptions& options) {
  Console console(options.json);
  check_options(options);
  console.document(document(options, run::make_raster(options, console)));
  return Exit::done;
}

/// --origin: two numbers or three.
void add_corner(Command& app, std::vector<double>& origin_mm) {
  app.add_option("--origin", &origin_mm,
                 "Lower left corner in machine coordinates, Z0 without Z; default: picture in the "
                 "centre of the work space")
      .count({2, 3})
      .value_name("X,Y[,Z]")
      .group(burning_group)
      .common();
}

void add_burning(Command& app, RasterOptions& options) {
  const auto add = [&app](const char* name, Target value, const char* text,
                          const char* unit) -> Option& {
    return app.add_option(name, value, text).value_name(unit).group(burning_group);
  };
  add("--feed", &options.feed_mm_min, "Feed rate along the rows", "MM_MIN")
      .required()
      .check(number_from(0, false))
      .common();
  add("--pitch-mm", &options.pitch_mm,
      "Pixel size, also the distance between rows; default: from --width-mm, otherwise 0.1", "MM")
      .check(number_from(0, false))
      .common();
  add("--width-mm", &options.width_mm,
      "Width of the picture; together with --pitch-mm the picture is resampled (mean values)", "MM")
      .check(number_from(0, false))
      .common();
  add("--overscan-mm", &options.overscan_mm,
      "Distance before and after each row to speed up and brake, rounded up to whole pixels; "
      "default: the distance needed to reach the feed rate",
      "MM")
      .check(number_from(0, true));
  add("--power-max", &options.power_max, "Laser power for black", "PERCENT")
      .show_default()
      .check(number_in({0.0, 100.0}))
      .common();
  add("--power-min", &options.power_min, "Laser power for the lightest grey; white is not burned",
      "PERCENT")
      .show_default()
      .check(number_in({0.0, 100.0}));
  add_corner(app, options.origin_mm);
  app.add_option("--one-way", &options.one_way,
                 "Burn all rows from left to right, not back and forth")
      .group(burning_group)
      .common();
  app.add_option("--invert", &options.invert, "Burn light pixels instead of dark pixels")
      .group(burning_group)
      .common();
  app.add_option("--dry", &options.dry, "Make a job that moves without switching the laser on")
      .group(burning_group)
      .common();
}

}  // namespace

void add_raster(Command& program) {
  Command& app = program.add_command(
      "raster", "Convert a picture to rows of pixels for a continuous laser ($32=1)");
  app.footer(
      "A job (-o) needs the profile of a machine with a continuous laser: laser_mode = 1. G-code\n"
      "can be made without one.\n"
      "Example:\n  lamplock raster photo.png --width-mm 60 --pitch-mm 0.1 --feed 12000 \\\n"
      "      --machine examples/laser.toml -o rows.llj\n"
      "  lamplock send rows.llj --board /dev/ttyACM0");
  const auto options = std::make_shared<RasterOptions>();
  app.add_option("PICTURE", &options->input,
                 fmt::format("Picture ({})", model::extensions(model::InputKind::bitmap)))
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  app.add_option("-o,--output", &options->output, "Job file to write")
      .value_name("FILE.llj")
      .file(FileUse::write)
      .common();
  app.add_option(
         "--gcode", &options->gcode,
         "Write the same rows as G-code for any grbl board, one line for each change of power")
      .value_name("FILE.ngc")
      .file(FileUse::write)
      .common();
  app.add_option("--power-lists", &options->power_lists,
                 "Write the G-code as lists of powers: shorter, but read only by lamplock boards");
  add_burning(app, *options);
  add_machine(app, options->machine);
  app.add_json(options->json);
  app.action([options] { return make_raster(*options); });
}

}  // namespace lamplock::cli
