// The beat clock with lamps of every frequency, phase, jitter, drift and fault: it locks within 16
// edges, keeps the numbers of the beats, and keeps the lattice as close to the lamp as its gains
// allow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "firmware/lamp/beat_clock.hpp"
#include "tests/lamp/lamp_model.hpp"
#include "tests/scale.hpp"

namespace lamplock::lamp {
namespace {

using settings::Id;
using test::ClockBench;
using test::LampEdge;

constexpr std::uint64_t ever = ~std::uint64_t{0};
constexpr double us = clocks_per_us;

/// A lamp as described by its settings, plus faults.
struct Lamp {
  double hz = 100;
  double start_s = 0.01;
  double jitter_us = 0;  ///< as set; the true jitter is at most this
  double drift = 0;      ///< share of the period per second, as set and true
  double range = 0.03;
  double slew = 0.002;
  double first_off = 0;  ///< relative deviation of the period at the start
  double drop = 0;       ///< probability of a burst of drop-outs
  int max_burst = 1;
  double doubled = 0;  ///< probability of a second edge before the next flash
  double period_s() const { return 1 / hz; }
};

std::int32_t milli(double value) { return static_cast<std::int32_t>(std::lround(value * 1000)); }

settings::Values settings_for(const Lamp& lamp) {
  settings::Values values;
  const auto set = [&values](Id id, std::int32_t value) {
    ASSERT_TRUE(values.set_milli(id, value)) << settings::row(id).name << " " << value;
  };
  set(Id::lamp_mode, 1000);
  set(Id::lamp_frequency, milli(lamp.hz));
  set(Id::q_switch_delay, 5'000);
  set(Id::lamp_jitter, std::max(100, milli(lamp.jitter_us)));
  set(Id::lamp_drift, std::max(1, milli(lamp.drift * 100)));
  set(Id::lock_range, milli(lamp.range * 100));
  set(Id::slew_limit, milli(lamp.slew * 100));
  return values;
}

double log_uniform(double low, double high, std::mt19937_64& random) {
  return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
}
double uniform(double low, double high, std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A slew limit that lets the lattice follow: each beat the tracked period lags by up to two beats
/// of drift, `gap` beats without an edge add to that, and jitter moves the prediction.
double slew_for(const Lamp& lamp, int gap) {
  return std::min(0.05, 0.002 + 2 * (gap + 1) * lamp.drift * lamp.period_s() +
                            lamp.jitter_us * 1e-6 / lamp.period_s());
}

/// A random lamp. Jitter is at most an eighth of the period: with more, a quarter of a period no
/// longer identifies the beat of an edge while only two edges are known.
Lamp any_lamp(std::mt19937_64& random) {
  Lamp lamp;
  lamp.hz = std::round(log_uniform(1, 5000, random) * 1000) / 1000;
  lamp.start_s = uniform(0.001, 0.001 + 3 * lamp.period_s(), random);
  lamp.jitter_us = log_uniform(0.1, std::min(1000.0, 1e6 * lamp.period_s() / 16), random);
  lamp.range = uniform(0.01, 0.1, random);
  // A drift that crosses the range faster than a lock takes cannot be followed.
  const double fastest = std::min(0.02, lamp.range / (16 * lamp.period_s()));
  lamp.drift = random() % 3 == 0 ? 0 : log_uniform(1e-5, fastest, random);
  lamp.first_off = uniform(-0.8, 0.8, random) * lamp.range;
  lamp.slew = slew_for(lamp, 0);
  return lamp;
}

/// Edges of a lamp: `clean` flashes without faults, then `flashes` with them. The period wanders
/// up and down at the drift, inside the range.
std::vector<LampEdge> edges_of(const Lamp& lamp, long clean, long flashes,
                               std::mt19937_64& random) {
  std::vector<LampEdge> edges;
  double t = lamp.start_s, off = lamp.first_off;
  double way = random() % 2 == 0 ? lamp.drift : -lamp.drift;
  int dark = 0;
  for (long flash = 0; flash < clean + flashes; ++flash) {
    const double period = lamp.period_s() * (1 + off);
    const double at = t + uniform(-1, 1, random) * lamp.jitter_us * 1e-6;
    if (flash >= clean && dark == 0 && uniform(0, 1, random) < lamp.drop)
      dark = 1 + static_cast<int>(random() % static_cast<unsigned>(lamp.max_burst));
    if (dark == 0) {
      edges.push_back({static_cast<std::uint64_t>(std::llround(at * clock_hz)), flash, false});
      if (flash >= clean && uniform(0, 1, random) < lamp.doubled) {
        // Between the end of the pulse and the earliest next edge.
        const double from = 3e-6, to = period - 2e-6 * lamp.jitter_us - 3e-6;
        if (to > from)
          edges.push_back({edges.back().clock +
                               static_cast<std::uint64_t>(uniform(from, to, random) * clock_hz),
                           flash, true});
      }
    } else {
      --dark;
    }
    t += period;
    off += way * period;
    if (std::fabs(off) > 0.85 * lamp.range) way = off > 0 ? -lamp.drift : lamp.drift;
  }
  return edges;
}

/// Gains of Kalata's tracker for a lamp and the resulting errors, computed in floating point from
/// the article's formulas, independently of the firmware.
class Tracker {
 public:
  explicit Tracker(const Lamp& lamp) {
    const double jitter = std::max(0.1, lamp.jitter_us) / std::sqrt(3.0);
    const double change = std::max(1e-5, lamp.drift) * 1e6 * lamp.period_s() * lamp.period_s();
    const double index = std::clamp(change / jitter, 16.0 / 65536, 16.0);
    const double r = (4 + index - std::sqrt(8 * index + index * index)) / 4;
    alpha_ = 1 - r * r;
    beta_ = 2 * (1 - r) * (1 - r);
  }
  double alpha() const { return alpha_; }

  /// Largest error of a prediction `ahead` beats ahead, in jitters: the sum of the absolute
  /// weights of all past edges, of the steady tracker or of a line fitted through `edges`.
  double noise(int ahead, int edges) const {
    double x = 0, v = 0, sum = 0;
    for (int k = 0; k < 4000; ++k) {
      const double error = (k == 0 ? 1 : 0) - x;
      x += alpha_ * error, v += beta_ * error;
      sum += std::fabs(x + ahead * v);
      x += v;
    }
    double line = 0;
    const double mean = (edges - 1) / 2.0, spread = edges * (edges * edges - 1) / 12.0;
    for (int i = 0; i < edges; ++i)
      line += std::fabs(1.0 / edges + (edges - 1 + ahead - mean) * (i - mean) / spread);
    return std::max(sum, line);
  }
  /// Lag of a prediction if the period grows by 1 each beat.
  double lag(int ahead) const {
    double x = 0, v = 0, truth = 0, speed = 0;
    for (int k = 0; k < 4000; ++k) {
      const double error = truth - x;
      x += alpha_ * error, v += beta_ * error;
      if (k == 3999) return truth + ahead * speed + ahead * (ahead + 1) / 2.0 - x - ahead * v;
      x += v;
      speed += 1;
      truth += speed;
    }
    return 0;
  }

 private:
  double alpha_, beta_;
};

/// Number of edges by which the prediction of a lattice tick is ahead of the latest known edge.
int beats_ahead(const Lamp& lamp) {
  return 1 + static_cast<int>(std::floor(0.00056 / (lamp.period_s() * (1 - lamp.range))));
}

/// A beat clock that follows a lamp, and the checks of its output.
class Chase {
 public:
  Chase(const Lamp& lamp, long clean, long flashes, std::mt19937_64& random)
      : lamp_(lamp), tracker_(lamp), edges_(edges_of(lamp, clean, flashes, random)) {
    clock_.configure(settings_for(lamp));
  }
  void run() {
    ClockBench bench(clock_);
    bench.run(
        edges_, edges_.back().clock + 1,
        [&](const LampEdge& edge, const EdgeInfo& info) { judge(edge, info); },
        [&](const TickSpan& span) { judge(span); });
    if (testing::Test::HasFatalFailure()) return;
    ASSERT_TRUE(bench.gapless());
    for (const Seen& seen : seen_) {
      const std::uint64_t lattice = bench.time_of_beat(seen.beat);
      if (lattice == 0) continue;
      const double off = static_cast<double>(static_cast<std::int64_t>(lattice - seen.clock)) / us -
                         5;  // the delay
      ASSERT_LE(std::fabs(off), bound_us(seen.age))
          << "flash " << seen.flash << ", age " << seen.age << ", jitter " << lamp_.jitter_us;
      worst_share = std::max(worst_share, std::fabs(off) / bound_us(seen.age));
    }
  }
  /// Number of edges from a cold start until motion may begin.
  long settled_after = 0;
  long missed = 0, doubles = 0, taken_for_next = 0;
  double worst_share = 0;
  BeatClock& clock() { return clock_; }

 private:
  struct Seen {
    std::uint64_t beat, clock;
    long flash;
    int age;  ///< longest gap shortly before
  };

  /// The edge's own jitter, past jitter weighted by the gains, the remaining lag of drift (a
  /// reversal of the drift adds twice as much), the tolerance of settled(), and a microsecond for
  /// rounding. A gap adds to the beats ahead.
  double bound_us(int age) const {
    const int ahead = beats_ahead(lamp_) + age;
    const double change =
        lamp_.drift * 1e6 * lamp_.period_s() * lamp_.period_s() * (1 + lamp_.range);
    return lamp_.jitter_us * (1.5 + tracker_.noise(ahead, 9)) + 3 * change * tracker_.lag(ahead) +
           2;
  }

  void judge(const LampEdge& edge, const EdgeInfo& info) {
    if (testing::Test::HasFatalFailure()) return;
    ++count_;
    if (settled_after == 0) {
      if (info.valid) last_ = {info.beat, edge.clock, edge.flash, 0};
      return;  // after this edge the lattice must be within its bound
    }
    if (edge.extra) {
      ++doubles;
      // Just before the next flash an extra edge cannot be distinguished from it.
      if (!info.valid) return;
      ++taken_for_next;
      ASSERT_EQ(info.beat, last_.beat + static_cast<std::uint64_t>(edge.flash + 1 - last_.flash));
      taken_ = edge.flash + 1;
      last_ = {info.beat, edge.clock, edge.flash + 1, 0};
      quiet_ = 40;
      return;
    }
    if (edge.flash == taken_) {
      ASSERT_FALSE(info.valid) << "two edges for beat " << info.beat;
      return;
    }
    ASSERT_TRUE(info.valid) << "flash " << edge.flash << " of " << lamp_.hz << " Hz";
    const long passed = edge.flash - last_.flash;
    if (last_.flash != 0) {
      ASSERT_EQ(info.beat - last_.beat, static_cast<std::uint64_t>(passed));
      ASSERT_EQ(info.missed, static_cast<std::uint32_t>(passed - 1));
      missed += passed - 1;
    }
    // A gap has an effect until the tracker has forgotten it.
    const int gap = last_.flash == 0 ? 0 : static_cast<int>(passed) - 1;
    if (gap >= age_ || --age_left_ <= 0) {
      age_ = gap;
      age_left_ = 8 + static_cast<int>(3 / tracker_.alpha());
    }
    last_ = {info.beat, edge.clock, edge.flash, age_};
    if (quiet_ > 0)
      --quiet_;
    else if (clock_.tick_of_beat(info.beat) >= settled_tick_)
      seen_.push_back(last_);
  }

  void judge(const TickSpan& span) {
    if (testing::Test::HasFatalFailure()) return;
    const double nominal = span.ticks * double{clocks_per_tick};
    ASSERT_GE(span.clocks + 1.01, nominal * 0.75);
    ASSERT_LE(span.clocks - 1.01, nominal * 1.25);
    if (settled_after == 0) {
      if (clock_.settled()) {
        settled_after = count_;
        settled_tick_ = clock_.next_tick();
        clock_.set_motion_end(ever);
      }
      return;
    }
    // Slew limit relative to a tracked period within the range plus noise.
    const double noise = 2 * lamp_.jitter_us * 1e-6 / lamp_.period_s();
    ASSERT_GE(span.clocks + 1.01, nominal * (1 - lamp_.range - noise) * (1 - lamp_.slew) * 0.998);
    ASSERT_LE(span.clocks - 1.01, nominal * (1 + lamp_.range + noise) * (1 + lamp_.slew) * 1.002);
  }

  Lamp lamp_;
  Tracker tracker_;
  std::vector<LampEdge> edges_;
  BeatClock clock_;
  std::uint64_t settled_tick_ = 0;
  long count_ = 0, taken_ = -1;
  int age_ = 0, age_left_ = 0, quiet_ = 0;
  Seen last_{};
  std::vector<Seen> seen_;
};

/// Number of flashes to simulate: fewer for slow lamps, since the cost is simulated time.
long flashes_of(const Lamp& lamp, long most) {
  return std::clamp(static_cast<long>(10 * lamp.hz), 40L, most);
}

std::string describe(const Lamp& lamp, int number) {
  return std::string("lamp ") + std::to_string(number) + ": " + std::to_string(lamp.hz) +
         " Hz, jitter " + std::to_string(lamp.jitter_us) + " us, drift " +
         std::to_string(lamp.drift * 100) + " %/s, range " + std::to_string(lamp.range) + ", off " +
         std::to_string(lamp.first_off) + ", start " + std::to_string(lamp.start_s);
}

TEST(BeatClockSweep, LocksAndSettlesWithinSixteenEdgesAndKeepsTracking) {
  std::mt19937_64 random(1201);
  double worst = 0;
  long slowest = 0;
  for (int i = 0; i < test::scaled(150); ++i) {
    const Lamp lamp = any_lamp(random);
    SCOPED_TRACE(describe(lamp, i));
    Chase run(lamp, flashes_of(lamp, 200), 0, random);
    ASSERT_NO_FATAL_FAILURE(run.run());
    ASSERT_NE(run.settled_after, 0);
    ASSERT_LE(run.settled_after, 16);
    ASSERT_EQ(run.clock().lock_losses(), 0u);
    ASSERT_EQ(run.clock().spurious(), 0u);
    worst = std::max(worst, run.worst_share);
    slowest = std::max(slowest, run.settled_after);
  }
  std::cout << "settled after at most " << slowest << " edges; lattice error at most " << worst
            << " of its bound\n";
}

TEST(BeatClockSweep, SurvivesDropOutsAndDoubledEdges) {
  std::mt19937_64 random(1202);
  long missed = 0, doubles = 0;
  double worst = 0;
  const int lamps = std::max(30, test::scaled(60));
  for (int i = 0; i < lamps; ++i) {
    Lamp lamp = any_lamp(random);
    lamp.drop = uniform(0, 0.05, random);
    lamp.max_burst = i % 2 == 0 ? 1 : 10;
    lamp.doubled = uniform(0, 0.1, random);
    // A burst ends before drift carries an edge into another beat.
    const double beats = lamp.max_burst + 2.0;
    lamp.drift = std::min(lamp.drift, 0.05 / (beats * beats * lamp.period_s()));
    lamp.slew = slew_for(lamp, lamp.max_burst);
    SCOPED_TRACE(describe(lamp, i));
    Chase run(lamp, 20, flashes_of(lamp, 400), random);
    ASSERT_NO_FATAL_FAILURE(run.run());
    ASSERT_EQ(run.clock().lock_losses(), 0u);
    missed += run.missed;
    doubles += run.doubles;
    worst = std::max(worst, run.worst_share);
  }
  EXPECT_GT(missed, 5 * lamps);
  EXPECT_GT(doubles, 5 * lamps);
  std::cout << missed << " flashes missed, " << doubles << " doubled; lattice error at most "
            << worst << " of its bound\n";
}

/// Adds edges at a constant period.
void add_edges(std::vector<LampEdge>& edges, double period_s, long count, double jitter_us,
               std::mt19937_64& random) {
  double t = edges.empty() ? 0.01 : static_cast<double>(edges.back().clock) / clock_hz + period_s;
  long flash = edges.empty() ? 0 : edges.back().flash + 1;
  for (long i = 0; i < count; ++i, ++flash, t += period_s) {
    const double at = t + uniform(-1, 1, random) * jitter_us * 1e-6;
    edges.push_back({static_cast<std::uint64_t>(std::llround(at * clock_hz)), flash, false});
  }
}

TEST(BeatClockSweep, LocksAgainWithinSixteenEdgesAfterAJumpInsideTheRange) {
  // Jumps that are far outside the jitter; smaller ones are drift to the tracker.
  std::mt19937_64 random(1203);
  long lost = 0, kept = 0, slowest = 0;
  for (int i = 0; i < test::scaled(400); ++i) {
    Lamp lamp = any_lamp(random);
    lamp.drift = 0.003;
    lamp.jitter_us = std::min(lamp.jitter_us, 0.001e6 * lamp.period_s());
    const double to = -lamp.first_off + (random() % 2 == 0 ? 0.1 : -0.1) * lamp.range;
    if (std::fabs(to - lamp.first_off) < 0.01) continue;
    SCOPED_TRACE(describe(lamp, i));
    std::vector<LampEdge> edges;
    add_edges(edges, lamp.period_s() * (1 + lamp.first_off), 30, lamp.jitter_us, random);
    const long jump = edges.back().flash + 1;
    add_edges(edges, lamp.period_s() * (1 + to), 40, lamp.jitter_us, random);
    BeatClock clock;
    clock.configure(settings_for(lamp));
    ClockBench bench(clock);
    std::vector<std::pair<LampEdge, EdgeInfo>> seen;
    bench.run(edges, edges.back().clock + 1, [&](const LampEdge& edge, const EdgeInfo& info) {
      if (edge.flash >= jump) seen.emplace_back(edge, info);
    });
    // The lamp is tracked again when the edge has a beat and its lattice tick is within the bound.
    const double bound = 20 + 8 * lamp.jitter_us;
    long last_off = jump;
    for (const auto& [edge, info] : seen) {
      const std::uint64_t lattice = info.valid ? bench.time_of_beat(info.beat) : 0;
      const double off =
          static_cast<double>(static_cast<std::int64_t>(lattice - edge.clock)) / us - 5;
      if (!info.valid || (lattice != 0 && std::fabs(off) > bound)) last_off = edge.flash;
    }
    ASSERT_LE(last_off + 1 - jump, 16) << "to " << to;
    slowest = std::max(slowest, last_off + 1 - jump);
    ++(clock.lock_losses() != 0 ? lost : kept);
  }
  std::cout << "tracked again after at most " << slowest << " edges; lock kept " << kept
            << " times, lost " << lost << " times\n";
}

TEST(BeatClockSweep, HasNoLockOutsideTheRange) {
  // Other frequencies, including multiples and fractions, which fit every edge or every beat.
  std::mt19937_64 random(1204);
  for (int i = 0; i < test::scaled(150); ++i) {
    Lamp lamp = any_lamp(random);
    lamp.drift = 0.003;
    lamp.jitter_us = std::min(lamp.jitter_us, 0.001e6 * lamp.period_s());
    const double ratios[] = {0.5, 2, 1.0 / 3, 3, 1.5, 2.0 / 3, 0.25};
    const double ratio = i % 2 == 0          ? ratios[random() % std::size(ratios)]
                         : random() % 2 == 0 ? 1 + lamp.range * uniform(1.3, 4, random)
                                             : 1 - lamp.range * uniform(1.3, 4, random);
    SCOPED_TRACE(describe(lamp, i) + ", then period x " + std::to_string(ratio));
    std::vector<LampEdge> edges;
    add_edges(edges, lamp.period_s() * (1 + lamp.first_off), 30, lamp.jitter_us, random);
    const long other = edges.back().flash + 1;
    add_edges(edges, lamp.period_s() * ratio, 80, lamp.jitter_us, random);
    const long back = edges.back().flash + 1;
    add_edges(edges, lamp.period_s() * (1 + lamp.first_off), 30, lamp.jitter_us, random);
    BeatClock clock;
    clock.configure(settings_for(lamp));
    ClockBench bench(clock);
    bench.run(edges, edges.back().clock + 1,
              [&](const LampEdge& edge, const EdgeInfo& info) {
                if (testing::Test::HasFatalFailure()) return;
                if (edge.flash > 20 && edge.flash < other) {
                  ASSERT_TRUE(info.valid);
                }
                const auto passed = static_cast<double>(edge.flash - other);
                if (passed * std::min(1.0, ratio) > 20 && edge.flash < back) {
                  ASSERT_FALSE(clock.locked() || info.valid) << "edge " << edge.flash - other;
                }
                if (edge.flash >= back + 16) {
                  ASSERT_TRUE(clock.locked() && info.valid) << "edge " << edge.flash - back;
                }
              },
              {});
    ASSERT_FALSE(testing::Test::HasFatalFailure());
  }
}

TEST(BeatClockSweep, NoTickIsShorterThanTheLimitsOfTheMotionAllow) {
  // The lamp jumps to a shorter period during motion: the lattice lags, the limits are kept.
  std::mt19937_64 random(1205);
  long held_back = 0;
  for (int i = 0; i < test::scaled(100); ++i) {
    Lamp lamp = any_lamp(random);
    lamp.drift = 0.003;
    lamp.jitter_us = std::min(lamp.jitter_us, 0.001e6 * lamp.period_s());
    lamp.range = 0.03;
    SCOPED_TRACE(describe(lamp, i));
    std::vector<LampEdge> edges;
    add_edges(edges, lamp.period_s(), 20, lamp.jitter_us, random);
    add_edges(edges, lamp.period_s() * (1 - uniform(0.004, 0.025, random)), 30, lamp.jitter_us,
              random);
    BeatClock clock;
    clock.configure(settings_for(lamp));
    ClockBench bench(clock);
    std::uint32_t promised = 0, later = 0;
    std::uint64_t from = ever;
    bench.run(
        edges, edges.back().clock + 1,
        [&](const LampEdge& edge, const EdgeInfo& info) {
          if (edge.flash == 15) {
            ASSERT_TRUE(clock.locked() && info.valid);
            promised = clock.min_tick_q16(32 * clock.beat_ticks());
            clock.set_min_tick(0, promised);
            clock.set_motion_end(ever);
          }
          // The next window is planned for shorter ticks; it begins some beats later.
          if (edge.flash == 35) {
            from = clock.tick_of_beat(clock.beat_at_or_after(clock.next_tick()) + 4);
            later = promised - promised / 100;
            clock.set_min_tick(from, later);
          }
        },
        [&](const TickSpan& span) {
          if (promised == 0 || testing::Test::HasFatalFailure()) return;
          const double least = span.first_tick < from ? promised : later;
          const double share = span.clocks / (span.ticks * double{clocks_per_tick}) * 65536 / least;
          ASSERT_GE((span.clocks + 1.01) / (span.ticks * double{clocks_per_tick}) * 65536, least);
          if (share < 1.0001) ++held_back;
        });
  }
  EXPECT_GT(held_back, 10 * test::scaled(100));
}

TEST(BeatClockSweep, TheShortestTickCoversTheDriftUntilThePlanHasEnded) {
  std::mt19937_64 random(1206);
  for (int i = 0; i < test::scaled(200); ++i) {
    Lamp lamp = any_lamp(random);
    lamp.jitter_us = std::min(lamp.jitter_us, 0.0005e6 * lamp.period_s());
    lamp.slew = slew_for(lamp, 0);
    SCOPED_TRACE(describe(lamp, i));
    const std::vector<LampEdge> edges = edges_of(lamp, flashes_of(lamp, 200), 0, random);
    BeatClock clock;
    clock.configure(settings_for(lamp));
    ClockBench bench(clock);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> limits;  // valid up to tick, shortest tick
    bool moving = false;
    // Motion keeps ticks above the limit; without limits the lattice may shrink by the whole slew
    // limit, of which min_tick_q16() includes an eighth.
    const double noise = (1 - 2 * lamp.jitter_us * 1e-6 / lamp.period_s() - 0.0001) *
                         (1 - lamp.slew) / (1 - lamp.slew / 8);
    bench.run(
        edges, edges.back().clock + 1,
        [&](const LampEdge&, const EdgeInfo& info) {
          moving = moving || clock.settled();
          if (moving) clock.set_motion_end(ever);
          if (moving && info.valid)
            limits.emplace_back(clock.next_tick() + 24 * clock.beat_ticks(),
                                clock.min_tick_q16(24 * clock.beat_ticks()));
        },
        [&](const TickSpan& span) {
          if (testing::Test::HasFatalFailure()) return;
          for (std::size_t k = limits.size() > 30 ? limits.size() - 30 : 0; k < limits.size();
               ++k) {
            if (span.first_tick >= limits[k].first) continue;
            ASSERT_GE((span.clocks + 1.01) / (span.ticks * double{clocks_per_tick}) * 65536,
                      limits[k].second * noise);
          }
        });
  }
}

}  // namespace
}  // namespace lamplock::lamp
