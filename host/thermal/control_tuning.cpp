#include "host/thermal/control_tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numbers>

#include "host/error.hpp"

namespace lamplock::thermal {
namespace {

constexpr int steps_per_settling = 4000;
constexpr double simulated_settlings = 4;

/// Step response of omega = 1 at a time.
double unit_response(double zeta, double time) {
  const double damped = std::sqrt(1 - zeta * zeta);
  return 1 - std::exp(-zeta * time) *
                 (std::cos(damped * time) + zeta / damped * std::sin(damped * time));
}

/// Time with omega = 1 from which on the response remains in the band.
double unit_settling(double zeta, double band) {
  constexpr double step = 1e-4;
  // Its envelope is below any band by then.
  const double end = 12 / zeta;
  auto steps = static_cast<std::uint32_t>(end / step);
  while (steps > 1 && std::abs(unit_response(zeta, (steps - 1) * step) - 1) <= band) --steps;
  return steps * step;
}

/// The loop from equilibrium, by the classical method of Runge and Kutta. State: deviation of the
/// temperature and integral of the controller's error.
LoopResponse simulate(const Plant& plant, const LoopSettings& loop, const LoopGoal& goal,
                      double set_point_k, double absorption_part) {
  LoopResponse response;
  const double step = goal.settling_s / steps_per_settling;
  double y = 0, integral = 0;
  const auto output = [&](double yy, double ii) { return loop.ki_per_s * ii - loop.kp * yy; };
  const auto y_rate = [&](double yy, double ii) {
    // At equilibrium the output is 1 and y is 0.
    const double input = (1 + output(yy, ii)) * (1 + absorption_part) - 1;
    return (plant.gain_k * input - yy) / plant.time_constant_s;
  };
  const auto i_rate = [&](double yy) { return set_point_k - yy; };
  const int steps = static_cast<int>(simulated_settlings * steps_per_settling);
  for (int n = 0; n <= steps; ++n) {
    response.times_s.push_back(n * step);
    response.deviations_k.push_back(y);
    response.outputs.push_back(1 + output(y, integral));
    const double y1 = y_rate(y, integral), i1 = i_rate(y);
    const double y2 = y_rate(y + step / 2 * y1, integral + step / 2 * i1),
                 i2 = i_rate(y + step / 2 * y1);
    const double y3 = y_rate(y + step / 2 * y2, integral + step / 2 * i2),
                 i3 = i_rate(y + step / 2 * y2);
    const double y4 = y_rate(y + step * y3, integral + step * i3), i4 = i_rate(y + step * y3);
    y += step / 6 * (y1 + 2 * y2 + 2 * y3 + y4);
    integral += step / 6 * (i1 + 2 * i2 + 2 * i3 + i4);
  }
  return response;
}

/// The last time at which a deviation from `target` is more than `band`.
double settling_of(const LoopResponse& response, double target, double band) {
  for (std::size_t i = response.times_s.size(); i-- > 0;)
    if (std::abs(response.deviations_k[i] - target) > band) return response.times_s[i];
  return 0;
}

}  // namespace

LoopSettings tuned_loop(const Plant& plant, const LoopGoal& goal) {
  const auto require = [](bool is_right, const char* name, double value, const char* remedy) {
    if (!is_right)
      throw Error(Exit::bad_input, name, fmt::format("{:g} is out of range", value), remedy);
  };
  require(plant.gain_k > 0, "gain", plant.gain_k, "give a number above 0");
  require(plant.time_constant_s > 0, "time constant", plant.time_constant_s,
          "give a number above 0");
  require(goal.overshoot > 0 && goal.overshoot < 1, "overshoot", goal.overshoot,
          "give a part between 0 and 1");
  require(goal.settling_s > 0, "settling time", goal.settling_s, "give a number above 0");
  LoopSettings loop;
  const double log = std::log(goal.overshoot);
  loop.zeta = -log / std::hypot(std::numbers::pi, log);
  loop.omega_rad_s = unit_settling(loop.zeta, goal.band) / goal.settling_s;
  loop.ki_per_s = loop.omega_rad_s * loop.omega_rad_s * plant.time_constant_s / plant.gain_k;
  loop.kp = (2 * loop.zeta * loop.omega_rad_s * plant.time_constant_s - 1) / plant.gain_k;
  if (loop.kp < 0)
    throw Error(Exit::bad_input, "settling time",
                fmt::format("{:g} s is slower than the process itself, whose time constant is {:g} "
                            "s: Kp would be negative",
                            goal.settling_s, plant.time_constant_s),
                fmt::format("give at most {:.3g} s", goal.settling_s * 2 * loop.zeta *
                                                         loop.omega_rad_s * plant.time_constant_s));
  return loop;
}

LoopResponse set_point_step(const Plant& plant, const LoopSettings& loop, const LoopGoal& goal,
                            double step_k) {
  LoopResponse response = simulate(plant, loop, goal, step_k, 0);
  response.settling_s = settling_of(response, step_k, goal.band * std::abs(step_k));
  response.overshoot =
      *std::max_element(response.deviations_k.begin(), response.deviations_k.end()) / step_k - 1;
  return response;
}

LoopResponse absorption_step(const Plant& plant, const LoopSettings& loop, const LoopGoal& goal,
                             double part) {
  LoopResponse response = simulate(plant, loop, goal, 0, part);
  const auto [low, high] =
      std::minmax_element(response.deviations_k.begin(), response.deviations_k.end());
  const double first = std::max(std::abs(*low), std::abs(*high));
  response.settling_s = settling_of(response, 0, goal.band * first);
  response.overshoot = std::min(std::abs(*low), std::abs(*high)) / first;
  return response;
}

LoopResponse board_absorption_step(const Plant& plant, const LoopSettings& loop,
                                   const LoopGoal& goal, double part, const BoardLoop& board) {
  // $1065 and $1066 as they are delivered.
  constexpr double min_output = 0.5, max_output = 1.5;
  constexpr int steps_per_period = 10;
  constexpr double min_periods = 100;
  const double step = board.period_s / steps_per_period;
  const double kept = std::exp(-step / plant.time_constant_s);
  const double end_s =
      std::max(simulated_settlings * goal.settling_s, min_periods * board.period_s);
  std::deque<double> delayed(static_cast<std::size_t>(std::lround(board.delay_s / step)), 1.0);
  LoopResponse response;
  double y = 0, before = 0, output = 1;
  for (int n = 0; n * step < end_s; ++n) {
    if (n % steps_per_period == 0) {
      output -= loop.ki_per_s * board.period_s * y + loop.kp * (y - before);
      output = std::clamp(output, min_output, max_output);
      before = y;
    }
    response.times_s.push_back(n * step);
    response.deviations_k.push_back(y);
    response.outputs.push_back(output);
    delayed.push_back(output);
    const double target = plant.gain_k * (delayed.front() * (1 + part) - 1);
    delayed.pop_front();
    y = target + (y - target) * kept;
  }
  const auto [low, high] =
      std::minmax_element(response.deviations_k.begin(), response.deviations_k.end());
  const double first = std::max(std::abs(*low), std::abs(*high));
  response.settling_s = settling_of(response, 0, goal.band * first);
  if (response.settling_s > 0.9 * end_s)
    response.settling_s = std::numeric_limits<double>::infinity();
  response.overshoot = std::min(std::abs(*low), std::abs(*high)) / first;
  return response;
}

bool is_calm(const LoopResponse& response) {
  constexpr double max_overshoot = 0.25;
  return std::isfinite(response.settling_s) && response.overshoot <= max_overshoot;
}

std::optional<double> shortest_on_board(const Plant& plant, const LoopGoal& goal, double part,
                                        const BoardLoop& board) {
  constexpr double longer = 1.1;
  constexpr int max_tries = 100;
  LoopGoal tried = goal;
  for (int i = 0; i < max_tries; ++i, tried.settling_s *= longer) {
    try {
      const LoopSettings loop = tuned_loop(plant, tried);
      if (is_calm(board_absorption_step(plant, loop, tried, part, board))) return tried.settling_s;
    } catch (const Error&) {
      return std::nullopt;  // slower than the process
    }
  }
  return std::nullopt;
}

}  // namespace lamplock::thermal
