// The core on a minimal board, driven call by call.
#pragma once

#include <deque>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "firmware/machine/controller.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::test {

inline constexpr std::uint64_t pass_ticks = 250;
inline constexpr std::uint64_t timing_lead_ticks = 300;
inline constexpr std::uint64_t fill_lead_ticks = 2000;

/// Points in a row that jumps from side to side: all places differ.
inline job::Job jumping_row(int points, std::uint64_t seed) {
  geometry::PointCloud cloud;
  std::mt19937_64 random(seed);
  for (int i = 0; i < points; ++i)
    cloud.push_back({i * 0.05, static_cast<double>(random() % 100) * 0.005, 0});
  job::Profile profile = lamp_profile(200, LampMode::master);
  profile.settings.set_milli(settings::Id::dead_man, 0);  // HandBoard receives no frames
  return job::make_job(cloud, profile, {});
}

/// A minimal board for a lamp that it triggers (ticks of nominal length). The edge of a beat occurs
/// in one of the gaps between the calls of a pass.
class HandBoard {
  const job::Job& job_;
  std::mt19937_64 random_;
  const std::uint64_t stop_tick_ = 200'000 + random_() % 300'000;
  const bool stages_ = random_() % 2 == 0;  ///< as a board that masks interrupts briefly

 public:
  HandBoard(const job::Job& job, std::uint64_t seed) : job_(job), random_(seed) {}

  machine::Controller core{
      job_.settings,
      {},
      {.parts = stages_ ? machine::HandoutMode::staged : machine::HandoutMode::straight}};
  bool plans_itself = true;                ///< if false, another thread calls plan()
  std::function<void()> while_parts_wait;  ///< called between two parts
  std::vector<std::uint32_t> fired;        ///< how often each point was fired

  void begin(std::uint32_t first) {
    ASSERT_EQ(core.on_begin(job::header_from(job_, first)), Result::ok);
    job::RecordEncoder encoder(job_, first);
    while (encoder.index() != job_.targets.size())
      ASSERT_EQ(core.on_data(encoder.next(1024, 100)), Result::ok);
  }
  /// One pass of the main loop; `order` sends the host's command in it.
  template <class Order>
  void pass(Order&& order) {
    now_ += pass_ticks;
    const std::uint64_t gap = random_() % 4;
    if (gap == 0) interrupt();
    order();
    if (stages_) core.look_ahead();
    if (gap == 1) interrupt();
    const bool plan = core.prepare(now_ * clocks_per_tick);
    if (gap == 2) interrupt();
    while (plans_itself && plan && core.plan()) {
    }
    ASSERT_NO_FATAL_FAILURE(hand_out());
    core.service_host();
    if (gap == 3) interrupt();
    feed();
    withdraw();
    if (!token_) token_ = core.next_token(held_, now_);
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
  /// The next pass has an edge.
  bool edge_ahead() const { return core.clock().tick_of_beat(beat_) <= now_ + pass_ticks; }
  std::uint32_t shots() const {
    return std::accumulate(fired.begin(), fired.end(), std::uint32_t{0});
  }
  /// The beat interrupt: reports the edge of the due beat and whether it fired.
  void interrupt() {
    // A change of frequency renumbers the beats.
    if (beat_ticks_ != core.clock().beat_ticks()) {
      beat_ticks_ = core.clock().beat_ticks();
      beat_ = core.clock().beat_at_or_after(now_);
    }
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
  void hand_out() {
    for (std::uint32_t parts = 0;; ++parts) {
      ASSERT_LT(parts, stepper::SegmentQueue::capacity) << "a part waits and is never taken";
      if (stages_) core.stage();
      core.commit();
      if (!core.part_waits()) return;
      if (while_parts_wait) while_parts_wait();
      if (!stages_) return;
    }
  }
  /// Checks that the machine is at the point that was fired.
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

  std::deque<stepper::TickBlock> blocks_;
  lamp::FireToken held_;
  bool token_ = false;
  std::uint64_t now_ = 0, filled_ = 0;
  std::uint64_t beat_ = 2;
  std::uint32_t beat_ticks_ = core.clock().beat_ticks();
};

}  // namespace lamplock::test
