// The expander against the closed form that the virtual board steps by.
#include "firmware/boards/rp2040/lattice/step_expander.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "firmware/stepper/segment.hpp"
#include "sim/virtual_board/step_edges.hpp"
#include "tests/scale.hpp"

namespace lamplock::rp2040 {
namespace {

using stepper::AxisRun;
using stepper::TickBlock;

struct Tick {
  bool step, backwards;
  bool operator==(const Tick&) const = default;
};

/// Random blocks that join: rates below one step a tick, no change of direction inside a block.
class Blocks {
 public:
  explicit Blocks(std::uint64_t seed) : random_(seed) {
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
    const auto from = static_cast<std::int64_t>(random_() >> shift);
    const auto to = static_cast<std::int64_t>(random_() >> (2 + random_() % 40));
    r.rate_q62 = from;
    r.accel_q62 = kind == 1 ? 0 : (to - from) / static_cast<std::int64_t>(ticks) & ~1ll;
    // From or to a standstill.
    if (kind == 2)
      r.rate_q62 = r.accel_q62 / 2, r.accel_q62 = r.accel_q62 < 0 ? -r.accel_q62 : r.accel_q62,
      r.rate_q62 = r.accel_q62 / 2;
    if (kind == 3) r.rate_q62 = 0, r.accel_q62 = to / static_cast<std::int64_t>(ticks) & ~1ll;
    if (random_() % 2 != 0) r.rate_q62 = -r.rate_q62, r.accel_q62 = -r.accel_q62;
    return r;
  }

  std::mt19937_64 random_;
  std::uint64_t tick_ = 0;
  PerAxis<Int128> position_{};
};

/// A block in pieces: each axis cut anywhere, by itself.
void put(StepExpander& expander, const TickBlock& block, std::mt19937_64& random) {
  for (int a = 0; a < max_axes; ++a) {
    AxisRun run = block.axis[index(a)];
    for (std::uint32_t left = block.ticks; left != 0;) {
      const auto n = static_cast<std::uint32_t>(random() % 4 == 0 ? 1 + random() % left : left);
      if (run.stands())
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

Tick tick_in_ring(const LatticeRings& rings, std::size_t axis, std::uint64_t place) {
  const std::uint64_t at = place % ring_ticks;
  const std::uint32_t word = rings.steps[axis][at / ticks_per_step_word];
  const auto shift = 30 - 2 * (at % ticks_per_step_word);
  return {(word >> shift & 1) != 0, (word >> shift & 2) != 0};
}

std::uint32_t nibble_in_ring(const LatticeRings& rings, std::uint64_t place) {
  const std::uint64_t at = place % ring_ticks;
  return rings.bits[at / ticks_per_bits_word] >> (28 - 4 * (at % ticks_per_bits_word)) & 15;
}

TEST(StepExpander, StepsAtTheTicksOfTheClosedForm) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::scaled(60)); ++seed) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    StepExpander expander(*rings, *power);
    Blocks blocks(seed);
    std::mt19937_64 random(seed);
    const std::uint64_t first = seed * 1237;
    blocks.start_at(first);
    expander.begin(first, first, {});
    std::uint64_t checked = first;
    std::vector<TickBlock> kept;
    for (int n = 0; n < 40; ++n) {
      kept.push_back(blocks.next());
      put(expander, kept.back(), random);
      // Words that are complete.
      const std::uint64_t whole = first + (expander.end_tick() - first) / 16 * 16;
      while (!kept.empty() && kept.front().first_tick + kept.front().ticks <= whole) {
        const TickBlock& block = kept.front();
        for (std::size_t a = 0; a < block.axis.size(); ++a) {
          sim::StepCursor cursor(block.axis[a], block.ticks);
          for (std::uint32_t i = 0; i < block.ticks; ++i) {
            const Tick got = tick_in_ring(*rings, a, block.first_tick + i - first);
            const bool step = cursor.tick() == i;
            ASSERT_EQ(got.step, step) << "seed " << seed << " axis " << a << " tick " << i;
            if (!step) continue;
            ASSERT_EQ(got.backwards, cursor.backwards());
            cursor.next();
          }
          ASSERT_EQ(cursor.tick(), sim::StepCursor::none);
        }
        for (std::uint32_t i = 0; i < block.ticks; ++i)
          ASSERT_EQ(nibble_in_ring(*rings, block.first_tick + i - first),
                    lattice_nibble(block.bits));
        checked = block.first_tick + block.ticks;
        kept.erase(kept.begin());
      }
    }
    ASSERT_GT(checked, first + 500);
  }
}

TEST(StepExpander, KnowsWhereTheAxesStandAtAnyTickStillInTheRings) {
  std::mt19937_64 random(5);
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::scaled(30)); ++seed) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    StepExpander expander(*rings, *power);
    Blocks blocks(seed);
    expander.begin(0, 0, {});
    std::vector<TickBlock> all;
    for (int n = 0; n < 60; ++n) {
      all.push_back(blocks.next());
      put(expander, all.back(), random);
      for (int k = 0; k < 4; ++k) {
        const std::uint64_t end = expander.end_tick();
        const std::uint64_t tick = end - random() % std::min<std::uint64_t>(end + 1, 3000);
        StepPosition wanted{};
        for (const TickBlock& block : all)
          if (tick >= block.first_tick && tick <= block.first_tick + block.ticks)
            for (std::size_t a = 0; a < wanted.size(); ++a)
              wanted[a] = static_cast<std::int32_t>(
                  block.axis[a]
                      .position_after(static_cast<std::uint32_t>(tick - block.first_tick))
                      .hi());
        ASSERT_EQ(expander.steps_at(tick), wanted) << "seed " << seed << " tick " << tick;
      }
    }
  }
}

TEST(StepExpander, StandsUntilTheFirstRunAfterARestart) {
  auto rings = std::make_unique<LatticeRings>();
  auto power = std::make_unique<PowerRing>();
  for (auto& ring : rings->steps) ring.fill(~0u);
  rings->bits.fill(~0u);
  StepExpander expander(*rings, *power);
  expander.begin(1000, 1037, {1, 2, 3, 4});
  EXPECT_EQ(expander.end_tick(), 1037u);
  EXPECT_EQ(expander.steps_at(1000), (StepPosition{1, 2, 3, 4}));
  for (std::size_t a = 0; a < 4; ++a)
    for (std::uint64_t i = 0; i < 32; ++i) EXPECT_FALSE(tick_in_ring(*rings, a, i).step);
  for (std::uint64_t i = 0; i < 32; ++i) EXPECT_EQ(nibble_in_ring(*rings, i), 0u);
}

TEST(StepExpander, HasNoRoomForTicksNotYetPutOut) {
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

/// Written ahead so that it is in force in the ticks of its cell (laser_pwm.hpp).
TEST(StepExpander, CountsThePowerInTheMiddleOfEveryCell) {
  constexpr std::uint32_t cell = stepper::power_cell_ticks;
  std::mt19937_64 random(7);
  for (int i = 0; i < test::scaled(60); ++i) {
    auto rings = std::make_unique<LatticeRings>();
    auto power = std::make_unique<PowerRing>();
    power->counts.fill(77);
    StepExpander expander(*rings, *power);
    // Over the end of 32 bits, too. Cells begin with the first tick, whatever its number.
    const std::uint64_t first = (1ull << 32) - 20'000 + random() % 20'000;
    const std::uint32_t still = static_cast<std::uint32_t>(random() % 40);
    expander.begin(first, first + still, {});
    std::vector<std::uint16_t> told(still, 0);
    while (told.size() < 30'000) {
      const unsigned most = random() % 4 == 0 ? 500 : random() % 2 == 0 ? 40 : 5;
      const auto n = static_cast<std::uint32_t>(1 + random() % most);
      const auto p = static_cast<std::uint16_t>(random() % 3 == 0 ? 0 : 200 + random() % 65'000);
      expander.put_power(p, n);
      told.insert(told.end(), n, p);
      // As far back as the ring reaches.
      const std::size_t whole = told.size() / cell;
      for (std::size_t c = whole > 200 ? whole - 200 : 0; c < whole; c += 1 + random() % 3) {
        // The last one up to the middle, or else the first one behind it.
        std::uint32_t want = 0;
        for (std::uint32_t t = 0; t < cell; ++t) {
          const std::uint16_t shone = told[c * cell + t];
          if (shone != 0 && (t <= cell / 2 || want == 0)) want = shone;
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
}  // namespace lamplock::rp2040
