// Channels, shutters, attenuator, photosensors: a shot passes the only open shutter with the energy
// of its point, and a failed shot is repeated.

#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

/// A machine whose shutters take the times of its settings.
class BeamRig : public testing::Test {
 protected:
  void set_up(std::uint64_t seed) {
    random_.seed(seed);
    profile_ = lamp_profile();
    world_ = world_for(profile_, seed % 3 == 0 ? sim::LampConfig{} : faulty_lamp());
  }
  sim::LampConfig faulty_lamp() {
    sim::LampConfig lamp;
    lamp.jitter_us = 10;
    lamp.dropout = 0.02;
    lamp.seed = random_();
    return lamp;
  }
  void set(Id id, double value) { job::state_setting(profile_, id, value, "test"); }
  void slow_shutters(int open_ms, int close_ms) {
    set(Id::shutter_open, open_ms);
    set(Id::shutter_close, close_ms);
    world_.shutters = {open_ms * ps_per_ms, close_ms * ps_per_ms};
  }
  /// Groups of points share a channel and an energy, with passing points between.
  void make_job(std::size_t points, double change, double pass = 0) {
    job_ = job::make_job(histogram_walk(points, random_()), profile_, {});
    std::uint8_t channel = 0;
    std::uint16_t energy = 0;
    for (wire::Target& target : job_.targets) {
      if (chance(change)) channel = static_cast<std::uint8_t>(random_() % sim::beam_channels);
      if (chance(change)) energy = static_cast<std::uint16_t>(random_());
      target.channel = channel;
      target.energy = energy;
      if (chance(pass)) target = {target.steps, 0, 0, 0, 0};
    }
  }
  void start() {
    rig_ = std::make_unique<Rig>(profile_.settings, world_);
    cable_ = std::make_unique<BoardCable>(*rig_);
    link::SenderOptions options = session(1);
    options.auto_resume = true;
    options.on_text = [this](const std::string& text) { said_ += text; };
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, options);
  }
  link::JobResult run() {
    start();
    return finish(*sender_);
  }
  /// Runs to the end of the job; a test that would never end fails.
  link::JobResult finish(link::JobSender& sender) {
    const Picoseconds end = rig_->now() + 300 * ps_per_s;
    while (sender.step()) {
      if (rig_->now() < end) continue;
      ADD_FAILURE() << "the job does not end; " << rig_->shots().size() << " shots";
      break;
    }
    return sender.result();
  }
  bool chance(double p) { return static_cast<double>(random_() >> 11) * 0x1p-53 < p; }

  /// Shots are in order, through their channel, with their energy; each failed shot adds one.
  void expect_shots() const {
    const auto& made = rig_->board.world().photosensors().made();
    const sim::Shots& shots = rig_->shots();
    const bool repeated = profile_.settings.whole(Id::shot_check) == 2;
    std::uint16_t energy = 0;
    std::size_t point = 0;
    const auto skip_passes = [&] {
      while (point < job_.targets.size() && job_.targets[point].shots == 0) ++point;
    };
    skip_passes();
    for (std::size_t i = 0; i < shots.size(); ++i) {
      ASSERT_LT(point, job_.targets.size());
      const wire::Target& target = job_.targets[point];
      if (target.energy != 0) energy = target.energy;
      ASSERT_EQ(rig_->board.lattice_shots()[i].steps, target.steps) << "shot " << i;
      ASSERT_EQ(shots[i].channel, target.channel) << "shot " << i << " point " << point;
      ASSERT_EQ(shots[i].energy, energy) << "shot " << i << " point " << point;
      if (made[i] || !repeated) ++point;
      skip_passes();
    }
    EXPECT_EQ(point, job_.targets.size());
    EXPECT_EQ(rig_->board.world().laser().stray_pulses(), 0u);
    EXPECT_EQ(rig_->monitor.overlaps(), 0);
  }
  void expect_closed() const {
    for (int c = 0; c < sim::beam_channels; ++c)
      EXPECT_FALSE(rig_->board.bus().level(sim::shutter_pin(c))) << "shutter " << c;
    EXPECT_EQ(rig_->board.bus().attenuator(), 0);
  }
  std::uint32_t failures() const {
    const auto& made = rig_->board.world().photosensors().made();
    return static_cast<std::uint32_t>(std::count(made.begin(), made.end(), false));
  }

  std::string said_;  ///< text from the machine
  std::mt19937_64 random_;
  job::Profile profile_;
  sim::WorldConfig world_;
  job::Job job_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<BoardCable> cable_;
  std::unique_ptr<link::JobSender> sender_;
};

TEST_F(BeamRig, EveryShotGoesThroughItsShutter) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(static_cast<std::uint64_t>(seed));
    if (seed % 2 != 0)
      slow_shutters(static_cast<int>(random_() % 60), static_cast<int>(random_() % 60));
    if (seed % 4 >= 2) set(Id::attenuator_settle, static_cast<double>(random_() % 40));
    make_job(150, 0.1, seed % 5 == 0 ? 0.5 : 0.05);
    const link::JobResult result = run();
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_shots());
    expect_sound(*rig_, profile_.settings);
    expect_ledger(*rig_, result.status);
    // A shutter never causes a missed flash.
    if (seed % 3 == 0) {
      EXPECT_EQ(rig_->board.controller().runner().misses(), 0u);
    }
    rig_->run(ps_per_ms);
    expect_closed();
  }
}

/// Shutters that need no time and are never changed alter nothing: the steps are the same.
TEST_F(BeamRig, ShuttersThatNeedNoTimeCostNone) {
  set_up(0);
  make_job(200, 0);
  ASSERT_EQ(run().end, JobEnd::done);
  const std::unique_ptr<Rig> plain = std::move(rig_);
  const job::Job same = job_;
  for (wire::Target& target : job_.targets) {
    target.channel = static_cast<std::uint8_t>(random_() % sim::beam_channels);
    target.energy = static_cast<std::uint16_t>(random_() | 1);
  }
  ASSERT_EQ(run().end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_shots());
  ASSERT_EQ(plain->shots().size(), rig_->shots().size());
  for (std::size_t i = 0; i < plain->shots().size(); ++i)
    EXPECT_EQ(plain->shots()[i].at, rig_->shots()[i].at);
  // Slow shutters that are never changed cost their opening time once.
  job_ = same;
  slow_shutters(100, 100);
  for (wire::Target& target : job_.targets) target.channel = 2;
  ASSERT_EQ(run().end, JobEnd::done);
  EXPECT_EQ(rig_->monitor.openings(), 1);
  const auto length = [](const Rig& rig) { return rig.shots().back().at - rig.shots()[0].at; };
  EXPECT_EQ(length(*rig_), length(*plain));
  EXPECT_NEAR(static_cast<double>(rig_->shots()[0].at - plain->shots()[0].at), 100e9, 10.1e9);
}

TEST_F(BeamRig, AChangeTakesTheTimeOfTheShuttersAndNoMore) {
  for (const auto& [open, close, settle] :
       {std::tuple{30, 45, 0}, {0, 45, 0}, {30, 0, 0}, {20, 20, 100}}) {
    set_up(0);
    slow_shutters(open, close);
    set(Id::attenuator_settle, settle);
    make_job(40, 0);
    for (std::size_t i = 20; i < 40; ++i) job_.targets[i].channel = 1;
    job_.targets[20].energy = 1000;
    for (std::size_t i = 21; i < 40; ++i) job_.targets[i].energy = 1000;
    ASSERT_EQ(run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_shots());
    const auto ms = (rig_->shots()[20].at - rig_->shots()[19].at) / ps_per_ms;
    const int wait = std::max(open + close, settle);
    EXPECT_GE(ms, wait);
    // The move to the point, the margins at a start, the beat.
    EXPECT_LE(ms, wait + 70);
    EXPECT_GE(beats_of(rig_->status(), BeatReason::protection),
              static_cast<unsigned>(wait / 10 - 1));
    EXPECT_EQ(beats_of(rig_->status(), BeatReason::starved), 0u);
  }
}

/// More points than the queue holds: a run that ends at a change is planned as soon as the change
/// is known.
TEST_F(BeamRig, ChangesInALongJobCauseNoStarvation) {
  set_up(0);
  slow_shutters(5, 5);
  make_job(1800, 0);
  for (std::size_t i = 0; i < job_.targets.size(); ++i)
    job_.targets[i].channel = static_cast<std::uint8_t>(i / 77 % 3);
  const link::JobResult result = run();
  ASSERT_EQ(result.end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_shots());
  EXPECT_EQ(result.status.starvations, 0u);
  EXPECT_EQ(rig_->monitor.openings(), 24);
  // Twice 5 ms and the time of a start.
  EXPECT_LE(beats_of(result.status, BeatReason::protection), 24 * 4u);
}

TEST_F(BeamRig, ClosesInHoldAndDoorAndOpensInTimeAgain) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(static_cast<std::uint64_t>(seed));
    if (seed % 4 != 0) slow_shutters(25, 15);
    make_job(120, 0.05);
    start();
    for (int i = 0; i < 6; ++i) {
      const auto at = static_cast<Picoseconds>(300 + random_() % 2500) * ps_per_ms;
      const bool door = chance(0.3);
      if (door) {
        rig_->press(sim::Pin::door, at, at + 50 * ps_per_ms);
      } else {
        cable_->at(at, [this] { cable_->type("!"); });
      }
      cable_->at(at + ps_per_ms, [this] {
        if (rig_->state() != MachineState::run) expect_closed();
      });
      // Resumes while the shutter is still closing, or later.
      cable_->at(at + (door ? 60 : 2) * ps_per_ms, [this] { sender_->resume(); });
    }
    const link::JobResult result = finish(*sender_);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_shots());
    expect_sound(*rig_, profile_.settings);
  }
}

TEST_F(BeamRig, ClosesAtTheEStopAndWhenNoPointsCome) {
  set_up(0);
  slow_shutters(10, 10);
  make_job(200, 0);
  start();
  while (rig_->shots().size() < 40 && sender_->step()) {
  }
  // The host is gone, its points run out, and the dead man's timeout is off.
  EXPECT_TRUE(rig_->board.bus().level(sim::Pin::shutter_1));
  rig_->board.world().schedule(sim::Pin::estop, true, rig_->now() + ps_per_ms);
  rig_->run(ps_per_ms + 10 * ps_per_us);
  expect_closed();

  set_up(0);
  set(Id::dead_man, 0);
  slow_shutters(10, 10);
  make_job(4000, 0);
  start();
  while (rig_->shots().size() < 1200 && sender_->step()) {
  }
  EXPECT_TRUE(rig_->board.bus().level(sim::Pin::shutter_1));
  rig_->run(60 * ps_per_s);
  ASSERT_EQ(rig_->state(), MachineState::run);
  expect_closed();
  const link::JobResult result = finish(*sender_);
  ASSERT_EQ(result.end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_shots());
}

TEST_F(BeamRig, ShotsNotMadeAreCountedOrRepeated) {
  for (int seed = 0; seed < scaled(24); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(static_cast<std::uint64_t>(seed));
    world_.photosensors.failure = 0.1;
    world_.photosensors.seed = random_();
    const int check = seed % 3;
    set(Id::shot_check, check);
    set(Id::shot_repeats, 8);
    if (seed % 2 == 0) slow_shutters(20, 20);
    make_job(120, 0.05, 0.05);
    const link::JobResult result = run();
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_shots());
    expect_sound(*rig_, profile_.settings);
    expect_ledger(*rig_, result.status);
    rig_->run(ps_per_ms);  // the sensor of the last shot
    const wire::Status status = rig_->status();
    EXPECT_GT(failures(), 0u);
    EXPECT_EQ(status.shots_not_made, check == 0 ? 0 : failures());
    EXPECT_EQ(status.shots_made, check == 0 ? 0 : status.shots - failures());
    EXPECT_EQ(status.repeats, check == 2 ? failures() : 0);
  }
}

TEST_F(BeamRig, RepeatsSurviveHoldsAndStops) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(static_cast<std::uint64_t>(seed));
    world_.photosensors.failure = 0.2;
    world_.photosensors.seed = random_();
    world_.photosensors.answer = 3 * ps_per_ms;  // long enough for any event before the answer
    set(Id::shot_check, 2);
    set(Id::sensor_time, 5'000);
    set(Id::shot_repeats, 20);
    make_job(100, 0.02);
    start();
    for (int i = 0; i < 8; ++i) {
      const auto at = static_cast<Picoseconds>(300'000 + random_() % 2'000'000) * ps_per_us;
      cable_->at(at, [this] { cable_->type("!"); });
      cable_->at(at + 4 * ps_per_ms, [this] { cable_->type("~"); });
    }
    if (seed % 2 == 0) {
      const auto at = static_cast<Picoseconds>(300'000 + random_() % 1'000'000) * ps_per_us;
      cable_->at(at, [this] { sender_->stop(); });
    }
    link::JobResult result = finish(*sender_);
    if (result.end == JobEnd::stopped) {
      while (rig_->state() != MachineState::idle) rig_->run(50 * ps_per_us);
      link::SenderOptions options = session(2);
      options.first_index = rig_->status().first_unfired;
      link::JobSender rest(*cable_, job_, options);
      result = finish(rest);
    }
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_shots());
    expect_sound(*rig_, profile_.settings);
  }
}

TEST_F(BeamRig, ASensorThatSeesNothingHoldsTheJob) {
  for (const bool stuck : {false, true}) {
    set_up(0);
    (stuck ? world_.photosensors.stuck_high : world_.photosensors.blind) = true;
    set(Id::shot_check, 2);
    set(Id::shot_repeats, 3);
    make_job(50, 0);
    start();
    while (rig_->now() < 3 * ps_per_s && sender_->step()) {
    }
    EXPECT_EQ(rig_->state(), MachineState::hold);
    EXPECT_EQ(rig_->status().hold_reason, HoldReason::not_made);
    EXPECT_THAT(said_, HasSubstr("[MSG:Point 0 not made]"));
    EXPECT_EQ(rig_->shots().size(), 4u);
    EXPECT_EQ(rig_->status().first_unfired, 0u);
    expect_closed();
    cable_->type("~");  // the user resumes
    while (rig_->now() < 6 * ps_per_s && sender_->step()) {
    }
    EXPECT_EQ(rig_->state(), MachineState::hold);
    EXPECT_EQ(rig_->shots().size(), 8u);
    EXPECT_EQ(rig_->status().repeats, 7u);
  }
}

TEST_F(BeamRig, ALateAnswerIsIgnored) {
  for (const int answer_us : {190, 210}) {
    set_up(0);
    world_.photosensors.answer = answer_us * ps_per_us;
    set(Id::shot_check, 1);
    make_job(50, 0);
    ASSERT_EQ(run().end, JobEnd::done);
    rig_->run(ps_per_ms);
    EXPECT_EQ(rig_->status().shots_made, answer_us < 200 ? 50u : 0u);
    EXPECT_EQ(rig_->status().shots_not_made, answer_us < 200 ? 0u : 50u);
  }
}

/// Another channel's sensor does not confirm the shot.
TEST(BeamPath, TheSensorOfTheChannelCounts) {
  lamp::ShotScheduler shots;
  lamp::BeatClock clock;
  settings::Values values;
  values.set_milli(Id::lamp_mode, 0);
  clock.configure(values);
  lamp::ShotRules rules;
  rules.check = lamp::ShotCheck::repeat;
  rules.answer_clocks = 1000;
  shots.begin_job(rules);
  shots.permit(true, BeatReason::no_point_due);
  stepper::Segment segment;
  segment.ends_point = true;
  segment.shot = {true, 100, 2, 0};
  ASSERT_TRUE(shots.commit(segment, 1, 1));
  lamp::FireToken token;
  ASSERT_TRUE(shots.next_token(token, clock, 0));
  EXPECT_EQ(shots.beam().shutters(), 4);
  shots.edge({true, 1, 0, false}, true, true, 5000);
  lamp::PointOutcome outcome;
  shots.photosensors(0xb, 5500);
  EXPECT_FALSE(shots.outcome(outcome));
  EXPECT_TRUE(shots.point_pending());
  shots.photosensors(4, 5600);
  ASSERT_TRUE(shots.outcome(outcome));
  EXPECT_EQ(outcome.outcome, lamp::ShotResult::fired);
}

}  // namespace
}  // namespace lamplock::test
