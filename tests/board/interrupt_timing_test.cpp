// The core with its interrupts at the worst places: an edge of the lamp that comes between two
// calls of the main loop, whichever two, is told to whoever asks next. The virtual board has no
// such moments; a board with real interrupts has them in every pass.
#include <deque>
#include <numeric>
#include <random>
#include <vector>

#include "firmware/machine/controller.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::test {
namespace {

constexpr std::uint64_t pass_ticks = 250;
constexpr std::uint64_t timing_lead_ticks = 300;
constexpr std::uint64_t fill_lead_ticks = 2000;

/// A board as short as can be, for a lamp that we trigger (ticks of nominal length). The edge of a
/// beat comes in one of the gaps between the calls of a pass.
class HandBoard {
 public:
  HandBoard(const job::Job& job, std::uint64_t seed)
      : core(job.settings), job_(job), random_(seed) {
    stop_tick_ = 200'000 + random_() % 300'000;
  }

  machine::Controller core;
  std::vector<std::uint32_t> fired;  ///< how often each point was fired

  void begin(std::uint32_t first) {
    ASSERT_EQ(core.on_begin(job::header_from(job_, first)), Result::ok);
    job::RecordEncoder encoder(job_, first);
    ASSERT_EQ(core.on_data(encoder.next(1024, 100)), Result::ok);
    ASSERT_EQ(encoder.index(), job_.targets.size());
  }
  /// One pass of the main loop; `order` is what the host says in it.
  template <class Order>
  void pass(Order&& order) {
    now_ += pass_ticks;
    const std::uint64_t gap = random_() % 4;
    if (gap == 0) interrupt();
    order();
    if (gap == 1) interrupt();
    const bool plan = core.prepare(now_ * clocks_per_tick);
    if (gap == 2) interrupt();
    while (plan && core.plan()) {
    }
    core.commit();
    if (gap == 3) interrupt();
    feed();
    withdraw();
    if (!token_) token_ = core.next_token(held_);
  }
  void pass() {
    pass([] {});
  }
  wire::Status status() const {
    wire::Status status;
    core.fill_status(status);
    return status;
  }
  bool stop_due() const { return now_ >= stop_tick_; }
  /// The next pass is one with an edge.
  bool edge_ahead() const { return core.clock().tick_of_beat(beat_) <= now_ + pass_ticks; }
  std::uint32_t shots() const {
    return std::accumulate(fired.begin(), fired.end(), std::uint32_t{0});
  }
  /// The beat interrupt: the edge of the beat that is due, and whether it fired.
  void interrupt() {
    if (core.clock().tick_of_beat(beat_) > now_) return;
    const std::uint64_t tick = core.clock().tick_of_beat(beat_++);
    const std::uint64_t delay = core.fire_timing().delay_clocks;
    const bool spent = token_ && held_.not_before_tick <= tick;
    const bool fires = spent && tick < held_.expires_tick && armed(tick);
    if (fires) count(core.clock().tick_of_beat(held_.beat));
    if (spent) token_ = false;
    core.lamp_edge(tick * clocks_per_tick - delay, fires, spent);
  }

 private:
  bool armed(std::uint64_t tick) const {
    for (const stepper::TickBlock& b : blocks_)
      if (b.first_tick <= tick && tick < b.first_tick + b.ticks)
        return (b.bits & stepper::arm_bit) != 0;
    return false;
  }
  /// The point that the machine stands at is the one that was fired.
  void count(std::uint64_t tick) {
    fired.resize(job_.targets.size());
    for (const stepper::TickBlock& b : blocks_) {
      if (tick < b.first_tick || tick >= b.first_tick + b.ticks) continue;
      for (std::size_t i = 0; i < job_.targets.size(); ++i) {
        bool here = true;
        for (std::size_t a = 0; a < max_axes; ++a)
          here = here &&
                 job_.targets[i].steps[a] ==
                     b.axis[a].position_after(static_cast<std::uint32_t>(tick - b.first_tick)).hi();
        if (here) ++fired[i];
      }
    }
  }
  void feed() {
    while (core.clock().next_tick() < now_ + timing_lead_ticks) core.next_span(256);
    while (filled_ < core.clock().next_tick() + fill_lead_ticks) {
      stepper::TickBlock block;
      core.fill(block, 1024);
      filled_ = block.first_tick + block.ticks;
      blocks_.push_back(block);
    }
    while (blocks_.front().first_tick + 20'000 < now_) blocks_.pop_front();
  }
  void withdraw() {
    if (!token_ || (core.outputs().fire_enable && now_ < held_.expires_tick)) return;
    token_ = false;
    core.token_expired();
  }

  const job::Job& job_;
  std::mt19937_64 random_;
  std::deque<stepper::TickBlock> blocks_;
  lamp::FireToken held_;
  bool token_ = false;
  std::uint64_t now_ = 0, filled_ = 0, stop_tick_ = 0;
  std::uint64_t beat_ = 2;
};

class InterruptTiming : public testing::Test {
 protected:
  static job::Job job(std::uint64_t seed) {
    // Every point at a place of its own.
    points::PointCloud cloud;
    std::mt19937_64 random(seed);
    for (int i = 0; i < 40; ++i)
      cloud.push_back({i * 0.05, static_cast<double>(random() % 100) * 0.005, 0});
    return job::make_job(cloud, lamp_profile(200, settings::LampMode::master), {});
  }
};

TEST_F(InterruptTiming, IdleAfterAStopKnowsEveryShot) {
  int unfinished = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(300)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = this->job(seed);
    HandBoard board(job, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    // Half of the stops in a pass that has an edge.
    while (!board.stop_due() || (seed % 2 == 0 && !board.edge_ahead())) board.pass();
    board.pass([&] { board.core.on_command({wire::Command::stop}); });
    while (board.core.state() != MachineState::idle) board.pass();
    ASSERT_EQ(board.status().first_unfired, board.shots());
    for (int i = 0; i < 4000 && !board.core.runner().at_rest(); ++i) board.pass();
    unfinished += board.shots() < job.targets.size() ? 1 : 0;
    if (board.shots() == job.targets.size()) continue;
    ASSERT_NO_FATAL_FAILURE(board.begin(board.status().first_unfired));
    for (int i = 0; i < 40'000 && board.core.state() == MachineState::run; ++i) board.pass();
    ASSERT_EQ(board.fired, std::vector<std::uint32_t>(job.targets.size(), 1));
  }
  EXPECT_GT(unfinished, 0);
}

TEST_F(InterruptTiming, ADeadStopTellsTheShotThatTheBoardHasFound) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(100)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = this->job(seed);
    HandBoard board(job, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    while (!board.stop_due() || !board.edge_ahead()) board.pass();
    const std::uint32_t before = board.shots();
    board.pass([&] {
      board.core.input_changed(machine::Input::limit_x, true);
      board.interrupt();  // the pulse had begun
      board.core.stopped_at({});
      ASSERT_EQ(board.status().first_unfired, board.shots());
    });
    found += board.shots() > before ? 1 : 0;
  }
  EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace lamplock::test
