// The pixels burnt by a job of rows, computed only from its lines and runs.
//
// In:  a job, the position of the picture. Out: power of every pixel and how often it was burnt;
//      distances of edges from their places; faults of the lines.
// Who: tests of rows.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "host/raster/rows.hpp"
#include "host/units.hpp"
#include "shared/wire/runs.hpp"

namespace lamplock::test {

/// A row as executed, from rest to rest.
struct RunRow {
  double dark_before = 0, dark_behind = 0;  ///< steps
  int way = 0;                              ///< 1 to the right, -1 to the left
};

class Burnt {
 public:
  Burnt(const job::Job& job, const raster::Pixels& pixels, const raster::RowOptions& options)
      : job_(job),
        pixels_(pixels),
        options_(options),
        steps_per_mm_{in_units(job.settings, settings::Id::steps_per_mm_x, 0),
                      in_units(job.settings, settings::Id::steps_per_mm_x, 1)} {
    const auto& lines = job.rows.lines;
    EXPECT_FALSE(lines.front().to.light) << "light during the move to the first row";
    for (std::size_t i = 1; i < lines.size(); ++i)
      if (lines[i].to.light) burn(lines[i - 1], lines[i]);
    close_row();
  }

  /// Power and count of a lit pixel, by column and row.
  struct Light {
    std::uint16_t power = 0;
    int times = 0;
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Light> lit;
  double max_shift = 0;  ///< largest distance of an edge of a lit pixel from its place, steps
  std::vector<RunRow> rows;

  /// Expects every pixel with its power once, and none outside the picture.
  void expect_each_once() const {
    std::size_t wanted = 0;
    for (std::size_t row = 0; row < pixels_.rows; ++row)
      for (std::size_t column = 0; column < pixels_.columns; ++column) {
        const std::uint16_t power = pixels_.at(column, row);
        if (power == 0) continue;
        ++wanted;
        const auto found =
            lit.find({static_cast<std::int64_t>(column), static_cast<std::int64_t>(row)});
        ASSERT_NE(found, lit.end()) << column << ", " << row;
        ASSERT_EQ(found->second.power, power) << column << ", " << row;
        ASSERT_EQ(found->second.times, 1) << column << ", " << row;
      }
    EXPECT_EQ(lit.size(), wanted);
  }

 private:
  void burn(const job::Line& before, const job::Line& line) {
    const StepPosition &from = before.to.steps, &to = line.to.steps;
    for (const std::size_t other : {1u, 2u, 3u}) {
      ASSERT_EQ(from[other], to[other]) << "not along the row";
    }
    const int way = to[0] > from[0] ? 1 : -1;
    if (!before.to.light) close_row(), rows.push_back({0, 0, way}), dark_ = 0, seen_ = false;
    ASSERT_EQ(rows.back().way, way) << "reverses within the row";
    const auto runs = job_.rows.runs_of(line);
    ASSERT_LE(runs.size(), wire::max_runs_a_line);
    std::uint32_t all = 0, done = 0;
    for (const std::uint16_t run : runs) all += wire::run_cells(run);
    ASSERT_NE(all, 0u);
    ASSERT_LE(all, wire::max_cells_a_line);
    const double cell = (static_cast<double>(to[0]) - from[0]) / all;
    for (const std::uint16_t run : runs) {
      const std::uint32_t cells = wire::run_cells(run);
      if (wire::run_power(run) == 0) {
        dark_ += cells * std::abs(cell);
      } else {
        if (!seen_) rows.back().dark_before = dark_;
        seen_ = true;
        dark_ = 0;
        for (std::uint32_t i = 0; i < cells; ++i)
          light(from[0] + (done + i) * cell, from[0] + (done + i + 1) * cell, from[1],
                wire::run_power(run));
      }
      done += cells;
    }
  }
  void close_row() {
    if (!rows.empty()) rows.back().dark_behind = dark_;
  }
  void light(double from, double to, double y, std::uint16_t power) {
    const double pitch = options_.pitch_mm;
    const auto place = [&](double steps, int axis, double corner) {
      return (steps / steps_per_mm_[axis] - corner) / pitch;
    };
    const auto column =
        static_cast<std::int64_t>(std::floor(place((from + to) / 2, 0, options_.corner.x)));
    // The middle of a row, rounded up at half a step.
    const auto row =
        static_cast<std::int64_t>(std::ceil(place(y, 1, options_.corner.y) - 1 - 1e-9));
    Light& pixel = lit[{column, row}];
    pixel.power = power;
    ++pixel.times;
    const auto left = static_cast<double>(column);
    for (const auto& [edge, wanted] :
         {std::pair{std::min(from, to), left}, {std::max(from, to), left + 1}})
      max_shift = std::max(
          max_shift, std::abs(edge - (options_.corner.x + wanted * pitch) * steps_per_mm_[0]));
  }

  const job::Job& job_;
  const raster::Pixels& pixels_;
  const raster::RowOptions& options_;
  double steps_per_mm_[2];
  double dark_ = 0;  ///< steps since the last light
  bool seen_ = false;
};

}  // namespace lamplock::test
