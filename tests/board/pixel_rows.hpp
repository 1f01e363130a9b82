// Rows of a raster as a row job, and the light that each cell must get, independent of speed.
//
// In:  a raster (raster.hpp); after the run the light and the steps of a board.
// Out: lines with their runs; cells that got their light, and light elsewhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/world/beam.hpp"
#include "tests/board/raster.hpp"
#include "tests/board/row_host.hpp"
#include "tests/judges/pin_monitor.hpp"

namespace lamplock::test {

/// Power proportional to speed is accurate to about one count of LASER PWM.
inline constexpr int flicker = 40;
inline constexpr std::uint32_t raster_feed_milli = 60'000u * Raster::speed_mm_s;

/// Rows as lines with at most `max_runs` runs, with run-up and run-out as dark cells, and a rapid
/// between rows.
class PixelLines {
 public:
  explicit PixelLines(const Raster& raster, std::size_t max_runs = wire::max_runs_a_line)
      : max_runs_(max_runs) {
    rapid(-Raster::run_up_pixels, 0);
    for (row_ = 0; row_ < raster.rows(); ++row_) {
      way_ = raster.backwards(row_) ? -1 : 1;
      add_cells(0, Raster::run_up_pixels);
      const std::vector<int> pixels = raster.passed(row_);
      for (std::size_t i = 0; i < pixels.size();) {
        std::size_t end_of_run = i;
        while (end_of_run < pixels.size() && pixels[end_of_run] == pixels[i]) ++end_of_run;
        add_cells(pixels[i], static_cast<int>(end_of_run - i));
        i = end_of_run;
      }
      add_cells(0, Raster::run_up_pixels);
      end_line();
      rapid(at_, row_ + 1);
    }
  }
  const std::vector<PixelLine>& lines() const { return lines_; }

 private:
  static StepPosition place(int pixel, std::size_t row) {
    return {pixel * Raster::steps_per_pixel,
            static_cast<std::int32_t>(row) * Raster::steps_per_pixel, 0, 0};
  }
  void rapid(int pixel, std::size_t row) {
    lines_.push_back({{place(pixel, row), false, 0}, {}});
    at_ = pixel;
  }
  void add_cells(int power, int cells) {
    for (auto left = static_cast<std::uint32_t>(cells); left != 0;) {
      const std::uint16_t run = wire::max_run(Raster::light_of(power), left);
      open_.runs.push_back(run);
      at_ += way_ * static_cast<int>(wire::run_cells(run));
      left -= wire::run_cells(run);
      if (open_.runs.size() == max_runs_) end_line();
    }
  }
  void end_line() {
    if (open_.runs.empty()) return;
    open_.line = {place(at_, row_), true, raster_feed_milli};
    lines_.push_back(std::exchange(open_, {}));
  }

  std::size_t max_runs_;
  std::vector<PixelLine> lines_;
  PixelLine open_;
  std::size_t row_ = 0;
  int at_ = 0, way_ = 1;
};

/// Light up to a given time, in seconds of full power.
class LightSum {
 public:
  explicit LightSum(const sim::Beam& beam) : changes_(beam.changes()) {
    double sum = 0;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      if (i != 0) sum += of(changes_[i - 1], changes_[i].at);
      sums_.push_back(sum);
    }
  }
  double until(sim::Picoseconds at) const {
    const auto next = std::partition_point(changes_.begin(), changes_.end(),
                                           [at](const sim::BeamChange& c) { return c.at <= at; });
    if (next == changes_.begin()) return 0;
    const auto last = static_cast<std::size_t>(next - changes_.begin()) - 1;
    return sums_[last] + of(changes_[last], at);
  }
  double total() const { return sums_.empty() ? 0 : sums_.back(); }

 private:
  static double of(const sim::BeamChange& change, sim::Picoseconds until) {
    return static_cast<double>(until - change.at) * 1e-12 * change.light() / 65'535.0;
  }
  std::vector<sim::BeamChange> changes_;
  std::vector<double> sums_;
};

/// Result for the cells of a raster.
struct CellLight {
  int right = 0;            ///< cells with the right light
  int dark = 0, twice = 0;  ///< cells with too little or too much
  double elsewhere = 0;     ///< light outside all cells, as a part of their total
};

/// Light by the machine's position: row and step of X.
class LightMap {
 public:
  LightMap(const Raster& raster, const PinMonitor& monitor, const sim::Beam& beam)
      : steps_(static_cast<std::size_t>(raster.columns()) * Raster::steps_per_pixel),
        rows_(raster.rows(), std::vector<double>(steps_)) {
    const LightSum light(beam);
    const auto &x = monitor.steps(0), &y = monitor.steps(1);
    std::size_t next_y = 0;
    elsewhere_ = light.total();
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      while (next_y < y.size() && y[next_y].at <= x[i].at) ++next_y;
      const int at_y = next_y == 0 ? 0 : y[next_y - 1].position;
      const bool on_row = at_y >= 0 && at_y % Raster::steps_per_pixel == 0;
      const auto row = static_cast<std::size_t>(at_y / Raster::steps_per_pixel);
      const int step = x[i].position;
      if (!on_row || row >= rows_.size() || step < 0 || step >= static_cast<int>(steps_)) continue;
      const double got = light.until(x[i + 1].at) - light.until(x[i].at);
      rows_[row][static_cast<std::size_t>(step)] += got;
      elsewhere_ -= got;
    }
  }
  double at(std::size_t row, int step) const { return rows_[row][static_cast<std::size_t>(step)]; }
  double elsewhere() const { return elsewhere_; }

 private:
  std::size_t steps_;
  std::vector<std::vector<double>> rows_;
  double elsewhere_ = 0;
};

/// In M4 a cell gets the light of the feed rate at any speed. Rows before `from` are ignored.
inline CellLight cell_light(const Raster& raster, const PinMonitor& monitor, const sim::Beam& beam,
                            std::size_t from = 0) {
  constexpr double step_s = 0.1 / Raster::steps_per_pixel / Raster::speed_mm_s;
  // Near an edge the light may belong to the neighbour.
  constexpr int margin = 2;
  // A change of light is up to a tick off its place; near a rest it is dark for a step or two.
  constexpr double tolerance_s = 2.5 * step_s;
  const LightMap map(raster, monitor, beam);
  CellLight result;
  double all = 0;
  for (std::size_t row = from; row < raster.rows(); ++row) {
    std::vector<int> pixels = raster.passed(row);
    if (raster.backwards(row)) std::reverse(pixels.begin(), pixels.end());
    for (int i = 0; i < raster.columns(); ++i) {
      const double power = Raster::light_of(pixels[static_cast<std::size_t>(i)]) / 65'535.0;
      double got = 0;
      for (int s = margin; s < Raster::steps_per_pixel - margin; ++s)
        got += map.at(row, i * Raster::steps_per_pixel + s);
      const double wanted = power * (Raster::steps_per_pixel - 2 * margin) * step_s;
      all += power * Raster::steps_per_pixel * step_s;
      if (std::abs(got - wanted) <= tolerance_s)
        ++result.right;
      else
        ++(got < wanted ? result.dark : result.twice);
    }
  }
  result.elsewhere = map.elsewhere() / all;
  return result;
}

}  // namespace lamplock::test
