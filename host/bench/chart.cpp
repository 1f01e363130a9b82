// The chart of beats per point against a / f^2, as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/bench/report.hpp"
#include "host/svg.hpp"

namespace lamplock::bench {
namespace {

constexpr double width = 860, height = 520, chart_left = 70, chart_right = 20, chart_top = 50,
                 chart_bottom = 60;
constexpr double min_beats_shown = 0.95;

/// Converts numbers to positions: a / f^2 on a logarithmic scale, beats on a linear one.
struct Scale {
  double min_um, max_um, max_beats;

  double x(double way_um) const {
    return chart_left + (width - chart_left - chart_right) * std::log(way_um / min_um) /
                            std::log(max_um / min_um);
  }
  double y(double beats) const {
    return height - chart_bottom -
           (height - chart_top - chart_bottom) * (beats - min_beats_shown) /
               (max_beats - min_beats_shown);
  }
};

constexpr const char* grid_colour = "#ddd";

std::string grid(const Scale& scale) {
  std::string picture;
  for (const double um : {100.0, 200.0, 300.0, 500.0, 1000.0, 2000.0, 3000.0, 5000.0}) {
    if (um < scale.min_um || um > scale.max_um) continue;
    picture += svg::line(scale.x(um), chart_top, scale.x(um), height - chart_bottom, grid_colour);
    picture +=
        svg::text_at(scale.x(um), height - chart_bottom + 18, "middle", fmt::format("{:g}", um));
  }
  for (int tenth = 10; tenth / 10.0 < scale.max_beats; ++tenth) {
    const double beats = tenth / 10.0;
    picture +=
        svg::line(chart_left, scale.y(beats), width - chart_right, scale.y(beats), grid_colour);
    picture +=
        svg::text_at(chart_left - 8, scale.y(beats) + 4, "end", fmt::format("{:.1f}", beats));
  }
  picture += svg::text_at((chart_left + width - chart_right) / 2, height - 14, "middle",
                          "acceleration / lamp frequency squared, um (logarithmic)");
  return picture + svg::turned_text(20, (chart_top + height - chart_bottom) / 2, "beats per point");
}

/// One set of numbers: a mark for every row, hollow for the faster lamp.
struct Series {
  const char* name;
  const char* colour;
  double radius;
  std::function<double(const MeasuredFigures&)> beats;
};

std::string marks(const Series& series, const std::vector<MeasuredFigures>& rows,
                  const Scale& scale) {
  std::string picture;
  for (const MeasuredFigures& row : rows)
    picture +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" stroke=\"{}\" fill=\"{}\"/>\n",
                    scale.x(row.machine().way_um()), scale.y(series.beats(row)), series.radius,
                    series.colour, row.row.lamp_hz > 50 ? "none" : series.colour);
  return picture;
}

}  // namespace

std::string chart_svg(const BenchReport& report) {
  const std::vector<Series> all{
      {"measured, start-stop", "#888", 6, [](const auto& m) { return measured_beats(m.row); }},
      {"start-stop, one axis", "#c33", 2.5, [](const auto& m) { return m.start_stop; }},
      {"start-stop, walk", "#e90", 2.5, [](const auto& m) { return m.walk.start_stop; }},
      {"free, walk", "#17b", 4.5, [](const auto& m) { return m.walk.free; }},
      {"exact optimum, walk", "#083", 1.5, [](const auto& m) { return m.walk.optimum; }}};
  Scale scale{1e9, 0, 0};
  for (const MeasuredFigures& row : report.measured) {
    scale.min_um = std::min(scale.min_um, row.machine().way_um() * 0.93);
    scale.max_um = std::max(scale.max_um, row.machine().way_um() * 1.07);
    for (const Series& series : all)
      scale.max_beats = std::max(scale.max_beats, series.beats(row) + 0.05);
  }
  std::string picture = svg::opening(width, height, "#fff", 13);
  picture += svg::text_at(
      chart_left, 24, "start",
      "Beats per point at 50 Hz (filled) and 100 Hz (hollow): every row of the source");
  picture += grid(scale);
  double y = chart_top + 20;
  for (const Series& series : all) {
    picture += marks(series, report.measured, scale);
    picture +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" stroke=\"{}\" fill=\"none\"/>\n",
                    width - 210.0, y - 4, series.radius, series.colour);
    picture += svg::text_at(width - 196, y, "start", series.name);
    y += 20;
  }
  return picture + "</svg>\n";
}

}  // namespace lamplock::bench
