#include "sim/world/servo.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lamplock::sim {
namespace {

/// Deviation from the command and its rate of change.
struct Motion {
  double way, rate;
};

/// T e' + e = 0; the error determines the rate.
Motion first_order(double way, double t, double time_constant) {
  const double left = way * std::exp(-t / time_constant);
  return {left, -left / time_constant};
}

/// e'' + 2 D w e' + w^2 e = 0, below, at and above the critical damping.
Motion second_order(Motion begin, double t, double w, double damping) {
  const double d = damping * w;
  if (damping < 1) {
    const double wd = w * std::sqrt(1 - damping * damping);
    const double fade = std::exp(-d * t), c = std::cos(wd * t), s = std::sin(wd * t);
    return {fade * (begin.way * c + (begin.rate + d * begin.way) / wd * s),
            fade * (begin.rate * c - (w * w * begin.way + d * begin.rate) / wd * s)};
  }
  if (damping == 1) {
    const double fade = std::exp(-w * t), slope = begin.rate + w * begin.way;
    return {fade * (begin.way + slope * t), fade * (begin.rate - w * slope * t)};
  }
  const double root = w * std::sqrt(damping * damping - 1);
  const double slow = -d + root, fast = -d - root;
  const double a = (begin.rate - fast * begin.way) / (slow - fast);
  const double b = begin.way - a;
  const double first = a * std::exp(slow * t), second = b * std::exp(fast * t);
  return {first + second, slow * first + fast * second};
}

void check(const ServoConfig& c) {
  if (!(c.steps_per_rev > 0 && c.counts_per_rev > 0 && c.mm_per_rev > 0))
    throw std::invalid_argument(
        "steps, counts and travel per revolution of a servo must be positive");
  if (!(c.time_constant_ms > 0 && c.time_constant_ms < 1e6))
    throw std::invalid_argument("time constant of a servo out of range");
  if (c.order != 1 && c.order != 2)
    throw std::invalid_argument("a servo is of first or second order");
  if (!(c.damping > 0 && c.damping < 100))
    throw std::invalid_argument("damping of a servo out of range");
}

}  // namespace

Servo::Servo(const ServoConfig& config, int axis, Drives& drives) : config_(config) {
  check(config);
  const double start = drives.position()[index(axis)];
  states_.push_back({0, start, 0, 0});
  drives.listen(axis, *this);
}

void Servo::load_moves(int /*axis*/, std::int32_t place, Picoseconds at) {
  State next = after(states_.back(), at);
  next.lag += place - next.command;
  next.command = place;
  states_.push_back(next);
}

const Servo::State& Servo::state_before(Picoseconds at) const {
  const auto next = std::upper_bound(states_.begin(), states_.end(), at,
                                     [](Picoseconds t, const State& s) { return t < s.at; });
  return next == states_.begin() ? states_.front() : *std::prev(next);
}

/// The state at a later time under the same command.
Servo::State Servo::after(const State& state, Picoseconds at) const {
  const double t = seconds(std::max<Picoseconds>(0, at - state.at));
  const double time_constant = config_.time_constant_ms / 1000;
  const Motion begin{-state.lag, state.speed};
  const Motion end = config_.order == 1
                         ? first_order(begin.way, t, time_constant)
                         : second_order(begin, t, 1 / time_constant, config_.damping);
  return {at, state.command, -end.way, end.rate};
}

double Servo::load_at(Picoseconds at) const {
  const State state = after(state_before(at), at);
  return state.command - state.lag;
}

std::int64_t Servo::counts_at(Picoseconds at) const {
  const double counts = load_at(at) / config_.steps_per_rev * config_.counts_per_rev;
  return static_cast<std::int64_t>(std::floor(counts + 0.5));
}

double Servo::encoder_mm_at(Picoseconds at) const {
  return static_cast<double>(counts_at(at)) / config_.counts_per_rev * config_.mm_per_rev;
}

}  // namespace lamplock::sim
