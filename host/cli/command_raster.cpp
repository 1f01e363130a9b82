// `lamplock raster`: a picture becomes rows of pixels for a continuous laser.
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/options.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/prepare.hpp"
#include "host/cli/run_rows.hpp"
#include "host/cli/staged_file.hpp"
#include "host/file.hpp"
#include "host/job/job_file.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/raster/pixels.hpp"
#include "host/raster/row_gcode.hpp"
#include "host/raster/row_motion.hpp"
#include "host/raster/rows.hpp"

namespace lamplock::cli {
namespace {

constexpr double share_per_percent = 0.01, default_pitch_mm = 0.1;
constexpr const char* burning_group = "Burning";

struct RasterOptions {
  std::string input{}, output{}, gcode{};
  std::optional<double> pitch_mm{}, width_mm{}, overscan_mm{};
  double feed_mm_min = 0, power_min = 0, power_max = 100;
  std::vector<double> origin_mm{};
  bool one_way = false, invert = false, dry = false, json = false, power_lists = false;
  MachineOptions machine{};
};

/// How large pixels are, and how many.
struct Size {
  double pitch_mm;
  std::size_t columns, rows;

  double width_mm() const { return static_cast<double>(columns) * pitch_mm; }
  double height_mm() const { return static_cast<double>(rows) * pitch_mm; }
};

/// Pixels are those of the picture, unless both pitch and width are given.
Size size_of(const RasterOptions& options, const model::Bitmap& bitmap) {
  const auto width = static_cast<std::size_t>(bitmap.width);
  const auto height = static_cast<std::size_t>(bitmap.height);
  if (!options.width_mm) return {options.pitch_mm.value_or(default_pitch_mm), width, height};
  const double pixel_mm = *options.width_mm / static_cast<double>(width);
  if (!options.pitch_mm) return {pixel_mm, width, height};
  const auto count = [&](std::size_t pixels) {
    const double exact = static_cast<double>(pixels) * pixel_mm / *options.pitch_mm;
    if (!(exact < 1e9))
      throw Error(Exit::bad_input, "--pitch-mm", "too many pixels", "give a greater one");
    return static_cast<std::size_t>(std::max(1.0, std::round(exact)));
  };
  const Size size{*options.pitch_mm, count(width), count(height)};
  constexpr std::size_t most_pixels = 100'000'000;  // as of pictures
  if (size.columns > most_pixels / size.rows)
    throw Error(Exit::bad_input, "--pitch-mm",
                fmt::format("{} x {} pixels", size.columns, size.rows), "give a greater one");
  return size;
}

/// Its lower left corner: as told, or so that the picture is in the middle of the work space.
points::Point corner_of(const RasterOptions& options, const Size& size,
                        const settings::Values& values) {
  const std::vector<double>& told = options.origin_mm;
  if (!told.empty()) return {told[0], told[1], told.size() > 2 ? told[2] : 0};
  const points::Point middle = work_space_mm(values).centre();
  return {middle.x - size.width_mm() / 2, middle.y - size.height_mm() / 2, 0};
}

void check_outputs(const RasterOptions& options) {
  if (options.output.empty() && options.gcode.empty())
    throw Error(Exit::bad_input, "lamplock raster", "where to write is missing",
                "give -o FILE.llj or --gcode FILE.ngc");
  if (options.power_lists && options.gcode.empty())
    throw Error(Exit::bad_input, "--power-lists", "needs --gcode",
                "add --gcode FILE.ngc, or leave it out");
  check_distinct({{"-o", options.output}, {"--gcode", options.gcode}}, options.input);
  for (const std::string& file : {options.output, options.gcode})
    if (!file.empty()) check_target(file);
}

raster::PowerForm form_of(const RasterOptions& options) {
  return options.power_lists ? raster::PowerForm::lists : raster::PowerForm::plain;
}

/// Reads the picture and makes rows of it; says what came of it.
job::Job make_job(const RasterOptions& options, Console& console, Json& json) {
  const job::Profile profile = options.machine.profile();
  const model::Bitmap bitmap = model::read_bitmap(options.input);
  const Size size = size_of(options, bitmap);
  const raster::Pixels pixels =
      raster::make_pixels(bitmap, size.columns, size.rows,
                          {options.power_min * share_per_percent,
                           options.power_max * share_per_percent, options.invert});
  console.phase("picture", fmt::format("{}: {} x {} pixels of {:g} mm, {:g} x {:g} mm",
                                       options.input, size.columns, size.rows, size.pitch_mm,
                                       size.width_mm(), size.height_mm()));
  raster::RowOptions how;
  how.corner = corner_of(options, size, profile.settings);
  how.pitch_mm = size.pitch_mm;
  how.feed_mm_min = options.feed_mm_min;
  how.overscan_mm = options.overscan_mm ? *options.overscan_mm
                                        : raster::run_up_mm(profile.settings, options.feed_mm_min);
  how.one_way = options.one_way;
  how.dry = options.dry;
  job::Job job = raster::make_rows(pixels, how, profile);
  const points::Bounds box = points::bounds(points_of(job));
  console.phase("rows", fmt::format("{} with {:.4g} mm overscan, {}", rows_text(job),
                                    how.overscan_mm, bounds_text(box)));
  json = {{"input", options.input},       {"columns", size.columns},        {"rows", size.rows},
          {"pitch_mm", size.pitch_mm},    {"overscan_mm", how.overscan_mm}, {"lines", job.size()},
          {"runs", job.rows.runs.size()}, {"bounds", bounds_json(box)}};
  return job;
}

/// Writes one of the results; `name`: in the document.
void write_result(const std::string& file, std::string_view bytes, const char* name,
                  Console& console, Json& json) {
  write_whole(file, [&](const std::filesystem::path& path) { write_file(path, bytes); });
  console.phase("written", fmt::format("{}, {} bytes", file, bytes.size()));
  json[name] = {{"file", file}, {"bytes", bytes.size()}};
}

Exit make_raster(const RasterOptions& options) {
  Console console(options.json);
  check_outputs(options);
  Json json;
  const job::Job job = make_job(options, console, json);
  if (!options.output.empty()) {
    const std::vector<std::uint8_t> bytes = job::encode_job_file(job);
    write_result(options.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                 "output", console, json);
  }
  if (!options.gcode.empty())
    write_result(options.gcode, raster::row_gcode(job, form_of(options)), "gcode", console, json);
  json["seconds"] = raster::seconds_of(job);
  console.say("time      about {:.1f} s", json["seconds"].get<double>());
  console.document(json);
  return Exit::done;
}

/// --origin: two numbers or three.
void add_origin(Command& app, std::vector<double>& origin_mm) {
  app.add_option(
         "--origin", &origin_mm,
         "Lower left corner in machine coordinates, and height, 0 if left out; without it the "
         "middle of the work space")
      .count({2, 3})
      .value_name("X,Y[,Z]")
      .group(burning_group);
}

void add_burning(Command& app, RasterOptions& options) {
  const auto add = [&app](const char* name, Target value, const char* text,
                          const char* unit) -> Option& {
    return app.add_option(name, value, text).value_name(unit).group(burning_group);
  };
  add("--feed", &options.feed_mm_min, "Speed along the rows", "MM_MIN")
      .required()
      .check(number_from(0, false));
  add("--pitch-mm", &options.pitch_mm,
      "Size of a pixel, and distance of rows; without it and --width-mm 0.1", "MM")
      .check(number_from(0, false));
  add("--width-mm", &options.width_mm,
      "Width of the picture; with --pitch-mm pixels are means of those of the picture", "MM")
      .check(number_from(0, false));
  add("--overscan-mm", &options.overscan_mm,
      "Dark way before and behind each row; without it what the machine needs for the feed", "MM")
      .check(number_from(0, true));
  add("--power-max", &options.power_max, "Power of black", "PERCENT")
      .show_default()
      .check(number_in({0.0, 100.0}));
  add("--power-min", &options.power_min, "Power of the lightest grey; white is dark", "PERCENT")
      .show_default()
      .check(number_in({0.0, 100.0}));
  add_origin(app, options.origin_mm);
  app.add_option("--one-way", &options.one_way, "All rows to the right, not back and forth")
      .group(burning_group);
  app.add_option("--invert", &options.invert, "Burn light instead of dark").group(burning_group);
  app.add_option("--dry", &options.dry, "A job that moves and never shines").group(burning_group);
}

}  // namespace

void add_raster(Command& program) {
  Command& app = program.add_command(
      "raster", "Turn a picture into rows of pixels for a continuous laser ($32=1)");
  app.footer(
      "Example:\n  lamplock raster photo.png --width-mm 60 --pitch-mm 0.1 --feed 12000 \\\n"
      "      --machine examples/laser.toml -o rows.llj\n"
      "  lamplock send rows.llj --board /dev/ttyACM0");
  const auto options = std::make_shared<RasterOptions>();
  app.add_option("PICTURE", &options->input, "Picture (png, bmp, jpeg)")
      .required()
      .value_name("FILE");
  app.add_option("-o,--output", &options->output, "Job file to write").value_name("FILE.llj");
  app.add_option("--gcode", &options->gcode,
                 "The same rows as G-code that every grbl reads, one line for each power")
      .check(file_name())
      .value_name("FILE.ngc");
  app.add_option("--power-lists", &options->power_lists,
                 "Write the G-code as lists of powers: shorter, but read only by lamplock boards");
  add_burning(app, *options);
  options->machine.add_machine(app);
  app.add_json(options->json);
  app.action([options] { return make_raster(*options); });
}

}  // namespace lamplock::cli
