#include "host/thermal/straight_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/error.hpp"

namespace lamplock::thermal {
namespace {

constexpr double margin_radii = 100, way_radii = 120;
constexpr double steady_change = 0.002;
constexpr int max_rounds = 400;  ///< of a radius each, or of the time that heat needs for one
constexpr double hold_tolerance = 0.002;
constexpr int max_hold_rounds = 20;

/// The beam on its way along x.
class Track {
 public:
  Track(const StraightSetup& setup, double speed_mm_s, std::function<void()> each_step = {})
      : setup_(setup),
        speed_(speed_mm_s),
        each_step_(std::move(each_step)),
        field_(moving_setup(setup, speed_mm_s)) {
    const double radius = setup.beam.radius_mm();
    // A slow beam heats by conduction: its time is that of the heat.
    step_s_ = setup.meshing.radii_per_step *
              std::min(radius / speed_mm_s, radius * radius / setup.body.diffusivity_mm2_s());
  }

  void advance(double power_w) {
    const double next = x_ + speed_ * step_s_;
    field_.advance({x_, 0, next, 0}, power_w, step_s_);
    x_ = next;
    ++steps_;
    if (each_step_) each_step_();
  }
  bool has_ended() const { return x_ + speed_ * step_s_ > way_radii * setup_.beam.half_x_mm; }
  double rise() const { return field_.max_surface_k() - setup_.surface.ambient_k; }
  double step_s() const { return step_s_; }
  std::size_t steps() const { return steps_; }
  const MovingField& field() const { return field_; }

  /// Until the rise changes by less than 0.2 % in the time of a radius.
  bool settle(double power_w) {
    const auto steps_per_radius = static_cast<int>(std::ceil(1 / setup_.meshing.radii_per_step));
    constexpr int min_rounds = 4;
    double last = 0;
    for (int round = 0; !has_ended() && round < max_rounds; ++round) {
      for (int i = 0; i < steps_per_radius; ++i) advance(power_w);
      const double now = rise();
      if (round >= min_rounds && std::abs(now - last) <= steady_change * now) return true;
      last = now;
    }
    return false;
  }

 private:
  static MovingSetup moving_setup(const StraightSetup& setup, double speed_mm_s) {
    const double margin = margin_radii * std::max(setup.beam.half_x_mm, setup.beam.half_y_mm);
    const double way = way_radii * setup.beam.half_x_mm;
    return {setup.body,
            setup.surface,
            setup.beam,
            setup.meshing,
            -margin,
            way + margin,
            0,
            margin,
            setup.thickness_mm.value_or(margin),
            speed_mm_s};
  }

  StraightSetup setup_;
  double speed_, x_ = 0, step_s_ = 0;
  std::size_t steps_ = 0;
  std::function<void()> each_step_;
  MovingField field_;
};

}  // namespace

StraightResult straight_run(const StraightSetup& setup, double speed_mm_s, double power_w,
                            const std::function<void()>& each_step) {
  Track track(setup, speed_mm_s, each_step);
  StraightResult result;
  result.is_steady = track.settle(power_w);
  result.steps = track.steps();
  result.max_k = track.field().max_surface_k();
  const HeatSolver& solver = track.field().solver();
  // Both halves.
  const Losses half = solver.losses_w();
  result.losses_w = {2 * half.convection, 2 * half.radiation, 2 * half.evaporation};
  result.absorbed_w = setup.body.absorption * power_w;
  result.balance = solver.balance();
  return result;
}

HeldPair held_pair(const StraightSetup& setup, double speed_mm_s, double hold_k) {
  const double wanted = hold_k - setup.surface.ambient_k;
  if (!(wanted > 0))
    throw Error(Exit::bad_input, "--hold",
                fmt::format("{:g} K is not above the ambient temperature of {:g} K", hold_k,
                            setup.surface.ambient_k),
                "give a higher temperature");
  StraightSetup lossless = setup;
  lossless.surface = {.ambient_k = setup.surface.ambient_k};
  const double rise_per_w = straight_run(lossless, speed_mm_s, 1).max_k - setup.surface.ambient_k;
  HeldPair pair{speed_mm_s, wanted / rise_per_w, {}};
  double last_power = 0, last_rise = 0;
  for (int round = 0; round < max_hold_rounds; ++round) {
    pair.at = straight_run(setup, speed_mm_s, pair.power_w);
    const double rise = pair.at.max_k - setup.surface.ambient_k;
    if (std::abs(rise - wanted) <= hold_tolerance * wanted) return pair;
    // Secant; losses grow with the temperature, so the rise grows ever less with the power.
    const double slope = (rise - last_rise) / (pair.power_w - last_power);
    last_power = pair.power_w;
    last_rise = rise;
    pair.power_w = std::max(pair.power_w + (wanted - rise) / slope, 0.5 * pair.power_w);
  }
  throw Error(Exit::job_failed, "--hold",
              fmt::format("no power holds {:g} K at {:g} mm/s", hold_k, speed_mm_s),
              "give a lower temperature");
}

StraightSetup refined(const StraightSetup& setup) {
  StraightSetup fine = setup;
  fine.meshing.cells_per_radius *= 2;
  fine.meshing.growth = std::sqrt(setup.meshing.growth);
  fine.meshing.radii_per_step /= 2;
  return fine;
}

Plant measured_plant(const StraightSetup& setup, double speed_mm_s, double power_w) {
  constexpr double increase = 0.1, lag_part = 0.632120558828558;
  StraightSetup fine = setup;
  fine.meshing.radii_per_step /= 5;
  Track track(fine, speed_mm_s);
  track.settle(power_w);
  const double before = track.rise();
  std::vector<double> responses{0};
  const auto max_steps = static_cast<std::size_t>(20 / fine.meshing.radii_per_step);
  while (!track.has_ended() && responses.size() < max_steps) {
    track.advance((1 + increase) * power_w);
    responses.push_back(track.rise() - before);
  }
  const double end = responses.back();
  if (!(end > 0))
    throw Error(Exit::job_failed, "--tune", "the temperature does not follow the power",
                "give --gain and --time-constant");
  std::size_t i = 1;
  while (i + 1 < responses.size() && responses[i] < lag_part * end) ++i;
  const double part = (lag_part * end - responses[i - 1]) / (responses[i] - responses[i - 1]);
  return {end / increase, (static_cast<double>(i - 1) + part) * track.step_s()};
}

}  // namespace lamplock::thermal
