// Segments of the line planner run by the tick generator; checks its output block by block.
#include <gtest/gtest.h>

#include <memory>

#include "firmware/stepper/tick_generator.hpp"
#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

/// Runs segments as they are planned; the queue is filled up to a random number of them.
class TickRun {
 public:
  TickRun(const LineMachine& machine, LineRandom& random)
      : limits_(machine.limits()), line_limits_(machine.line_limits(limits_)), random_(random) {
    stepper::MotionState at;
    for (stepper::AxisState& a : at.axis) a.position_q64 = stepper::middle_of_step(0);
    planner_.start(at);
    generator_->set_position({});
  }

  motion::LinePlanner& planner() { return planner_; }
  /// Ticks of all segments; run(): ticks that were run.
  std::uint64_t planned() const { return planned_; }
  std::uint64_t run() const { return run_; }
  stepper::MotionState state() const { return generator_->state(); }

  /// Queues some segments and runs a part of them; false if none are left.
  bool step() {
    const std::uint32_t most = 2 + static_cast<std::uint32_t>(random_() % 30);
    while (queue_->free() > stepper::SegmentQueue::capacity - most && hand_over()) {
    }
    const std::uint64_t ticks = generator_->tick();
    const std::uint64_t ready = planned_ - ticks;
    if (ready == 0) return false;
    // The board requests available ticks only; after the last segment there are none yet.
    const std::uint64_t part = planner_.idle() ? ready : ready / 2 + 1;
    while (generator_->tick() < ticks + part) {
      const std::uint64_t left = ticks + part - generator_->tick();
      generator_->fill(block_, static_cast<std::uint32_t>(std::min<std::uint64_t>(left, 5000)));
      check_block();
      if (testing::Test::HasFatalFailure()) return false;
    }
    return true;
  }

 private:
  bool hand_over() {
    LineSegment s;
    if (!planner_.next(s)) return false;
    queue_->push(s.segment);
    for (std::size_t a = 0; a < max_axes; ++a)
      jump_[a] = std::max(jump_[a], abs64(s.segment.axis[a].speed_q62 - end_.axis[a].speed_q62));
    end_ = s.segment.end;
    planned_ += s.segment.ticks;
    return true;
  }

  void check_block() {
    ASSERT_FALSE(generator_->underrun());
    for (int a = 0; a < limits_.axes; ++a) {
      const stepper::AxisRun& r = block_.axis[index(a)];
      const motion::AxisLimits& limit = limits_.axis[index(a)];
      if (run_ != 0) {
        ASSERT_EQ(native(r.position_q64), native(position_[index(a)]));
      }
      ASSERT_LE(abs64(r.accel_q62), limit.accel_q62);
      ASSERT_LE(abs64(r.rate_q62), limit.speed_q62);
      ASSERT_LE(abs64(r.rate_after(block_.ticks - 1)), limit.speed_q62);
      // Between blocks; segments join where rounding to whole ticks lets the speed jump.
      ASSERT_LE(abs64(r.rate_q62 - rate_[index(a)]), limit.accel_q62 + jump_[index(a)]);
      position_[index(a)] = r.position_after(block_.ticks);
      rate_[index(a)] = r.rate_after(block_.ticks - 1);
    }
    run_ += block_.ticks;
  }

  motion::Limits limits_;
  motion::LineLimits line_limits_;
  motion::LineRing ring_;
  motion::LinePlanner planner_{ring_, line_limits_, limits_};
  std::unique_ptr<stepper::SegmentQueue> queue_ = std::make_unique<stepper::SegmentQueue>();
  std::unique_ptr<stepper::TickGenerator> generator_ =
      std::make_unique<stepper::TickGenerator>(*queue_);
  LineRandom& random_;
  stepper::TickBlock block_;
  stepper::MotionState end_;
  PerAxis<std::int64_t> jump_{}, rate_{};
  PerAxis<Int128> position_{};
  std::uint64_t planned_ = 0, run_ = 0;
};

void run_program(std::uint64_t seed, bool jerk) {
  LineRandom random(seed);
  LineMachine m = random_machine(random);
  if (jerk) limit_jerk(random, m);
  const auto targets = random_lines(random, m, 20 + random() % 60, between(random, 0.02, 10));
  TickRun rig(m, random);
  for (std::size_t next = 0; next < targets.size() || !rig.planner().idle();) {
    while (next < targets.size() && rig.planner().push(targets[next])) ++next;
    if (random() % 20 == 0)
      rig.planner().set_feed_percent(static_cast<std::uint32_t>(between(random, 20, 200)));
    rig.step();
    ASSERT_FALSE(testing::Test::HasFatalFailure());
  }
  while (rig.step()) {
  }
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  ASSERT_EQ(rig.run(), rig.planned());
  const stepper::MotionState end = rig.state();
  ASSERT_EQ(end.tick, rig.planned());
  ASSERT_TRUE(end.at_rest());
  for (int a = 0; a < m.axes; ++a) {
    ASSERT_EQ(end.axis[index(a)].step(), targets.back().steps[index(a)]);
    ASSERT_EQ(native(end.axis[index(a)].position_q64),
              native(rig.planner().state().axis[index(a)].position_q64));
  }
}

TEST(LineTicks, RandomProgramsThroughTheTickGenerator) {
  for (int i = 0; i < scaled(24); ++i) {
    SCOPED_TRACE(testing::Message() << "program " << i);
    ASSERT_NO_FATAL_FAILURE(run_program(static_cast<std::uint64_t>(i) + 10'000, i % 4 == 3));
  }
}

}  // namespace
}  // namespace lamplock::test
