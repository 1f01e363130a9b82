#include "host/cli/motion_plot_file.hpp"

#include <fmt/format.h>

#include <limits>

#include "host/cli/command_line.hpp"
#include "host/cli/options.hpp"
#include "host/cli/staged_file.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/report/motion_plot.hpp"

namespace lamplock::cli {
namespace {

/// Without --plot-beats a picture ends this long after the first shot.
constexpr std::int64_t beats_unless_asked = 200;
/// More than that cannot be told apart in a picture, not even at less than a pixel a beat.
constexpr std::int64_t most_beats = 2000;
/// What comes before the first shot is short: one way.
constexpr std::int64_t earliest_beat = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t latest_beat = std::numeric_limits<std::int32_t>::max();

}  // namespace

void PlotOptions::add(Command& app, const char* group) {
  app.add_option("--plot", &file,
                 "Picture (SVG) of position, speed and acceleration over beats; virtual board")
      .check(file_name())
      .value_name("FILE")
      .group(group);
  app.add_option("--plot-beats", &beats,
                 "What it shows, in beats since the first shot; without it the first 200")
      .count({2, 2})
      .value_name("FROM,TO")
      .group(group);
}

void PlotOptions::check() const {
  if (!any()) {
    if (beats.empty()) return;
    throw Error(Exit::bad_input, "--plot-beats", "there is no picture to show them",
                "add --plot FILE.svg");
  }
  if (lower_extension(file) != ".svg")
    throw Error(Exit::bad_input, file, "pictures of motion are written as SVG",
                "name it something.svg");
  const auto fits = [this] {
    const std::int64_t from = beats[0], to = beats[1];
    return from >= earliest_beat && from < to && to <= latest_beat && to - from <= most_beats;
  };
  if (!beats.empty() && !fits())
    throw Error(Exit::bad_input, fmt::format("--plot-beats {},{}", beats[0], beats[1]),
                "is not what a picture can show",
                fmt::format("give a first beat and a later one, at most {} apart", most_beats));
  check_target(file);
}

sim::BeatWindow PlotOptions::window() const {
  if (beats.empty()) return {earliest_beat, beats_unless_asked};
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
  write_whole(options_.file, [&](const std::filesystem::path& path) {
    write_file(path, report::motion_svg(series, title));
  });
}

}  // namespace lamplock::cli
