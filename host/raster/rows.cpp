#include "host/raster/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "host/error.hpp"
#include "host/job/step_rounder.hpp"
#include "host/units.hpp"

namespace lamplock::raster {
namespace {

using settings::Id;

/// The board plans only complete lines: 32 of them fit into its run table of 2048 entries,
/// with their headers, so that an incomplete line uses little of the table.
constexpr std::size_t runs_a_line = 63;
static_assert(runs_a_line <= wire::max_runs_a_line);
/// Rounding tolerance, in pixels.
constexpr double rounding = 1e-9;

[[noreturn]] void fail(const std::string& where, const std::string& what,
                       const std::string& remedy) {
  throw Error(Exit::bad_input, where, what, remedy);
}

/// Makes the rows of one picture.
class RowMaker {
 public:
  RowMaker(const Pixels& pixels, const RowOptions& options, const settings::Values& values)
      : pixels_(pixels),
        options_(options),
        values_(values),
        rounder_(values),
        feed_milli_(static_cast<std::uint32_t>(std::lround(options.feed_mm_min * milli_per_unit))),
        overscan_(overscan_pixels(options.overscan_mm, options.pitch_mm)) {}

  job::Rows make() {
    bool backwards = false;
    for (std::size_t row = 0; row < pixels_.rows; ++row)
      if (add_row(row, backwards) && !options_.one_way) backwards = !backwards;
    return std::move(rows_);
  }

 private:
  /// False if the row is blank.
  bool add_row(std::size_t row, bool backwards) {
    const auto power = std::span(pixels_.power).subspan(row * pixels_.columns, pixels_.columns);
    const auto lit = [](std::uint16_t p) { return p != 0; };
    const auto begin = std::find_if(power.begin(), power.end(), lit);
    if (begin == power.end()) return false;
    const auto end = std::find_if(power.rbegin(), power.rend(), lit).base();
    row_ = row;
    way_ = backwards ? -1 : 1;
    edge_ = (backwards ? end : begin) - power.begin() - way_ * std::int64_t{overscan_};
    rows_.lines.push_back({{place(), false, 0}, rows_.runs.size(), 0});
    add(0, overscan_);
    if (backwards)
      add_pixels(std::make_reverse_iterator(end), std::make_reverse_iterator(begin));
    else
      add_pixels(begin, end);
    add(0, overscan_);
    end_line();
    return true;
  }

  /// Joins neighbours of one power.
  template <class Iterator>
  void add_pixels(Iterator begin, Iterator end) {
    while (begin != end) {
      const auto power = *begin;
      const auto next = std::find_if(begin, end, [power](auto p) { return p != power; });
      add(power, static_cast<std::uint32_t>(next - begin));
      begin = next;
    }
  }

  void add(std::uint16_t power, std::uint32_t cells) {
    while (cells != 0) {
      const std::uint16_t run = wire::max_run(power, std::min(cells, wire::max_cells_a_line));
      const std::uint32_t length = wire::run_cells(run);
      if (runs_ == runs_a_line || length > wire::max_cells_a_line - cells_) end_line();
      rows_.runs.push_back(run);
      ++runs_;
      cells_ += length;
      edge_ += way_ * std::int64_t{length};
      cells -= length;
    }
  }

  /// Ends the line of the cells so far, at the edge after them.
  void end_line() {
    if (runs_ == 0) return;
    rows_.lines.push_back({{place(), true, feed_milli_}, rows_.runs.size() - runs_, runs_});
    runs_ = 0;
    cells_ = 0;
  }

  /// Position of the edge, in the middle of the row.
  StepPosition place() const {
    const double pitch = options_.pitch_mm;
    const geometry::Point& corner = options_.corner;
    const geometry::Point mm{corner.x + static_cast<double>(edge_) * pitch,
                             corner.y + (static_cast<double>(row_) + 0.5) * pitch, corner.z};
    StepPosition steps{};
    if (rounder_.round(mm, steps)) return steps;
    fail("rows",
         fmt::format("with an overscan of {:g} mm they reach ({:g}, {:g}, {:g}) mm, outside the "
                     "work space",
                     overscan_ * pitch, mm.x, mm.y, mm.z),
         fmt::format("{}: {}", job::describe_work_space(values_), options_.remedy_outside));
  }

  const Pixels& pixels_;
  const RowOptions& options_;
  const settings::Values& values_;
  const job::Rounder rounder_;
  const std::uint32_t feed_milli_;
  const std::uint32_t overscan_;  ///< pixels
  job::Rows rows_;
  std::size_t row_ = 0;
  int way_ = 1;            ///< 1 to the right, -1 to the left
  std::int64_t edge_ = 0;  ///< after the cells so far, in pixels from the left
  std::size_t runs_ = 0;   ///< of the line that is being made
  std::uint32_t cells_ = 0;
};

void check(const RowOptions& options, const settings::Values& values) {
  const double fastest = in_units(values, Id::max_rate_x);
  if (!(options.feed_mm_min >= 1 / milli_per_unit && options.feed_mm_min <= fastest))
    fail("feed", fmt::format("{:g} mm/min", options.feed_mm_min),
         fmt::format("the machine's maximum speed along X is {:g} mm/min", fastest));
  if (!(options.overscan_mm >= 0 && options.overscan_mm <= in_units(values, Id::travel_x)))
    fail("overscan", fmt::format("{:g} mm", options.overscan_mm),
         fmt::format("the travel of X is {:g} mm", in_units(values, Id::travel_x)));
  for (int axis = 0; axis < 2; ++axis) {
    const double steps = options.pitch_mm * in_units(values, Id::steps_per_mm_x, axis);
    if (!(steps >= 1 - rounding))
      fail("pitch",
           fmt::format("{:g} mm is finer than a step of {}", options.pitch_mm,
                       axis == 0 ? "X" : "Y"),
           fmt::format("give {:g} mm or more", options.pitch_mm / steps));
  }
}

}  // namespace

std::uint32_t overscan_pixels(double overscan_mm, double pitch_mm) {
  return static_cast<std::uint32_t>(std::ceil(overscan_mm / pitch_mm - rounding));
}

job::Job make_rows(const Pixels& pixels, const RowOptions& options, const job::Profile& profile) {
  check(options, profile.settings);
  job::Job job;
  job.settings = profile.settings;
  job.rows = RowMaker(pixels, options, job.settings).make();
  if (job.rows.lines.empty())
    fail("picture", "no pixel has any power", "use a darker picture, or try --invert");
  if (job.rows.lines.size() > std::numeric_limits<std::uint32_t>::max())
    fail("picture", "too many lines", "split it");
  job::JobOptions header;
  header.dry = options.dry;
  job.header = job::make_header(profile, header, job.rows.lines.size());
  job.header.mode = wire::mode_rows;
  return job;
}

}  // namespace lamplock::raster
