#include "host/program/servo_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/svg.hpp"

namespace lamplock::program_run {
namespace {

// All lengths are pixels.
constexpr double side = 360, chart_width = 520, picture_left = 64, picture_gap = 84,
                 picture_right = 28;
constexpr double head = 40, foot = 52, row_height = head + side + foot;
constexpr double max_ticks = 7, tick_length = 5;
/// Points of a curve that are closer are merged.
constexpr double min_distance = 0.7;
constexpr double range_margin = 1.06;  ///< of the drawn values
constexpr const char* servo_frame_colour = "#999";
constexpr const char* programmed_colour = "#222222";
constexpr std::array<const char*, servo_axes> axis_colours{"#0072b2", "#d55e00"};
constexpr const char* measured_colour = "#8fd9c0";
/// The measured path is broad and pale below the programmed one: both are visible where they agree.
constexpr double programmed_width = 1, measured_width = 4;

/// Converts a range of values to a range of pixels.
struct ServoScale {
  double low, high, at_low, at_high;

  double operator()(double value) const {
    return at_low + (value - low) / (high - low) * (at_high - at_low);
  }
};

/// A curve without points that are too close together.
class Curve {
 public:
  void add(double x, double y) {
    if (!d_.empty() && std::hypot(x - x_, y - y_) < min_distance) return;
    d_ += fmt::format("{}{:.1f} {:.1f}", d_.empty() ? 'M' : 'L', x, y);
    x_ = x, y_ = y;
  }
  std::string element(const char* colour, double width) const {
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n", d_,
                       colour, width);
  }

 private:
  std::string d_;
  double x_ = 0, y_ = 0;
};

std::string number(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value + 0.0, decimals);  // not "-0"
}

/// A curve over time with samples closer than pixels: draws the lowest and the highest value of
/// each column.
class DenseCurve {
 public:
  void add(double x, double y) {
    if (x >= column_ + 1) flush(x);
    low_ = std::min(low_, y);
    high_ = std::max(high_, y);
  }
  std::string element(const char* colour, double width) {
    flush(column_);
    return curve_.element(colour, width);
  }

 private:
  void flush(double next) {
    if (low_ <= high_) {
      curve_.add(column_, rising_ ? low_ : high_);
      curve_.add(column_, rising_ ? high_ : low_);
      rising_ = !rising_;
    }
    column_ = std::floor(next);
    low_ = std::numeric_limits<double>::max();
    high_ = std::numeric_limits<double>::lowest();
  }

  Curve curve_;
  double column_ = 0;
  double low_ = std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::lowest();
  bool rising_ = true;
};

/// A frame with numbers on its lower and left side.
std::string frame(const ServoScale& x, const ServoScale& y) {
  std::string out = fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
      "fill=\"#fff\" stroke=\"{}\"/>\n",
      x.at_low, y.at_high, x.at_high - x.at_low, y.at_low - y.at_high, servo_frame_colour);
  const double x_step = svg::nice_step(x.high - x.low, max_ticks);
  for (double k = std::ceil(x.low / x_step); k * x_step <= x.high; ++k) {
    out += svg::line(x(k * x_step), y.at_low, x(k * x_step), y.at_low + tick_length,
                     servo_frame_colour);
    out += svg::text_at(x(k * x_step), y.at_low + 18, "middle", number(k * x_step, x_step));
  }
  const double y_step = svg::nice_step(y.high - y.low, max_ticks);
  for (double k = std::ceil(y.low / y_step); k * y_step <= y.high; ++k) {
    out += svg::line(x.at_low - tick_length, y(k * y_step), x.at_low, y(k * y_step),
                     servo_frame_colour);
    out += svg::text_at(x.at_low - 8, y(k * y_step) + 4, "end", number(k * y_step, y_step));
  }
  return out;
}

/// Both axes to one scale.
std::string path_panel(const NamedServoRun& named, double top) {
  std::array<double, servo_axes> low{}, high{};
  for (std::size_t a = 0; a < servo_axes; ++a)
    low[a] = high[a] = named.run.samples.front().axis[a].programmed;
  for (const ServoSample& sample : named.run.samples)
    for (std::size_t a = 0; a < servo_axes; ++a) {
      low[a] = std::min({low[a], sample.axis[a].programmed, sample.axis[a].measured});
      high[a] = std::max({high[a], sample.axis[a].programmed, sample.axis[a].measured});
    }
  const double half = std::max({high[0] - low[0], high[1] - low[1], 1e-3}) * range_margin / 2;
  const auto scale = [&](std::size_t a, double at_low, double at_high) {
    const double middle = (low[a] + high[a]) / 2;
    return ServoScale{middle - half, middle + half, at_low, at_high};
  };
  const ServoScale x = scale(0, picture_left, picture_left + side), y = scale(1, top + side, top);
  Curve programmed, measured;
  for (const ServoSample& sample : named.run.samples) {
    programmed.add(x(sample.axis[0].programmed), y(sample.axis[1].programmed));
    measured.add(x(sample.axis[0].measured), y(sample.axis[1].measured));
  }
  return frame(x, y) + measured.element(measured_colour, measured_width) +
         programmed.element(programmed_colour, programmed_width) +
         svg::text_at(picture_left + side / 2, top + side + 38, "middle", "X / mm") +
         svg::turned_text(16, top + side / 2, "Y / mm");
}

std::string error_panel(const NamedServoRun& named, double top, double pulse_mm) {
  double most = pulse_mm;
  for (const ServoSample& sample : named.run.samples)
    for (const ServoPlace& place : sample.axis)
      most = std::max(most, std::abs(place.programmed - place.measured));
  const double from = picture_left + side + picture_gap;
  const ServoScale x{0, std::max(named.run.samples.back().at_s, 1e-3), from, from + chart_width};
  const ServoScale y{-most * range_margin, most * range_margin, top + side, top};
  std::string out = frame(x, y);
  for (const double mm : {-pulse_mm, 0.0, pulse_mm})
    out += svg::line(x.at_low, y(mm), x.at_high, y(mm), servo_frame_colour, mm == 0 ? "" : "4 3");
  for (std::size_t a = 0; a < servo_axes; ++a) {
    DenseCurve curve;
    for (const ServoSample& sample : named.run.samples)
      curve.add(x(sample.at_s), y(sample.axis[a].programmed - sample.axis[a].measured));
    out += curve.element(axis_colours[a], 1);
  }
  out += svg::text_at(from + chart_width / 2, top + side + 38, "middle", "time / s");
  return out + svg::turned_text(from - 56, top + side / 2, "programmed less measured / mm");
}

/// An entry of the legend: a line with its meaning.
std::string key(double x, double y, const char* colour, double width, const char* text) {
  return fmt::format("<g stroke-width=\"{}\">{}</g>", width,
                     svg::line(x, y - 4, x + 24, y - 4, colour)) +
         svg::text_at(x + 30, y, "start", text);
}

}  // namespace

std::string servo_svg(const std::vector<NamedServoRun>& runs, double pulse_mm) {
  const double width = picture_left + side + picture_gap + chart_width + picture_right;
  std::string out = svg::opening(width, row_height * static_cast<double>(runs.size()));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double row = row_height * static_cast<double>(i), top = row + head;
    out += svg::heading(picture_left, row + 26, runs[i].name);
    out += key(picture_left + side - 180, row + 26, programmed_colour, programmed_width, "program");
    out += key(picture_left + side - 84, row + 26, measured_colour, measured_width, "encoders");
    out += svg::line(width - picture_right - 224, row + 22, width - picture_right - 200, row + 22,
                     servo_frame_colour, "4 3");
    out += svg::text_at(width - picture_right - 194, row + 26, "start", "one pulse");
    out += key(width - picture_right - 110, row + 26, axis_colours[0], 2, "X");
    out += key(width - picture_right - 54, row + 26, axis_colours[1], 2, "Y");
    out += path_panel(runs[i], top) + error_panel(runs[i], top, pulse_mm);
  }
  return out + "</svg>\n";
}

}  // namespace lamplock::program_run
