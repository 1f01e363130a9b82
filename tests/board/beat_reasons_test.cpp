// Every flash of the lamp ends in one counter, with its reason, and every reason occurs.

#include <set>

#include "tests/board/board_cable.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

/// A job with one kind of trouble and its counted reasons, which account for all flashes.
class Reasons : public testing::Test {
 protected:
  void set(Id id, double value) { job::state_setting(profile_, id, value, "test"); }
  void begin(const sim::LampConfig& lamp = {}, bool dry = false) {
    job::JobOptions options;
    options.dry = dry;
    job_ = job::make_job(histogram_walk(150, 5), profile_, options);
    for (std::size_t i = 40; i < 50; ++i) job_.targets[i].shots = 0;
    rig_ = std::make_unique<Rig>(profile_, lamp);
    cable_ = std::make_unique<BoardCable>(*rig_);
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
  }
  /// Runs to the end of the job; drop-outs are counted too, as no_edge.
  void run(bool flashes_known = true) {
    std::int64_t before = -1;
    bool more = true;
    while (more) {
      more = sender_->step();
      if (before < 0 && rig_->state() != MachineState::idle) before = periods();
    }
    // The edges of the last beats are reported when they are judged.
    rig_->run(3 * ps_per_ms);
    const wire::Status status = rig_->status();
    std::int64_t counted = 0;
    for (std::size_t i = 0; i < max_beat_reasons; ++i) {
      const std::uint32_t beats = status.beats_by_reason[i] + status.beats_outside[i];
      counted += beats;
      if (beats != 0) seen_.insert(std::string(name(static_cast<BeatReason>(i))));
    }
    // BEGIN arrived some time before the state was read.
    if (flashes_known) {
      EXPECT_LE(std::abs(counted - (periods() - before)), 1);
    }
  }
  std::int64_t periods() const { return rig_->board.world().lamp().periods(); }
  void expect_seen(std::initializer_list<BeatReason> reasons) const {
    for (const BeatReason reason : reasons)
      EXPECT_TRUE(seen_.contains(std::string(name(reason)))) << name(reason);
  }

  job::Profile profile_ = lamp_profile();
  job::Job job_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<BoardCable> cable_;
  std::unique_ptr<link::JobSender> sender_;
  std::set<std::string> seen_;
};

TEST_F(Reasons, OfAJobWithoutTrouble) {
  begin();
  rig_->run(200 * ps_per_ms);  // until the clock is locked
  run();
  expect_seen({BeatReason::fired, BeatReason::moving, BeatReason::no_point_due});
  EXPECT_EQ(seen_.size(), 3u);
}

TEST_F(Reasons, WarmUpAndNotLocked) {
  set(Id::lamp_warm_up, 60);
  begin();
  run();
  // The lamp locks before the warm-up ends.
  expect_seen({BeatReason::fired, BeatReason::warm_up});
  EXPECT_GE(rig_->status().beats_outside[static_cast<std::size_t>(BeatReason::warm_up)], 40u);
  seen_.clear();
  profile_ = lamp_profile();
  set(Id::lock_edges, 16);
  begin();
  run();
  expect_seen({BeatReason::not_locked});
}

TEST_F(Reasons, HoldAndDoor) {
  begin();
  cable_->at(700 * ps_per_ms, [this] { cable_->type("!"); });
  cable_->at(900 * ps_per_ms, [this] { cable_->type("~"); });
  rig_->press(sim::Pin::door, 1200 * ps_per_ms, 1400 * ps_per_ms);
  cable_->at(1500 * ps_per_ms, [this] { sender_->resume(); });
  run();
  expect_seen({BeatReason::fired, BeatReason::hold, BeatReason::door});
}

TEST_F(Reasons, ProtectionByTheRateOfShots) {
  set(Id::max_shot_rate, 30);
  begin();
  run();
  expect_seen({BeatReason::fired, BeatReason::protection});
  // The limit is slightly above three beats, so the fourth may fire.
  const auto& shots = rig_->shots();
  for (std::size_t i = 1; i < shots.size(); ++i) EXPECT_GE(shots[i].beat - shots[i - 1].beat, 4);
  EXPECT_GE(beats_of(rig_->status(), BeatReason::protection), 3 * (shots.size() - 1) - 10);
}

TEST_F(Reasons, ProtectionByShutters) {
  set(Id::shutter_open, 100);
  begin();
  run();
  expect_seen({BeatReason::fired, BeatReason::protection});
  EXPECT_NEAR(rig_->status().beats_outside[static_cast<std::size_t>(BeatReason::protection)], 10,
              1);
}

TEST_F(Reasons, AnUnkindLamp) {
  set(Id::shot_tolerance, 1);
  set(Id::lamp_jitter, 100);
  sim::LampConfig lamp;
  lamp.jitter_us = 100;
  lamp.dropout = 0.03;
  begin(lamp);
  // Drop-outs while the clock searches for the rhythm have no beat to be counted on.
  run(false);
  expect_seen({BeatReason::fired, BeatReason::no_edge, BeatReason::outside_tolerance,
               BeatReason::returning});
}

TEST_F(Reasons, Alarm) {
  begin();
  rig_->press(sim::Pin::estop, 900 * ps_per_ms, 950 * ps_per_ms);
  run();
  rig_->run(ps_per_s);
  EXPECT_GE(rig_->status().beats_outside[static_cast<std::size_t>(BeatReason::alarm)], 90u);
  // The job is over: after $X its counters are fixed, and the status line shows the same.
  expect_seen({BeatReason::fired});
}

TEST_F(Reasons, Dry) {
  begin({}, true);
  run();
  expect_seen({BeatReason::dry});
  EXPECT_FALSE(seen_.contains("fired"));
}

TEST_F(Reasons, AreOnTheStatusLine) {
  begin();
  run();
  const std::string text = ProgramHost(*rig_).status();
  const wire::Status status = rig_->status();
  std::string wanted =
      std::string("|Lamp:1,") + std::to_string(rig_->board.controller().clock().edges());
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    wanted += std::string(i == 0 ? "|Beats:" : ",") +
              std::to_string(status.beats_by_reason[i] + status.beats_outside[i]);
  EXPECT_THAT(text, EndsWith(wanted + ">"));
}

}  // namespace
}  // namespace lamplock::test
