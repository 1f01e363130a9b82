// The programs, run clock by clock in the simulator's PIO blocks (an independent implementation of
// the datasheet): every number that programs.hpp states.
#include "firmware/boards/rp2040/pio/programs.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "firmware/boards/rp2040/lattice/stamp_reader.hpp"
#include "firmware/boards/rp2040/lattice/step_kernel.hpp"
#include "firmware/boards/rp2040/lattice/tick_words.hpp"
#include "sim/chip/pio/pio_block.hpp"

namespace lamplock::rp2040 {
namespace {

using namespace pio;
using sim::chip::Cycle;

constexpr unsigned step = 0, dir = 1, sync = 8, q_switch = 9, bits = 10, arm = 12;

/// One PIO block with its pins fed back; a test may drive them from outside.
class Rig final : public sim::chip::ClockOwner {
 public:
  Rig()
      : block_(std::make_unique<sim::chip::PioBlock>(*this, 0, irqs_, [](const std::string&) {})) {
    block_->set_every_clock(true, 0);
  }
  std::uint32_t read(std::uint32_t offset) { return block_->read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) { block_->write(offset, value); }

  void load(const Program& p, unsigned offset) {
    for (unsigned i = 0; i < p.size; ++i) write(0x48 + 4 * (offset + i), p.at(i, offset));
  }
  void machine(unsigned sm, const Program& p, unsigned offset, unsigned entry, std::uint32_t shift,
               std::uint32_t pins, unsigned jmp_pin = 0) {
    const std::uint32_t base = 0xc8 + 0x18 * sm;
    write(base, 1u << 16);
    write(base + 4, (offset + p.wrap_target) << 7 | (offset + p.wrap) << 12 | jmp_pin << 24);
    write(base + 8, shift);
    write(base + 0x14, pins);
    execute(sm, encode::jump(Jump::always, offset + entry));
  }
  /// Executed in the next clock; a store of the CPU takes longer.
  void execute(unsigned sm, std::uint16_t instruction) {
    write(0xd8 + 0x18 * sm, instruction);
    run(clock_ + 2);
  }
  void outputs(unsigned sm, unsigned first, unsigned count) {
    const std::uint32_t base = 0xc8 + 0x18 * sm;
    const std::uint32_t pins = read(base + 0x14);
    write(base + 0x14, first << 5 | count << 26);
    execute(sm, encode::set(SetTo::pindirs, 31));
    write(base + 0x14, pins);
  }
  void put(unsigned sm, std::uint32_t word) { write(0x10 + 4 * sm, word); }
  void enable(std::uint32_t machines) { write(0, read(0) | machines); }
  std::uint32_t get(unsigned sm) { return read(0x20 + 4 * sm); }
  bool has(unsigned sm) { return (read(0x4) >> (8 + sm) & 1) == 0; }

  void drive(unsigned gpio, bool level) {
    outside_ = level ? outside_ | 1u << gpio : outside_ & ~(1u << gpio);
  }
  bool pad(unsigned gpio) const { return (pads_ >> gpio & 1) != 0; }
  /// Runs to the beginning of `clock`; `each(clock)` may drive pins for that clock.
  void run(Cycle until, const std::function<void(Cycle)>& each = nullptr) {
    for (; clock_ < until; ++clock_) {
      if (each) each(clock_);
      const std::uint32_t levels = block_->take_levels(), enables = block_->take_enables();
      const std::uint32_t pads = (levels & enables) | (outside_ & ~enables);
      for (unsigned gpio = 0; gpio < 30; ++gpio)
        if (((pads ^ pads_) >> gpio & 1) != 0) edges[gpio].push_back(clock_);
      pads_ = pads;
      block_->set_inputs(pads_, clock_);
      block_->clock(clock_);
    }
  }
  Cycle now() const { return clock_; }

  std::map<unsigned, std::vector<Cycle>> edges;  ///< of the pads, rise and fall in turn

  Cycle bring_up_to_date() override { return clock_; }
  void changed() override {}

 private:
  sim::chip::IrqLines irqs_;
  std::unique_ptr<sim::chip::PioBlock> block_;
  Cycle clock_ = 0;
  std::uint32_t outside_ = 0, pads_ = 0;
};

constexpr std::uint32_t autopull = 1u << 17, join_tx = 1u << 30, autopush = 1u << 16,
                        join_rx = 1u << 31, out_right = 1u << 19;

/// AXIS, BITS, TICK in one block.
struct Lattice {
  static constexpr unsigned axis_sm = 0, bits_sm = 1, tick_sm = 2;
  static constexpr std::uint32_t high = 50;
  Rig rig;
  explicit Lattice(settings::PulseMode mode = settings::PulseMode::step_dir,
                   std::uint32_t high_ticks = 0) {
    rig.load(axis_program, axis_offset);
    rig.load(bits_program, bits_offset);
    rig.load(tick_program.program, tick_offset);
    rig.machine(axis_sm, axis_program, axis_offset, 0, autopull | join_tx,
                step | 2u << 20 | step << 5 | fallen_pins(mode, high_ticks) << 26);
    rig.outputs(axis_sm, step, 2);
    rig.machine(bits_sm, bits_program, bits_offset, 0, autopull | join_tx, bits | 3u << 20);
    rig.outputs(bits_sm, bits, 3);
    rig.machine(tick_sm, tick_program.program, tick_offset, tick_program.entry, out_right,
                bits << 5 | 3u << 26 | tick_gpio << 10 | 1u << 29);
    rig.outputs(tick_sm, tick_gpio, 1);
    rig.put(tick_sm, high - tick_high_overhead);
    rig.execute(tick_sm, encode::pull(false, false));
    rig.execute(tick_sm, encode::move(MoveTo::isr, MoveFrom::osr));
    rig.execute(tick_sm, encode::move(MoveTo::x, MoveFrom::null));
  }
  void start() {
    rig.enable(1u << axis_sm | 1u << bits_sm);
    rig.run(100);
    rig.enable(1u << tick_sm);
  }
};

TEST(Programs, TicksHaveTheLengthsOfTheirWordsWithinAndBetweenWords) {
  Lattice l;
  for (int i = 0; i < 4; ++i) l.rig.put(Lattice::axis_sm, 0);
  for (int i = 0; i < 4; ++i) l.rig.put(Lattice::bits_sm, 0);
  l.rig.put(Lattice::tick_sm, tick_word(1, 20));
  l.rig.put(Lattice::tick_sm, tick_word(3, 125 - 50 - tick_low_overhead));
  l.rig.put(Lattice::tick_sm, tick_word(1, 126 - 50 - tick_low_overhead));
  l.rig.put(Lattice::tick_sm, tick_word(2, 124 - 50 - tick_low_overhead));
  l.start();
  l.rig.run(3000);
  const auto& line = l.rig.edges[tick_gpio];
  ASSERT_EQ(line.size(), 14u) << "seven ticks, then the credits have ended";
  EXPECT_EQ(line[0], 100 + tick_start_clocks + 20);
  const std::vector<Cycle> lengths{125, 125, 125, 126, 124, 124};
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_EQ(line[2 * i + 2] - line[2 * i], lengths[i]) << i;
    EXPECT_EQ(line[2 * i + 1] - line[2 * i], Lattice::high) << i;
  }
}

TEST(Programs, StepsDirectionAndBitsChangeOnTheSameClock) {
  Lattice l;
  // DIR and STEP of each tick.
  l.rig.put(Lattice::axis_sm, 0b00'01'11'11'00'10u << 20);
  l.rig.put(Lattice::axis_sm, 0);
  l.rig.put(Lattice::bits_sm, 0x01450000u);
  l.rig.put(Lattice::tick_sm, tick_word(8, 125 - 50 - tick_low_overhead));
  l.start();
  l.rig.run(100 + 8 * 125 + 60);
  const auto& line = l.rig.edges[tick_gpio];
  const auto rise = [&line](std::size_t tick) { return line[2 * tick]; };
  const auto& steps = l.rig.edges[step];
  ASSERT_EQ(steps.size(), 6u);
  for (const std::size_t tick : {1u, 2u, 3u}) {
    EXPECT_EQ(steps[2 * (tick - 1)], rise(tick) + step_latency_clocks);
    EXPECT_EQ(steps[2 * (tick - 1) + 1], steps[2 * (tick - 1)] + Lattice::high - 1);
  }
  const auto& dirs = l.rig.edges[dir];
  ASSERT_EQ(dirs.size(), 4u);
  EXPECT_EQ(dirs[0], rise(2) + step_latency_clocks);
  EXPECT_EQ(dirs[1], rise(4) + step_latency_clocks);
  EXPECT_EQ(dirs[2], rise(5) + step_latency_clocks);
  ASSERT_GE(l.rig.edges[bits].size(), 2u);
  EXPECT_EQ(l.rig.edges[bits][0], rise(1) + step_latency_clocks);
  ASSERT_GE(l.rig.edges[arm].size(), 1u);
  EXPECT_EQ(l.rig.edges[arm][0], rise(2) + step_latency_clocks);
}

TEST(Programs, PulsesOfCwAndCcwFallWithTheTickLine) {
  Lattice l(settings::PulseMode::cw_ccw);
  l.rig.put(Lattice::axis_sm, 0b00'01'10'01'00'10u << 20);
  l.rig.put(Lattice::axis_sm, 0);
  for (int i = 0; i < 2; ++i) l.rig.put(Lattice::bits_sm, 0);
  l.rig.put(Lattice::tick_sm, tick_word(8, 125 - 50 - tick_low_overhead));
  l.start();
  l.rig.run(100 + 8 * 125 + 60);
  const auto& line = l.rig.edges[tick_gpio];
  std::map<unsigned, std::vector<Cycle>> wanted;
  for (const auto& [pin, tick] : {std::pair{step, 1u}, {dir, 2u}, {step, 3u}, {dir, 5u}})
    for (const Cycle width : {Cycle{0}, Cycle{Lattice::high - 1}})
      wanted[pin].push_back(line[2 * tick] + step_latency_clocks + width);
  EXPECT_EQ(l.rig.edges[step], wanted[step]);
  EXPECT_EQ(l.rig.edges[dir], wanted[dir]);
}

TEST(Programs, LongPulsesEndWithTheirTick) {
  for (const auto mode : {settings::PulseMode::step_dir, settings::PulseMode::cw_ccw}) {
    Lattice l(mode, 3);
    // The second pin before the first one, three ticks each.
    l.rig.put(Lattice::axis_sm, 0b00'10'10'10'00'00'01'01'01'00u << 12);
    l.rig.put(Lattice::axis_sm, 0);
    for (int i = 0; i < 2; ++i) l.rig.put(Lattice::bits_sm, 0);
    l.rig.put(Lattice::tick_sm, tick_word(12, 125 - 50 - tick_low_overhead));
    l.start();
    l.rig.run(100 + 12 * 125 + 60);
    const auto& line = l.rig.edges[tick_gpio];
    const auto at = [&line](std::size_t tick) { return line[2 * tick] + step_latency_clocks; };
    EXPECT_EQ(l.rig.edges[dir], (std::vector<Cycle>{at(1), at(4)}));
    EXPECT_EQ(l.rig.edges[step], (std::vector<Cycle>{at(6), at(9)}));
  }
}

/// The pulses that shared/pulse_times.hpp calls short.
TEST(Programs, ShortPulsesHaveTheirTimesAtThePad) {
  constexpr unsigned high = tick_high_clocks - 1;  // as above
  EXPECT_GE(high * 1000, short_pulse_ns * clocks_per_us);
  EXPECT_LT((high - 1) * 1000, short_pulse_ns * clocks_per_us);
  EXPECT_GE(min_moving_tick_ns * clocks_per_us - high * 1000, short_low_ns * clocks_per_us);
}

TEST(Programs, LevelsInQuadratureStayUntilTheNextStep) {
  Lattice l(settings::PulseMode::quadrature);
  // B, A: up, up, nothing, down, down, down.
  l.rig.put(Lattice::axis_sm, 0b01'11'11'01'00'10u << 20 | 0b10'10'10'10'10'10'10'10'10'10u);
  l.rig.put(Lattice::axis_sm, all_dir_bits);
  for (int i = 0; i < 2; ++i) l.rig.put(Lattice::bits_sm, 0);
  l.rig.put(Lattice::tick_sm, tick_word(8, 125 - 50 - tick_low_overhead));
  l.start();
  l.rig.run(100 + 8 * 125 + 60);
  const auto& line = l.rig.edges[tick_gpio];
  const auto at = [&line](std::size_t tick) { return line[2 * tick] + step_latency_clocks; };
  EXPECT_EQ(l.rig.edges[step], (std::vector<Cycle>{at(0), at(4)}));
  EXPECT_EQ(l.rig.edges[dir], (std::vector<Cycle>{at(1), at(3), at(5)}));
}

TEST(Programs, AllLatticeBitsGoLowWhenTheCreditsEnd) {
  Lattice l;
  l.rig.put(Lattice::axis_sm, 0x55555555u);
  l.rig.put(Lattice::axis_sm, 0x55555555u);
  for (int i = 0; i < 3; ++i) l.rig.put(Lattice::bits_sm, 0x77777777u);
  l.rig.put(Lattice::tick_sm, tick_word(5, 69));
  l.start();
  l.rig.run(2000);
  for (const unsigned pin : {bits, bits + 1, bits + 2}) {
    ASSERT_EQ(l.rig.edges[pin].size(), 2u);
    EXPECT_LT(l.rig.edges[pin][1], l.rig.edges[tick_gpio].back() + 20);
  }
  EXPECT_EQ(l.rig.edges[step].size(), 10u);
  EXPECT_FALSE(l.rig.pad(step));
  // For good: late words would not match the clock.
  l.rig.put(Lattice::tick_sm, tick_word(2, 69));
  l.rig.run(3000);
  EXPECT_EQ(l.rig.edges[step].size(), 10u);
  EXPECT_EQ(l.rig.edges[arm].size(), 2u);
}

/// FIRE with its pins.
struct Fire {
  static constexpr unsigned sm = 3, offset = axis_program.size;
  Rig rig;
  Fire() {
    rig.load(fire_program.program, offset);
    rig.machine(sm, fire_program.program, offset, 0, out_right,
                q_switch << 5 | 1u << 26 | sync << 15, arm);
    rig.outputs(sm, q_switch, 1);
    rig.enable(1u << sm);
    rig.run(50);
  }
  /// A pulse on LAMP SYNC at `edge`, ARM high in [arm_on, arm_off).
  void pulse(Cycle edge, Cycle width, Cycle arm_on, Cycle arm_off, Cycle until) {
    rig.run(until, [&](Cycle c) {
      if (c == edge) rig.drive(sync, true);
      if (c == edge + width) rig.drive(sync, false);
      if (c == arm_on) rig.drive(arm, true);
      if (c == arm_off) rig.drive(arm, false);
    });
  }
};

TEST(Programs, EdgeToQSwitchIsTheSetDelayToTheClock) {
  for (const std::uint32_t delay : {1u, 2u, 100u, 351u}) {
    for (const Cycle edge : {100u, 101u, 102u, 103u, 107u}) {
      Fire f;
      f.rig.put(Fire::sm, delay | 40u << 16);
      f.pulse(edge, 2500, 60, 5000, 4000);
      const auto& q = f.rig.edges[q_switch];
      ASSERT_EQ(q.size(), 2u);
      EXPECT_EQ(q[0], edge + fire_fixed_clocks + delay);
      EXPECT_EQ(q[1] - q[0], fire_width_fixed_clocks + 40 * clocks_per_width_count);
      ASSERT_TRUE(f.rig.has(Fire::sm));
      EXPECT_EQ(f.rig.get(Fire::sm), fired_result);
      EXPECT_FALSE(f.rig.has(Fire::sm));
    }
  }
}

TEST(Programs, RuntsAreIgnoredUpToTheClock) {
  for (const Cycle width : {1u, 100u, 249u, 250u}) {
    Fire f;
    f.rig.put(Fire::sm, 10 | 4u << 16);
    f.pulse(100, width, 60, 9000, 2000);
    EXPECT_TRUE(f.rig.edges[q_switch].empty()) << width;
    EXPECT_FALSE(f.rig.has(Fire::sm));
  }
  Fire f;
  f.rig.put(Fire::sm, 10 | 4u << 16);
  f.pulse(100, max_runt_clocks + 1, 60, 9000, 2000);
  EXPECT_EQ(f.rig.edges[q_switch].size(), 2u);
}

TEST(Programs, ArmingAndDisarmingAtAnyClockGivesOneWholePulseOrNone) {
  int fired = 0, spent = 0;
  for (Cycle shift = 0; shift < 400; ++shift) {
    for (const bool arming : {false, true}) {
      Fire f;
      f.rig.put(Fire::sm, 10 | 4u << 16);
      f.pulse(100, 2500, arming ? 60 + shift : 60, arming ? 9000 : 60 + shift, 4000);
      const auto& q = f.rig.edges[q_switch];
      ASSERT_TRUE(f.rig.has(Fire::sm));
      const std::uint32_t result = f.rig.get(Fire::sm);
      // The sampling instruction sees the pad as it was synchroniser_clocks before.
      const bool late = 60 + shift > 100 + fire_decision_clock - synchroniser_clocks;
      const bool shot = arming ? !late : late;
      ASSERT_EQ(q.size(), shot ? 2u : 0u) << shift;
      ASSERT_EQ(result, shot ? fired_result : 10u);
      if (shot) {
        ASSERT_EQ(q[1] - q[0], fire_width_fixed_clocks + 4 * clocks_per_width_count);
      }
      ++(shot ? fired : spent);
    }
  }
  EXPECT_GT(fired, 100);
  EXPECT_GT(spent, 100);
}

TEST(Programs, ATokenAtAnyClockIsSpentOnceOrKept) {
  for (Cycle shift = 0; shift < 400; ++shift) {
    Fire f;
    f.rig.run(4000, [&](Cycle c) {
      if (c == 100) f.rig.drive(sync, true);
      if (c == 2600) f.rig.drive(sync, false);
      if (c == 60) f.rig.drive(arm, true);
      if (c == 60 + shift) f.rig.put(Fire::sm, 10 | 4u << 16);
    });
    ASSERT_TRUE(f.rig.has(Fire::sm));
    const std::uint32_t result = f.rig.get(Fire::sm);
    const bool shot = result == fired_result;
    ASSERT_TRUE(shot || result == 0) << "neither a shot nor a kept token";
    ASSERT_EQ(f.rig.edges[q_switch].size(), shot ? 2u : 0u);
    ASSERT_EQ(f.rig.read(0xc) >> (8 * Fire::sm) & 15, shot ? 0u : 1u)
        << "the token must be spent or kept";
  }
}

TEST(Programs, StampsAreWithinAClockOfTheEdgesForEver) {
  Rig rig;
  rig.load(stamp_program.program, stamp_offset);
  rig.machine(3, stamp_program.program, stamp_offset, stamp_program.entry, autopush | join_rx, 0,
              sync);
  rig.execute(3, encode::move(MoveTo::x, MoveFrom::null, Operation::invert));
  rig.run(10);
  rig.enable(1u << 3);
  auto ring = std::make_unique<StampRing>();
  StampReader reader(*ring);
  reader.begin(10);
  std::uint32_t count = 0;
  Cycle edge = 50;
  for (std::uint32_t n = 0; n < 500; ++n) {
    const Cycle width = 251 + n * 7 % 50, gap = 30 + n * 13 % 401;
    rig.run(edge + width + gap, [&](Cycle c) {
      if (c == edge) rig.drive(sync, true);
      if (c == edge + width) rig.drive(sync, false);
    });
    while (rig.has(3)) ring->words[count++ % stamp_ring_words] = rig.get(3);
    std::uint64_t found = 0;
    ASSERT_TRUE(reader.find(count % stamp_ring_words, rig.now(), rig.now(), found)) << n;
    ASSERT_GE(found, edge) << n;
    ASSERT_LE(found, edge + 1) << n;
    reader.used(found);
    edge = rig.now();
  }
}

}  // namespace
}  // namespace lamplock::rp2040
