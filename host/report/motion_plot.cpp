#include "host/report/motion_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "host/svg.hpp"

namespace lamplock::report {
namespace {

// All lengths are pixels.
constexpr double plot_width = 880, plot_left = 96, plot_right = 16, plot_gap = 16, view_size = 264,
                 view_gap = 78;
constexpr double title_y = 20, legend_y = 42, strip_y = 62, panels_y = 74, below = 46;
constexpr double name_x = 13, limit_x = 27, view_name_gap = 56;
constexpr double digit_width = 7;
/// Vertices closer to the line than this are left out.
constexpr double tolerance = 0.12;
/// Smaller changes of ticks are not drawn: the clock is counted in whole cycles.
constexpr double seen_tick_spread = 5e-4;
/// Narrower beats get neither a ring without a shot nor dots on the curves with one.
constexpr double min_ring_width = 4;
/// A limit is drawn if the curve reaches this part of it.
constexpr double near_limit = 0.4;

constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7"};
constexpr const char* grid_colour = "#e4e4e4";
constexpr const char* frame_colour = "#999";
constexpr const char* limit_colour = "#555";

using svg::nice_step;
using svg::text_at;
using svg::turned_text;

struct Pixel {
  double x = 0, y = 0;
};

std::string line(Pixel from, Pixel to, const char* colour, const char* dashes = "") {
  return svg::line(from.x, from.y, to.x, to.y, colour, dashes);
}

double distance_to_line(const Pixel& p, const Pixel& a, const Pixel& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  if (length == 0) return std::hypot(p.x - a.x, p.y - a.y);
  return std::fabs(dy * (p.x - a.x) - dx * (p.y - a.y)) / length;
}

/// Removes points without a visible effect on the curve (Douglas and Peucker).
std::vector<Pixel> simplified(const std::vector<Pixel>& points) {
  if (points.size() < 3) return points;
  std::vector<bool> kept(points.size());
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double most = tolerance;
    std::size_t furthest = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_to_line(points[i], points[first], points[last]);
      if (distance > most) most = distance, furthest = i;
    }
    if (furthest == 0) continue;
    kept[furthest] = true;
    open.emplace_back(first, furthest);
    open.emplace_back(furthest, last);
  }
  std::vector<Pixel> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (kept[i]) result.push_back(points[i]);
  return result;
}

std::string curve(const std::vector<Pixel>& points, const char* colour, const std::string& clip) {
  std::string d;
  for (const Pixel& p : simplified(points))
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? 'M' : 'L', p.x, p.y);
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-linejoin=\"round\""
      "{}/>\n",
      d, colour, clip);
}

/// Multiples of a step from `low` to `high`.
std::vector<double> multiples(double low, double high, double step) {
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  std::vector<double> all(static_cast<std::size_t>(std::max(0.0, last - first + 1)));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = (first + static_cast<double>(i)) * step;
  return all;
}

/// An upright axis: numbers to pixels, and its grid.
struct Scale {
  double low = 0, high = 1;

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void widen(double share) {
    const double room = share * (high > low ? high - low : 1);
    low -= room, high += room;
  }
};

/// The layout of the picture.
class Drawing {
 public:
  Drawing(const MotionSeries& series, const std::string& title) : series_(series) {
    plane_ = series.axes.size() > 1 && series.axes[0].number == 0 && series.axes[1].number == 1;
    right_ = plot_width - plot_right - (plane_ ? view_size + view_gap : 0);
    y_ = panels_y;
    body_ += svg::heading(plot_left, title_y, title);
    strip();
  }

  std::string finish() {
    const double bottom = y_ - plot_gap;
    beat_numbers(bottom);
    if (plane_) view();
    legend();
    const double height = bottom + below;
    return svg::opening(plot_width, height, "#fff") + body_ + "</svg>\n";
  }

  /// Contents of a panel for an axis: its curve, its limit (0 = none).
  struct Shown {
    const AxisSeries& axis;
    const Curve& curve;
    double limit;
  };
  void panel(double height, const std::string& name, const std::vector<Shown>& shown) {
    Scale scale{0, 0};
    bool first = true, limited = false;
    for (const Shown& s : shown) {
      double most = 0;
      for (const Vertex& v : s.curve) {
        if (first) scale = {v.value, v.value};
        first = false;
        scale.take(v.value);
        most = std::max(most, std::fabs(v.value));
      }
      limited = limited || s.limit > 0;
      if (s.limit > 0 && most > near_limit * s.limit) scale.take(s.limit), scale.take(-s.limit);
    }
    scale.widen(0.06);
    frame(height, name, scale);
    if (limited) limits(height, scale, shown);
    for (const Shown& s : shown) {
      std::vector<Pixel> points;
      for (const Vertex& v : s.curve) points.push_back({x(v.beat), y_of(scale, height, v.value)});
      body_ += report::curve(points, colours[index(s.axis.number)], clip());
    }
    scales_.push_back(scale);
    y_ += height + plot_gap;
  }
  /// Draws shots on the curves of the last panel.
  void shots_on_curves(double height) {
    if (beat_width() < min_ring_width) return;
    const double top = y_ - plot_gap - height;
    for (const ShotMark& shot : series_.shots)
      for (const AxisSeries& axis : series_.axes)
        dot({x(shot.beat), y_of(scales_.back(), height, shot.position_mm[index(axis.number)], top)},
            radius(), colours[index(axis.number)]);
  }
  void ticks_panel(double height) {
    Curve lengths;
    for (const BeatMark& beat : series_.beats) {
      if (beat.beat >= series_.to) break;
      lengths.push_back({beat.beat, beat.tick_us});
      lengths.push_back({std::min(beat.beat + 1, series_.to), beat.tick_us});
    }
    panel(height, "tick, us", {{grey_, lengths, 0}});
  }

 private:
  double x(double beat) const {
    return plot_left + (right_ - plot_left) * (beat - series_.from) / (series_.to - series_.from);
  }
  static double y_in(const Scale& scale, double top, double height, double value) {
    return top + height * (scale.high - value) / (scale.high - scale.low);
  }
  double y_of(const Scale& scale, double height, double value) const {
    return y_in(scale, y_, height, value);
  }
  static double y_of(const Scale& scale, double height, double value, double top) {
    return y_in(scale, top, height, value);
  }
  double beat_width() const { return (right_ - plot_left) / (series_.to - series_.from); }
  double radius() const { return std::clamp(0.3 * beat_width(), 1.2, 3.0); }
  std::string clip() const { return fmt::format(" clip-path=\"url(#panel{})\"", panels_); }
  void dot(Pixel at, double size, const char* colour) {
    body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>\n", at.x,
                         at.y, size, colour);
  }
  void ring(Pixel at, double size) {
    body_ += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"#fff\" stroke=\"#777\"/>\n", at.x,
        at.y, size);
  }
  void cross(Pixel at, double size) {
    body_ += fmt::format(
        "<path d=\"M{0:.1f} {2:.1f}L{1:.1f} {3:.1f}M{0:.1f} {3:.1f}L{1:.1f} {2:.1f}\" "
        "stroke=\"#c00\" stroke-width=\"1.5\"/>\n",
        at.x - size, at.x + size, at.y - size, at.y + size);
  }

  void legend();
  void strip();
  void frame(double height, const std::string& name, const Scale& scale);
  void limits(double height, const Scale& scale, const std::vector<Shown>& shown);
  void beat_numbers(double bottom);
  void view();

  const MotionSeries& series_;
  AxisSeries grey_{3, "", {}, {}, {}, 0, 0};
  bool plane_ = false;
  double right_ = 0, y_ = 0;
  int panels_ = 0;
  bool limits_ = false, dots_ = false, rings_ = false, crosses_ = false;  ///< drawn so far
  std::vector<Scale> scales_;
  std::string body_;
};

/// The legend of the symbols that were drawn.
void Drawing::legend() {
  constexpr double dash = 22, mark = 12, y = legend_y - 4;
  double at = plot_left;
  const auto word = [&](double room, const std::string& text) {
    body_ += text_at(at + room, legend_y, "start", text);
    at += room + digit_width * static_cast<double>(text.size()) + 18;
  };
  for (const AxisSeries& axis : series_.axes) {
    body_ += line({at, y}, {at + dash, y}, colours[index(axis.number)]);
    word(dash + 5, axis.name);
  }
  if (limits_) {
    body_ += line({at, y}, {at + dash, y}, limit_colour, "5 4");
    word(dash + 5, "limit");
  }
  if (dots_) {
    dot({at + 4, y}, 3, "#000");
    word(mark, "shot");
  }
  if (rings_) {
    ring({at + 4, y}, 2.5);
    word(mark, "beat without a shot");
  }
  if (crosses_) {
    cross({at + 4, y}, 3);
    word(mark, "no flash");
  }
}

void Drawing::strip() {
  for (const BeatMark& beat : series_.beats) {
    const Pixel at{x(beat.beat), strip_y};
    if (series_.lamp && !beat.flash) {
      cross(at, radius());
      crosses_ = true;
    } else if (beat.shot) {
      dot(at, radius(), "#000");
      dots_ = true;
    } else if (beat_width() >= min_ring_width) {
      ring(at, 0.8 * radius());
      rings_ = true;
    }
  }
}

/// The frame of the panel that begins here: bands, beats, numbers, name.
void Drawing::frame(double height, const std::string& name, const Scale& scale) {
  ++panels_;
  body_ += fmt::format(
      "<clipPath id=\"panel{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/>"
      "</clipPath>\n",
      panels_, plot_left, y_, right_ - plot_left, height);
  std::string names;
  for (const StateBand& band : series_.bands) {
    const double from = std::max(x(band.from), plot_left), to = std::min(x(band.to), right_);
    if (to <= from) continue;
    body_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#fdf0d0\"/>\n",
        from, y_, to - from, height);
    if (panels_ > 1) continue;
    const double room = digit_width * static_cast<double>(band.name.size()) / 2 + 4;
    names += text_at(std::clamp((from + to) / 2, plot_left + room, right_ - room), y_ + 14,
                     "middle", band.name);
  }
  const double every =
      std::max(1.0, nice_step(series_.to - series_.from, (right_ - plot_left) / 9));
  for (const double beat : multiples(series_.from, series_.to, every))
    body_ += line({x(beat), y_}, {x(beat), y_ + height}, grid_colour);
  const double step = nice_step(scale.high - scale.low, height / 18);
  for (const double value : multiples(scale.low, scale.high, step)) {
    const double y = y_of(scale, height, value);
    const bool zero = std::fabs(value) < step / 2;
    body_ += line({plot_left, y}, {right_, y}, zero ? "#bbb" : grid_colour);
    body_ += text_at(plot_left - 6, y + 4, "end", fmt::format("{:.6g}", zero ? 0 : value));
  }
  body_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"{}\"/>\n",
      plot_left, y_, right_ - plot_left, height, frame_colour);
  body_ += names + turned_text(name_x, y_ + height / 2, name);
  if (panels_ == 1 && series_.axes.empty())
    body_ += text_at((plot_left + right_) / 2, y_ + 20, "middle", "no axis moves in these beats");
}

void Drawing::limits(double height, const Scale& scale, const std::vector<Shown>& shown) {
  std::vector<double> done;
  std::string far;
  for (const Shown& s : shown) {
    if (std::find(done.begin(), done.end(), s.limit) != done.end()) continue;
    done.push_back(s.limit);
    bool drawn = false;
    for (const double limit : {s.limit, -s.limit}) {
      if (limit < scale.low || limit > scale.high) continue;
      const double y = y_of(scale, height, limit);
      body_ += line({plot_left, y}, {right_, y}, limit_colour, "5 4");
      drawn = limits_ = true;
    }
    if (!drawn) far += fmt::format("{}{:g}", far.empty() ? "limit " : ", ", s.limit);
  }
  if (!far.empty()) body_ += turned_text(limit_x, y_ + height / 2, "(" + far + ")");
}

void Drawing::beat_numbers(double bottom) {
  const auto text = [](double beat) { return fmt::format("{:.0f}", beat + 0.0); };
  const double longest =
      static_cast<double>(std::max(text(series_.from).size(), text(series_.to).size()));
  const double room = std::max(44.0, (longest + 2) * digit_width);
  const double every =
      std::max(1.0, nice_step(series_.to - series_.from, (right_ - plot_left) / room));
  for (const double beat : multiples(series_.from, series_.to, every))
    body_ += text_at(x(beat), bottom + 16, "middle", text(beat));
  body_ += text_at((plot_left + right_) / 2, bottom + 36, "middle",
                   fmt::format("beats of {:.4g} ms", series_.beat_ms));
}

/// The path in the plane, seen from above.
void Drawing::view() {
  const Curve &xs = series_.axes[0].position_mm, &ys = series_.axes[1].position_mm;
  std::vector<Pixel> way;
  for (std::size_t i = 0; i < xs.size(); ++i)
    if (xs[i].beat >= series_.from && xs[i].beat <= series_.to)
      way.push_back({xs[i].value, ys[i].value});
  if (way.empty()) return;
  Scale across{way[0].x, way[0].x}, up{way[0].y, way[0].y};
  for (const Pixel& p : way) across.take(p.x), up.take(p.y);
  const double size = std::max(across.high - across.low, up.high - up.low) * 1.12;
  const auto about = [size](const Scale& s) {
    return Scale{(s.low + s.high - size) / 2, (s.low + s.high + size) / 2};
  };
  across = about(across), up = about(up);
  const double x0 = plot_width - plot_right - view_size;
  const auto place = [&](const Pixel& mm) {
    return Pixel{x0 + view_size * (mm.x - across.low) / size,
                 panels_y + view_size * (up.high - mm.y) / size};
  };
  const double step = nice_step(size, 6);
  for (const double v : multiples(across.low, across.high, step)) {
    const double at = place({v, 0}).x;
    body_ += line({at, panels_y}, {at, panels_y + view_size}, grid_colour);
    body_ += text_at(at, panels_y + view_size + 16, "middle",
                     fmt::format("{:.4g}", std::fabs(v) < step / 2 ? 0 : v));
  }
  for (const double v : multiples(up.low, up.high, step)) {
    const double at = place({0, v}).y;
    body_ += line({x0, at}, {x0 + view_size, at}, grid_colour);
    body_ += text_at(x0 - 6, at + 4, "end", fmt::format("{:.4g}", std::fabs(v) < step / 2 ? 0 : v));
  }
  body_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"{}\"/>\n",
      x0, panels_y, view_size, view_size, frame_colour);
  std::transform(way.begin(), way.end(), way.begin(), place);
  body_ += curve(way, "#444", "");
  for (const ShotMark& shot : series_.shots)
    dot(place({shot.position_mm[0], shot.position_mm[1]}), std::min(radius(), 3.0), "#000");
  body_ += text_at(x0 + view_size / 2, panels_y + view_size + 36, "middle", "X, mm (from above)");
  body_ += turned_text(x0 - view_name_gap, panels_y + view_size / 2, "Y, mm");
}

}  // namespace

std::string motion_svg(const MotionSeries& series, const std::string& title) {
  constexpr double position_height = 120, height = 100, ticks_height = 70;
  Drawing drawing(series, title);
  std::vector<Drawing::Shown> positions, speeds, accelerations;
  for (const AxisSeries& axis : series.axes) {
    positions.push_back({axis, axis.position_mm, 0});
    speeds.push_back({axis, axis.speed_m_s, axis.max_speed_m_s});
    accelerations.push_back({axis, axis.accel_m_s2, axis.max_accel_m_s2});
  }
  drawing.panel(position_height, "position, mm", positions);
  drawing.shots_on_curves(position_height);
  drawing.panel(height, "speed, m/s", speeds);
  drawing.panel(height, "accel., m/s2", accelerations);
  if (series.tick_spread() > seen_tick_spread) drawing.ticks_panel(ticks_height);
  return drawing.finish();
}

}  // namespace lamplock::report
