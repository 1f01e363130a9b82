#include "host/thermal/path_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/svg.hpp"

namespace lamplock::thermal {
namespace {

// All lengths are pixels.
constexpr double view_width = 720, view_left = 76, view_top = 48, view_right = 130;
constexpr double time_height = 170, time_gap = 62, view_foot = 54;
constexpr double min_view_height = 140, max_view_height = 640, bar_gap = 24, bar_width = 16;
constexpr double line_width = 5, limit_width = 9, max_view_ticks = 8;
constexpr int path_shades = 32;
constexpr const char* view_frame = "#999";

/// Of one of the shades of the path.
std::string shade_colour(int shade) {
  return svg::shade(static_cast<double>(shade) / (path_shades - 1));
}

struct Span {
  double low = 1e300, high = -1e300;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double size() const { return high - low; }
};

class PathView {
 public:
  PathView(const PathResult& result, const std::vector<BeamMove>& moves) {
    for (const PathSample& sample : result.samples) {
      if (moves[sample.move].power_w <= 0) continue;
      x_.add(sample.x);
      y_.add(sample.y);
      kelvin_.add(sample.max_k);
    }
    const double margin = 0.06 * std::max({x_.size(), y_.size(), 1e-3});
    x_ = {x_.low - margin, x_.high + margin};
    y_ = {y_.low - margin, y_.high + margin};
    scale_ = std::min(view_width / x_.size(), max_view_height / y_.size());
    height_ = std::max(min_view_height, y_.size() * scale_);
    if (kelvin_.size() < 1) kelvin_.high = kelvin_.low + 1;
  }
  double px(double x) const {
    return view_left + view_width / 2 + (x - (x_.low + x_.high) / 2) * scale_;
  }
  double py(double y) const {
    return view_top + height_ / 2 - (y - (y_.low + y_.high) / 2) * scale_;
  }
  double height() const { return height_; }
  double scale() const { return scale_; }
  const Span& x() const { return x_; }
  const Span& y() const { return y_; }
  const Span& kelvin() const { return kelvin_; }

 private:
  Span x_, y_, kelvin_;
  double scale_ = 1, height_ = 0;
};

std::string place_ticks(const PathView& v) {
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{:.1f}\" fill=\"#fff\" stroke=\"{}\"/>\n",
      view_left, view_top, view_width, v.height(), view_frame);
  const double step = svg::nice_step(std::max(v.x().size(), v.y().size()), max_view_ticks);
  const double bottom = view_top + v.height();
  for (double k = std::ceil(v.x().low / step); k * step <= v.x().high; ++k) {
    out += svg::line(v.px(k * step), bottom, v.px(k * step), bottom + 5, view_frame);
    out += svg::text_at(v.px(k * step), bottom + 18, "middle", fmt::format("{:g}", k * step + 0.0));
  }
  for (double k = std::ceil(v.y().low / step); k * step <= v.y().high; ++k) {
    out += svg::line(view_left - 5, v.py(k * step), view_left, v.py(k * step), view_frame);
    out +=
        svg::text_at(view_left - 8, v.py(k * step) + 4, "end", fmt::format("{:g}", k * step + 0.0));
  }
  out += svg::text_at(view_left + view_width / 2, bottom + 36, "middle", "X / mm");
  return out + svg::turned_text(22, view_top + v.height() / 2, "Y / mm");
}

/// One path element for each shade; places above the limit under them, wider.
std::string coloured_path(const PathView& v, const PathResult& result,
                          const std::vector<BeamMove>& moves, double limit_k) {
  std::array<std::string, path_shades> shades;
  std::string above;
  for (std::size_t i = 1; i < result.samples.size(); ++i) {
    const PathSample &from = result.samples[i - 1], &to = result.samples[i];
    if (moves[to.move].power_w <= 0) continue;
    const std::string piece = fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", v.px(from.x),
                                          v.py(from.y), v.px(to.x), v.py(to.y));
    const double part = (to.max_k - v.kelvin().low) / v.kelvin().size();
    shades[static_cast<std::size_t>(std::lround(part * (path_shades - 1)))] += piece;
    if (to.max_k > limit_k) above += piece;
  }
  const auto element = [](const std::string& d, const std::string& colour, double width) {
    return d.empty() ? std::string()
                     : fmt::format(
                           "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
                           "stroke-linecap=\"round\"/>\n",
                           d, colour, width);
  };
  std::string out = element(above, "#e00000", limit_width);
  for (int s = 0; s < path_shades; ++s)
    out += element(shades[static_cast<std::size_t>(s)], shade_colour(s), line_width);
  return out;
}

std::string colour_bar(const PathView& v) {
  std::string out;
  const double x = view_left + view_width + bar_gap, height = std::min(v.height(), 260.0);
  for (int s = 0; s < path_shades; ++s)
    out += fmt::format("<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                       x, view_top + height * (path_shades - 1 - s) / path_shades, bar_width,
                       height / path_shades + 0.5, shade_colour(s));
  out += svg::text_at(x + bar_width + 6, view_top + 10, "start",
                      fmt::format("{:.0f} K", v.kelvin().high));
  return out + svg::text_at(x + bar_width + 6, view_top + height, "start",
                            fmt::format("{:.0f} K", v.kelvin().low));
}

std::string time_panel(const PathResult& result, double limit_k, double top) {
  Span kelvin;
  for (const PathSample& sample : result.samples) kelvin.add(sample.max_k);
  kelvin.add(limit_k);
  const double margin = std::max(0.05 * kelvin.size(), 0.5), end = std::max(result.seconds, 1e-9);
  kelvin = {kelvin.low - margin, kelvin.high + margin};
  const auto px = [&](double t) { return view_left + t / end * view_width; };
  const auto py = [&](double k) { return top + (kelvin.high - k) / kelvin.size() * time_height; };
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"#fff\" stroke=\"{}\"/>\n",
      view_left, top, view_width, time_height, view_frame);
  const double step_t = svg::nice_step(end, max_view_ticks);
  for (double k = 0; k * step_t <= end * (1 + 1e-9); ++k)
    out += svg::text_at(px(k * step_t), top + time_height + 18, "middle",
                        fmt::format("{:g}", k * step_t));
  const double step_k = svg::nice_step(kelvin.size(), 5);
  for (double k = std::ceil(kelvin.low / step_k); k * step_k <= kelvin.high; ++k)
    out += svg::text_at(view_left - 8, py(k * step_k) + 4, "end", fmt::format("{:g}", k * step_k));
  out += svg::line(view_left, py(limit_k), view_left + view_width, py(limit_k), "#e00000", "6 4");
  std::string d;
  double last_x = -1e9;
  for (const PathSample& sample : result.samples) {
    if (px(sample.time_s) - last_x < 0.3) continue;
    last_x = px(sample.time_s);
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? 'M' : 'L', last_x, py(sample.max_k));
  }
  out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1.3\"/>\n", d);
  out += svg::text_at(view_left + view_width / 2, top + time_height + 38, "middle", "time / s");
  out += svg::text_at(view_left + view_width + 8, py(limit_k) + 4, "start",
                      fmt::format("limit {:.0f} K", limit_k));
  return out + svg::turned_text(22, top + time_height / 2, "hottest place / K");
}

}  // namespace

std::string path_picture(const PathResult& result, const std::vector<BeamMove>& moves,
                         double limit_k, const std::string& title) {
  const PathView v(result, moves);
  const double width = view_left + view_width + view_right;
  const double time_top = view_top + v.height() + time_gap;
  const double height = time_top + time_height + view_foot;
  std::string out = svg::opening(width, height);
  out += svg::heading(view_left, 28, title);
  out += place_ticks(v);
  out += coloured_path(v, result, moves, limit_k);
  out += colour_bar(v);
  out += time_panel(result, limit_k, time_top);
  return out + "</svg>\n";
}

}  // namespace lamplock::thermal
