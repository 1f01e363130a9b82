#include "sim/world/lamp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "tests/scale.hpp"
#include "tests/world/recorder.hpp"

namespace lamplock::sim {
namespace {

using test::Change;
using test::Pulse;
using test::Recorder;

constexpr double us = static_cast<double>(ps_per_us);

/// A lamp after running for some time.
struct LampRun {
  LampRun(const LampConfig& config, double seconds) : lamp(config, bus) {
    lamp.advance(bus, static_cast<Picoseconds>(seconds * 1e12));
  }
  std::vector<Pulse> pulses() const { return test::pulses(recorder.changes); }
  PinBus bus;
  Recorder recorder{bus, {Pin::lamp_sync}};
  Lamp lamp;
};

TEST(Lamp, PerfectLampIsExactAfterHours) {
  // A period that is not a whole number of picoseconds.
  LampRun run({.frequency_hz = 30, .phase_us = 7}, 2 * 3600);
  const auto pulses = run.pulses();
  ASSERT_GT(pulses.size(), 215'000u);
  for (std::size_t n = 0; n < pulses.size(); ++n) {
    const auto exact = 7 * ps_per_us + static_cast<Picoseconds>(n) * ps_per_s / 30;
    ASSERT_NEAR(static_cast<double>(pulses[n].rise - exact), 0, 1.0) << n;
    ASSERT_EQ(pulses[n].width, 20 * ps_per_us);
  }
  EXPECT_EQ(run.lamp.flashes(), static_cast<std::int64_t>(pulses.size()));
}

TEST(Lamp, SameSeedSameFlashesOtherSeedOthers) {
  const LampConfig config{
      .jitter_us = 20, .wander = 0.01, .dropout = 0.05, .runt = 0.1, .doubled = 0.05, .seed = 42};
  LampConfig other = config;
  other.seed = 43;
  const LampRun a(config, 20), b(config, 20), c(other, 20);
  EXPECT_EQ(a.recorder.changes, b.recorder.changes);
  EXPECT_NE(a.recorder.changes, c.recorder.changes);
}

TEST(Lamp, SliceLengthDoesNotMatter) {
  const LampConfig config{.jitter_us = 20, .runt = 0.5, .doubled = 0.3};
  LampRun whole(config, 3);
  PinBus bus;
  Recorder recorder(bus, {Pin::lamp_sync});
  Lamp lamp(config, bus);
  for (Picoseconds t = 0; t <= 3 * ps_per_s; t += 1'234'567'891) {
    lamp.advance(bus, t);
    ASSERT_GT(lamp.next_event(), t);
  }
  lamp.advance(bus, 3 * ps_per_s);
  EXPECT_EQ(recorder.changes, whole.recorder.changes);
}

TEST(Lamp, JitterIsUniformAndDoesNotAccumulate) {
  LampRun run({.frequency_hz = 200, .jitter_us = 20, .phase_us = 100},
              200.0 * lamplock::test::scaled(1));
  const auto pulses = run.pulses();
  double sum = 0, squares = 0, least = 1e9, most = -1e9;
  for (std::size_t n = 0; n < pulses.size(); ++n) {
    const double ideal = 100 * us + 5000 * us * static_cast<double>(n);
    const double e = (static_cast<double>(pulses[n].rise) - ideal) / us;
    ASSERT_LE(std::abs(e), 20.001) << n;
    sum += e;
    squares += e * e;
    least = std::min(least, e);
    most = std::max(most, e);
  }
  const auto n = static_cast<double>(pulses.size());
  EXPECT_LT(std::abs(sum / n), 5 * 11.55 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 20 / std::sqrt(3.0), 0.3);
  EXPECT_LT(least, -19.5);
  EXPECT_GT(most, 19.5);
}

TEST(Lamp, WanderIsASineOfTheGivenSizeAndPeriod) {
  LampRun run({.frequency_hz = 100, .wander = 0.01, .wander_period_s = 10}, 30);
  const auto pulses = run.pulses();
  double least = 1e9, most = 0;
  for (std::size_t n = 0; n + 1 < pulses.size(); ++n) {
    const double period = static_cast<double>(pulses[n + 1].rise - pulses[n].rise) / us;
    const double t = static_cast<double>(pulses[n].rise) / 1e12;
    ASSERT_NEAR(period, 10'000 * (1 + 0.005 * std::sin(2 * std::numbers::pi * t / 10)), 0.001);
    least = std::min(least, period);
    most = std::max(most, period);
  }
  EXPECT_NEAR(most - least, 100, 0.1);  // 1 % of 10 ms, peak to peak
}

TEST(Lamp, DropoutsAreMissingFlashesWithoutAShiftOfTheOthers) {
  LampRun run({.frequency_hz = 100, .dropout = 0.1}, 300.001);
  const auto pulses = run.pulses();
  EXPECT_NEAR(static_cast<double>(pulses.size()), 27'000, 5 * std::sqrt(30'000 * 0.09));
  EXPECT_EQ(run.lamp.flashes(), static_cast<std::int64_t>(pulses.size()));
  EXPECT_EQ(run.lamp.periods(), 30'001);
  for (const Pulse& pulse : pulses) ASSERT_EQ(pulse.rise % (10 * ps_per_ms), 0);
}

TEST(Lamp, RuntsAreShortAnywhereInThePeriodAndAreNotFlashes) {
  LampRun run({.frequency_hz = 100, .jitter_us = 20, .runt = 0.3}, 300.001);
  std::int64_t runts = 0, flashes = 0;
  double earliest = 1, latest = 0;
  Picoseconds end_before = -ps_per_s;
  for (const Pulse& pulse : run.pulses()) {
    ASSERT_GE(pulse.rise - end_before, 500 * ps_per_ns);
    end_before = pulse.rise + pulse.width;
    if (pulse.width == 20 * ps_per_us) {
      ++flashes;
      continue;
    }
    ++runts;
    ASSERT_GE(pulse.width, 200 * ps_per_ns);
    ASSERT_LE(pulse.width, 1900 * ps_per_ns);
    const double phase = static_cast<double>(pulse.rise % (10 * ps_per_ms)) / (10'000 * us);
    earliest = std::min(earliest, phase);
    latest = std::max(latest, phase);
  }
  EXPECT_EQ(run.lamp.flashes(), flashes);
  EXPECT_NEAR(static_cast<double>(runts), 9'000, 5 * std::sqrt(30'000 * 0.21));
  EXPECT_LT(earliest, 0.01);
  EXPECT_GT(latest, 0.99);
}

TEST(Lamp, RuntsDoNotShiftTheFlashes) {
  const LampConfig plain{.jitter_us = 20, .dropout = 0.1};
  LampConfig noisy = plain;
  noisy.runt = 0.7;
  const LampRun a(plain, 20), b(noisy, 20);
  std::vector<Picoseconds> clean, cleaned;
  for (const Pulse& pulse : a.pulses()) clean.push_back(pulse.rise);
  for (const Pulse& pulse : b.pulses())
    if (pulse.width > 2 * ps_per_us) cleaned.push_back(pulse.rise);
  EXPECT_EQ(clean, cleaned);
}

TEST(Lamp, DoubledEdgesAreFullPulsesAndCountOnce) {
  LampRun run({.frequency_hz = 100, .doubled = 0.25}, 100);
  std::int64_t echoes = 0;
  double earliest = 1e9, latest = 0;
  for (const Pulse& pulse : run.pulses()) {
    ASSERT_GT(pulse.width, 2 * ps_per_us);
    const Picoseconds after = pulse.rise % (10 * ps_per_ms);
    if (after == 0) continue;
    ++echoes;
    ASSERT_GE(after, 3 * ps_per_us);
    ASSERT_LE(after, 200 * ps_per_us);
    ASSERT_EQ(pulse.width, 20 * ps_per_us);
    earliest = std::min(earliest, static_cast<double>(after) / us);
    latest = std::max(latest, static_cast<double>(after) / us);
  }
  EXPECT_NEAR(static_cast<double>(echoes), 2'500, 5 * std::sqrt(10'000 * 0.19));
  EXPECT_LT(earliest, 6);
  EXPECT_GT(latest, 195);
  EXPECT_EQ(run.lamp.flashes(), 10'001);
}

TEST(Lamp, IsDarkUntilSwitchedOn) {
  LampRun run({.frequency_hz = 50, .phase_us = 5, .on_after_s = 2.5}, 3);
  EXPECT_EQ(run.pulses().front().rise, 2'500 * ps_per_ms + 5 * ps_per_us);
}

TEST(Lamp, FindsTheFlashBeforeATime) {
  LampRun run({.frequency_hz = 100, .phase_us = 1000}, 1);
  EXPECT_EQ(run.lamp.flash_before(995 * ps_per_ms).number, 100);
  EXPECT_EQ(run.lamp.flash_before(991 * ps_per_ms).at, 991 * ps_per_ms);
  EXPECT_EQ(run.lamp.flash_before(991 * ps_per_ms - 1).number, 99);
  EXPECT_EQ(run.lamp.flash_before(0).number, 0);
}

TEST(Lamp, TriggeredLampFlashesAtTheTrigger) {
  PinBus bus;
  Recorder recorder(bus, {Pin::lamp_sync});
  Lamp lamp({.triggered = true}, bus);
  EXPECT_EQ(lamp.next_event(), never);
  std::vector<Picoseconds> triggers;
  for (int n = 0; n < 100; ++n) {
    const Picoseconds at = n * 9'876'543'210 + 17;
    lamp.advance(bus, at);
    bus.set(Pin::lamp_trigger, true, at);
    ASSERT_TRUE(bus.level(Pin::lamp_sync));
    bus.set(Pin::lamp_trigger, false, at + 50 * ps_per_us);
    triggers.push_back(at);
  }
  lamp.advance(bus, 2 * ps_per_s);
  std::vector<Picoseconds> edges;
  for (const Pulse& pulse : test::pulses(recorder.changes)) {
    edges.push_back(pulse.rise);
    EXPECT_EQ(pulse.width, 20 * ps_per_us);
  }
  EXPECT_EQ(edges, triggers);
  EXPECT_EQ(lamp.flashes(), 100);
}

TEST(Lamp, TriggeredLampDropsFlashesAndIsDarkBeforeItsFirstTrigger) {
  PinBus bus;
  Lamp lamp({.dropout = 0.2, .on_after_s = 10, .triggered = true}, bus);
  for (int n = 0; n < 11'000; ++n) {
    const Picoseconds at = n * (10 * ps_per_ms);
    lamp.advance(bus, at);
    bus.set(Pin::lamp_trigger, true, at);
    bus.set(Pin::lamp_trigger, false, at + ps_per_us);
  }
  EXPECT_EQ(lamp.periods(), 10'000);
  EXPECT_NEAR(static_cast<double>(lamp.flashes()), 8'000, 5 * std::sqrt(10'000 * 0.16));
}

TEST(Lamp, RefusesInvalidLamps) {
  PinBus bus;
  const auto make = [&bus](const LampConfig& config) { Lamp lamp(config, bus); };
  EXPECT_THROW(make({.frequency_hz = 0}), std::invalid_argument);
  EXPECT_THROW(make({.frequency_hz = -100}), std::invalid_argument);
  EXPECT_THROW(make({.frequency_hz = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(make({.jitter_us = 5000}), std::invalid_argument);
  EXPECT_THROW(make({.dropout = 1.5}), std::invalid_argument);
  EXPECT_THROW(make({.pulse_us = 9000}), std::invalid_argument);
  EXPECT_NO_THROW(make({.dropout = 1}));
}

}  // namespace
}  // namespace lamplock::sim
