#include "host/run/raster.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/job/job_file.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/number_text.hpp"
#include "host/raster/pixels.hpp"
#include "host/raster/row_gcode.hpp"
#include "host/raster/row_motion.hpp"
#include "host/raster/rows.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/file_ways.hpp"
#include "host/run/job_points.hpp"
#include "host/run/prepare.hpp"
#include "host/run/run_rows.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::run {
namespace {

constexpr double share_per_percent = 0.01, default_pitch_mm = 0.1;

/// Pixels are those of the picture, unless both pitch and width are given.
RasterSize size_of(const RasterOptions& options, const model::Bitmap& bitmap) {
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
  const RasterSize size{*options.pitch_mm, count(width), count(height)};
  constexpr std::size_t max_pixels = 100'000'000;  // as of pictures
  if (size.columns > max_pixels / size.rows)
    throw Error(Exit::bad_input, "--pitch-mm",
                fmt::format("{} x {} pixels", size.columns, size.rows), "give a greater one");
  return size;
}

/// Its lower left corner: as given, or so that the picture is in the middle of the work space.
geometry::Point corner_of(const RasterOptions& options, const RasterSize& size,
                          const settings::Values& values) {
  const std::vector<double>& given = options.origin_mm;
  if (!given.empty()) return {given[0], given[1], given.size() > 2 ? given[2] : 0};
  const geometry::Point middle = work_space_mm(values).centre();
  return {middle.x - size.width_mm() / 2, middle.y - size.height_mm() / 2, 0};
}

/// True if the whole picture with its overscan is inside the work space.
bool fits(const RasterOptions& options, const RasterSize& size, double overscan_mm,
          const settings::Values& values) {
  const geometry::Bounds space = work_space_mm(values);
  const geometry::Point corner = corner_of(options, size, values);
  const double beside_mm = raster::overscan_pixels(overscan_mm, size.pitch_mm) * size.pitch_mm;
  // Rows are in the middle of their pixels.
  const double above_mm = size.pitch_mm / 2;
  constexpr double slack_mm = 1e-6;  // rounding of positions
  return corner.x - beside_mm >= space.low.x - slack_mm &&
         corner.x + size.width_mm() + beside_mm <= space.high.x + slack_mm &&
         corner.y + above_mm >= space.low.y - slack_mm &&
         corner.y + size.height_mm() - above_mm <= space.high.y + slack_mm &&
         corner.z >= space.low.z && corner.z <= space.high.z;
}

/// The greatest width in steps of 0.1 mm, below the present one, with which the picture fits; 0 if
/// there is none. Overscan and size in pixels depend on the width, so that it is searched for.
double max_width_mm(const RasterOptions& options, const model::Bitmap& bitmap, double width_mm,
                    double overscan_mm, const settings::Values& values) {
  constexpr double per_mm = 10;
  const auto fits_with = [&](double tenths) {
    RasterOptions smaller = options;
    smaller.width_mm = tenths / per_mm;
    return fits(smaller, size_of(smaller, bitmap), overscan_mm, values);
  };
  const geometry::Bounds space = work_space_mm(values);
  double low = 0, high = std::ceil(std::min(width_mm, space.high.x - space.low.x) * per_mm);
  while (high - low > 1) {
    const double middle = std::floor((low + high) / 2);
    (fits_with(middle) ? low : high) = middle;
  }
  return low / per_mm;
}

std::string remedy_outside(const RasterOptions& options, const model::Bitmap& bitmap,
                           double overscan_mm, const settings::Values& values) {
  const RasterSize size = size_of(options, bitmap);
  if (fits(options, size, overscan_mm, values)) return {};
  const double width_mm = max_width_mm(options, bitmap, size.width_mm(), overscan_mm, values);
  if (width_mm > 0) return fmt::format("the greatest width that fits is --width-mm {:g}", width_mm);
  if (!options.origin_mm.empty()) return "leave out --origin, or give one farther inside";
  return fits(options, size, 0, values) ? "use a lower --feed, which needs less overscan"
                                        : "give a smaller --pitch-mm";
}

void check_outputs(const RasterOptions& options) {
  if (!options.output.empty()) check_job_name(options.output);
  if (!options.gcode.empty()) check_program_name(options.gcode);
  for (const std::string& file : {options.output, options.gcode})
    if (!file.empty()) check_target(file);
}

raster::PowerForm form_of(const RasterOptions& options) {
  return options.power_lists ? raster::PowerForm::lists : raster::PowerForm::plain;
}

/// A board runs rows only with a continuous laser. G-code is for boards of any kind.
void require_laser(const RasterOptions& options, const job::Profile& profile) {
  if (options.output.empty() || profile.settings.whole(settings::Id::laser_mode) != 0) return;
  const std::string& file = options.machine.machine;
  if (!file.empty())
    throw Error(Exit::bad_input, file,
                "describes a machine with a pulsed laser (laser_mode = 0), rows of pixels need a "
                "continuous one",
                "for a continuous laser set laser_mode = 1 in it and on the board");
  throw Error(Exit::bad_input, "machine",
              "the built-in settings are those of a pulsed laser, rows of pixels need a continuous "
              "one",
              "give the profile of a machine with laser_mode = 1 with --machine FILE.toml; "
              "lamplock settings backup FILE.toml --board PORT writes that of a board");
}

/// Files of other kinds are refused with the command that takes them.
model::Bitmap read_picture(const std::string& file) {
  try {
    return model::read_bitmap(file);
  } catch (const Error&) {
    refuse_for_picture(file);
    throw;
  }
}

/// A width that is not a whole number of pixels cannot be kept.
void note_width(const RasterOptions& options, const RasterSize& size, Frontend& frontend) {
  constexpr double rounding = 1e-9;
  const double wanted_mm = options.width_mm.value_or(size.width_mm());
  if (std::abs(size.width_mm() - wanted_mm) <= rounding * wanted_mm) return;
  frontend.notice(
      fmt::format("note: --width-mm {:g} is not a whole number of pixels of {:g} mm, the picture "
                  "is {:g} mm wide",
                  wanted_mm, size.pitch_mm, size.width_mm()));
}

/// Reads the picture and makes rows of it.
job::Job make_job(const RasterOptions& options, Frontend& frontend, RasterResult& result) {
  const job::Profile profile = options.machine.profile();
  require_laser(options, profile);
  const model::Bitmap bitmap = read_picture(options.input);
  const RasterSize size = size_of(options, bitmap);
  const raster::Pixels pixels =
      raster::make_pixels(bitmap, size.columns, size.rows,
                          {options.power_min * share_per_percent,
                           options.power_max * share_per_percent, options.invert});
  frontend.phase("picture", fmt::format("{}: {} x {} pixels of {:g} mm, {:g} x {:g} mm",
                                        options.input, size.columns, size.rows, size.pitch_mm,
                                        size.width_mm(), size.height_mm()));
  note_width(options, size, frontend);
  raster::RowOptions how;
  how.corner = corner_of(options, size, profile.settings);
  how.pitch_mm = size.pitch_mm;
  how.feed_mm_min = options.feed_mm_min;
  how.overscan_mm = options.overscan_mm ? *options.overscan_mm
                                        : raster::run_up_mm(profile.settings, options.feed_mm_min);
  how.one_way = options.one_way;
  how.dry = options.dry;
  how.remedy_outside = remedy_outside(options, bitmap, how.overscan_mm, profile.settings);
  job::Job job = raster::make_rows(pixels, how, profile);
  const geometry::Bounds box = geometry::bounds(points_of(job));
  result.overscan_mm = raster::overscan_pixels(how.overscan_mm, size.pitch_mm) * size.pitch_mm;
  frontend.phase("rows", fmt::format("{} with {:.4g} mm overscan, {}", rows_text(job),
                                     result.overscan_mm, bounds_text(box)));
  result.size = size;
  result.lines = job.size();
  result.runs = job.rows.runs.size();
  result.box = box;
  return job;
}

/// Writes one of the results. Returns its size in bytes.
std::size_t write_result(const std::string& file, std::string_view bytes, Frontend& frontend) {
  write_whole(file, bytes);
  frontend.phase("written", fmt::format("{}, {}", file, count_text(bytes.size(), "byte")));
  return bytes.size();
}

}  // namespace

RasterResult make_raster(const RasterOptions& options, Frontend& frontend) {
  check_outputs(options);
  RasterResult result;
  const job::Job job = make_job(options, frontend, result);
  if (!options.output.empty()) {
    const std::vector<std::uint8_t> bytes = job::encode_job_file(job);
    result.job_bytes = write_result(
        options.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, frontend);
  }
  if (!options.gcode.empty())
    result.gcode_bytes =
        write_result(options.gcode, raster::row_gcode(job, form_of(options)), frontend);
  result.seconds = raster::seconds_of(job);
  frontend.say("time      about {}", duration_text(result.seconds));
  return result;
}

}  // namespace lamplock::run
