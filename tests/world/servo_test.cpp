#include "sim/world/servo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "sim/world/world.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim {
namespace {

struct Kick {
  Picoseconds at;
  int way;
};

void step(PinBus& bus, int way, Picoseconds at) {
  bus.set(Pin::dir_x, way < 0, at - 400 * ps_per_ns);
  bus.set(Pin::step_x, true, at);
  bus.set(Pin::step_x, false, at + 500 * ps_per_ns);
}

/// Response of the load to one step, t after it: closed forms from the textbook.
double answer(const ServoConfig& c, double t) {
  if (t < 0) return 0;
  const double u = t / (c.time_constant_ms / 1000), d = c.damping;
  if (c.order == 1) return 1 - std::exp(-u);
  if (d == 1) return 1 - std::exp(-u) * (1 + u);
  if (d < 1) {
    const double w = std::sqrt(1 - d * d);
    return 1 - std::exp(-d * u) * (std::cos(w * u) + d / w * std::sin(w * u));
  }
  const double w = std::sqrt(d * d - 1), slow = d - w, fast = d + w;
  return 1 - (fast * std::exp(-slow * u) - slow * std::exp(-fast * u)) / (2 * w);
}

TEST(Servo, FollowsAsTheSumOfItsStepResponses) {
  // The system is linear: random steps, and the sum of the responses to each of them.
  std::mt19937_64 random(2);
  for (const ServoConfig& config :
       {ServoConfig{.order = 1, .time_constant_ms = 3}, ServoConfig{.time_constant_ms = 4},
        ServoConfig{.time_constant_ms = 4, .damping = 0.3},
        ServoConfig{.time_constant_ms = 2, .damping = 1.7}}) {
    PinBus bus;
    World world({.drives = {.lag_us = {125, 0, 0, 0}, .start = {40, 0, 0, 0}}, .servos = {config}},
                bus);
    std::vector<Kick> kicks;
    Picoseconds at = ps_per_ms;
    for (int n = 0; n < 300; ++n) {
      at += static_cast<Picoseconds>(1 + random() % 2000) * ps_per_us;
      kicks.push_back({at, random() % 3 == 0 ? -1 : 1});
      step(bus, kicks.back().way, at);
    }
    const Servo& servo = *world.servo(0);
    for (int n = 0; n < 500; ++n) {
      const auto t = static_cast<Picoseconds>(random() % static_cast<std::uint64_t>(at * 11 / 10));
      double load = 40, command = 40;
      for (const Kick& kick : kicks) {
        const Picoseconds since = t - kick.at - 125 * ps_per_us;
        load += kick.way * answer(config, seconds(since));
        if (since >= 0) command += kick.way;
      }
      ASSERT_NEAR(servo.load_at(t), load, 1e-9) << config.order << ' ' << config.damping;
      ASSERT_EQ(servo.command_at(t), command);
      ASSERT_NEAR(servo.following_error_at(t), command - load, 1e-9);
      const double counts = load * 4;  // 2048 counts, 512 steps a revolution
      ASSERT_LE(std::abs(static_cast<double>(servo.counts_at(t)) - counts), 0.5 + 1e-6);
      ASSERT_LE(std::abs(servo.encoder_mm_at(t) - load * 78 / 512), 78.0 / 4096 + 1e-9);
    }
  }
}

TEST(Servo, LagsARampByItsTimeConstants) {
  // At constant speed v the load lags its command by v T (first order), or v 2 D T (second), on the
  // average over a step, since the command is a staircase.
  struct Row {
    ServoConfig config;
    double error_s;
  };
  for (const Row& row : {Row{{.order = 1, .time_constant_ms = 5}, 0.005},
                         Row{{.order = 2, .time_constant_ms = 5, .damping = 0.8}, 0.008}}) {
    PinBus bus;
    World world({.servos = {row.config}}, bus);
    constexpr Picoseconds period = 500 * ps_per_us;  // 2000 steps/s
    for (int n = 1; n <= 1000; ++n) step(bus, 1, n * period);
    double sum = 0;
    constexpr int parts = 100;
    for (int n = 0; n < parts; ++n)
      sum += world.servo(0)->following_error_at(900 * period + (2 * n + 1) * period / (2 * parts));
    EXPECT_NEAR(sum / parts, 2000 * row.error_s, 1e-3);
    EXPECT_NEAR(world.servo(0)->load_at(2 * ps_per_s), 1000, 1e-9);
    EXPECT_EQ(world.servo(0)->counts_at(2 * ps_per_s), 4000);
    EXPECT_DOUBLE_EQ(world.servo(0)->encoder_mm_at(2 * ps_per_s), 1000 * 78.0 / 512);
  }
}

TEST(Servo, ReadingChangesNothing) {
  const auto run = [](bool ask) {
    PinBus bus;
    World world({.servos = {ServoConfig{.damping = 0.5}}}, bus);
    double sum = 0;
    for (int n = 1; n <= 500; ++n) {
      step(bus, n % 7 == 0 ? -1 : 1, n * 300 * ps_per_us);
      for (int k = 0; k < 5 && ask; ++k)
        sum += world.servo(0)->load_at((n * 300 + k * 50) * ps_per_us);
    }
    EXPECT_EQ(ask, sum != 0);
    return world.servo(0)->load_at(123'456'789'012);
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(Servo, ExistsOnlyWhereConfigured) {
  PinBus bus;
  World world({.drives = {.start = {0, -7, 0, 0}}, .servos = {std::nullopt, ServoConfig{}}}, bus);
  EXPECT_EQ(world.servo(0), nullptr);
  ASSERT_NE(world.servo(1), nullptr);
  EXPECT_EQ(world.servo(1)->load_at(ps_per_s), -7);
  EXPECT_EQ(world.servo(1)->counts_at(ps_per_s), -28);
}

TEST(Servo, RefusesInvalidConfigurations) {
  for (const ServoConfig& config :
       {ServoConfig{.steps_per_rev = 0}, ServoConfig{.order = 3},
        ServoConfig{.time_constant_ms = 0}, ServoConfig{.damping = -1}}) {
    PinBus bus;
    EXPECT_THROW(World({.servos = {config}}, bus), std::invalid_argument);
  }
}

}  // namespace
}  // namespace lamplock::sim
