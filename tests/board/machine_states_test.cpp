// Hold, door, stop, e-stop, limit switches and a silent host at random moments of a job: the
// machine rests inside the limits, fires no shot while held, and has fired every point once at the
// end.
#include <algorithm>

#include "host/error.hpp"
#include "tests/board/board_cable.hpp"

namespace lamplock::test::machine_states_test {
namespace {

constexpr std::size_t job_points = 60;
/// The board polls its inputs and bytes this often.
constexpr sim::Picoseconds notice = 600 * ps_per_us;
/// Braking from the highest speed that 2 m/s2 reach inside 100 mm, sqrt(2 x 0.1) m/s, plus ticks
/// handed out ahead.
constexpr sim::Picoseconds to_rest = 230 * ps_per_ms;

/// One job on one rig, disturbed at a random moment.
class Disturbed : public testing::Test {
 protected:
  void set_up(int seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    random_.seed(number);
    profile_ = lamp_profile();
    const bool jitter = seed % 4 >= 2;
    // A lag is converted to ticks at rest; if the lamp's frequency wanders later, long lags are
    // wrong.
    if (seed % 5 == 4) set_lag(profile_, {150, 0, jitter ? 300.0 : 4000.0});
    if (seed % 5 == 2) set_lag(profile_, {0, jitter ? 200.0 : 900.0, 100});
    job_ = job_for(seed % 3 == 0 ? wild_points(20, number) : histogram_walk(job_points, number),
                   profile_, both_modes[seed % 2]);
    rig_ = std::make_unique<Rig>(profile_, sim::LampConfig{.jitter_us = jitter ? 20.0 : 0.0,
                                                           .wander = jitter ? 0.01 : 0.0,
                                                           .seed = number + 1});
    cable_ = std::make_unique<BoardCable>(*rig_);
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
    jitter_ = jitter;
  }
  static link::SenderOptions session(std::uint32_t number) {
    link::SenderOptions options;
    options.session = number;
    return options;
  }
  /// A random moment of the job, to the picosecond.
  sim::Picoseconds moment() {
    return std::uniform_int_distribution<sim::Picoseconds>(110 * ps_per_ms,
                                                           800 * ps_per_ms)(random_);
  }
  sim::Picoseconds up_to(sim::Picoseconds time) {
    return std::uniform_int_distribution<sim::Picoseconds>(0, time)(random_);
  }
  void run_sender_until(sim::Picoseconds at) {
    while (rig_->board.now() < at && sender_->step()) {
    }
  }
  void finish() {
    ASSERT_EQ(sender_->run().end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(*rig_, job_, jitter_));
    expect_sound(*rig_, profile_.settings);
  }
  /// Between `from` and `to` nothing was fired, and after a while nothing moved.
  void expect_quiet(sim::Picoseconds from, sim::Picoseconds to) {
    EXPECT_EQ(rig_->monitor.fired(from + notice, to), 0u);
    EXPECT_FALSE(rig_->monitor.stepped(from + to_rest, to));
  }
  /// Sends the STOP of the running session now.
  void send_stop() {
    constexpr std::uint32_t later_than_all = 1'000'000;
    std::array<std::uint8_t, wire::frame_header_size + 1> content;
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::command, 1, later_than_all});
    out.put(static_cast<std::uint8_t>(wire::Command::stop));
    std::array<std::uint8_t, wire::max_frame> frame;
    const std::size_t size = wire::encode_frame(out.written(), frame);
    rig_->board.write(std::span<const std::uint8_t>(frame).first(size));
  }
  /// Text of the board since the last call.
  std::string said() {
    std::array<std::uint8_t, 4096> bytes{};
    const std::size_t size = rig_->board.read(bytes);
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
  }
  /// A new host process finishes the rest of the job.
  void finish_job(std::uint32_t session_number) {
    const wire::Status status = rig_->status();
    ASSERT_EQ(status.first_unfired, rig_->shots().size());
    link::SenderOptions options = session(session_number);
    options.first_index = status.first_unfired;
    ASSERT_EQ(run_job(*rig_, job_, options).end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(*rig_, job_, jitter_));
  }

  std::mt19937_64 random_;
  job::Profile profile_;
  job::Job job_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<BoardCable> cable_;
  std::unique_ptr<link::JobSender> sender_;
  bool jitter_ = false;
};

TEST_F(Disturbed, HoldByFrame) {
  int held = 0;
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    sim::Picoseconds held_at = 0;
    cable_->at(moment(), [&] { sender_->pause(); });
    while (sender_->step() && rig_->state() != MachineState::hold) {
    }
    if (rig_->state() == MachineState::hold) {
      ++held;
      held_at = rig_->board.now();
      run_sender_until(held_at + 400 * ps_per_ms);
      expect_quiet(held_at, rig_->board.now());
      EXPECT_EQ(rig_->state(), MachineState::hold);
      sender_->resume();
    }
    ASSERT_NO_FATAL_FAILURE(finish());
  }
  EXPECT_GT(held, scaled(60) / 2);
}

TEST_F(Disturbed, HoldsAndResumesInQuickSuccession) {
  for (int seed = 0; seed < scaled(40); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    // Resumes come before, during and after the machine's coming to rest.
    for (sim::Picoseconds at = moment(); at < 1000 * ps_per_ms; at += 5 * ps_per_ms) {
      cable_->at(at, [&] { cable_->type("!"); });
      cable_->at(at += up_to(60 * ps_per_ms), [&] { cable_->type("~"); });
      at += up_to(60 * ps_per_ms);
    }
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, HoldFollowedByAnImmediateResume) {
  // Both arrive before the shots that were handed out ahead: those must not be planned again.
  for (int seed = 0; seed < scaled(25); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    // Rare enough for the machine to reach its points.
    const auto pause = [this] { return 20 * ps_per_ms + up_to(60 * ps_per_ms); };
    for (sim::Picoseconds at = moment(); at < 2000 * ps_per_ms; at += pause()) {
      if (seed % 2 == 0) {
        cable_->at(at, [&] { cable_->type("!~"); });
      } else {
        cable_->at(at, [&] { cable_->type("!"); });
        cable_->at(at += up_to(3 * ps_per_ms), [&] { cable_->type("~"); });
      }
    }
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, HoldsWhileSomeAxesLagTheOthers) {
  // Beats much shorter than the lag: a hold occurs before some axes have reached the last brake.
  for (int seed = 0; seed < scaled(30); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(seed);
    jitter_ = false;
    profile_ = lamp_profile(2000, settings::LampMode::slave, 10);
    set_lag(profile_, {5000, 0, 300});
    job_ = job_for(histogram_walk(100, static_cast<std::uint64_t>(seed)), profile_,
                   both_modes[seed % 2]);
    rig_ = std::make_unique<Rig>(profile_);
    cable_ = std::make_unique<BoardCable>(*rig_);
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
    for (sim::Picoseconds at = 30 * ps_per_ms; at < 400 * ps_per_ms; at += up_to(30 * ps_per_ms)) {
      for (int holds = 0; holds < 6; ++holds) {
        cable_->at(at += up_to(4 * ps_per_ms), [&] { cable_->type("!"); });
        cable_->at(at += up_to(2 * ps_per_ms), [&] { cable_->type("~"); });
      }
    }
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, HoldsInAJobLongerThanTheQueue) {
  for (int seed = 0; seed < scaled(2); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    set_up(seed);
    job_ = job::make_job(histogram_walk(1600, static_cast<std::uint64_t>(seed)), profile_, {});
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
    for (sim::Picoseconds at = moment(); at < 20 * ps_per_s; at += up_to(40 * ps_per_ms)) {
      cable_->at(at, [&] { cable_->type("!"); });
      cable_->at(at += up_to(15 * ps_per_ms), [&] { cable_->type("~"); });
    }
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, HoldByRealTimeByte) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const sim::Picoseconds at = moment();
    run_sender_until(at);
    const bool running = rig_->state() == MachineState::run;
    const sim::Picoseconds held_at = rig_->board.now();
    cable_->type(seed % 5 == 0 ? "\x84" : "!");
    rig_->run(400 * ps_per_ms);
    if (running) {
      ASSERT_EQ(rig_->state(), MachineState::hold);
      expect_quiet(held_at, rig_->board.now());
    }
    cable_->type("~");
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, DoorOpensAndCloses) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const sim::Picoseconds open = moment(), close = open + ps_per_ms + up_to(300 * ps_per_ms);
    rig_->board.world().schedule(sim::Pin::door, true, open);
    rig_->board.world().schedule(sim::Pin::door, false, close);
    bool running = false;
    cable_->at(open - 1, [&] { running = rig_->state() == MachineState::run; });
    cable_->at(close - 1, [&] {
      EXPECT_TRUE(!running || rig_->state() == MachineState::door);
      cable_->type("~");  // an open door still holds the machine
    });
    run_sender_until(close - ps_per_us);
    // A decided shot is fired, at most one delay later; no other shot is.
    EXPECT_EQ(rig_->monitor.fired(open + 20 * ps_per_us, rig_->board.now()), 0u);
    if (close - open > to_rest) {
      EXPECT_FALSE(rig_->monitor.stepped(open + to_rest, rig_->board.now()));
    }
    // Closing the door does not resume: the host, still sending, leaves that to its user.
    run_sender_until(close + 500 * ps_per_ms);
    if (running) {
      EXPECT_EQ(rig_->state(), MachineState::hold);
      expect_quiet(open, rig_->board.now());
    }
    sender_->resume();
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

TEST_F(Disturbed, StopAndContinueAtTheFirstPointNotFired) {
  int stopped = 0;
  for (int seed = 0; seed < scaled(80); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    cable_->at(moment(), [&] { sender_->stop(); });
    const link::JobResult result = sender_->run();
    if (result.end == link::JobEnd::done) continue;
    ASSERT_EQ(result.end, link::JobEnd::stopped);
    ASSERT_EQ(result.status.first_unfired, rig_->shots().size());
    rig_->run(to_rest);
    EXPECT_EQ(rig_->state(), MachineState::idle);
    ASSERT_NO_FATAL_FAILURE(finish_job(2));
    expect_sound(*rig_, profile_.settings);
    ++stopped;
  }
  EXPECT_GT(stopped, scaled(80) / 2);
}

/// Idle means at rest: a host that sees it may change settings or disconnect.
TEST_F(Disturbed, AStoppedMachineIsIdleOnceItRests) {
  int braking = 0;
  for (int seed = 0; seed < scaled(40); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    run_sender_until(moment());
    send_stop();
    const sim::Picoseconds end = rig_->board.now() + to_rest;
    while (rig_->board.now() < end) {
      rig_->run(250 * ps_per_us);
      const bool at_rest = rig_->board.controller().runner().at_rest();
      if (!at_rest) ++braking;
      ASSERT_TRUE(at_rest || rig_->state() != MachineState::idle) << rig_->board.now();
    }
    EXPECT_EQ(rig_->state(), MachineState::idle);
  }
  EXPECT_GT(braking, scaled(40));
}

/// A shot counts if the stop comes between the decision to fire and the pulse.
TEST_F(Disturbed, StopWhileAShotIsDecidedButNotBegun) {
  int late = 0;
  // At least 20 runs, because not every edge has a shot.
  for (int seed = 0; seed < std::max(20, scaled(20)); ++seed) {
    set_up(4 * seed);  // a lamp without jitter: edges every 10 ms
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    profile_.settings.set_milli(Id::q_switch_delay, 500'000);
    const auto number = static_cast<std::uint64_t>(seed);
    job_ = job::make_job(histogram_walk(job_points, number), profile_, {});
    rig_ = std::make_unique<Rig>(profile_);
    cable_ = std::make_unique<BoardCable>(*rig_);
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
    const sim::Picoseconds edge = (400 + 10 * seed) * ps_per_ms;
    run_sender_until(edge - 2 * ps_per_ms);
    rig_->board.run_until(edge + 100 * ps_per_us);
    const std::size_t before = rig_->shots().size();
    send_stop();
    while (rig_->state() != MachineState::idle) rig_->run(50 * ps_per_us);
    const std::size_t after = rig_->shots().size();
    EXPECT_EQ(rig_->status().first_unfired, after) << "idle before the shot was counted";
    if (after == before + 1) ++late;
    rig_->run(to_rest);
    EXPECT_EQ(rig_->shots().size(), after);
    ASSERT_NO_FATAL_FAILURE(finish_job(2));
  }
  EXPECT_GT(late, 0);
}

/// An immediate stop at `at`: checks pins, laser and alarm; then unlocks and finishes the job.
class DeadStop : public Disturbed {
 protected:
  void stop_and_resume(sim::Pin pin, sim::Picoseconds at, bool at_once) {
    constexpr sim::Picoseconds soon = 10 * ps_per_us;
    rig_->board.world().schedule(pin, true, at);
    rig_->board.world().schedule(pin, false, at + 300 * ps_per_ms);
    bool running = false;
    cable_->at(at - 1, [&] { running = rig_->state() == MachineState::run; });
    const link::JobResult result = sender_->run();
    if (!running) return;
    ASSERT_EQ(result.end, link::JobEnd::alarm);
    EXPECT_NE(result.status.alarm, 0);
    ASSERT_EQ(result.status.first_unfired, rig_->shots().size());
    rig_->board.run_until(at + 250 * ps_per_ms);
    if (at_once) {
      EXPECT_FALSE(rig_->monitor.stepped(at + soon, rig_->board.now()));
      EXPECT_EQ(rig_->monitor.fired(at, rig_->board.now()), 0u);
      EXPECT_FALSE(rig_->board.bus().level(sim::Pin::q_switch));
      if (!rig_->monitor.fires().empty()) {
        EXPECT_LE(rig_->monitor.fires().back().fall, at + soon);
      }
    }
    // Locked: neither a new job nor a resume starts anything.
    cable_->type("~");
    EXPECT_THROW(run_job(*rig_, job_, session(3)), Error);
    rig_->board.run_until(std::max(rig_->board.now(), at + 350 * ps_per_ms));
    EXPECT_THROW(run_job(*rig_, job_, session(4)), Error);
    EXPECT_EQ(rig_->state(), MachineState::alarm);
    EXPECT_FALSE(rig_->monitor.stepped(at + soon, rig_->board.now()));
    EXPECT_EQ(rig_->monitor.violation(profile_.settings, 0, at), "");
    cable_->type("\n$X\n");
    rig_->run(5 * ps_per_ms);
    ASSERT_EQ(rig_->state(), MachineState::idle);
    const sim::Picoseconds unlocked = rig_->board.now();
    ASSERT_NO_FATAL_FAILURE(finish_job(2));
    EXPECT_EQ(rig_->monitor.violation(profile_.settings, unlocked), "");
    EXPECT_EQ(rig_->board.world().drives().total_faults(), 0u);
  }
};

TEST_F(DeadStop, EStop) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_NO_FATAL_FAILURE(stop_and_resume(sim::Pin::estop, moment(), true));
  }
}

TEST_F(DeadStop, LimitSwitch) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_NO_FATAL_FAILURE(stop_and_resume(sim::limit_pin(seed % 3), moment(), true));
  }
}

/// No command unlocks a machine while its e-stop is pressed.
TEST_F(DeadStop, AnotherAlarmDoesNotHideTheEStop) {
  set_up(0);
  sim::World& world = rig_->board.world();
  world.schedule(sim::Pin::estop, true, 300 * ps_per_ms);
  world.schedule(sim::Pin::limit_x, true, 310 * ps_per_ms);
  world.schedule(sim::Pin::limit_x, false, 320 * ps_per_ms);
  ASSERT_EQ(sender_->run().end, link::JobEnd::alarm);
  rig_->board.run_until(330 * ps_per_ms);
  const std::size_t shots = rig_->shots().size();
  cable_->type("\n$X\n");
  rig_->run(5 * ps_per_ms);
  EXPECT_EQ(rig_->state(), MachineState::estop);
  EXPECT_THROW(run_job(*rig_, job_, session(3)), Error);
  EXPECT_FALSE(rig_->board.bus().level(sim::Pin::enable));
  EXPECT_EQ(rig_->shots().size(), shots);
}

/// `$X` at any moment: the e-stop is pressed, bounces, or is released only briefly.
TEST_F(DeadStop, NoUnlockWhileTheEStopIsPressed) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const sim::Picoseconds at = moment(), released = at + 5 * ps_per_ms + up_to(100 * ps_per_ms);
    sim::World& world = rig_->board.world();
    world.schedule(sim::Pin::estop, true, at);
    for (sim::Picoseconds bounce = at; bounce < at + ps_per_ms;) {
      world.schedule(sim::Pin::estop, false, bounce += 1 + up_to(300 * ps_per_us));
      world.schedule(sim::Pin::estop, true, bounce += 1 + up_to(300 * ps_per_us));
    }
    if (seed % 3 == 0) {  // another alarm on top
      world.schedule(sim::Pin::limit_x, true, at + up_to(3 * ps_per_ms));
      world.schedule(sim::Pin::limit_x, false, at + 4 * ps_per_ms);
    }
    world.schedule(sim::Pin::estop, false, released);
    run_sender_until(at);
    while (rig_->board.now() < released) {
      cable_->type("\n$X\n");
      rig_->board.run_until(std::min(released, rig_->board.now() + up_to(ps_per_ms) + 1));
      const bool pressed = rig_->board.bus().level(sim::Pin::estop);
      ASSERT_TRUE(!pressed || rig_->state() == MachineState::estop);
      ASSERT_FALSE(pressed && rig_->board.bus().level(sim::Pin::enable));
    }
    rig_->run(400 * ps_per_ms);
    // Nothing moved or fired after the first edge, even with `$X` in the gaps.
    EXPECT_FALSE(rig_->monitor.stepped(at + 10 * ps_per_us, rig_->board.now()));
    EXPECT_EQ(rig_->monitor.fired(at, rig_->board.now()), 0u);
    EXPECT_EQ(rig_->status().first_unfired, rig_->shots().size());
  }
}

TEST_F(DeadStop, UnlockIsRefusedWithAMessageWhileTheEStopIsPressed) {
  set_up(0);
  rig_->board.world().schedule(sim::Pin::estop, true, ps_per_ms);
  rig_->run(2 * ps_per_ms);
  cable_->type("$X\n");
  rig_->run(2 * ps_per_ms);
  const std::string text = said();
  EXPECT_NE(text.find("error:50\r\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("ok\r\n"), std::string::npos) << text;
}

TEST_F(DeadStop, AReleasedEStopSaysHowToUnlock) {
  set_up(0);
  rig_->board.world().schedule(sim::Pin::estop, true, ps_per_ms);
  rig_->run(2 * ps_per_ms);
  said();
  rig_->board.world().schedule(sim::Pin::estop, false, rig_->board.now());
  rig_->run(2 * ps_per_ms);
  EXPECT_EQ(said(), "[MSG:'$H'|'$X' to unlock]\r\n");
}

TEST_F(DeadStop, EStopInTheMiddleOfAShot) {
  int cut_short = 0;
  // Between the edge, the decision, the rise of the Q-switch and its fall: to the microsecond.
  for (int us = 0; us < 12; ++us) {
    set_up(4 * us + us % 2);  // a lamp without jitter: edges every 10 ms
    SCOPED_TRACE(testing::Message() << us << " us after the edge");
    const sim::Picoseconds at = (400 + 10 * us) * ps_per_ms + us * ps_per_us + 500 * sim::ps_per_ns;
    ASSERT_NO_FATAL_FAILURE(stop_and_resume(sim::Pin::estop, at, true));
    const sim::Picoseconds width = profile_.settings.milli(Id::q_switch_width) * sim::ps_per_ns;
    for (const PinMonitor::Fire& fire : rig_->monitor.fires())
      cut_short += fire.fall - fire.rise < width ? 1 : 0;
  }
  EXPECT_GT(cut_short, 0);
}

TEST_F(Disturbed, SilentHostHoldsTheMachine) {
  for (int seed = 0; seed < scaled(15); ++seed) {
    set_up(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    profile_.settings.set_milli(Id::dead_man, 300'000);
    job_ = job::make_job(histogram_walk(200, static_cast<std::uint64_t>(seed)), profile_, {});
    rig_ = std::make_unique<Rig>(profile_);
    cable_ = std::make_unique<BoardCable>(*rig_);
    sender_ = std::make_unique<link::JobSender>(*cable_, job_, session(1));
    jitter_ = false;
    run_sender_until(moment());
    const sim::Picoseconds silent_from = rig_->board.now();
    rig_->run(1500 * ps_per_ms);
    EXPECT_EQ(rig_->state(), MachineState::hold);
    EXPECT_EQ(rig_->status().hold_reason, wire::HoldReason::dead_man);
    expect_quiet(silent_from + 305 * ps_per_ms, rig_->board.now());
    // Not before its time either: points were still fired.
    EXPECT_GT(rig_->monitor.fired(silent_from, silent_from + 300 * ps_per_ms), 0u);
    ASSERT_NO_FATAL_FAILURE(finish());
  }
}

}  // namespace
}  // namespace lamplock::test::machine_states_test
