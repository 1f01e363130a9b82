#include "host/run/motion_plot_file.hpp"

#include <fmt/format.h>

#include <limits>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/report/motion_plot.hpp"

namespace lamplock::run {
namespace {

/// Without --plot-beats a picture ends this long after the first shot.
constexpr std::int64_t beats_unless_asked = 200;
/// More beats cannot be distinguished in a picture, not even at less than a pixel a beat.
constexpr std::int64_t max_beats = 2000;
/// The part before the first shot is one short move.
constexpr std::int64_t min_beat = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t max_beat_number = std::numeric_limits<std::int32_t>::max();

}  // namespace

void PlotOptions::check() const {
  if (!any()) {
    if (beats.empty()) return;
    throw Error(Exit::bad_input, "--plot-beats", "needs --plot", "add --plot FILE.svg");
  }
  require_extension(file, ".svg", "pictures of motion are written as SVG");
  const auto fits = [this] {
    const std::int64_t from = beats[0], to = beats[1];
    return from >= min_beat && from < to && to <= max_beat_number && to - from <= max_beats;
  };
  if (!beats.empty() && !fits())
    throw Error(Exit::bad_input, fmt::format("--plot-beats {},{}", beats[0], beats[1]),
                "is not a range that a picture can show",
                fmt::format("give a first beat and a later one, at most {} apart", max_beats));
  check_target(file);
}

sim::BeatWindow PlotOptions::window() const {
  if (beats.empty()) return {min_beat, beats_unless_asked};
  return {beats[0], beats[1]};
}

report::Fit PlotOptions::fit() const {
  return beats.empty() ? report::Fit::motion : report::Fit::window;
}

MotionPlotFile::MotionPlotFile(const PlotOptions& options, sim::VirtualBoard& board, bool dry)
    : options_(options),
      trace_(board, options.window(),
             dry ? sim::MotionTrace::Zero::first_motion : sim::MotionTrace::Zero::first_shot) {}

void MotionPlotFile::write(const settings::Values& values, const std::string& title) const {
  const report::MotionSeries series =
      report::motion_series(trace_, values, options_.window(), options_.fit());
  write_whole(options_.file, report::motion_svg(series, title));
}

}  // namespace lamplock::run
