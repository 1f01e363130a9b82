#include "host/feed_optimiser/motion_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/feed_optimiser/motion_meter.hpp"
#include "host/svg.hpp"

namespace lamplock::feed_optimiser {
namespace {

// All lengths are pixels.
constexpr double chart_width = 860, panel_height = 150, panel_gap = 26;
constexpr double chart_left = 96, chart_top = 52, chart_right = 24, chart_foot = 52;
constexpr double max_time_ticks = 10, max_value_ticks = 5, tick_length = 5;
constexpr double range_margin = 1.08;  ///< of the drawn values
constexpr const char* frame_colour = "#999";
constexpr std::array<const char*, axes> axis_colours{"#0072b2", "#d55e00", "#009e73"};
constexpr std::array<const char*, axes> chart_axis_names{"X", "Y", "Z"};

/// Lowest and highest value in each pixel column.
class ColumnCurve {
 public:
  ColumnCurve() {
    low_.fill(std::numeric_limits<double>::max());
    high_.fill(std::numeric_limits<double>::lowest());
  }
  /// `part`: 0 to 1 of the width.
  void add(double part, double value) {
    const auto column = static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * chart_width);
    low_[column] = std::min(low_[column], value);
    high_[column] = std::max(high_[column], value);
  }
  double max() const { return *std::max_element(high_.begin(), high_.end()); }
  double min() const { return *std::min_element(low_.begin(), low_.end()); }
  template <class Y>
  std::string element(const char* colour, Y y) const {
    std::string d;
    bool rising = true;
    for (std::size_t i = 0; i < low_.size(); ++i) {
      if (low_[i] > high_[i]) continue;
      // Within a level part only its ends are drawn.
      const bool is_level = i > 0 && i + 1 < low_.size() && low_[i] == high_[i] &&
                            low_[i - 1] == low_[i] && high_[i - 1] == low_[i] &&
                            low_[i + 1] == low_[i] && high_[i + 1] == low_[i];
      if (is_level) continue;
      const double x = chart_left + static_cast<double>(i);
      const auto point = [&](double value) {
        d += fmt::format("{}{:.0f} {:.1f}", d.empty() ? 'M' : 'L', x, y(value));
      };
      point(rising ? low_[i] : high_[i]);
      if (high_[i] > low_[i]) point(rising ? high_[i] : low_[i]);
      rising = !rising;
    }
    return fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\" "
        "stroke-linejoin=\"round\"/>\n",
        d, colour);
  }

 private:
  std::array<double, static_cast<std::size_t>(chart_width) + 1> low_{}, high_{};
};

struct Panel {
  std::string name;
  std::array<ColumnCurve, axes> curves;
  PerAxis limits{};  ///< 0: none

  double max_jump() const {
    double max = 0;
    for (std::size_t a = 0; a < axes; ++a)
      max = std::max(max, std::max(std::abs(curves[a].max()), std::abs(curves[a].min())));
    return max;
  }
};

/// Position, speed, acceleration and jerk.
std::array<Panel, 4> panels_of(const std::vector<OptimisedBlock>& blocks, const Method& method,
                               double steps) {
  std::array<Panel, 4> panels;
  panels[0].name = "from the begin / mm";
  panels[1] = {"speed / mm/s", {}, method.limits.speed_mm_s};
  panels[2] = {"acceleration / mm/s2", {}, method.limits.accel_mm_s2};
  panels[3] = {"jerk / mm/s3", {}, method.limits.jerk_mm_s3};
  MotionMeter meter(method.period_s);
  double step = 0;
  Point begin;
  const auto add = [&](const Point& p) {
    meter.add(p);
    if (step == 0) begin = p;
    const PerAxis place{p.x - begin.x, p.y - begin.y, p.z - begin.z};
    for (std::size_t a = 0; a < axes; ++a) {
      panels[0].curves[a].add(step / steps, place[a]);
      panels[1].curves[a].add(step / steps, meter.now().speed[a]);
      panels[2].curves[a].add(step / steps, meter.now().accel[a]);
      panels[3].curves[a].add(step / steps, meter.now().jerk[a]);
    }
    ++step;
  };
  for (const OptimisedBlock& block : blocks) {
    const std::vector<Point> at = places(block);
    for (std::size_t i = meter.places() == 0 ? 0 : 1; i < at.size(); ++i) add(at[i]);
  }
  // The stop at the end: of the printed recipe it is not smooth.
  constexpr int derivatives = 3;
  if (!blocks.empty())
    for (int i = 0; i < derivatives; ++i) add(blocks.back().block.to);
  return panels;
}

std::string value_ticks(double low, double high, double top) {
  std::string out;
  const double step = svg::nice_step(high - low, max_value_ticks);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(low / step); k * step <= high; ++k) {
    const double y = top + (high - k * step) / (high - low) * panel_height;
    out += svg::line(chart_left - tick_length, y, chart_left, y, frame_colour);
    out += svg::text_at(chart_left - 8, y + 4, "end",
                        fmt::format("{:.{}f}", k * step + 0.0, decimals));
  }
  return out;
}

std::string panel_svg(const Panel& panel, double top, const std::array<bool, axes>& moves) {
  double low = 0, high = 0;
  if (panel.limits[0] > 0) {
    high = panel.max_jump();
    for (std::size_t a = 0; a < axes; ++a)
      if (moves[a]) high = std::max(high, panel.limits[a]);
    low = -high;
  } else {
    low = std::numeric_limits<double>::max();
    high = std::numeric_limits<double>::lowest();
    for (std::size_t a = 0; a < axes; ++a)
      if (moves[a]) {
        low = std::min(low, panel.curves[a].min());
        high = std::max(high, panel.curves[a].max());
      }
  }
  const double middle = (low + high) / 2, half = std::max((high - low) / 2, 1e-6) * range_margin;
  low = middle - half;
  high = middle + half;
  const auto y = [&](double value) { return top + (high - value) / (high - low) * panel_height; };
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#fff\" stroke=\"{}\"/>\n",
      chart_left, top, chart_width, panel_height, frame_colour);
  out += value_ticks(low, high, top);
  out += svg::turned_text(22, top + panel_height / 2, panel.name);
  for (std::size_t a = 0; a < axes; ++a) {
    if (!moves[a]) continue;
    if (panel.limits[a] > 0)
      for (const double limit : {-panel.limits[a], panel.limits[a]})
        out += svg::line(chart_left, y(limit), chart_left + chart_width, y(limit), axis_colours[a],
                         "6 4");
    out += panel.curves[a].element(axis_colours[a], y);
  }
  return out;
}

std::string legend(const std::array<bool, axes>& moves, double y) {
  std::string out;
  double x = chart_left + chart_width - 250;
  for (std::size_t a = 0; a < axes; ++a) {
    if (!moves[a]) continue;
    out += svg::line(x, y - 4, x + 22, y - 4, axis_colours[a]);
    out += svg::text_at(x + 27, y, "start", chart_axis_names[a]);
    x += 52;
  }
  out += svg::line(x, y - 4, x + 30, y - 4, frame_colour, "6 4");
  return out + svg::text_at(x + 36, y, "start", "limits");
}

}  // namespace

std::string motion_chart(const std::vector<OptimisedBlock>& blocks, const Method& method,
                         const std::string& title) {
  double steps = 0;
  for (const OptimisedBlock& block : blocks) steps += static_cast<double>(block.profile.steps());
  const std::array<Panel, 4> panels = panels_of(blocks, method, std::max(steps, 1.0));
  std::array<bool, axes> moves{};
  for (std::size_t a = 0; a < axes; ++a)
    moves[a] = panels[0].curves[a].max() > panels[0].curves[a].min();
  const double width = chart_left + chart_width + chart_right;
  const double height = chart_top + 4 * panel_height + 3 * panel_gap + chart_foot;
  std::string out = svg::opening(width, height);
  out += svg::heading(chart_left, 30, title);
  out += legend(moves, 30);
  double top = chart_top;
  for (const Panel& panel : panels) {
    out += panel_svg(panel, top, moves);
    top += panel_height + panel_gap;
  }
  const double bottom = top - panel_gap, seconds = steps * method.period_s;
  const double step = svg::nice_step(seconds, max_time_ticks);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = 0; k * step <= seconds * (1 + 1e-9); ++k) {
    const double x = chart_left + k * step / seconds * chart_width;
    out += svg::line(x, bottom, x, bottom + tick_length, frame_colour);
    out += svg::text_at(x, bottom + 18, "middle", fmt::format("{:.{}f}", k * step, decimals));
  }
  out += svg::text_at(chart_left + chart_width / 2, bottom + 38, "middle", "time / s");
  return out + "</svg>\n";
}

}  // namespace lamplock::feed_optimiser
