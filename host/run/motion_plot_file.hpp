// A picture of the motion of a job: what `--plot` asks for, and the file.
//
// In:  options; the simulated board, before it runs and afterwards. Out: an SVG file, whole or not.
// Who: jobs on the virtual board, the one whose ticks are there to be traced.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/report/motion_series.hpp"
#include "shared/settings_table.hpp"
#include "sim/virtual_board/motion_trace.hpp"

namespace lamplock::run {

/// --plot and --plot-beats.
struct PlotOptions {
  std::string file{};
  std::vector<std::int64_t> beats{};  ///< none, or from and to

  bool any() const { return !file.empty(); }
  /// Throws Error(bad_input).
  void check() const;
  sim::BeatWindow window() const;
  report::Fit fit() const;
};

/// Traces from its construction on, draws at the end.
class MotionPlotFile {
 public:
  /// `dry`: no shot will come, beats count from the first motion.
  MotionPlotFile(const PlotOptions& options, sim::VirtualBoard& board, bool dry);
  /// Throws Error(bad_input) if the file cannot be written.
  void write(const settings::Values& values, const std::string& title) const;

 private:
  const PlotOptions& options_;
  sim::MotionTrace trace_;
};

}  // namespace lamplock::run
