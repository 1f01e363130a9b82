#include "host/thermal/heat_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/svg.hpp"

namespace lamplock::thermal {
namespace {

// All lengths are pixels.
constexpr double panel_width = 420, panel_height = 320, panel_gap = 96;
constexpr double chart_left = 86, chart_top = 52, chart_right = 28, chart_foot = 56;
constexpr double max_ticks_x = 6, max_ticks_y = 7, tick_length = 5;
constexpr const char* frame_colour = "#999";
constexpr std::array<const char*, 6> curve_colours{"#0072b2", "#d55e00", "#009e73",
                                                   "#cc79a7", "#e69f00", "#000000"};

struct Range {
  double low = 1e300, high = -1e300;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Never empty.
  void widen() {
    if (high - low > 1e-12 * std::max(std::abs(high), 1.0)) return;
    low -= 0.5;
    high += 0.5;
  }
};

int decimals_of(double step) {
  return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

std::string curve_path(const Curve& curve, const char* colour, const Range& xs, const Range& ys,
                       double left) {
  std::string d;
  double last_x = -1e9, last_y = -1e9;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = left + (curve.x[i] - xs.low) / (xs.high - xs.low) * panel_width;
    const double y = chart_top + (ys.high - curve.y[i]) / (ys.high - ys.low) * panel_height;
    if (i + 1 < curve.x.size() && std::hypot(x - last_x, y - last_y) < 0.7) continue;
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? 'M' : 'L', x, y);
    last_x = x;
    last_y = y;
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" "
      "stroke-linejoin=\"round\"/>\n",
      d, colour);
}

std::string panel_svg(const ChartPanel& panel, double left) {
  Range xs, ys;
  for (const Curve& curve : panel.curves) {
    for (const double x : curve.x) xs.add(x);
    for (const double y : curve.y) ys.add(y);
  }
  xs.widen();
  ys.widen();
  const double margin = 0.05 * (ys.high - ys.low);
  ys = {ys.low - margin, ys.high + margin};
  const double bottom = chart_top + panel_height;
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#fff\" stroke=\"{}\"/>\n", left,
      chart_top, panel_width, panel_height, frame_colour);
  const double step_x = svg::nice_step(xs.high - xs.low, max_ticks_x);
  for (double k = std::ceil(xs.low / step_x - 1e-9); k * step_x <= xs.high * (1 + 1e-9); ++k) {
    const double x = left + (k * step_x - xs.low) / (xs.high - xs.low) * panel_width;
    out += svg::line(x, bottom, x, bottom + tick_length, frame_colour);
    out += svg::text_at(x, bottom + 18, "middle",
                        fmt::format("{:.{}f}", k * step_x + 0.0, decimals_of(step_x)));
  }
  const double step_y = svg::nice_step(ys.high - ys.low, max_ticks_y);
  for (double k = std::ceil(ys.low / step_y); k * step_y <= ys.high; ++k) {
    const double y = chart_top + (ys.high - k * step_y) / (ys.high - ys.low) * panel_height;
    out += svg::line(left - tick_length, y, left, y, frame_colour);
    out += svg::text_at(left - 8, y + 4, "end",
                        fmt::format("{:.{}f}", k * step_y + 0.0, decimals_of(step_y)));
  }
  out += svg::text_at(left + panel_width / 2, bottom + 40, "middle", panel.x_name);
  out += svg::turned_text(left - 62, chart_top + panel_height / 2, panel.y_name);
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    const char* colour = curve_colours[i % curve_colours.size()];
    out += curve_path(curve, colour, xs, ys, left);
    if (curve.name.empty()) continue;
    const double y = chart_top + 18 + 17 * static_cast<double>(i);
    const double x = left + panel_width - 108;
    out += svg::line(x, y - 4, x + 22, y - 4, colour);
    out += svg::text_at(x + 28, y, "start", curve.name);
  }
  return out;
}

}  // namespace

std::string heat_chart(const std::vector<ChartPanel>& panels, const std::string& title) {
  const auto count = static_cast<double>(panels.size());
  const double width = chart_left + count * panel_width + (count - 1) * panel_gap + chart_right;
  const double height = chart_top + panel_height + chart_foot;
  std::string out = svg::opening(width, height);
  out += svg::heading(chart_left, 30, title);
  double left = chart_left;
  for (const ChartPanel& panel : panels) {
    out += panel_svg(panel, left);
    left += panel_width + panel_gap;
  }
  return out + "</svg>\n";
}

}  // namespace lamplock::thermal
