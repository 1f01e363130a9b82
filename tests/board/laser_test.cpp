// The continuous laser on the virtual board: light in segments that have power, at their ticks, and
// only while it is enabled. The test builds the segments itself.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/stepper/segment_power.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::test {
namespace {

using sim::Picoseconds;
using sim::ps_per_ms;
using sim::ps_per_us;

/// Times at which ticks are output.
class TickTimes final : public sim::TickListener {
 public:
  void ticks_played(const sim::PlayedTicks& ticks) override {
    if (ticks.from <= tick && tick < ticks.to)
      at = ticks.start + (ticks.end - ticks.start) * static_cast<Picoseconds>(tick - ticks.from) /
                             static_cast<Picoseconds>(ticks.to - ticks.from);
  }
  void beat_begins(std::uint64_t /*tick*/, Picoseconds /*at*/) override {}
  std::uint64_t tick = 0;
  Picoseconds at = 0;  ///< begin of that tick
};

class LaserBoard : public testing::Test {
 protected:
  static constexpr std::uint32_t lead = 6000, cruise = 8000, tail = 4000;
  static constexpr stepper::PowerPoints power{0, 40'000, 10'000};

  LaserBoard() {
    board_.listen(start_);
    board_.run_until(50 * ps_per_ms);
  }
  /// Accelerates to a tenth of a step per tick and brakes to rest, with light all the way.
  void move() {
    // The runner has no interface for foreign segments yet.
    auto& runner = const_cast<machine::JobRunner&>(board_.controller().runner());
    stepper::Segment s;
    s.end = runner.generator().state();
    s.start_tick = s.end.tick;
    s.ticks = lead + cruise + tail;
    for (stepper::AxisProfile& p : s.axis) p.cruise_ticks = s.ticks;
    stepper::AxisProfile& p = s.axis[0];
    p.lead_ticks = lead, p.cruise_ticks = cruise, p.tail_ticks = tail;
    // A multiple of lead and tail, so that it comes to rest exactly.
    const std::int64_t unit = (std::int64_t{1} << 58) / (lead * tail);
    p.lead_accel_q62 = 2 * unit * tail;
    p.tail_accel_q62 = -2 * unit * lead;
    s.end.tick = s.end_tick();
    s.end.axis[0].position_q64 = s.end.axis[0].position_q64 + (displacement_q62(p) << 2);
    set_power(s, power);
    start_.tick = s.start_tick;
    runner.generator().replace(s);
  }
  /// Runs until the motion begins.
  void move_and_start() {
    move();
    while (start_.at == 0 && board_.now() < 200 * ps_per_ms)
      board_.run_until(board_.now() + 50 * ps_per_us);
    ASSERT_NE(start_.at, 0);
  }
  const sim::Beam& beam() const { return board_.world().beam(); }
  Picoseconds time_of(std::uint32_t ticks) const { return start_.at + ticks * ps_per_us; }

  sim::VirtualBoard board_{settings::Values{}, sim::WorldConfig{}};
  TickTimes start_;
};

TEST_F(LaserBoard, ShinesAtTheTicksAndWithThePowerOfTheSegment) {
  board_.enable_laser(true);
  board_.run_until(51 * ps_per_ms);
  move();
  board_.run_until(90 * ps_per_ms);
  ASSERT_NE(start_.at, 0);
  EXPECT_NE(board_.world().drives().position()[0], 0);
  EXPECT_EQ(beam().openings(), 1u);
  // A tick is a microsecond, apart from the slewing by the lamp.
  const Picoseconds first = beam().changes().front().at;
  EXPECT_NEAR(static_cast<double>(first - start_.at), 0, 20e3);
  EXPECT_FALSE(beam().shone(0, start_.at - ps_per_us));
  EXPECT_FALSE(beam().shone(time_of(lead + cruise + tail + 20), board_.now()));
  // The power lasts to the end of its cell.
  const auto expect_power = [this](std::uint32_t at, double now, double then) {
    const double is = beam().at(time_of(at)).light();
    EXPECT_GE(is, std::min(now, then) - 70) << at;
    EXPECT_LE(is, std::max(now, then) + 70) << at;
  };
  for (std::uint32_t at = 100; at + 100 < lead; at += 97)
    expect_power(at, 40'000.0 * at / lead, 40'000.0 * (at + 64) / lead);
  for (std::uint32_t at = lead + 100; at + 100 < lead + cruise; at += 97)
    expect_power(at, 40'000, 40'000);
  for (std::uint32_t at = 100; at + 100 < tail; at += 97)
    expect_power(lead + cruise + at, 40'000 - 30'000.0 * at / tail,
                 40'000 - 30'000.0 * (at + 64) / tail);
  const double exact = (lead * 20'000.0 + cruise * 40'000.0 + tail * 25'000.0) / 65'535 * 1e-6;
  EXPECT_NEAR(beam().energy(0, board_.now()), exact, 0.01 * exact);
  EXPECT_EQ(beam().at(board_.now()).power, 0);
}

TEST_F(LaserBoard, IsDarkWhileItIsNotEnabled) {
  move_and_start();
  board_.run_until(time_of(4000));
  board_.enable_laser(true);
  board_.run_until(time_of(8000));
  board_.enable_laser(false);
  board_.run_until(time_of(30'000));
  EXPECT_NE(board_.world().drives().position()[0], 0);
  EXPECT_FALSE(beam().shone(0, time_of(4000)));
  EXPECT_TRUE(beam().shone(time_of(4300), time_of(4301)));
  EXPECT_TRUE(beam().shone(time_of(7999), time_of(8000)));
  // It is dark after the main loop's next round.
  EXPECT_FALSE(beam().shone(time_of(8300), board_.now()));
  EXPECT_EQ(beam().at(board_.now()).power, 0);
}

TEST_F(LaserBoard, AnEStopTurnsItOffAtOnceAndForGood) {
  board_.enable_laser(true);
  move_and_start();
  const Picoseconds pressed = time_of(7000) + ps_per_us / 3;
  board_.world().schedule(sim::Pin::estop, true, pressed);
  board_.world().schedule(sim::Pin::estop, false, pressed + 5 * ps_per_ms);
  board_.run_until(time_of(40'000));
  EXPECT_TRUE(beam().shone(pressed - ps_per_us, pressed));
  EXPECT_FALSE(beam().shone(pressed + 1, board_.now()));
  EXPECT_FALSE(board_.bus().level(sim::Pin::laser_gate));
}

}  // namespace
}  // namespace lamplock::test
