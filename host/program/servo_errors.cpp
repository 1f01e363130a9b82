#include "host/program/servo_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamplock::program_run {
namespace {

constexpr const char* axis_names = "XY";
/// Time range in which the nearest position of the path is searched: the load lags, so mostly back.
constexpr double looked_back_s = 0.3, looked_ahead_s = 0.05;

/// Distance of a load from a straight piece of the path.
double distance_mm(const ServoSample& load, const ServoSample& from, const ServoSample& to) {
  std::array<double, servo_axes> way{}, off{};
  double dot = 0, length_2 = 0;
  for (std::size_t a = 0; a < servo_axes; ++a) {
    way[a] = to.axis[a].programmed - from.axis[a].programmed;
    off[a] = load.axis[a].measured - from.axis[a].programmed;
    dot += way[a] * off[a];
    length_2 += way[a] * way[a];
  }
  const double part = length_2 > 0 ? std::clamp(dot / length_2, 0.0, 1.0) : 0;
  return std::hypot(off[0] - part * way[0], off[1] - part * way[1]);
}

}  // namespace

double beside_path_mm(const ServoRun& run, std::size_t sample) {
  const ServoSample& load = run.samples[sample];
  double nearest = distance_mm(load, load, load);
  for (std::size_t i = sample; i > 0 && load.at_s - run.samples[i].at_s < looked_back_s; --i)
    nearest = std::min(nearest, distance_mm(load, run.samples[i - 1], run.samples[i]));
  for (std::size_t i = sample + 1;
       i < run.samples.size() && run.samples[i].at_s - load.at_s < looked_ahead_s; ++i)
    nearest = std::min(nearest, distance_mm(load, run.samples[i - 1], run.samples[i]));
  return nearest;
}

ContourError contour_error(const std::vector<double>& beside_mm) {
  ContourError error;
  if (beside_mm.empty()) return error;
  const auto count = static_cast<double>(beside_mm.size());
  for (const double mm : beside_mm) {
    error.mean_mm += mm / count;
    error.max_mm = std::max(error.max_mm, mm);
  }
  double squares = 0;
  for (const double mm : beside_mm) squares += (mm - error.mean_mm) * (mm - error.mean_mm);
  error.deviation_mm = std::sqrt(squares / count);
  return error;
}

ServoErrors servo_errors(const ServoRun& run, double pulses_per_mm, const std::string& name) {
  ServoErrors errors;
  errors.name = name;
  errors.moving_s = run.moving_s;
  errors.samples = run.samples.size();
  for (std::size_t a = 0; a < servo_axes; ++a) {
    ServoAxisErrors& axis = errors.axis[a];
    double squares = 0;
    for (const ServoSample& sample : run.samples) {
      const ServoPlace& place = sample.axis[a];
      const double error = place.programmed - place.measured;
      axis.max_mm = std::max(axis.max_mm, error);
      axis.min_mm = std::min(axis.min_mm, error);
      squares += error * error;
      axis.max_pulses = std::max(axis.max_pulses, std::abs(place.programmed * run.steps_per_mm -
                                                           place.commanded * pulses_per_mm));
    }
    axis.rms_mm = std::sqrt(squares / static_cast<double>(run.samples.size()));
    axis.programmed_end_mm = run.samples.back().axis[a].programmed;
    axis.measured_end_mm = run.samples.back().axis[a].measured;
    axis.end_pulses = run.pulses[a];
  }
  for (std::size_t i = 0; i < run.samples.size(); ++i)
    errors.beside_mm = std::max(errors.beside_mm, beside_path_mm(run, i));
  return errors;
}

std::string servo_table(const std::vector<ServoErrors>& rows) {
  std::size_t width = std::string_view("trajectory").size();
  for (const ServoErrors& row : rows) width = std::max(width, row.name.size());
  std::string text =
      fmt::format("{:<{}}  axis  largest +  largest -  rms      pulses off  end         measured\n",
                  "trajectory", width);
  for (const ServoErrors& row : rows) {
    for (std::size_t a = 0; a < servo_axes; ++a) {
      const ServoAxisErrors& axis = row.axis[a];
      text +=
          fmt::format("{:<{}}  {}     {:9.4f}  {:9.4f}  {:7.4f}  {:10.3f}  {:10.4f}  {:10.4f}\n",
                      a == 0 ? row.name : "", width, axis_names[a], axis.max_mm, axis.min_mm,
                      axis.rms_mm, axis.max_pulses, axis.programmed_end_mm, axis.measured_end_mm);
    }
    text += fmt::format("{:<{}}  at most {:.4f} mm beside the path, {:.3f} s\n", "", width,
                        row.beside_mm, row.moving_s);
  }
  return text;
}

}  // namespace lamplock::program_run
