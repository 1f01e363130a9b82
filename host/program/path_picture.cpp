#include "host/program/path_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/svg.hpp"

namespace lamplock::program_run {
namespace {

// All lengths are pixels.
constexpr double view = 720, left = 70, top = 44, right = 132, below = 50;
constexpr double bar_gap = 24, bar_width = 16, tick_length = 5;
/// Ends of pieces that are closer are merged.
constexpr double min_distance = 0.15;
constexpr int shades = 32;
constexpr double max_ticks = 8;

std::string shade_colour(int shade) {
  return svg::shade(static_cast<double>(shade) / (shades - 1));
}

int shade_of(double power) {
  return static_cast<int>(std::lround(std::clamp(power, 0.0, 1.0) * (shades - 1)));
}

/// Millimetres to pixels, the same for both axes; a path without extent lies in the middle.
class View {
 public:
  explicit View(const Bounds& bounds)
      : x_((bounds.low[0] + bounds.high[0]) / 2), y_((bounds.low[1] + bounds.high[1]) / 2) {
    const double size =
        std::max({bounds.high[0] - bounds.low[0], bounds.high[1] - bounds.low[1], 1e-3});
    half_mm_ = size * 0.53;
    scale_ = view / (2 * half_mm_);
  }
  double px(double x_mm) const { return left + view / 2 + (x_mm - x_) * scale_; }
  double py(double y_mm) const { return top + view / 2 - (y_mm - y_) * scale_; }
  double low_x() const { return x_ - half_mm_; }
  double low_y() const { return y_ - half_mm_; }
  double size_mm() const { return 2 * half_mm_; }

 private:
  double x_, y_, half_mm_, scale_;
};

/// Paths of one style, written as one element.
class Stroke {
 public:
  void add(const View& v, const Piece& piece) {
    const double x0 = v.px(piece.from[0]), y0 = v.py(piece.from[1]);
    const double x1 = v.px(piece.to[0]), y1 = v.py(piece.to[1]);
    const bool joined = !d_.empty() && std::hypot(x0 - x_, y0 - y_) < min_distance;
    if (joined && std::hypot(x1 - x_, y1 - y_) < min_distance) return;
    if (!joined) d_ += fmt::format("M{:.1f} {:.1f}", x0, y0);
    d_ += fmt::format("L{:.1f} {:.1f}", x1, y1);
    x_ = x1, y_ = y1;
  }
  std::string element(const std::string& look) const {
    return d_.empty() ? "" : "<path d=\"" + d_ + "\" fill=\"none\" " + look + "/>\n";
  }

 private:
  std::string d_;
  double x_ = 0, y_ = 0;
};

std::string axes(const View& v) {
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#fff\" stroke=\"#999\"/>\n", left,
      top, view, view);
  const double step = svg::nice_step(v.size_mm(), max_ticks);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  // Not "-0".
  const auto number = [&](double k) { return fmt::format("{:.{}f}", k * step + 0.0, decimals); };
  const double bottom = top + view;
  for (double k = std::ceil(v.low_x() / step); k * step < v.low_x() + v.size_mm(); ++k) {
    const double x = v.px(k * step);
    out += svg::line(x, bottom, x, bottom + tick_length, "#999");
    out += svg::text_at(x, bottom + 18, "middle", number(k));
  }
  for (double k = std::ceil(v.low_y() / step); k * step < v.low_y() + v.size_mm(); ++k) {
    const double y = v.py(k * step);
    out += svg::line(left - tick_length, y, left, y, "#999");
    out += svg::text_at(left - 8, y + 4, "end", number(k));
  }
  out += svg::text_at(left + view / 2, bottom + 38, "middle", "X / mm");
  return out + svg::turned_text(16, top + view / 2, "Y / mm");
}

std::string legend() {
  const double x = left + view + bar_gap, height = view / 3, step = height / shades;
  std::string out = svg::text_at(x, top + 10, "start", "power");
  for (int shade = 0; shade < shades; ++shade)
    out += fmt::format("<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                       x, top + 20 + height - (shade + 1) * step, bar_width, step + 0.5,
                       shade_colour(shade));
  out += svg::text_at(x + bar_width + 6, top + 30, "start", "100 %");
  out += svg::text_at(x + bar_width + 6, top + 20 + height, "start", "> 0 %");
  const double y = top + height + 50;
  out += svg::line(x, y, x + 30, y, "#4a7fb5", "4 3");
  return out + svg::text_at(x + 36, y + 4, "start", "rapid, 0 %");
}

}  // namespace

std::string path_svg(const ProgramRun& run, const std::string& title) {
  const View v(run.bounds);
  Stroke dark;  // rapids, and moves without power
  std::array<Stroke, shades> strokes;
  for (const Piece& piece : run.pieces) {
    const bool is_dark = piece.rapid || piece.power <= 0;
    (is_dark ? dark : strokes[static_cast<std::size_t>(shade_of(piece.power))]).add(v, piece);
  }
  std::string out = svg::opening(left + view + right, top + view + below);
  out += svg::heading(left, 26, title);
  out += axes(v);
  out += dark.element("stroke=\"#4a7fb5\" stroke-width=\"0.8\" stroke-dasharray=\"4 3\"");
  for (int shade = 0; shade < shades; ++shade)
    out += strokes[static_cast<std::size_t>(shade)].element(fmt::format(
        "stroke=\"{}\" stroke-width=\"1.2\" stroke-linejoin=\"round\"", shade_colour(shade)));
  return out + legend() + "</svg>\n";
}

}  // namespace lamplock::program_run
