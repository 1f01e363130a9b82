// The beat clock with simulated lamps.
#include "firmware/lamp/beat_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "firmware/lamp/shot_delay.hpp"
#include "tests/lamp/lamp_model.hpp"
#include "tests/scale.hpp"

namespace lamplock::lamp::beat_clock_test {
namespace {

using settings::Id;
using test::ClockBench;
using test::lamp_edges;
using test::LampEdge;
using test::LampSpec;

constexpr std::uint64_t ever = ~std::uint64_t{0};

settings::Values lamp_settings(double hz, settings::LampMode mode = settings::LampMode::slave) {
  settings::Values values;
  values.set_milli(Id::lamp_frequency, static_cast<std::int32_t>(std::lround(hz * 1000)));
  values.set_milli(Id::lamp_mode, static_cast<std::int32_t>(mode) * 1000);
  return values;
}

std::int64_t delay_clocks(const settings::Values& values) {
  return lamp::shot_delay_clocks(values.milli(Id::q_switch_delay));
}

std::uint64_t clocks(double seconds) { return static_cast<std::uint64_t>(seconds * clock_hz); }

/// Every edge that was assigned to a beat after the lattice had settled.
struct Judged {
  LampEdge edge;
  EdgeInfo info;
};

/// rms and largest distance of lattice ticks from edge + delay, us.
struct LatticeErrors {
  double rms_us = 0, worst_us = 0;
  std::size_t edges = 0;
};

LatticeErrors lattice_errors(const ClockBench& bench, const std::vector<Judged>& judged,
                             std::int64_t delay) {
  LatticeErrors e;
  for (const Judged& j : judged) {
    const std::uint64_t lattice = bench.time_of_beat(j.info.beat);
    if (lattice == 0) continue;
    const double off = static_cast<double>(static_cast<std::int64_t>(lattice) - delay -
                                           static_cast<std::int64_t>(j.edge.clock)) /
                       clocks_per_us;
    e.rms_us += off * off;
    e.worst_us = std::max(e.worst_us, std::fabs(off));
    ++e.edges;
  }
  e.rms_us = std::sqrt(e.rms_us / static_cast<double>(std::max<std::size_t>(1, e.edges)));
  return e;
}

TEST(BeatClock, FollowsAWanderingJitteringLamp) {
  std::mt19937_64 random(71);
  for (const double hz : {20.0, 50.0, 100.0, 200.0}) {
    double worst = 0, rms = 0;
    const int lamps = test::scaled(4);
    for (int i = 0; i < lamps; ++i) {
      const settings::Values values = lamp_settings(hz);
      BeatClock clock;
      clock.configure(values);
      ClockBench bench(clock);
      const LampSpec lamp{hz, 0.01, 10, 20, 0, 0};
      std::vector<Judged> judged;
      std::optional<double> settled_s;
      bench.run(lamp_edges(lamp, 0.0123, 40, random), clocks(40),
                [&](const LampEdge& edge, const EdgeInfo& info) {
                  if (clock.settled() && !settled_s) {
                    settled_s = static_cast<double>(edge.clock) / clock_hz;
                    clock.set_motion_end(ever);  // after this the slew limit applies
                  }
                  if (!settled_s) return;
                  EXPECT_TRUE(info.valid);
                  if (info.valid) judged.push_back({edge, info});
                });
      ASSERT_TRUE(settled_s.has_value()) << hz << " Hz";
      EXPECT_LT(*settled_s, 30 / hz) << "settled late at " << hz << " Hz";
      EXPECT_TRUE(clock.locked());
      EXPECT_EQ(clock.lock_losses(), 0u);
      const LatticeErrors e = lattice_errors(bench, judged, delay_clocks(values));
      ASSERT_GT(static_cast<double>(e.edges), 39 * hz - 40);
      worst = std::max(worst, e.worst_us);
      rms = std::max(rms, e.rms_us);
    }
    std::cout << "lamp " << hz
              << " Hz, period wanders 1 % in 10 s, edges +-20 us: lattice off by rms " << rms
              << " us, worst " << worst << " us\n";
    RecordProperty("worst_us_at_" + std::to_string(static_cast<int>(hz)) + "_hz",
                   std::to_string(worst));
    EXPECT_LT(worst, 120) << hz << " Hz";
    EXPECT_LT(rms, 40) << hz << " Hz";
  }
}

TEST(BeatClock, PutsTheLatticeOnTheEdgesOfAnIdealLamp) {
  std::mt19937_64 random(72);
  for (const double hz : {1.0, 20.0, 97.3, 100.0, 1000.0, 4000.0}) {
    const settings::Values values = lamp_settings(hz);
    BeatClock clock;
    clock.configure(values);
    ClockBench bench(clock);
    // 0.7 % off its nominal frequency; a period of whole clocks, so that the edges are exact.
    const double period = std::round(clock_hz / (hz * 1.007));
    const LampSpec lamp{clock_hz / period, 0, 10, 0, 0, 0};
    const double seconds = std::max(2.0, 60 / hz);
    std::vector<Judged> judged;
    bench.run(lamp_edges(lamp, 0.01, seconds, random), clocks(seconds),
              [&](const LampEdge& edge, const EdgeInfo& info) {
                if (static_cast<double>(edge.clock) < 0.5 * seconds * clock_hz) return;
                clock.set_motion_end(ever);
                EXPECT_TRUE(info.valid);
                judged.push_back({edge, info});
              });
    const LatticeErrors e = lattice_errors(bench, judged, delay_clocks(values));
    EXPECT_GT(e.edges, 20u);
    EXPECT_LE(e.worst_us * clocks_per_us, 2) << hz << " Hz";
  }
}

TEST(BeatClock, NumbersBeatsWithoutSkippingOrRepeating) {
  std::mt19937_64 random(73);
  for (int i = 0; i < test::scaled(10); ++i) {
    const double hz = i % 2 == 0 ? 100 : 50;
    BeatClock clock;
    clock.configure(lamp_settings(hz));
    ClockBench bench(clock);
    const LampSpec lamp{hz, 0.01, 10, 20, 0.05, 0.05};
    const std::vector<LampEdge> edges = lamp_edges(lamp, 0.01, 20, random);
    std::optional<Judged> last;
    std::uint64_t missed = 0, drops = 0;
    std::uint32_t doubles = 0, spurious_at_lock = 0;
    bench.run(edges, clocks(20.1), [&](const LampEdge& edge, const EdgeInfo& info) {
      if (!last && !info.valid) {
        spurious_at_lock = clock.spurious();
        return;
      }
      if (edge.extra) {
        ++doubles;
        EXPECT_FALSE(info.valid) << "a second edge taken for a beat";
        return;
      }
      ASSERT_TRUE(info.valid) << "flash " << edge.flash;
      if (last) {
        const auto flashes = static_cast<std::uint64_t>(edge.flash - last->edge.flash);
        ASSERT_EQ(info.beat - last->info.beat, flashes) << "flash " << edge.flash;
        ASSERT_EQ(info.missed, flashes - 1) << "flash " << edge.flash;
        missed += info.missed;
        drops += flashes - 1;
      }
      last = Judged{edge, info};
    });
    EXPECT_EQ(missed, drops);
    EXPECT_GT(drops, 10u);
    EXPECT_GT(doubles, 10u);
    EXPECT_EQ(clock.spurious() - spurious_at_lock, doubles);
    EXPECT_EQ(clock.lock_losses(), 0u);
    EXPECT_EQ(clock.edges(), edges.size());
    EXPECT_TRUE(bench.gapless());
  }
}

TEST(BeatClock, NeverPutsATickMoreThanAQuarterOffItsNominalLength) {
  // A lamp as far from nominal as allowed, which the lattice catches up with at rest.
  std::mt19937_64 random(78);
  for (int i = 0; i < test::scaled(40); ++i) {
    settings::Values values = lamp_settings(100);
    values.set_milli(Id::lock_range, settings::row(Id::lock_range).max_milli);
    BeatClock clock;
    clock.configure(values);
    ClockBench bench(clock);
    const double hz = i % 2 == 0 ? 109.5 : 91.5;
    const double start_s = std::uniform_real_distribution<double>(0.001, 0.02)(random);
    bench.run(lamp_edges({hz, 0, 10, 0, 0, 0}, start_s, 1, random), clocks(1), {},
              [&](const TickSpan& span) {
                const std::uint32_t nominal = span.ticks * clocks_per_tick;
                ASSERT_GE(span.clocks, nominal * 3 / 4) << hz << " Hz, " << span.ticks << " ticks";
                ASSERT_LE(span.clocks, nominal * 5 / 4 + 1)
                    << hz << " Hz, " << span.ticks << " ticks";
              });
    EXPECT_TRUE(clock.settled()) << hz << " Hz from " << start_s << " s";
  }
}

TEST(BeatClock, LosesTheLockOutsideItsRangeAndRegainsItInside) {
  std::mt19937_64 random(74);
  BeatClock clock;
  clock.configure(lamp_settings(100));  // lock range 3 %
  ClockBench bench(clock);
  std::vector<LampEdge> edges = lamp_edges({100, 0, 10, 5, 0, 0}, 0.01, 3, random);
  const auto follow = [&](double hz) {
    const double start = static_cast<double>(edges.back().clock) / clock_hz + 1 / hz;
    const auto more = lamp_edges({hz, 0, 10, 5, 0, 0}, start, 3, random, edges.back().flash + 1);
    edges.insert(edges.end(), more.begin(), more.end());
  };
  follow(106);  // 6 % above nominal: outside
  follow(98);   // inside
  bool locked_far_out = false, locked_first = false;
  std::vector<Judged> judged;
  bench.run(edges, edges.back().clock, [&](const LampEdge& edge, const EdgeInfo& info) {
    const double t = static_cast<double>(edge.clock) / clock_hz;
    if (t > 2 && t < 3) locked_first = clock.locked();
    if (t > 4 && t < 5.9) {
      locked_far_out = locked_far_out || clock.locked() || info.valid;
      EXPECT_FALSE(clock.settled());
    }
    if (t > 7.5) {
      EXPECT_TRUE(info.valid);
      judged.push_back({edge, info});
    }
  });
  EXPECT_TRUE(locked_first);
  EXPECT_FALSE(locked_far_out);
  EXPECT_GE(clock.lock_losses(), 1u);
  EXPECT_TRUE(clock.locked());
  EXPECT_TRUE(bench.gapless());
  EXPECT_LT(lattice_errors(bench, judged, 5 * clocks_per_us).worst_us, 25);
  for (std::size_t i = 1; i < judged.size(); ++i)
    ASSERT_EQ(judged[i].info.beat, judged[i - 1].info.beat + 1);
}

TEST(BeatClock, LosesTheLockWhenTheLampStops) {
  std::mt19937_64 random(75);
  BeatClock clock;
  clock.configure(lamp_settings(100));
  ClockBench bench(clock);
  std::vector<LampEdge> edges = lamp_edges({100, 0, 10, 20, 0, 0}, 0.01, 1, random);
  bench.run(edges, clocks(1.2), {});
  EXPECT_TRUE(clock.locked());  // 20 beats of silence are bridged
  bench.run({}, clocks(2), {});
  EXPECT_FALSE(clock.locked());
  EXPECT_EQ(clock.lock_losses(), 1u);
  edges = lamp_edges({100.9, 0, 10, 20, 0, 0}, 2.003, 1, random);
  bench.run(edges, clocks(3), {});
  EXPECT_TRUE(clock.locked());
  EXPECT_TRUE(clock.settled());
}

TEST(BeatClock, NeverPassesTheSlewLimitWhileMoving) {
  // A lamp of exact period whose phase the lattice has not yet reached when motion begins.
  std::mt19937_64 random(76);
  for (int i = 0; i < test::scaled(20); ++i) {
    settings::Values values = lamp_settings(100);
    const std::int32_t slew_milli = 10 + static_cast<std::int32_t>(random() % 990);
    ASSERT_TRUE(values.set_milli(Id::slew_limit, slew_milli));
    const double slew = slew_milli / 1e5;
    BeatClock clock;
    clock.configure(values);
    ClockBench bench(clock);
    const double period = 1.25e6 + static_cast<double>(random() % 20'000);
    const double tick = period / clock.beat_ticks();
    const double start = static_cast<double>(random() % 10'000) * 1e-6;
    bool at_the_limit = false;
    std::uint64_t checked = 0;
    std::uint32_t promised = 0;
    bench.run(
        lamp_edges({clock_hz / period, 0, 10, 0, 0, 0}, start, 5, random), clocks(5),
        [&](const LampEdge&, const EdgeInfo&) {
          if (!clock.locked()) return;
          clock.set_motion_end(ever);
          if (promised != 0) return;
          promised = clock.min_tick_q16(5 * ticks_per_second);
          clock.set_min_tick(0, promised);
        },
        [&](const TickSpan& span) {
          if (!clock.locked() || checked++ == 0) return;
          const double even = tick * span.ticks;
          EXPECT_LE(std::fabs(span.clocks - even), even * slew + 1.01);
          if (std::fabs(span.clocks - even) > even * slew * 0.9 && even * slew > 20)
            at_the_limit = true;
          // The limit given to the planner: no tick is shorter.
          EXPECT_GE(span.clocks + 1.01, span.ticks * double{clocks_per_tick} * promised / 65536);
        });
    EXPECT_GT(checked, 100u);
    if (slew > 0.005) {
      EXPECT_TRUE(at_the_limit) << "the limit was never needed";
    }
  }
}

TEST(BeatClock, ShortestTickHoldsWhileTheLampWanders) {
  std::mt19937_64 random(77);
  BeatClock clock;
  clock.configure(lamp_settings(50));
  ClockBench bench(clock);
  std::uint32_t promised = 65536, checked = 0;
  bench.run(
      lamp_edges({50, 0.01, 10, 20, 0.02, 0}, 0.01, 60, random), clocks(60),
      [&](const LampEdge&, const EdgeInfo&) {
        if (clock.settled()) clock.set_motion_end(ever);
        promised = clock.min_tick_q16(32 * clock.beat_ticks());
      },
      [&](const TickSpan& span) {
        if (!clock.locked() || span.first_tick < 1'000'000) return;
        ++checked;
        EXPECT_GE(span.clocks + 1.01, span.ticks * double{clocks_per_tick} * promised / 65536);
      });
  EXPECT_GT(checked, 1'000u);
}

TEST(BeatClock, ShortestTickFallsWithTheDriftToTheEndOfTheLockRange) {
  // The largest drift at the slowest lamps: more than a whole period in the planned window.
  for (std::int32_t milli_hz = 1000; milli_hz <= 10'000; milli_hz += 1) {
    settings::Values values = lamp_settings(1);
    ASSERT_TRUE(values.set_milli(settings::Id::lamp_frequency, milli_hz));
    ASSERT_TRUE(values.set_milli(settings::Id::lamp_drift, 10'000));
    BeatClock clock;
    clock.configure(values);
    const double range = values.milli(settings::Id::lock_range) / 100'000.0;
    const double slew = values.milli(settings::Id::slew_limit) / 100'000.0;
    ASSERT_NEAR(clock.min_tick_q16(32 * clock.beat_ticks()), 65536 * (1 - range) * (1 - slew / 8),
                2)
        << milli_hz;
  }
}

TEST(BeatClock, TicksAreExactWithoutALampToFollow) {
  for (const auto mode : {settings::LampMode::master, settings::LampMode::free_beat}) {
    std::mt19937_64 random(78);
    const settings::Values values = lamp_settings(100, mode);
    BeatClock clock;
    clock.configure(values);
    EXPECT_TRUE(clock.locked());
    EXPECT_TRUE(clock.settled());
    EXPECT_EQ(clock.min_tick_q16(clock.beat_ticks()), 65536u);
    ClockBench bench(clock);
    // A lamp that follows our trigger: its edges precede the lattice ticks by the delay.
    const std::int64_t delay = delay_clocks(values);
    std::vector<LampEdge> edges;
    for (long k = 5; k < 300; ++k) {
      if (k % 17 == 0) continue;  // did not flash
      const std::int64_t lattice = k * std::int64_t{clock.beat_ticks()} * clocks_per_tick;
      edges.push_back({static_cast<std::uint64_t>(lattice - delay), k, false});
      if (k % 29 == 0) edges.push_back({edges.back().clock + 30 * clocks_per_us, k, true});
    }
    std::uint64_t first_beat = 0;
    std::uint32_t extras = 0;
    long last = 0;
    bench.run(
        edges, clocks(2.9),
        [&](const LampEdge& edge, const EdgeInfo& info) {
          if (edge.extra) {
            ++extras;
            EXPECT_FALSE(info.valid);
            return;
          }
          ASSERT_TRUE(info.valid);
          if (first_beat == 0) first_beat = info.beat - 5;
          ASSERT_EQ(info.beat, first_beat + static_cast<std::uint64_t>(edge.flash));
          ASSERT_EQ(info.missed,
                    last == 0 ? 0u : static_cast<std::uint32_t>(edge.flash - last - 1));
          last = edge.flash;
        },
        [&](const TickSpan& span) {
          ASSERT_EQ(span.clocks, span.ticks * clocks_per_tick);
          ASSERT_EQ(span.first_clock, span.first_tick * clocks_per_tick);
        });
    EXPECT_GT(last, 250);
    EXPECT_EQ(clock.spurious(), extras);
    EXPECT_TRUE(bench.gapless());
  }
}

TEST(BeatClock, AsMasterTicksHaveTheRequestedLength) {
  std::mt19937_64 random(80);
  for (int i = 0; i < test::scaled(40); ++i) {
    const double hz = std::exp(std::uniform_real_distribution<double>(0, std::log(5000))(random));
    settings::Values values = lamp_settings(hz, settings::LampMode::master);
    const auto tolerance_milli = static_cast<std::int32_t>(random() % 10'001);
    ASSERT_TRUE(values.set_milli(Id::period_tolerance, tolerance_milli));
    const std::int32_t delay_ns = i % 3 == 0 ? 20'000 : 2'220;
    ASSERT_TRUE(values.set_milli(Id::q_switch_delay, delay_ns));
    BeatClock clock;
    clock.configure(values);
    const double shot_ns = lamp::shot_delay_clocks(delay_ns) * 1000.0 / clocks_per_us;
    SCOPED_TRACE(testing::Message() << hz << " Hz, " << tolerance_milli << ", " << delay_ns);
    const double most = clock.max_tick_q16() / 65536.0 - 1;
    EXPECT_LE(most, tolerance_milli / 1e5);
    EXPECT_LE(most * shot_ns, 1000.0);
    EXPECT_GE(most + 0.0001, std::min(tolerance_milli / 1e5, 1000.0 / shot_ns));
    // Lengths requested some beats ahead, also beyond the tolerance; some are cancelled.
    std::map<std::uint64_t, std::uint32_t> asked;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> starts;  // beat, clock
    std::uint64_t edges = 0, changes = 0;
    std::uint64_t next_reported = 0;
    for (int beats = 0; beats < 200;) {
      const std::uint64_t now = clock.next_tick();
      if (random() % 30 == 0) {
        const std::uint64_t from = clock.tick_of_beat(clock.beat_at_or_after(now) + random() % 5);
        const auto q16 = static_cast<std::uint32_t>(58'000 + random() % 15'000);
        asked.erase(asked.lower_bound(from), asked.end());
        asked[from] = q16;
        clock.set_tick_length(from, q16);
      } else if (random() % 1000 == 0) {
        const std::uint64_t from = clock.tick_of_beat(clock.beat_at_or_after(now) + 2);
        asked.erase(asked.lower_bound(from), asked.end());
        clock.keep_tick_length(from);
      }
      const std::uint64_t beat = clock.beat_at_or_after(now);
      const bool first = clock.tick_of_beat(beat) == now;
      const TickSpan span = clock.next_span(256);
      if (first) {
        starts.emplace_back(beat, span.first_clock);
        ++beats;
      }
      const auto holds = asked.upper_bound(now);
      const std::uint32_t q16 = holds == asked.begin() ? 65536 : std::prev(holds)->second;
      const double length = std::clamp(q16 / 65536.0, 1 - most, 1 + most);
      if (length != 1) ++changes;
      const double wanted = span.ticks * length * clocks_per_tick;
      ASSERT_NEAR(span.clocks, wanted, 1.01) << "tick " << now;
      // The edges of our own trigger, reported as late as by a board.
      const std::uint64_t reported_until =
          span.first_clock > 60'000 ? span.first_clock - 60'000 : 0;
      while (next_reported < starts.size() && starts[next_reported].second <= reported_until) {
        const auto& [of, at] = starts[next_reported++];
        if (at < 100'000) continue;
        const EdgeInfo info = clock.edge(at - lamp::shot_delay_clocks(delay_ns));
        ASSERT_TRUE(info.valid);
        ASSERT_EQ(info.beat, of);
        ++edges;
      }
    }
    EXPECT_GT(edges, 100u);
    EXPECT_TRUE(changes > 20 || tolerance_milli == 0);
  }
}

TEST(BeatClock, TracksTheLampForMonthsOfUptime) {
  // Times in Q16 clocks wrap after 26 days; this must have no effect.
  settings::Values values = lamp_settings(1);
  BeatClock clock;
  clock.configure(values);
  const std::uint64_t period = clock_hz;
  const auto delay = static_cast<std::uint64_t>(delay_clocks(values));
  constexpr std::uint64_t days = 60;
  std::uint64_t end_clock = 0, wrong = 0, edges = 0;
  for (std::uint64_t flash = 1; flash < days * 24 * 3600; ++flash) {
    const EdgeInfo info = clock.edge(flash * period);
    while (end_clock < flash * period + period / 2) {
      const TickSpan span = clock.next_span(1u << 20);
      end_clock = span.first_clock + span.clocks;
      if (flash < 20 || !info.valid || span.first_tick != clock.tick_of_beat(info.beat)) continue;
      ++edges;
      const std::uint64_t wanted = flash * period + delay;
      if (span.first_clock + 2 < wanted || span.first_clock > wanted + 2) ++wrong;
    }
  }
  EXPECT_TRUE(clock.locked());
  EXPECT_EQ(clock.lock_losses(), 0u);
  EXPECT_GT(edges, days * 24 * 3600 / 2);
  EXPECT_EQ(wrong, 0u);
}

TEST(BeatClock, SpansAreGapless) {
  // Spans of any length, a bad lamp, changes of settings: no gap, no tick counted twice.
  std::mt19937_64 random(79);
  BeatClock clock;
  clock.configure(lamp_settings(100));
  std::uint64_t tick = 0, at = 0, last_beat = 0;
  std::uint64_t next_edge = 1000;
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const TickSpan span = clock.next_span(1 + static_cast<std::uint32_t>(random() % 500));
    ASSERT_EQ(span.first_tick, tick);
    ASSERT_EQ(span.first_clock, at);
    ASSERT_GT(span.ticks, 0u);
    ASSERT_GT(span.clocks, 0u);
    tick += span.ticks;
    at += span.clocks;
    const std::uint64_t beat = clock.beat_at_or_after(tick);
    ASSERT_GE(beat, last_beat);
    last_beat = beat;
    while (next_edge < at) {
      clock.edge(next_edge);
      next_edge += random() % 50 == 0 ? random() % 3'000'000 : 1'240'000 + random() % 20'000;
    }
    if (random() % 20'000 == 0) clock.configure(lamp_settings(random() % 2 == 0 ? 100 : 137));
  }
}

}  // namespace
}  // namespace lamplock::lamp::beat_clock_test
