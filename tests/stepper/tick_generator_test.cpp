// The tick generator: blocks compared with their segments, tick by tick.
#include "firmware/stepper/tick_generator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "firmware/motion/profile/pulse.hpp"
#include "sim/virtual_board/step_edges.hpp"
#include "tests/motion/chain.hpp"
#include "tests/motion/jerk_watch.hpp"
#include "tests/motion/tick_sum.hpp"
#include "tests/scale.hpp"

namespace lamplock::stepper::tick_generator_test {
namespace {

using stepper::MotionState;
using stepper::Segment;
using stepper::SegmentQueue;
using test::native;
using wire::JoinMode;

/// A step: its tick, axis and direction.
struct Step {
  std::uint64_t tick;
  int axis, way;
  friend bool operator==(const Step&, const Step&) = default;
};
/// A change of the lattice bits.
struct BitsChange {
  std::uint64_t tick;
  std::uint8_t bits;
  friend bool operator==(const BitsChange&, const BitsChange&) = default;
};

/// Expands blocks as the simplest board does: position += rate, rate += accel, a step where the
/// integer part changes. Checks that blocks are contiguous and keep their guarantees.
class NaiveBoard {
 public:
  NaiveBoard() {
    for (auto& p : position_) p = native(stepper::middle_of_step(0));
  }

  void play(const TickBlock& block) {
    ASSERT_EQ(block.first_tick, tick_) << "a gap between blocks";
    ASSERT_GT(block.ticks, 0u);
    if (bits_.empty() || bits_.back().bits != block.bits) bits_.push_back({tick_, block.bits});
    for (int a = 0; a < max_axes; ++a) ASSERT_NO_FATAL_FAILURE(play_axis(a, block));
    tick_ += block.ticks;
    ++blocks_;
  }

  // Axis by axis, as called by fill_axes(); the ticks pass in end_runs().
  void put_axis(int a, const AxisRun& run, std::uint32_t ticks) {
    ASSERT_FALSE(run.is_at_rest());
    put(a, run, ticks);
  }
  void put_still(int a, std::uint32_t ticks) {
    AxisRun run;
    const test::Native p = position_[index(a)];
    run.position_q64 = {static_cast<std::uint64_t>(p >> 64), static_cast<std::uint64_t>(p)};
    put(a, run, ticks);
  }
  void set_step(int a, std::int32_t step) {
    ASSERT_EQ(step, static_cast<std::int32_t>(position_[index(a)] >> 64));
    ++steps_set_;
  }
  void put_bits(std::uint8_t bits, std::uint32_t ticks) {
    ASSERT_GT(ticks, 0u);
    if (bits_.empty() || bits_.back().bits != bits) bits_.push_back({tick_ + put_bits_, bits});
    put_bits_ += ticks;
  }
  void put_power(std::uint16_t power, std::uint32_t ticks) {
    ASSERT_EQ(power, 0) << "these segments have no power";
    put_power_ += ticks;
  }
  void end_runs(std::uint32_t ticks) {
    ASSERT_EQ(put_power_, ticks);
    put_power_ = 0;
    for (std::uint32_t& n : put_) {
      ASSERT_EQ(n, ticks);
      n = 0;
    }
    ASSERT_EQ(put_bits_, ticks);
    ASSERT_EQ(steps_set_, max_axes) << "every axis must set its step each time";
    put_bits_ = 0;
    steps_set_ = 0;
    tick_ += ticks;
  }

  std::uint64_t tick() const { return tick_; }
  test::Native position(int a) const { return position_[index(a)]; }
  const std::vector<Step>& steps() const { return steps_; }
  /// Steps in the order of time, independent of blocks.
  std::vector<Step> sorted_steps() const {
    std::vector<Step> sorted = steps_;
    std::sort(sorted.begin(), sorted.end(), [](const Step& a, const Step& b) {
      return a.tick != b.tick ? a.tick < b.tick : a.axis < b.axis;
    });
    return sorted;
  }
  const std::vector<BitsChange>& bits() const { return bits_; }
  long counted(int a) const { return counted_[index(a)]; }
  long blocks() const { return blocks_; }

 private:
  void put(int a, const AxisRun& run, std::uint32_t ticks) {
    TickBlock block;
    block.ticks = ticks;
    block.axis[index(a)] = run;
    const std::uint64_t start = tick_;
    tick_ += put_[index(a)];
    play_axis(a, block);
    tick_ = start;
    put_[index(a)] += ticks;
    ++blocks_;
  }
  void play_axis(int a, const TickBlock& block) {
    const AxisRun& run = block.axis[index(a)];
    test::Native& position = position_[index(a)];
    ASSERT_EQ(native(run.position_q64), position) << "a remainder was lost at tick " << tick_;
    std::int64_t rate = run.rate_q62;
    bool up = false, down = false;
    sim::StepCursor cursor(run, block.ticks);
    for (std::uint32_t j = 0; j < block.ticks; ++j) {
      const auto before = static_cast<std::int64_t>(position >> 64);
      position += static_cast<test::Native>(rate) * 4;
      up = up || rate > 0;
      down = down || rate < 0;
      rate += run.accel_q62;
      const auto after = static_cast<std::int64_t>(position >> 64);
      if (after == before) continue;
      ASSERT_EQ(std::llabs(after - before), 1) << "two steps in tick " << tick_ + j;
      const int way = after > before ? 1 : -1;
      steps_.push_back({tick_ + j, a, way});
      counted_[index(a)] += way;
      ASSERT_EQ(cursor.tick(), j) << "block at " << tick_;
      ASSERT_EQ(cursor.backwards(), way < 0);
      cursor.next();
    }
    ASSERT_EQ(cursor.tick(), sim::StepCursor::none);
    ASSERT_FALSE(up && down) << "a block changes its direction at tick " << tick_;
    ASSERT_EQ(native(run.position_after(block.ticks)), position);
  }

  std::uint64_t tick_ = 0;
  PerAxis<test::Native> position_{};
  PerAxis<long> counted_{};
  std::vector<Step> steps_;
  std::vector<BitsChange> bits_;
  long blocks_ = 0;
  PerAxis<std::uint32_t> put_{};
  std::uint32_t put_bits_ = 0, put_power_ = 0;
  int steps_set_ = 0;
};

std::vector<Segment> shifted(std::vector<Segment> segments, std::uint64_t ticks) {
  for (Segment& s : segments) {
    s.start_tick += ticks;
    s.end.tick += ticks;
  }
  return segments;
}

/// A fast lamp, so that many segments take few ticks.
test::Chain fast_chain(std::mt19937_64& random, std::size_t points, int axes = 4) {
  std::uniform_real_distribution<double> unit(0, 1);
  test::Chain chain;
  chain.settings = test::machine_settings(2000 + 3000 * unit(random), 30, 0.9, axes, 900);
  chain.limits = test::limits_of(chain.settings);
  std::array<double, max_axes> at{};
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < points; ++i) {
    wire::Target t;
    const double length = std::pow(10.0, -1 + 3 * unit(random));
    for (std::size_t a = 0; a < static_cast<std::size_t>(axes); ++a) {
      at[a] += length * normal(random);
      t.steps[a] = static_cast<std::int32_t>(std::lround(at[a]));
    }
    if (random() % 4 == 0) t.shots = 0;
    chain.targets.push_back(t);
  }
  for (motion::AxisLimits& axis : chain.limits.axis) {
    axis.min_steps = -1'000'000'000;
    axis.max_steps = 1'000'000'000;
  }
  return chain;
}

std::vector<Segment> plan(const test::Chain& chain) {
  static motion::Planner planner;
  test::ChainPlan plan = test::plan_chain(chain, planner);
  EXPECT_EQ(plan.result, Result::ok);
  return plan.segments;
}

/// A generator with its queue and a board.
struct Machine {
  SegmentQueue queue;
  TickGenerator generator{queue};
  NaiveBoard board;
  std::size_t fed = 0;
  /// Feeds segments while the queue has room and plays every block until the board reaches `tick`.
  void run_to(const std::vector<Segment>& segments, std::uint64_t tick,
              std::uint32_t max_ticks = 1000) {
    TickBlock block;
    while (board.tick() < tick) {
      feed(segments);
      const auto most =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(max_ticks, tick - board.tick()));
      generator.fill(block, most);
      ASSERT_LE(block.ticks, most);
      ASSERT_NO_FATAL_FAILURE(board.play(block));
    }
  }
  void feed(const std::vector<Segment>& segments) {
    while (fed < segments.size() && queue.free() != 0) queue.push(segments[fed++]);
  }
  /// The board is where a segment ends.
  void expect_at_end_of(const Segment& s, int axes = max_axes) {
    for (int a = 0; a < axes; ++a) {
      ASSERT_EQ(board.position(a), native(s.end.axis[index(a)].position_q64)) << s.point;
      ASSERT_EQ(board.counted(a), s.end.axis[index(a)].step()) << s.point;
    }
  }
  /// Every axis separately, up to `most` ticks at a time.
  void run_axes_to(const std::vector<Segment>& segments, std::uint64_t tick, std::uint32_t most,
                   std::mt19937_64& random) {
    while (board.tick() < tick) {
      feed(segments);
      const auto ticks = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(tick - board.tick(), 1 + random() % most));
      generator.fill_axes(ticks, board);
      ASSERT_FALSE(::testing::Test::HasFatalFailure());
      ASSERT_NO_FATAL_FAILURE(board.end_runs(ticks));
      ASSERT_EQ(generator.tick(), board.tick());
    }
  }
  void brake(const motion::Limits& limits, std::size_t all) {
    queue.clear();
    fed = all;
    if (generator.running()) generator.replace(motion::make_brake(generator.state(), limits));
  }
};

TEST(TickGenerator, EndsEverySegmentExactlyWhereItWasPlanned) {
  std::mt19937_64 random(61);
  for (int i = 0; i < test::scaled(10); ++i) {
    const std::vector<Segment> segments = shifted(plan(fast_chain(random, 100)), 1000);
    Machine m;
    for (const Segment& s : segments) {
      ASSERT_NO_FATAL_FAILURE(m.run_to(segments, s.end.tick, 5000));
      ASSERT_NO_FATAL_FAILURE(m.expect_at_end_of(s));
      const MotionState state = m.generator.state();
      ASSERT_EQ(state.tick, s.end.tick);
      for (int a = 0; a < max_axes; ++a)
        ASSERT_EQ(state.axis[index(a)].speed_q62, s.end.axis[index(a)].speed_q62);
    }
    ASSERT_NO_FATAL_FAILURE(m.run_to(segments, segments.back().end.tick + 500, 100));
    EXPECT_FALSE(m.generator.underrun());
    EXPECT_FALSE(m.generator.running());
  }
}

/// The same with jerk pulses: every stair of every phase, to the tick.
TEST(TickGenerator, RunsPulsesExactly) {
  std::mt19937_64 random(66);
  long blocks = 0;
  for (int i = 0; i < test::scaled(40); ++i) {
    test::Chain chain = test::random_chain(random, 20);
    test::limit_jerk(chain, random);
    const std::vector<Segment> segments = plan(chain);
    Machine m;
    for (const Segment& s : segments) {
      if (s.end.tick > 3'000'000) break;
      ASSERT_NO_FATAL_FAILURE(m.run_to(segments, s.end.tick, 5000));
      ASSERT_NO_FATAL_FAILURE(m.expect_at_end_of(s, chain.limits.axes));
    }
    blocks += m.board.blocks();
  }
  EXPECT_GT(blocks, test::scaled(40) * 100);
}

TEST(TickGenerator, CarriesRemaindersThroughTenThousandSegments) {
  std::mt19937_64 random(62);
  const auto points = static_cast<std::size_t>(test::scaled(10'000));
  const test::Chain chain = fast_chain(random, points, 2);
  const std::vector<Segment> segments = plan(chain);
  Machine m;
  int off_the_middle = 0;
  for (const Segment& s : segments) {
    ASSERT_NO_FATAL_FAILURE(m.run_to(segments, s.end.tick, 1u << 14));
    ASSERT_NO_FATAL_FAILURE(m.expect_at_end_of(s, 2));
    for (int a = 0; a < 2; ++a) {
      const std::int32_t step = chain.targets[s.point].steps[index(a)];
      ASSERT_EQ(m.board.counted(a), step) << s.point;
      // The rounding remainder is kept, and always stays below 1e-6 step.
      const test::Native off = m.board.position(a) - native(stepper::middle_of_step(step));
      ASSERT_LT(std::fabs(static_cast<double>(off)) / 18446744073709551616.0, 1e-6) << s.point;
      off_the_middle += off != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(off_the_middle, static_cast<int>(points) / 2);
  EXPECT_FALSE(m.generator.underrun());
}

TEST(TickGenerator, GivesTheSameStepsAndBitsForAnyBlockSize) {
  std::mt19937_64 random(63);
  for (int i = 0; i < test::scaled(3); ++i) {
    const std::vector<Segment> segments = shifted(plan(fast_chain(random, 60)), 700);
    std::vector<Step> steps;
    std::vector<BitsChange> bits;
    for (const std::uint32_t max_ticks : {16384u, 1u, 7u, 16u, 1000u}) {
      Machine m;
      m.generator.set_arm_lead(5);
      m.generator.set_trigger({400, 20, 130});
      ASSERT_NO_FATAL_FAILURE(m.run_to(segments, segments.back().end.tick + 2000, max_ticks));
      if (steps.empty()) {
        steps = m.board.sorted_steps();
        bits = m.board.bits();
        ASSERT_GT(steps.size(), 100u);
        ASSERT_GT(bits.size(), 40u);
      }
      ASSERT_EQ(m.board.sorted_steps(), steps) << max_ticks << " ticks at most";
      ASSERT_EQ(m.board.bits(), bits) << max_ticks << " ticks at most";
    }
  }
}

/// Every tick up to `end` was armed and triggered as segments and pattern require.
void expect_bits(const NaiveBoard& board, const std::vector<Segment>& segments,
                 std::uint32_t arm_lead, const TriggerPattern& trigger, std::uint64_t end) {
  std::vector<std::uint8_t> want(end, 0);
  for (const Segment& s : segments) {
    if (!s.shot.present) continue;
    const std::uint64_t centre = s.end_tick() - arm_lead;
    for (std::uint64_t t = centre - s.shot.half_window_ticks; t < centre + s.shot.half_window_ticks;
         ++t)
      want[t] |= arm_bit;
  }
  for (std::uint64_t on = trigger.first_tick; on < end; on += trigger.period_ticks)
    for (std::uint64_t t = on; t < std::min(on + trigger.width_ticks, end); ++t)
      want[t] |= trigger_bit;
  std::size_t change = 0;
  std::uint8_t now = 0;
  for (std::uint64_t t = 0; t < end; ++t) {
    if (change < board.bits().size() && board.bits()[change].tick == t)
      now = board.bits()[change++].bits;
    ASSERT_EQ(now, want[t]) << "tick " << t;
  }
}

TEST(TickGenerator, BrakesFromAnyTickWithoutAJump) {
  std::mt19937_64 random(65);
  for (int i = 0; i < test::scaled(100); ++i) {
    const test::Chain chain = fast_chain(random, 24);
    const std::vector<Segment> segments = plan(chain);
    Machine m;
    const std::uint64_t at = random() % segments.back().end.tick;
    ASSERT_NO_FATAL_FAILURE(m.run_to(segments, at, 333));
    const MotionState before = m.generator.state();
    ASSERT_EQ(before.tick, at);
    const Segment brake = motion::make_brake(before, chain.limits);
    m.queue.clear();
    m.generator.replace(brake);
    m.fed = segments.size();
    TickBlock block;
    m.generator.fill(block, 1);
    for (int a = 0; a < chain.limits.axes; ++a) {
      // First rate of the brake: the speed at that tick, half a tick of braking later.
      ASSERT_EQ(native(block.axis[index(a)].position_q64),
                native(before.axis[index(a)].position_q64));
      ASSERT_LE(abs64(block.axis[index(a)].rate_q62 - before.axis[index(a)].speed_q62),
                chain.limits.axis[index(a)].accel_q62);
    }
    ASSERT_NO_FATAL_FAILURE(m.board.play(block));
    ASSERT_NO_FATAL_FAILURE(m.run_to(segments, brake.end.tick + 300, 333));
    for (int a = 0; a < max_axes; ++a)
      ASSERT_EQ(m.board.position(a), native(brake.end.axis[index(a)].position_q64));
    EXPECT_FALSE(m.generator.running());
    EXPECT_FALSE(m.generator.underrun());
  }
}

/// Leads that drives may need: none, equal ones, or as long as many segments.
PerAxis<std::uint32_t> random_leads(std::mt19937_64& random) {
  PerAxis<std::uint32_t> leads{};
  const std::uint32_t most = random() % 2 == 0 ? 5000 : 60;
  for (std::uint32_t& lead : leads)
    if (random() % 4 != 0) lead = static_cast<std::uint32_t>(random() % (most + 1));
  if (random() % 5 == 0) leads[1] = leads[0];
  return leads;
}

std::vector<Step> earlier(std::vector<Step> steps, const PerAxis<std::uint32_t>& leads) {
  for (Step& s : steps) s.tick -= leads[index(s.axis)];
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return a.tick != b.tick ? a.tick < b.tick : a.axis < b.axis;
  });
  return steps;
}

TEST(TickGenerator, AnAxisWithALeadStepsEarlierByTheLead) {
  std::mt19937_64 random(71);
  for (int i = 0; i < test::scaled(10); ++i) {
    const std::vector<Segment> segments = shifted(plan(fast_chain(random, 100)), 6000);
    const std::uint64_t end = segments.back().end.tick + 1000;
    Machine plain, ahead;
    const PerAxis<std::uint32_t> leads = random_leads(random);
    ahead.generator.set_leads(leads);
    for (Machine* machine : {&plain, &ahead}) machine->generator.set_arm_lead(5);
    ASSERT_NO_FATAL_FAILURE(plain.run_to(segments, end));
    ASSERT_NO_FATAL_FAILURE(ahead.run_to(segments, end));
    ASSERT_GT(plain.board.steps().size(), 100u);
    EXPECT_EQ(ahead.board.sorted_steps(), earlier(plain.board.steps(), leads));
    EXPECT_EQ(ahead.board.bits(), plain.board.bits());
    EXPECT_FALSE(ahead.generator.underrun());
    EXPECT_TRUE(ahead.queue.released());
  }
}

/// With jerk pulses and leads, in runs of any length: the same steps and bits as in blocks.
TEST(TickGenerator, AxesSeparatelyStepAsInBlocks) {
  std::mt19937_64 random(74);
  for (int i = 0; i < test::scaled(10); ++i) {
    test::Chain chain = fast_chain(random, 60);
    if (i % 3 != 0) test::limit_jerk(chain, random);
    const std::vector<Segment> segments = shifted(plan(chain), 6000);
    const PerAxis<std::uint32_t> leads =
        i % 2 == 0 ? random_leads(random) : PerAxis<std::uint32_t>{};
    const std::uint64_t end = std::min<std::uint64_t>(segments.back().end.tick + 1000, 2'000'000);
    Machine blocks, axes;
    for (Machine* machine : {&blocks, &axes}) {
      machine->generator.set_leads(leads);
      machine->generator.set_arm_lead(5);
      machine->generator.set_trigger({chain.limits.beat_ticks, 40, 6000});
    }
    ASSERT_NO_FATAL_FAILURE(blocks.run_to(segments, end));
    ASSERT_NO_FATAL_FAILURE(axes.run_axes_to(segments, end, i % 4 == 0 ? 20 : 1000, random));
    ASSERT_GT(blocks.board.steps().size(), 20u);
    EXPECT_EQ(axes.board.sorted_steps(), blocks.board.sorted_steps());
    EXPECT_EQ(axes.board.bits(), blocks.board.bits());
    EXPECT_EQ(axes.generator.last_trigger(), blocks.generator.last_trigger());
    EXPECT_FALSE(axes.generator.underrun());
    EXPECT_TRUE(axes.queue.released());
  }
}

/// Motors of axis pairs, in blocks and separately: the same steps, no reversal within a run, no
/// step lost; they equal sums and differences of the motors of a Cartesian machine.
TEST(TickGenerator, MotorsOfPairsStepAsTheirAxesTogether) {
  settings::Values values;
  values.set_milli(settings::Id::kinematics, 1000);
  values.set_milli(settings::Id::ganged_axis, 3000);
  const Kinematics kinematics(values);
  std::mt19937_64 random(75);
  for (int i = 0; i < test::scaled(10); ++i) {
    test::Chain chain = fast_chain(random, 60);
    if (i % 3 != 0) test::limit_jerk(chain, random);
    const std::vector<Segment> segments = shifted(plan(chain), 6000);
    PerAxis<std::uint32_t> leads = random_leads(random);
    leads[1] = leads[0];
    leads[3] = leads[2];
    const std::uint64_t end = std::min<std::uint64_t>(segments.back().end.tick + 1000, 2'000'000);
    Machine plain, blocks, motors;
    for (Machine* machine : {&blocks, &motors}) machine->generator.set_kinematics(kinematics);
    for (Machine* machine : {&plain, &blocks, &motors}) machine->generator.set_leads(leads);
    ASSERT_NO_FATAL_FAILURE(plain.run_to(segments, end));
    ASSERT_NO_FATAL_FAILURE(blocks.run_to(segments, end));
    ASSERT_NO_FATAL_FAILURE(motors.run_axes_to(segments, end, i % 4 == 0 ? 20 : 1000, random));
    EXPECT_GT(motors.board.steps().size(), 20u);
    EXPECT_EQ(motors.board.sorted_steps(), blocks.board.sorted_steps());
    const test::Native half = native(middle_of_step(0));
    const auto axis = [&plain](int a) { return plain.board.position(a); };
    EXPECT_EQ(motors.board.position(0), axis(0) + axis(1) - half);
    EXPECT_EQ(motors.board.position(1), axis(0) - axis(1) + half);
    EXPECT_EQ(motors.board.position(2), axis(2));
    EXPECT_EQ(motors.board.position(3), axis(2) + axis(3) - half);
    EXPECT_EQ(motors.generator.state().axis[0].position_q64,
              plain.generator.state().axis[0].position_q64);
  }
}

/// Adds a pause wherever the plan comes to rest.
std::vector<Segment> with_pauses(std::vector<Segment> segments, std::mt19937_64& random) {
  std::uint64_t pause = 0;
  for (Segment& s : segments) {
    s.start_tick += pause;
    s.end.tick += pause;
    if (s.end.at_rest()) pause += 1 + random() % 3000;
  }
  return segments;
}

/// Bits that change before a segment begins, within the same run: in blocks and axis by axis, bits
/// and segments keep their ticks.
TEST(TickGenerator, TriggersWhileItWaitsForSegmentsAndBeginsThemInTime) {
  std::mt19937_64 random(75);
  for (int i = 0; i < test::scaled(10); ++i) {
    test::Chain chain = fast_chain(random, 20 + 30 * static_cast<std::size_t>(i % 2));
    if (i % 4 != 1) chain.mode = JoinMode::start_stop;
    const std::vector<Segment> segments = with_pauses(shifted(plan(chain), 6000), random);
    const auto arm_lead = static_cast<std::uint32_t>(random() % 30);
    const std::uint64_t end = segments.back().end.tick + 6000;
    const PerAxis<std::uint32_t> leads =
        i % 2 == 0 ? random_leads(random) : PerAxis<std::uint32_t>{};
    const TriggerPattern trigger{100 + static_cast<std::uint32_t>(random() % 400), 40, 77};
    Machine blocks, axes;
    for (Machine* machine : {&blocks, &axes}) {
      machine->generator.set_leads(leads);
      machine->generator.set_arm_lead(arm_lead);
      machine->generator.set_trigger(trigger);
    }
    ASSERT_NO_FATAL_FAILURE(blocks.run_to(segments, end));
    ASSERT_NO_FATAL_FAILURE(axes.run_axes_to(segments, end, 4000, random));
    EXPECT_EQ(axes.board.sorted_steps(), blocks.board.sorted_steps());
    for (const Machine* machine : {&blocks, &axes}) {
      ASSERT_NO_FATAL_FAILURE(expect_bits(machine->board, segments, arm_lead, trigger, end));
      for (int a = 0; a < max_axes; ++a)
        EXPECT_EQ(machine->board.counted(a), segments.back().end.axis[index(a)].step());
      EXPECT_FALSE(machine->generator.underrun());
      EXPECT_TRUE(machine->queue.released());
    }
  }
}

TEST(TickGenerator, BrakesFromTheHeadForAnyLeads) {
  std::mt19937_64 random(72);
  for (int i = 0; i < test::scaled(100); ++i) {
    const test::Chain chain = fast_chain(random, 24);
    const std::vector<Segment> segments = shifted(plan(chain), 6000);
    Machine plain, ahead;
    const PerAxis<std::uint32_t> leads = random_leads(random);
    ahead.generator.set_leads(leads);
    const std::uint32_t lead = ahead.generator.lead();
    std::uint64_t at = 1000 + random() % segments.back().end.tick;
    // Brakes again before some axes have reached the first brake.
    for (int brakes = 0; brakes < 3; ++brakes) {
      ASSERT_NO_FATAL_FAILURE(ahead.run_to(segments, at));
      ASSERT_NO_FATAL_FAILURE(plain.run_to(segments, at + lead));
      const MotionState state = ahead.generator.state(), wanted = plain.generator.state();
      ASSERT_EQ(ahead.generator.running(), plain.generator.running());
      ASSERT_EQ(state.tick, wanted.tick);
      for (int a = 0; a < max_axes; ++a) {
        const AxisState& is = state.axis[index(a)];
        ASSERT_EQ(native(is.position_q64), native(wanted.axis[index(a)].position_q64));
        ASSERT_EQ(is.speed_q62, wanted.axis[index(a)].speed_q62);
      }
      for (Machine* machine : {&plain, &ahead}) machine->brake(chain.limits, segments.size());
      at += random() % 3 == 0 ? 0 : random() % 500;
    }
    ASSERT_NO_FATAL_FAILURE(ahead.run_to(segments, at + 100'000));
    ASSERT_NO_FATAL_FAILURE(plain.run_to(segments, at + 100'000));
    ASSERT_EQ(ahead.board.sorted_steps(), earlier(plain.board.steps(), leads));
    EXPECT_FALSE(ahead.generator.underrun());
    EXPECT_TRUE(ahead.queue.released());
  }
}

TEST(TickGenerator, HaltsEachAxisWhereItsStepsAre) {
  std::mt19937_64 random(73);
  for (int i = 0; i < test::scaled(20); ++i) {
    const std::vector<Segment> segments = shifted(plan(fast_chain(random, 24)), 6000);
    Machine machine;
    if (i % 4 != 0) machine.generator.set_leads(random_leads(random));
    ASSERT_NO_FATAL_FAILURE(machine.run_to(segments, 1000 + random() % segments.back().end.tick));
    machine.generator.halt();
    machine.fed = segments.size();
    EXPECT_TRUE(machine.queue.released() && machine.queue.empty());
    const MotionState state = machine.generator.state();
    EXPECT_TRUE(state.at_rest());
    EXPECT_FALSE(machine.generator.running());
    for (int a = 0; a < max_axes; ++a)
      EXPECT_EQ(state.axis[index(a)].step(), machine.board.counted(a));
    const std::size_t steps = machine.board.steps().size();
    ASSERT_NO_FATAL_FAILURE(machine.run_to(segments, machine.board.tick() + 20'000));
    EXPECT_EQ(machine.board.steps().size(), steps);
  }
}

/// Braking with limited jerk, with and without leads: checks every tick of plan and brake.
TEST(TickGenerator, BrakesWithinTheJerkLimit) {
  std::mt19937_64 random(67);
  int inside = 0;
  for (int i = 0; i < test::scaled(80); ++i) {
    SCOPED_TRACE(i);
    test::Chain chain = test::random_chain(random, 24);
    test::limit_jerk(chain, random);
    const std::vector<Segment> segments = shifted(plan(chain), 6000);
    if (segments.back().end.tick > 5'000'000) continue;
    Machine machine;
    TickGenerator& generator = machine.generator;
    SegmentQueue& queue = machine.queue;
    NaiveBoard& board = machine.board;
    if (i % 2 != 0) generator.set_leads(random_leads(random));
    std::vector<test::JerkWatch> watches;
    for (const motion::AxisLimits& axis : chain.limits.axis) watches.emplace_back(axis);
    const auto watch = [&](const TickBlock& block) {
      for (int a = 0; a < chain.limits.axes; ++a)
        for (std::uint32_t j = 0; j < block.ticks; ++j) {
          const AxisRun& run = block.axis[index(a)];
          ASSERT_LE(abs64(run.accel_q62), chain.limits.axis[index(a)].accel_q62);
          ASSERT_LE(abs64(run.rate_q62 + run.accel_q62 * j), chain.limits.axis[index(a)].speed_q62);
          watches[index(a)].tick(run.accel_q62);
        }
    };
    const auto allow = [&](const Segment& s) {
      for (int a = 0; a < chain.limits.axes; ++a) watches[index(a)].allow_stairs(s.axis[index(a)]);
    };
    std::size_t fed = 0;
    const std::uint64_t at = random() % segments.back().end.tick;
    TickBlock block;
    while (board.tick() < at) {
      while (fed < segments.size() && queue.free() != 0) {
        allow(segments[fed]);
        queue.push(segments[fed++]);
      }
      generator.fill(block,
                     static_cast<std::uint32_t>(std::min<std::uint64_t>(at - board.tick(), 9999)));
      ASSERT_NO_FATAL_FAILURE(board.play(block));
      ASSERT_NO_FATAL_FAILURE(watch(block));
    }
    const MotionState before = generator.state();
    const Segment brake = motion::make_brake(before, chain.limits, generator.accelerations_q62());
    inside += motion::stays_inside(brake, before, chain.limits) ? 1 : 0;
    allow(brake);
    queue.clear();
    generator.replace(brake);
    while (board.tick() < brake.end.tick + 300) {
      generator.fill(block, static_cast<std::uint32_t>(1 + random() % 5000));
      ASSERT_NO_FATAL_FAILURE(board.play(block));
      ASSERT_NO_FATAL_FAILURE(watch(block));
    }
    EXPECT_FALSE(generator.running());
    EXPECT_FALSE(generator.underrun());
    for (int a = 0; a < chain.limits.axes; ++a) {
      const test::JerkWatch& axis = watches[index(a)];
      ASSERT_FALSE(axis.broken()) << "axis " << a << ": " << axis.worst() << " stairs";
      EXPECT_LE(std::llabs(board.counted(a) - brake.end.axis[index(a)].step()), 0);
    }
  }
  // The work space of these chains is the box of their points.
  EXPECT_GT(inside, test::scaled(80) / 4);
}

TEST(TickGenerator, ACancelledShotIsNotArmed) {
  std::mt19937_64 random(66);
  test::Chain chain = fast_chain(random, 4, 1);
  for (wire::Target& t : chain.targets) t.shots = 1;
  const std::vector<Segment> segments = plan(chain);
  Machine m;
  // Within an open window: braking or halting closes it.
  const std::uint64_t in_window = segments[0].end_tick() - 1;
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, in_window));
  ASSERT_EQ(m.board.bits().back().bits, arm_bit);
  m.brake(chain.limits, segments.size());
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, in_window + 1));
  EXPECT_EQ(m.board.bits().back().bits, 0);
}

TEST(TickGenerator, ReportsMotionThatEndsAtASpeed) {
  std::mt19937_64 random(67);
  std::vector<Segment> segments = plan(fast_chain(random, 30));
  std::size_t moving_end = 0;
  while (segments[moving_end].end.at_rest()) ++moving_end;
  segments.resize(moving_end + 1);
  Machine m;
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, segments.back().end.tick, 100));
  EXPECT_FALSE(m.generator.underrun());
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, segments.back().end.tick + 10, 100));
  EXPECT_TRUE(m.generator.underrun());
}

TEST(TickGenerator, IsAtRestUntilASegmentStarts) {
  std::mt19937_64 random(69);
  const std::vector<Segment> segments = shifted(plan(fast_chain(random, 5)), 12'345);
  Machine m;
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, 12'345));
  EXPECT_FALSE(m.generator.running());
  EXPECT_TRUE(m.board.steps().empty());
  ASSERT_NO_FATAL_FAILURE(m.run_to(segments, 12'346));
  EXPECT_TRUE(m.generator.running());
}

}  // namespace
}  // namespace lamplock::stepper::tick_generator_test
