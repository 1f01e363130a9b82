// Turns a picture into rows of pixels for a continuous laser.
//
// In:  a picture, sizes, powers, a machine. Out: a job file, G-code, or both.
// Who: `raster`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/run/frontend.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

struct RasterOptions {
  std::string input{}, output{}, gcode{};
  std::optional<double> pitch_mm{}, width_mm{}, overscan_mm{};
  double feed_mm_min = 0, power_min = 0, power_max = 100;  ///< powers in percent
  std::vector<double> origin_mm{};  ///< lower left corner, height; empty: middle of the work space
  bool one_way = false, invert = false, dry = false, power_lists = false;
  MachineOptions machine{};
};

/// Size and number of the pixels.
struct RasterSize {
  double pitch_mm = 0;
  std::size_t columns = 0, rows = 0;

  double width_mm() const { return static_cast<double>(columns) * pitch_mm; }
  double height_mm() const { return static_cast<double>(rows) * pitch_mm; }
};

struct RasterResult {
  RasterSize size;
  double overscan_mm = 0, seconds = 0;
  std::size_t lines = 0, runs = 0;
  geometry::Bounds box;
  std::size_t job_bytes = 0, gcode_bytes = 0;  ///< written; 0 where no file was requested
};

/// Throws Error(bad_input).
RasterResult make_raster(const RasterOptions& options, Frontend& frontend);

}  // namespace lamplock::run
