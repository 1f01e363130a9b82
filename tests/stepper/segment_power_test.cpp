// The continuous laser: gate and power in every tick, compared with exact fractions.
#include "firmware/stepper/segment_power.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "firmware/stepper/tick_generator.hpp"
#include "tests/scale.hpp"

namespace lamplock::stepper::segment_power_test {
namespace {

/// A segment and the power and phases that it was made from.
struct Lit {
  Segment segment;
  PowerPoints power;  ///< all 0: the laser is off
  std::uint32_t lead = 0, cruise = 0, tail = 0;

  bool shines() const { return (power.start | power.cruise | power.end) != 0; }
  /// Power at the beginning of tick `at` of the segment.
  double exact(std::uint32_t at) const {
    const auto between = [](double from, double to, double part) {
      return from + (to - from) * part;
    };
    if (at < lead) return between(power.start, power.cruise, double{1} * at / lead);
    if (at < lead + cruise) return power.cruise;
    return between(power.cruise, power.end, double{1} * (at - lead - cruise) / tail);
  }
};

class Segments {
 public:
  explicit Segments(std::uint64_t seed) : random_(seed) {}

  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  /// A segment with phases of random length up to `most`; some phases are empty.
  Lit next(std::uint64_t start, std::uint32_t most, bool shines) {
    Lit lit;
    do {
      lit.lead = phase(most), lit.cruise = phase(most), lit.tail = phase(most);
    } while (lit.lead + lit.cruise + lit.tail == 0);
    Segment& s = lit.segment;
    s.start_tick = start;
    s.ticks = lit.lead + lit.cruise + lit.tail;
    s.end.tick = s.end_tick();
    for (AxisProfile& p : s.axis) p.cruise_ticks = s.ticks;  // at rest
    // Axis `first` moves; each later axis moves or is at rest at random.
    const std::size_t first = below(max_axes);
    for (std::size_t a = first; a < max_axes; ++a)
      if (a == first || below(2) == 0) s.axis[a] = profile(lit);
    if (shines) {
      // A power that applies to no tick leaves the laser off.
      while (!lit.shines()) {
        lit.power = {power(), power(), power()};
        if (lit.lead == 0) lit.power.start = lit.power.cruise;
        if (lit.tail == 0) lit.power.end = lit.power.cruise;
      }
    }
    set_power(s, lit.power);
    return lit;
  }

 private:
  std::uint32_t phase(std::uint32_t most) { return below(3) == 0 ? 0 : 1 + below(most); }
  std::uint16_t power() {
    const std::uint32_t kind = below(6);
    if (kind < 2) return kind == 0 ? 0 : 65535;
    return static_cast<std::uint16_t>(random_());
  }
  AxisProfile profile(const Lit& lit) {
    AxisProfile p;
    p.lead_ticks = lit.lead, p.cruise_ticks = lit.cruise, p.tail_ticks = lit.tail;
    p.speed_q62 = std::int64_t{1} << (40 + below(18));
    if (lit.lead != 0) p.lead_accel_q62 = 2 * (p.speed_q62 / 2 / lit.lead);
    if (lit.tail != 0) p.tail_accel_q62 = -2 * (p.speed_q62 / 4 / lit.tail);
    return p;
  }
  std::mt19937_64 random_;
};

/// Records every tick, received in blocks or axis by axis.
class LightBoard {
 public:
  void play(const TickBlock& block) {
    ASSERT_EQ(block.first_tick, tick());
    const bool gate = (block.bits & gate_bit) != 0;
    for (std::uint32_t i = 0; i < block.ticks; ++i) {
      bits.push_back(block.bits);
      power.push_back(gate ? block.power(i) : std::uint16_t{0});
    }
    if (!gate) {
      ASSERT_EQ(block.power_q16 | block.power_slope_q16, 0u);
    }
  }
  void put_axis(int, const AxisRun&, std::uint32_t) {}
  void put_still(int, std::uint32_t) {}
  void set_step(int, std::int32_t) {}
  void put_bits(std::uint8_t b, std::uint32_t ticks) { bits.insert(bits.end(), ticks, b); }
  void put_power(std::uint16_t p, std::uint32_t ticks) {
    ASSERT_GT(ticks, 0u);
    power.insert(power.end(), ticks, p);
  }
  std::uint64_t tick() const { return bits.size(); }

  std::vector<std::uint8_t> bits;
  std::vector<std::uint16_t> power;
};

struct Machine {
  SegmentQueue queue;
  TickGenerator generator{queue};
  LightBoard board;
  std::size_t fed = 0;

  void feed(const std::vector<Lit>& segments) {
    while (fed < segments.size() && queue.free() != 0) queue.push(segments[fed++].segment);
  }
  void run_blocks(const std::vector<Lit>& segments, std::uint64_t tick, std::uint32_t most) {
    TickBlock block;
    while (board.tick() < tick) {
      feed(segments);
      generator.fill(
          block, static_cast<std::uint32_t>(std::min<std::uint64_t>(most, tick - board.tick())));
      ASSERT_NO_FATAL_FAILURE(board.play(block));
    }
  }
  void run_axes(const std::vector<Lit>& segments, std::uint64_t tick, std::uint32_t most,
                std::mt19937_64& random) {
    while (board.tick() < tick) {
      feed(segments);
      const auto ticks = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(tick - board.tick(), 1 + random() % most));
      generator.fill_axes(ticks, board);
      ASSERT_FALSE(::testing::Test::HasFatalFailure());
      ASSERT_EQ(board.power.size(), board.bits.size());
    }
  }
};

/// Segments with and without light, with and without a pause between them.
std::vector<Lit> program(Segments& make, std::size_t count, std::uint32_t most) {
  std::vector<Lit> segments;
  std::uint64_t tick = 10 + make.below(300);
  for (std::size_t i = 0; i < count; ++i) {
    segments.push_back(make.next(tick, most, make.below(3) != 0));
    tick = segments.back().segment.end_tick() + (make.below(3) == 0 ? make.below(500) : 0);
  }
  return segments;
}

/// The segment that contains tick `tick`; null if there is none.
const Lit* lit_at(const std::vector<Lit>& segments, std::uint64_t tick) {
  const auto after =
      std::upper_bound(segments.begin(), segments.end(), tick,
                       [](std::uint64_t t, const Lit& lit) { return t < lit.segment.start_tick; });
  if (after == segments.begin() || tick >= (after - 1)->segment.end_tick()) return nullptr;
  return &*(after - 1);
}

/// Gate and power of ticks [from, to); with `in_cells` the power is that of a tick at most half a
/// cell away.
void expect_light(const LightBoard& board, const std::vector<Lit>& segments, std::uint64_t from,
                  std::uint64_t to, bool in_cells) {
  for (std::uint64_t t = from; t < to; ++t) {
    const Lit* lit = lit_at(segments, t);
    const bool shines = lit != nullptr && lit->shines();
    ASSERT_EQ((board.bits[t] & gate_bit) != 0, shines) << "tick " << t;
    if (!shines) {
      ASSERT_EQ(board.power[t], 0) << "tick " << t;
      continue;
    }
    const auto at = static_cast<std::uint32_t>(t - lit->segment.start_tick);
    if (!in_cells) {
      ASSERT_LE(std::fabs(board.power[t] - lit->exact(at)), 1) << "tick " << t;
      continue;
    }
    // A tick of the same phase, because a jump of power happens at its exact tick.
    const std::uint32_t tail = lit->lead + lit->cruise;
    const std::uint32_t begin = at < lit->lead ? 0 : at < tail ? lit->lead : tail;
    const std::uint32_t end = at < lit->lead ? lit->lead : at < tail ? tail : lit->segment.ticks;
    const double a = lit->exact(std::max(begin + power_cell_ticks / 2, at) - power_cell_ticks / 2);
    const double b = lit->exact(std::min(end - 1, at + power_cell_ticks / 2));
    ASSERT_GE(board.power[t], std::min(a, b) - 1) << "tick " << t;
    ASSERT_LE(board.power[t], std::max(a, b) + 1) << "tick " << t;
  }
}

TEST(SegmentPower, IsWithinOneLeastBitOfExactFractions) {
  Segments make(1);
  for (int i = 0; i < test::scaled(300); ++i) {
    const std::uint32_t most = i % 4 == 0 ? 5 : i % 4 == 1 ? 65'535 : 6000;
    const Lit lit = make.next(0, most, true);
    ASSERT_TRUE(lit.segment.shines);
    const int axis = power_axis(lit.segment);
    ASSERT_GE(axis, 0);
    const AxisProfile& phases = lit.segment.axis[index(axis)];
    PowerStretch stretch;
    std::uint32_t next = 0;
    for (std::uint32_t at = 0; at < lit.segment.ticks; ++at) {
      const PowerStretch here = power_from(lit.segment.power, phases, at);
      ASSERT_LE(std::fabs(here.power_q16 / 65536.0 - lit.exact(at)), 1.0) << at;
      ASSERT_GT(here.ticks, 0u);
      // A stretch predicts the power of all its ticks.
      if (at == next) {
        stretch = here;
        next = at + here.ticks;
      }
      ASSERT_EQ(here.power_q16,
                stretch.power_q16 + stretch.slope_q16 * (stretch.ticks - next + at));
      ASSERT_EQ(here.slope_q16, stretch.slope_q16);
    }
    ASSERT_EQ(next, lit.segment.ticks);
  }
}

TEST(SegmentPower, IsOffWithoutMotionOrWithoutPower) {
  Segments make(2);
  Lit dark = make.next(0, 100, false);
  EXPECT_FALSE(dark.segment.shines);
  Segment still;
  still.ticks = 100;
  set_power(still, {1000, 1000, 1000});
  EXPECT_FALSE(still.shines);
  EXPECT_LT(power_axis(still), 0);
  // Even if `shines` is set, there is no power axis.
  still.shines = true;
  still.power = {1000, 1000, 0, 0};
  EXPECT_LT(power_axis(still), 0);
  // A shot and the power share storage.
  Segment shot;
  shot.shot = {true, 100, 2, 3};
  EXPECT_TRUE(shot.has_shot());
  EXPECT_FALSE(make.next(0, 100, true).segment.has_shot());
}

TEST(LaserGate, IsOpenOnlyInSegmentsThatShine) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(20); ++i) {
    Segments make(random());
    const std::vector<Lit> segments = program(make, 100, i % 2 == 0 ? 3000 : 60);
    const std::uint64_t end = segments.back().segment.end_tick() + 1000;
    Machine blocks, axes;
    for (Machine* machine : {&blocks, &axes}) {
      if (i % 3 == 0) machine->generator.set_leads({500, 0, 90, 1000});
      if (i % 2 == 0) machine->generator.set_trigger({200, 30, 50});
    }
    // With leads the first segment would begin before the lattice reaches it.
    const std::uint64_t later = i % 3 == 0 ? 1000 : 0;
    std::vector<Lit> shifted = segments;
    for (Lit& lit : shifted) lit.segment.start_tick += later, lit.segment.end.tick += later;
    ASSERT_NO_FATAL_FAILURE(blocks.run_blocks(shifted, end + later, 1 + make.below(20'000)));
    ASSERT_NO_FATAL_FAILURE(axes.run_axes(shifted, end + later, 1 + make.below(1000), random));
    ASSERT_NO_FATAL_FAILURE(expect_light(blocks.board, shifted, 0, end + later, false));
    ASSERT_NO_FATAL_FAILURE(expect_light(axes.board, shifted, 0, end + later, true));
    EXPECT_EQ(axes.board.bits, blocks.board.bits);
  }
}

/// With a lead of the laser against the axes, the light is the same but shifted by the lead, and
/// the laser is off while the lattice is at rest.
TEST(LaserGate, IsShiftedByTheLeadOfTheLaserAndDarkAtRest) {
  std::mt19937_64 random(8);
  for (int i = 0; i < test::scaled(40); ++i) {
    Segments make(random());
    std::vector<Lit> segments = program(make, 60, i % 2 == 0 ? 3000 : 60);
    for (Lit& lit : segments) lit.segment.start_tick += 3000, lit.segment.end.tick += 3000;
    const std::uint64_t end = segments.back().segment.end_tick() + 3000;
    const auto lead = static_cast<std::int32_t>(make.below(2001)) - 1000;
    const std::uint32_t axis_lead = i % 3 == 0 ? 0 : make.below(2000);
    Machine blocks, axes;
    for (Machine* machine : {&blocks, &axes}) {
      machine->generator.set_leads({0, axis_lead, 0, 0}, lead);
      ASSERT_EQ(machine->generator.lead(), std::max(static_cast<std::int32_t>(axis_lead), lead));
    }
    ASSERT_NO_FATAL_FAILURE(blocks.run_blocks(segments, end, 1 + make.below(20'000)));
    ASSERT_NO_FATAL_FAILURE(axes.run_axes(segments, end, 1 + make.below(1000), random));
    EXPECT_EQ(axes.board.bits, blocks.board.bits);
    EXPECT_TRUE(axes.queue.released());
    for (std::uint64_t t = 1000; t < end; ++t) {
      const std::uint64_t read = t + static_cast<std::uint64_t>(std::int64_t{lead});
      const Lit* lit = lit_at(segments, read);
      const bool shines = lit != nullptr && lit->shines() && lit_at(segments, t) != nullptr;
      ASSERT_EQ((blocks.board.bits[t] & gate_bit) != 0, shines) << "tick " << t << ", " << lead;
      const double want =
          shines ? lit->exact(static_cast<std::uint32_t>(read - lit->segment.start_tick)) : 0;
      ASSERT_LE(std::fabs(blocks.board.power[t] - want), 1) << "tick " << t << ", " << lead;
    }
  }
}

/// Brake: the light of motion already given to the drives remains; from the brake on it is off.
TEST(LaserGate, ClosesWhereABrakeBegins) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(60); ++i) {
    Segments make(random());
    std::vector<Lit> segments = program(make, 40, 400);
    for (Lit& lit : segments) lit.segment.start_tick += 3000, lit.segment.end.tick += 3000;
    Machine machine;
    const std::uint32_t lead = i % 2 == 0 ? 0 : make.below(3000);
    machine.generator.set_leads({0, lead, 0, 0});
    const std::uint64_t at =
        make.below(static_cast<std::uint32_t>(segments.back().segment.end.tick));
    ASSERT_NO_FATAL_FAILURE(i % 4 < 2 ? machine.run_blocks(segments, at, 333)
                                      : machine.run_axes(segments, at, 333, random));
    const std::uint64_t head = machine.generator.head();
    ASSERT_EQ(head, at + lead);
    if (!machine.generator.running()) continue;
    Lit brake = make.next(head, 300, false);
    machine.queue.clear();
    machine.generator.replace(brake.segment);
    machine.fed = segments.size();
    const std::uint64_t end = brake.segment.end.tick + 2000;
    ASSERT_NO_FATAL_FAILURE(i % 4 < 2 ? machine.run_blocks(segments, end, 333)
                                      : machine.run_axes(segments, end, 333, random));
    ASSERT_NO_FATAL_FAILURE(expect_light(machine.board, segments, 0, head, i % 4 >= 2));
    for (std::uint64_t t = head; t < end; ++t) {
      ASSERT_EQ(machine.board.bits[t], 0) << "tick " << t;
      ASSERT_EQ(machine.board.power[t], 0) << "tick " << t;
    }
  }
}

/// With a lead of the laser the light is off from the tick where the laser reads the brake.
TEST(LaserGate, ClosesWhereItReadsABrake) {
  std::mt19937_64 random(9);
  for (int i = 0; i < test::scaled(60); ++i) {
    Segments make(random());
    std::vector<Lit> segments = program(make, 40, 400);
    for (Lit& lit : segments) lit.segment.start_tick += 3000, lit.segment.end.tick += 3000;
    Machine machine;
    const auto lead = static_cast<std::int32_t>(make.below(2001)) - 1000;
    machine.generator.set_leads({0, i % 3 == 0 ? 0 : make.below(2000), 0, 0}, lead);
    const std::uint64_t at =
        make.below(static_cast<std::uint32_t>(segments.back().segment.end.tick));
    ASSERT_NO_FATAL_FAILURE(i % 4 < 2 ? machine.run_blocks(segments, at, 333)
                                      : machine.run_axes(segments, at, 333, random));
    if (!machine.generator.running()) continue;
    const std::uint64_t head = machine.generator.head();
    Lit brake = make.next(head, 300, false);
    machine.queue.clear();
    machine.generator.replace(brake.segment);
    machine.fed = segments.size();
    const std::uint64_t rest = brake.segment.end.tick, end = rest + 3000;
    ASSERT_NO_FATAL_FAILURE(i % 4 < 2 ? machine.run_blocks(segments, end, 333)
                                      : machine.run_axes(segments, end, 333, random));
    EXPECT_TRUE(machine.queue.released());
    for (std::uint64_t t = 1000; t < end; ++t) {
      const std::uint64_t read = t + static_cast<std::uint64_t>(std::int64_t{lead});
      const Lit* lit = read < head ? lit_at(segments, read) : nullptr;
      const bool moves = t < head ? lit_at(segments, t) != nullptr : t < rest;
      const bool shines = lit != nullptr && lit->shines() && moves;
      ASSERT_EQ((machine.board.bits[t] & gate_bit) != 0, shines) << "tick " << t << ", " << lead;
    }
  }
}

TEST(LaserGate, ClosesAtOnceAtAHalt) {
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(30); ++i) {
    Segments make(random());
    const std::vector<Lit> segments = program(make, 30, 400);
    Machine machine;
    const std::uint64_t at =
        make.below(static_cast<std::uint32_t>(segments.back().segment.end.tick));
    ASSERT_NO_FATAL_FAILURE(machine.run_axes(segments, at, 333, random));
    machine.generator.halt();
    machine.fed = segments.size();
    ASSERT_NO_FATAL_FAILURE(machine.run_axes(segments, at + 5000, 333, random));
    for (std::uint64_t t = at; t < at + 5000; ++t)
      ASSERT_EQ(machine.board.bits[t] | machine.board.power[t], 0) << "tick " << t;
  }
}

/// A program that ends at a speed is a fault; a segment that arrives too late does not begin.
TEST(LaserGate, ClosesWhereMotionEndsOrASegmentIsLate) {
  Segments make(6);
  Lit lit = make.next(100, 300, true);
  lit.segment.end.axis[0].speed_q62 = 1;
  std::mt19937_64 random(6);
  Machine machine;
  const std::uint64_t end = lit.segment.end_tick();
  ASSERT_NO_FATAL_FAILURE(machine.run_axes({lit}, end + 500, 100, random));
  EXPECT_TRUE(machine.generator.underrun());
  ASSERT_NO_FATAL_FAILURE(expect_light(machine.board, {lit}, 0, end + 500, true));
  machine.queue.push(make.next(end, 100, true).segment);
  ASSERT_NO_FATAL_FAILURE(machine.run_axes({lit}, end + 1500, 100, random));
  ASSERT_NO_FATAL_FAILURE(expect_light(machine.board, {lit}, 0, end + 1500, true));
}

}  // namespace
}  // namespace lamplock::stepper::segment_power_test
