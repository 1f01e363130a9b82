// The expander against the virtual board's closed form of steps, with the guard of reversals
// applied in every tick; its words as drives of each kind read them.
#include "firmware/boards/rp2040/lattice/step_expander.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include "firmware/stepper/pulse_output.hpp"
#include "firmware/stepper/segment.hpp"
#include "sim/virtual_board/step_edges.hpp"
#include "tests/scale.hpp"

namespace lamplock::rp2040::step_expander_test {
namespace {

using stepper::AxisRun;
using stepper::TickBlock;

struct Tick {
  bool step = false, backwards = false;
};

/// Output of an axis, tick by tick.
class Reference {
 public:
  Reference(const stepper::DirectionTimes& times, std::int32_t step) : put_{step} {
    guard_.set_times(times);
    guard_.begin(false);
    guard_.wake(~0u);
  }
  void play(const AxisRun& run, std::uint32_t ticks) {
    sim::StepCursor cursor(run, ticks);
    for (std::uint32_t i = 0; i < ticks; ++i) {
      if (run.rate_after(i) != 0) guard_.head(cursor.backwards());
      const bool wanted = cursor.tick() == i;
      const bool step = guard_.tick(!wanted ? 0 : cursor.backwards() ? -1 : 1);
      if (wanted) cursor.next();
      ticks_.push_back({step, guard_.back()});
      put_.push_back(put_.back() + (!step ? 0 : guard_.back() ? -1 : 1));
      late_ += wanted && !step ? 1 : 0;
    }
  }
  const Tick& tick(std::size_t i) const { return ticks_[i]; }
  /// Steps output before tick i.
  std::int32_t put(std::size_t i) const { return put_[i]; }
  std::size_t late() const { return late_; }

 private:
  stepper::ReversalGuard guard_;
  std::vector<Tick> ticks_;
  std::vector<std::int32_t> put_;
  std::size_t late_ = 0;
};

/// A drive that reads the output of AXIS at the beginning of each tick.
class PinReader {
 public:
  PinReader(settings::PulseMode mode, const PulseTimes& pulses)
      : mode_(mode), high_ticks_(mode == settings::PulseMode::quadrature ? 0 : pulses.high_ticks) {}
  Tick read(std::uint32_t pins) { return read_steps(high_ticks_ == 0 ? pins : begun(pins)); }

 private:
  /// DIR, and the pulses that begin; every pulse has its length.
  std::uint32_t begun(std::uint32_t pins) {
    std::uint32_t result = 0;
    for (const std::uint32_t pin : {1u, 2u}) {
      std::uint32_t& high = high_[pin - 1];
      if (pin == 2 && mode_ == settings::PulseMode::step_dir) {
        result |= pins & pin;
      } else if ((pins & pin) != 0) {
        if (high++ == 0) result |= pin;
      } else if (high != 0) {
        EXPECT_EQ(high, high_ticks_);
        high = 0;
      }
    }
    return result;
  }
  Tick read_steps(std::uint32_t pins) {
    const bool first = (pins & 1) != 0, second = (pins & 2) != 0;
    if (mode_ == settings::PulseMode::step_dir) return {first, second};
    if (mode_ == settings::PulseMode::cw_ccw) {
      EXPECT_FALSE(first && second);
      return {first || second, second};
    }
    // 00, 10, 11, 01 (A B) upwards.
    constexpr std::array<std::uint32_t, 4> turn{0b00, 0b01, 0b11, 0b10};  // B A
    const auto place =
        static_cast<std::uint32_t>(std::find(turn.begin(), turn.end(), pins) - turn.begin());
    const std::uint32_t way = (place - place_) & 3;
    place_ = place;
    EXPECT_NE(way, 2u);
    return {way != 0, way == 3};
  }

  settings::PulseMode mode_;
  std::uint32_t high_ticks_;
  std::array<std::uint32_t, 2> high_{};
  std::uint32_t place_ = 0;
};

/// Random modes and times.
stepper::PulseOutput random_output(std::mt19937_64& random) {
  stepper::PulseOutput output;
  for (stepper::AxisPulses& axis : output.axis)
    axis.mode = static_cast<settings::PulseMode>(random() % 3);
  const auto ticks = [&random] { return static_cast<std::uint8_t>(1 + random() % 25); };
  output.times = {ticks(), ticks()};
  if (random() % 2 == 0) return output;
  // Long pulses, or pauses that are longer than a tick.
  const auto high = static_cast<std::uint8_t>(random() % 13);
  const auto low = static_cast<std::uint8_t>(1 + random() % 12);
  output.pulses = {high, static_cast<std::uint8_t>(high + low)};
  output.times = {std::max(output.times.setup_ticks, low), std::max(output.times.hold_ticks, high),
                  output.pulses.period_ticks};
  return output;
}

std::vector<Reference> references(const stepper::PulseOutput& output, const StepPosition& steps) {
  std::vector<Reference> all;
  for (const std::int32_t step : steps) all.emplace_back(output.times, step);
  return all;
}

/// Random blocks that join: rates below one step a tick, no change of direction inside a block.
class Blocks {
 public:
  explicit Blocks(std::uint64_t seed, const PulseTimes& pulses = {})
      : random_(seed), period_(pulses.period_ticks) {
    for (int a = 0; a < max_axes; ++a)
      position_[static_cast<std::size_t>(a)] = stepper::middle_of_step(100 * a - 150);
  }
  TickBlock next() {
    TickBlock block;
    block.first_tick = tick_;
    block.ticks = 1 + static_cast<std::uint32_t>(random_() % (random_() % 4 == 0 ? 700 : 40));
    block.bits = static_cast<std::uint8_t>(random_() % 8);
    block.moving = true;
    for (std::size_t a = 0; a < block.axis.size(); ++a) {
      block.axis[a] = run(position_[a], block.ticks);
      position_[a] = block.axis[a].position_after(block.ticks);
    }
    tick_ += block.ticks;
    return block;
  }
  void start_at(std::uint64_t tick) { tick_ = tick; }

 private:
  AxisRun run(Int128 position, std::uint32_t ticks) {
    AxisRun r;
    r.position_q64 = position;
    const auto kind = random_() % 8;
    if (kind == 0) return r;
    // Slow rates are as frequent as fast ones.
    const auto shift = static_cast<int>(2 + random_() % 40);
    const auto from = static_cast<std::int64_t>(random_() >> shift) / period_;
    const auto to = static_cast<std::int64_t>(random_() >> (2 + random_() % 40)) / period_;
    r.rate_q62 = from;
    r.accel_q62 = kind == 1 ? 0 : (to - from) / static_cast<std::int64_t>(ticks) & ~1ll;
    // A ramp from or to rest.
    if (kind == 2)
      r.rate_q62 = r.accel_q62 / 2, r.accel_q62 = r.accel_q62 < 0 ? -r.accel_q62 : r.accel_q62,
      r.rate_q62 = r.accel_q62 / 2;
    if (kind == 3) r.rate_q62 = 0, r.accel_q62 = to / static_cast<std::int64_t>(ticks) & ~1ll;
    if (random_() % 2 != 0) r.rate_q62 = -r.rate_q62, r.accel_q62 = -r.accel_q62;
    return r;
  }

  std::mt19937_64 random_;
  std::int64_t period_;  ///< ticks between two steps at least
  std::uint64_t tick_ = 0;
  PerAxis<Int128> position_{};
};

/// Writes a block in pieces: each axis is cut at its own random places.
void put(StepExpander& expander, const TickBlock& block, std::mt19937_64& random) {
  for (int a = 0; a < max_axes; ++a) {
    AxisRun run = block.axis[index(a)];
    for (std::uint32_t left = block.ticks; left != 0;) {
      const auto n = static_cast<std::uint32_t>(random() % 4 == 0 ? 1 + random() % left : left);
      if (run.is_at_rest())
        expander.put_still(a, n);
      else
        expander.put_axis(a, run, n);
      run.position_q64 = run.position_after(n);
      run.rate_q62 = run.rate_after(n);
      left -= n;
    }
    expander.set_step(a, static_cast<std::int32_t>(run.position_q64.hi()));
  }
  expander.put_bits(block.bits, block.ticks);
  expander.end_runs(block.ticks);
}

/// Levels of both pins of an axis.
std::uint32_t pins_in_ring(const LatticeRings& rings, std::size_t axis, std::uint64_t place) {
  const std::uint64_t at = place % ring_ticks;
  return rings.steps[axis][at / ticks_per_step_word] >> (30 - 2 * (at % ticks_per_step_word)) & 3;
}

std::uint32_t nibble_in_ring(const LatticeRings& rings, std::uint64_t place) {
  const std::uint64_t at = place % ring_ticks;
  return rings.bits[at / ticks_per_bits_word] >> (28 - 4 * (at % ticks_per_bits_word)) & 15;
}

TEST(StepExpander, StepsAtTheTicksOfTheClosedFormWithTheGuard) {
  std::size_t late = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::scaled(60)); ++seed) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    StepExpander expander(*rings, *power);
    std::mt19937_64 random(seed);
    const stepper::PulseOutput output = random_output(random);
    Blocks blocks(seed, output.pulses);
    std::vector<Reference> wanted = references(output, {});
    std::vector<PinReader> readers;
    for (const stepper::AxisPulses& axis : output.axis)
      readers.emplace_back(axis.mode, output.pulses);
    const std::uint64_t first = seed * 1237;
    blocks.start_at(first);
    expander.configure(output);
    expander.begin(first, first, {});
    std::uint64_t read = 0;  // ticks, from the first one on
    std::vector<std::uint8_t> bits;
    for (int n = 0; n < 40; ++n) {
      const TickBlock block = blocks.next();
      put(expander, block, random);
      for (std::size_t a = 0; a < wanted.size(); ++a) wanted[a].play(block.axis[a], block.ticks);
      bits.insert(bits.end(), block.ticks, block.bits);
      // Words that are complete.
      const std::uint64_t whole = (expander.end_tick() - first) / 16 * 16;
      for (; read < whole; ++read) {
        for (std::size_t a = 0; a < wanted.size(); ++a) {
          const Tick got = readers[a].read(pins_in_ring(*rings, a, read));
          const Tick& tick = wanted[a].tick(read);
          ASSERT_EQ(got.step, tick.step) << "seed " << seed << " axis " << a << " tick " << read;
          if (tick.step || output.axis[a].mode == settings::PulseMode::step_dir) {
            ASSERT_EQ(got.backwards, tick.backwards)
                << "seed " << seed << " axis " << a << " tick " << read;
          }
        }
        ASSERT_EQ(nibble_in_ring(*rings, read), lattice_nibble(bits[read]));
      }
    }
    ASSERT_GT(read, 500u);
    for (const Reference& axis : wanted) late += axis.late();
  }
  EXPECT_GT(late, static_cast<std::size_t>(test::scaled(60)) * 5)
      << "the guard delayed too few steps";
}

TEST(StepExpander, ReturnsThePositionsAtAnyTickStillInTheRings) {
  std::mt19937_64 random(5);
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::scaled(30)); ++seed) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    StepExpander expander(*rings, *power);
    const stepper::PulseOutput output = random_output(random);
    Blocks blocks(seed, output.pulses);
    // Begins of the random blocks.
    std::vector<Reference> put_out = references(output, {-150, -50, 50, 150});
    expander.configure(output);
    expander.begin(0, 0, {});
    for (int n = 0; n < 60; ++n) {
      const TickBlock block = blocks.next();
      put(expander, block, random);
      for (std::size_t a = 0; a < put_out.size(); ++a) put_out[a].play(block.axis[a], block.ticks);
      for (int k = 0; k < 4; ++k) {
        const std::uint64_t end = expander.end_tick();
        const std::uint64_t tick = end - random() % std::min<std::uint64_t>(end + 1, 3000);
        StepPosition wanted{};
        for (std::size_t a = 0; a < wanted.size(); ++a) wanted[a] = put_out[a].put(tick);
        ASSERT_EQ(expander.steps_at(tick), wanted) << "seed " << seed << " tick " << tick;
      }
    }
  }
}

/// Quadrature levels and DIR continue from their state when the ticks were stopped.
TEST(StepExpander, ContinuesWithTheLevelsOfThePins) {
  std::mt19937_64 random(11);
  for (int run = 0; run < test::scaled(60); ++run) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    StepExpander expander(*rings, *power);
    stepper::PulseOutput output = random_output(random);
    output.axis[0].mode = settings::PulseMode::quadrature;
    output.axis[1].mode = settings::PulseMode::step_dir;
    expander.configure(output);
    expander.begin(0, 0, {});
    Blocks blocks(static_cast<std::uint64_t>(run), output.pulses);
    for (int n = 0; n < 12; ++n) put(expander, blocks.next(), random);
    const std::uint64_t stop = expander.end_tick() - 16 - random() % 200;
    PerAxis<std::uint8_t> levels{};
    for (std::size_t a = 0; a < levels.size(); ++a)
      levels[a] = static_cast<std::uint8_t>(pins_in_ring(*rings, a, stop - 1));
    const StepPosition steps = expander.steps_at(stop);
    const std::uint64_t first = expander.end_tick() + 500;
    expander.begin(first, first + 100, steps, levels);
    EXPECT_EQ(expander.steps_at(first + 50), steps);
    blocks.start_at(first + 100);
    put(expander, blocks.next(), random);
    for (std::uint64_t i = 0; i < 96; ++i) {
      ASSERT_EQ(pins_in_ring(*rings, 0, i), levels[0]) << "run " << run << " tick " << i;
      ASSERT_EQ(pins_in_ring(*rings, 1, i) & 2u, levels[1] & 2u) << "run " << run << " tick " << i;
    }
  }
}

TEST(StepExpander, IsAtRestUntilTheFirstRunAfterARestart) {
  auto rings = std::make_unique<LatticeRings>();
  auto power = std::make_unique<PowerRing>();
  for (auto& ring : rings->steps) ring.fill(~0u);
  rings->bits.fill(~0u);
  StepExpander expander(*rings, *power);
  expander.begin(1000, 1037, {1, 2, 3, 4});
  EXPECT_EQ(expander.end_tick(), 1037u);
  EXPECT_EQ(expander.steps_at(1000), (StepPosition{1, 2, 3, 4}));
  for (std::size_t a = 0; a < 4; ++a)
    for (std::uint64_t i = 0; i < 32; ++i) EXPECT_EQ(pins_in_ring(*rings, a, i), 0u);
  for (std::uint64_t i = 0; i < 32; ++i) EXPECT_EQ(nibble_in_ring(*rings, i), 0u);
}

TEST(StepExpander, HasNoRoomForTicksNotYetOutput) {
  auto rings = std::make_unique<LatticeRings>();
  auto power = std::make_unique<PowerRing>();
  StepExpander expander(*rings, *power);
  expander.begin(0, 0, {});
  ASSERT_LT(expander.room(0), ring_ticks);
  expander.end_runs(expander.room(0));
  EXPECT_EQ(expander.room(0), 0u);
  EXPECT_EQ(expander.room(100), 100u);
}

TEST(StepExpander, PutsEachLatticeBitOnItsPin) {
  // LAMP TRIGGER, LASER GATE, SHOT ENABLE in a row.
  EXPECT_EQ(lattice_nibble(stepper::trigger_bit), 1u);
  EXPECT_EQ(lattice_nibble(stepper::gate_bit), 2u);
  EXPECT_EQ(lattice_nibble(stepper::arm_bit), 4u);
  EXPECT_EQ(lattice_nibble(stepper::trigger_bit | stepper::gate_bit | stepper::arm_bit), 7u);
}

/// A pulse ends, and few ticks later stronger or weaker light begins, at any place in the cell: the
/// light is nowhere stronger than the commanded light within half a cell.
TEST(StepExpander, TwoLightsInACellNeverExceedTheirPowers) {
  constexpr std::uint32_t cell = stepper::power_cell_ticks;
  constexpr std::uint16_t powers[] = {10'000, 50'000};
  for (std::uint32_t end = 1; end < cell; ++end) {
    for (std::uint32_t begin = end + 1; begin < cell; ++begin) {
      for (const bool weaker_first : {false, true}) {
        SCOPED_TRACE(testing::Message() << end << " to " << begin << ", " << weaker_first);
        auto rings = std::make_unique<LatticeRings>();
        auto power = std::make_unique<PowerRing>();
        StepExpander expander(*rings, *power);
        expander.begin(0, 0, {});
        const std::uint16_t one = powers[weaker_first ? 0 : 1],
                            other = powers[weaker_first ? 1 : 0];
        expander.put_power(one, cell + end);
        expander.put_power(0, begin - end);
        expander.put_power(other, 2 * cell);
        const auto count = power->counts[(1 + power_ahead_cells) % power_ring_cells];
        const auto max_near = [&](std::uint32_t t) {
          return std::max(t < end + cell / 2 ? one : 0, t + cell / 2 >= begin ? other : 0);
        };
        for (std::uint32_t t = 0; t < cell; ++t)
          if (t < end || t >= begin) {
            ASSERT_LE(count, laser_duty(static_cast<std::uint16_t>(max_near(t)))) << t;
          }
      }
    }
  }
}

/// Power is written ahead so that it applies in the ticks of its cell (laser_pwm.hpp).
TEST(StepExpander, CountsThePowerInTheMiddleOfEveryCell) {
  constexpr std::uint32_t cell = stepper::power_cell_ticks;
  std::mt19937_64 random(7);
  for (int i = 0; i < test::scaled(60); ++i) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    power->counts.fill(77);
    StepExpander expander(*rings, *power);
    // Also over the wrap of 32 bits. Cells begin with the first tick, whatever its number.
    const std::uint64_t first = (1ull << 32) - 20'000 + random() % 20'000;
    const std::uint32_t still = static_cast<std::uint32_t>(random() % 40);
    expander.begin(first, first + still, {});
    std::vector<std::uint16_t> commanded(still, 0);
    while (commanded.size() < 30'000) {
      const unsigned most = random() % 4 == 0 ? 500 : random() % 2 == 0 ? 40 : 5;
      const auto n = static_cast<std::uint32_t>(1 + random() % most);
      const auto p = static_cast<std::uint16_t>(random() % 3 == 0 ? 0 : 200 + random() % 65'000);
      expander.put_power(p, n);
      commanded.insert(commanded.end(), n, p);
      // As far back as the ring reaches.
      const std::size_t whole = commanded.size() / cell;
      for (std::size_t c = whole > 200 ? whole - 200 : 0; c < whole; c += 1 + random() % 3) {
        // The last power up to the middle, or else the first one after it; a weaker power after
        // darkness.
        std::uint32_t want = 0;
        for (std::uint32_t t = 0; t < cell; ++t) {
          const std::uint16_t shone = commanded[c * cell + t];
          const bool weaker = t != 0 && commanded[c * cell + t - 1] == 0 && shone < want;
          if (shone != 0 && (t <= cell / 2 || want == 0 || weaker)) want = shone;
        }
        ASSERT_EQ(power->counts[(c + power_ahead_cells) % power_ring_cells],
                  laser_duty(static_cast<std::uint16_t>(want)))
            << "cell " << c;
      }
    }
    expander.begin(first, first, {});
    for (const std::uint16_t count : power->counts) ASSERT_EQ(count, 0);
  }
}

}  // namespace
}  // namespace lamplock::rp2040::step_expander_test
