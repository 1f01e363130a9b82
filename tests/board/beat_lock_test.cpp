// Programs with M130: every end of a feed move fires one shot at its place, on a beat and in order,
// whatever happens between; no shot in rapids, without the lock, or after an abort.
#include <fmt/format.h>

#include <random>

#include "host/program/program_run.hpp"
#include "host/units.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::beat_lock_test {
namespace {

constexpr double steps_per_mm = 200;
constexpr std::uint8_t reset_byte = 0x18;

StepPosition steps_at(double x, double y, double z = 0) {
  const auto steps = [](double mm) {
    return static_cast<std::int32_t>(std::lround(mm * steps_per_mm));
  };
  return {steps(x), steps(y), steps(z)};
}

/// Alternates locked and unlocked parts inside a cube of 20 mm; knows the shots to be fired.
class LockedProgram {
 public:
  explicit LockedProgram(std::uint64_t seed) : random_(seed) { text_ = "G21 G90 F12000\n"; }

  LockedProgram& parts(int count) {
    for (int i = 0; i < count; ++i) part(static_cast<unsigned>(random_() % 3));
    text_ += "M131\n";
    return *this;
  }
  /// One part, locked from its first line on.
  LockedProgram& locked(bool free, int moves) {
    part(free ? 2 : 1, moves);
    return *this;
  }

  const std::string& text() const { return text_; }
  const std::vector<StepPosition>& shots() const { return shots_; }
  const StepPosition& end() const { return at_; }

 private:
  void part(unsigned kind, int moves = 0) {
    text_ += kind == 0 ? "M131\n" : kind == 1 ? "M130 P0\n" : "M130 P1\n";
    const int count = moves != 0 ? moves : 1 + static_cast<int>(random_() % 60);
    for (int i = 0; i < count; ++i) move(kind != 0);
  }
  void move(bool locked) {
    const bool rapid = random_() % 5 == 0, far = random_() % 10 == 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t most = far ? 2000 : 60;
      const auto change =
          static_cast<std::int32_t>(random_() % static_cast<unsigned>(2 * most + 1));
      at_[a] = std::clamp(at_[a] + change - most, -2000, 2000);
    }
    if (random_() % 8 == 0) at_ = before_;
    before_ = at_;
    text_ += fmt::format("G{} X{:.3f} Y{:.3f} Z{:.3f}\n", rapid ? 0 : 1, at_[0] / steps_per_mm,
                         at_[1] / steps_per_mm, at_[2] / steps_per_mm);
    if (locked && !rapid) shots_.push_back(at_);
    if (random_() % 40 == 0) text_ += "G4 P0.01\n";
  }

  std::mt19937_64 random_;
  std::string text_;
  StepPosition at_{}, before_{};
  std::vector<StepPosition> shots_;
};

/// A board with its lamp and the host of programs.
class BeatLock : public testing::Test {
 protected:
  void start(std::uint64_t seed, double hz = 500) {
    constexpr std::array modes{LampMode::slave, LampMode::master, LampMode::free_beat};
    jitter_ = seed % 3 == 0 && seed % 2 == 0;
    profile_ = lamp_profile(hz, modes[seed % 3], 10);
    rig_ = std::make_unique<Rig>(profile_, sim::LampConfig{.jitter_us = jitter_ ? 20.0 : 0.0,
                                                           .dropout = seed % 6 == 0 ? 0.02 : 0.0,
                                                           .seed = seed + 1});
    host_ = std::make_unique<ProgramHost>(*rig_);
    random_.seed(seed);
  }
  /// The first of these shots (with `all`: every shot) were fired once and in order, and no other.
  void expect_fired(const std::vector<StepPosition>& wanted, bool all = true) {
    expect_places(wanted, all);
    expect_good_pulses();
  }
  /// As expect_fired(), and every axis kept its limits: unlike points of a path, lines pass corners
  /// at a speed above zero.
  void expect_fired_within_limits(const std::vector<StepPosition>& wanted, bool all = true) {
    expect_places(wanted, all);
    expect_sound(*rig_, profile_.settings);
  }
  void expect_places(const std::vector<StepPosition>& wanted, bool all) {
    const auto& shots = rig_->board.lattice_shots();
    ASSERT_EQ(rig_->shots().size(), shots.size());
    ASSERT_LE(shots.size(), wanted.size());
    ASSERT_TRUE(!all || shots.size() == wanted.size()) << shots.size() << " of " << wanted.size();
    for (std::size_t i = 0; i < shots.size(); ++i) {
      ASSERT_EQ(shots[i].steps, wanted[i]) << "shot " << i;
      ASSERT_TRUE(i == 0 || rig_->shots()[i].beat > rig_->shots()[i - 1].beat) << i;
      if (jitter_) continue;
      for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(rig_->shots()[i].steps[a], wanted[i][a]) << i;
    }
  }
  void expect_good_pulses() const {
    EXPECT_EQ(rig_->board.world().drives().total_faults(), 0u);
    const sim::Laser& laser = rig_->board.world().laser();
    EXPECT_EQ(laser.narrow_pulses() + laser.late_pulses() + laser.unlit_pulses(), 0u);
    EXPECT_EQ(rig_->board.controller().shots().stray_shots(), 0u);
    EXPECT_FALSE(rig_->board.controller().runner().underrun());
  }
  /// Streams `text` and calls `disturb` now and then.
  template <class Disturb>
  void stream(const std::string& text, Disturb disturb) {
    std::size_t sent = 0, lines = 0, known = 0;
    const std::size_t before = host_->answers().size();
    const auto limit = rig_->now() + 200 * ps_per_s;
    while (rig_->now() < limit) {
      known = host_->answers().size() - before;
      while (sent < text.size() && lines < known + 10) {
        const std::size_t size = text.find('\n', sent) + 1 - sent;
        host_->send(std::string_view(text).substr(sent, size));
        sent += size;
        ++lines;
      }
      if (sent == text.size() && known == lines && rig_->state() == MachineState::idle) return;
      host_->run_ms(0.5);
      disturb();
    }
    FAIL() << "not at its end: " << host_->status();
  }
  double up_to(double most) { return std::uniform_real_distribution<double>(0, most)(random_); }
  bool now_and_then(unsigned one_in) { return random_() % one_in == 0; }
  void open_door(bool open) { rig_->set(sim::Pin::door, open); }
  StepPosition stood() {
    host_->run_ms(5);  // until the ticks handed out are over
    return rig_->board.world().drives().position();
  }
  /// From the first step to the last step or shot.
  double busy_seconds() const {
    const Picoseconds last = std::max(rig_->monitor.last_step(), rig_->monitor.fires().back().rise);
    return sim::seconds(last - rig_->monitor.first_step());
  }
  /// From now on nothing fires, and after a while nothing moves.
  void expect_quiet() {
    host_->run_ms(1);  // until the event is detected and a shot that the hardware has begun is over
    const std::size_t shots = rig_->shots().size();
    host_->run_ms(300);
    EXPECT_EQ(rig_->shots().size(), shots);
    const StepPosition at = stood();
    host_->run_ms(50);
    EXPECT_EQ(stood(), at);
    EXPECT_FALSE(rig_->board.controller().outputs().fire_enable);
  }

  job::Profile profile_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<ProgramHost> host_;
  std::mt19937_64 random_;
  bool jitter_ = false;
};

TEST_F(BeatLock, FiresOnceAtEveryEndOfAFeedMoveAndNowhereElse) {
  for (int seed = 0; seed < scaled(18); ++seed) {
    SCOPED_TRACE(seed);
    const auto number = static_cast<std::uint64_t>(seed);
    start(number);
    if (seed % 4 == 1) rig_->board.set_planning_time(2 * ps_per_ms);
    const LockedProgram program = LockedProgram(number).parts(6);
    ASSERT_TRUE(host_->stream(program.text()));
    EXPECT_THAT(host_->answers(), Each("ok"));
    ASSERT_NO_FATAL_FAILURE(expect_fired(program.shots()));
    EXPECT_EQ(stood(), program.end());
  }
}

/// Each part may begin and end a beat earlier or later: how many lines after a point are known when
/// it is planned depends on when they arrived.
TEST_F(BeatLock, TakesTheTimeThatCheckPredicts) {
  constexpr int parts = 6;
  for (int seed = 0; seed < scaled(18); ++seed) {
    SCOPED_TRACE(seed);
    start(static_cast<std::uint64_t>(seed));
    if (jitter_ || seed % 6 == 0) continue;  // check assumes a lamp without faults
    const LockedProgram program = LockedProgram(static_cast<std::uint64_t>(seed)).parts(parts);
    const auto plan = program_run::run_program(program.text(), profile_.settings, 1);
    ASSERT_TRUE(plan.problems.empty());
    rig_->run(100 * ps_per_ms);  // until it follows the lamp
    ASSERT_TRUE(host_->stream(program.text()));
    EXPECT_EQ(plan.beats.shots, rig_->shots().size());
    const double beat_s = 1 / in_units(profile_.settings, settings::Id::lamp_frequency);
    EXPECT_NEAR(plan.seconds(), busy_seconds(), 2 * parts * beat_s);
  }
}

/// More points than the board can hold, fewer than a window; also without M131 or a program end.
TEST_F(BeatLock, RunsAcceptedPointsWithoutAnEndMark) {
  for (const int count : {1, 5, 35, 36, 37, 300, 1500}) {
    for (const bool free : {false, true}) {
      SCOPED_TRACE(testing::Message() << count << (free ? " free" : " path"));
      start(1, 2000);
      const LockedProgram program = LockedProgram(7).locked(free, count);
      ASSERT_TRUE(host_->stream(program.text()));
      ASSERT_NO_FATAL_FAILURE(expect_fired_within_limits(program.shots()));
      EXPECT_EQ(stood(), program.end());
      EXPECT_THAT(host_->status(), StartsWith("<Idle|"));
      // The program then continues as usual.
      const std::size_t before = rig_->shots().size();
      ASSERT_TRUE(host_->stream("G1 X1 F6000\nX2\nM131\nX3\n"));
      EXPECT_EQ(rig_->shots().size(), before + 2);
    }
  }
}

TEST_F(BeatLock, HoldsAndDoorsCostTimeAndNoPoint) {
  for (int seed = 0; seed < scaled(18); ++seed) {
    SCOPED_TRACE(seed);
    const auto number = static_cast<std::uint64_t>(seed);
    start(number);
    LockedProgram program(number + 100);
    for (int part = 0; part < 4; ++part) program.locked(part % 2 == 0, 40);
    int held = 0;
    stream(program.text(), [&] {
      if (!now_and_then(150)) return;
      const bool door = now_and_then(3);
      if (door)
        open_door(true);
      else
        host_->send("!");
      host_->run_ms(up_to(100));
      const MachineState state = rig_->state();
      if (state == MachineState::hold || state == MachineState::door) {
        ++held;
        EXPECT_FALSE(rig_->board.controller().outputs().fire_enable);
        if (door) {
          host_->send("~");  // no effect while the door is open
          host_->run_ms(2);
          EXPECT_EQ(rig_->state(), MachineState::door);
        }
      }
      if (door) open_door(false);
      host_->run_ms(1);
      host_->send("~");
    });
    EXPECT_GT(held, 0);
    // While the machine is idle, an open door refuses lines; then there is nothing to compare.
    if (std::count(host_->answers().begin(), host_->answers().end(), "ok") !=
        static_cast<std::ptrdiff_t>(host_->answers().size()))
      continue;
    ASSERT_NO_FATAL_FAILURE(expect_fired_within_limits(program.shots()));
    EXPECT_EQ(stood(), program.end());
  }
}

/// The shots fired are the first of the program's shots; after the reset the lock is off.
TEST_F(BeatLock, AResetDropsTheRest) {
  for (int seed = 0; seed < scaled(18); ++seed) {
    SCOPED_TRACE(seed);
    const auto number = static_cast<std::uint64_t>(seed);
    start(number);
    const LockedProgram program = LockedProgram(number + 200).locked(seed % 2 == 0, 200);
    host_->send(program.text().substr(0, 1000));
    host_->run_ms(20 + up_to(400));
    const bool first_a_hold = now_and_then(3);
    if (first_a_hold) {
      host_->send("!");
      host_->run_ms(up_to(200));
    }
    host_->send(reset_byte);
    expect_quiet();
    ASSERT_NO_FATAL_FAILURE(expect_fired_within_limits(program.shots(), false));
    EXPECT_EQ(host_->position(), stood());
    const std::size_t shots = rig_->shots().size();
    host_->send("$X\n");
    host_->run_ms(2);
    EXPECT_THAT(host_->ask("G90 G1 X1 Y1 Z1 F6000\nG0 X0\n"), Each("ok"));
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(stood(), steps_at(0, 1, 1));
    EXPECT_EQ(rig_->shots().size(), shots);
  }
}

/// Random bytes, lines and door events on a board that is slow now and then: every shot is at an
/// end of a feed move in a locked line, at most as often as programmed; limits hold; after a reset
/// a plain program runs and fires nothing.
TEST_F(BeatLock, KeepsToItsPointsWhateverHappens) {
  constexpr std::string_view bytes = "!~?\x84\x85\x90\x91\x92\x93\x94\x95\x96\x97\x99\xa0\xa1";
  const std::vector<std::string> lines{"M130 P0", "M130 P1", "M131", "M2",     "G4 P0.02",
                                       "$X",      "G1",      "M0",   "G61.1",  "G64",
                                       "G99999",  "M3 S100", "$G",   "$981=1", "G1 X1000"};
  std::size_t fired = 0;
  for (int seed = 0; seed < scaled(15); ++seed) {
    SCOPED_TRACE(seed);
    start(static_cast<std::uint64_t>(seed));
    if (seed % 4 == 1) rig_->board.set_planning_time(3 * ps_per_ms);
    std::vector<StepPosition> asked;
    std::size_t lines_sent = 0;
    // At most as many lines as the board has room for: it may be held for long.
    const auto send_line = [&](const std::string& line) {
      if (lines_sent >= host_->answers().size() + 15) return false;
      host_->send(line + "\n");
      ++lines_sent;
      return true;
    };
    send_line("G90 F12000");
    send_line("M130 P0");
    for (int i = 0; i < 400; ++i) {
      const auto pick = [&](unsigned n) { return static_cast<std::int32_t>(random_() % n); };
      if (now_and_then(12)) host_->send(bytes.substr(random_() % bytes.size(), 1));
      if (now_and_then(5)) host_->send("~");
      if (now_and_then(200)) {
        host_->send(reset_byte);
        host_->run_ms(5);  // waiting lines are dropped and get no answer
        lines_sent = host_->answers().size();
      }
      if (now_and_then(50)) open_door(now_and_then(4));
      if (now_and_then(15)) send_line(lines[random_() % lines.size()]);
      if (now_and_then(8)) {
        send_line("$X");
        send_line(now_and_then(2) ? "M130 P0" : "M130 P1");
      }
      const StepPosition at{pick(400) - 200, pick(400) - 200, pick(100) - 50};
      if (send_line(fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f} F12000", at[0] / steps_per_mm,
                                at[1] / steps_per_mm, at[2] / steps_per_mm)))
        asked.push_back(at);
      host_->run_ms(up_to(8));
    }
    open_door(false);
    host_->run_ms(2);
    host_->send(reset_byte);
    host_->run_ms(1500);
    const auto& shots = rig_->board.lattice_shots();
    ASSERT_EQ(shots.size(), rig_->shots().size());
    // Each shot is found after the one before: in order, none twice, none elsewhere.
    auto from = asked.begin();
    for (std::size_t i = 0; i < shots.size(); ++i) {
      from = std::find(from, asked.end(), shots[i].steps);
      ASSERT_NE(from, asked.end()) << "shot " << i;
      ++from;
    }
    expect_good_pulses();
    fired += shots.size();
    EXPECT_EQ(host_->position(), stood());
    EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
    const std::size_t before = shots.size();
    ASSERT_TRUE(host_->stream("G21 G90 G61 G1 X1 Y1 Z1 F6000\n")) << host_->status();
    EXPECT_EQ(stood(), steps_at(1, 1, 1));
    EXPECT_EQ(shots.size(), before);
  }
  EXPECT_GT(fired, static_cast<std::size_t>(scaled(15)) * 25);
}

TEST_F(BeatLock, AnEmergencyStopFiresNothingMore) {
  for (int seed = 0; seed < scaled(12); ++seed) {
    SCOPED_TRACE(seed);
    const auto number = static_cast<std::uint64_t>(seed);
    start(number);
    const LockedProgram program = LockedProgram(number + 300).locked(seed % 2 == 0, 200);
    host_->send(program.text().substr(0, 1000));
    host_->run_ms(20 + up_to(400));
    rig_->set(sim::Pin::estop, true);
    host_->run_ms(2);
    const std::size_t shots = rig_->shots().size();
    EXPECT_EQ(rig_->state(), MachineState::estop);
    expect_quiet();
    EXPECT_EQ(rig_->shots().size(), shots);
    // The e-stop may cut a pulse short.
    ASSERT_NO_FATAL_FAILURE(expect_places(program.shots(), false));
    EXPECT_EQ(host_->position(), stood());
    rig_->set(sim::Pin::estop, false);
    host_->run_ms(2);
    EXPECT_THAT(host_->ask("G1 X1\n"), Contains("error:9"));
    EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
    EXPECT_THAT(host_->ask("$G\n"), Not(Contains(HasSubstr("M130"))));
    EXPECT_THAT(host_->ask("G90 G1 X1 Y1 Z1 F6000\n"), Each("ok"));
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(stood(), steps_at(1, 1, 1));
    EXPECT_EQ(rig_->shots().size(), shots);
  }
}

/// If the lamp is still off or warms up, the machine waits for it and loses no point.
TEST_F(BeatLock, WaitsForTheLamp) {
  profile_ = lamp_profile(100);
  profile_.settings.set_milli(Id::lamp_warm_up, 50'000);
  rig_ = std::make_unique<Rig>(profile_, sim::LampConfig{.on_after_s = 1});
  host_ = std::make_unique<ProgramHost>(*rig_);
  const LockedProgram program = LockedProgram(3).locked(false, 20);
  host_->send(program.text() + "M131\n");
  host_->run_ms(1400);
  EXPECT_THAT(host_->status(), StartsWith("<Run|"));
  EXPECT_TRUE(rig_->shots().empty());
  ASSERT_TRUE(host_->wait_for_rest());
  ASSERT_NO_FATAL_FAILURE(expect_fired(program.shots()));
}

TEST_F(BeatLock, IsRefusedWhereTheLaserMayNotFire) {
  start(2);
  // The lamp's power would exceed its maximum.
  EXPECT_THAT(host_->ask("M130 P0\n"), ElementsAre("ok"));
  EXPECT_THAT(host_->ask("$922=100\n"),
              ElementsAre("[MSG:$922 contradicts other settings]", "error:52"));
  job::Profile profile = lamp_profile(500, LampMode::free_beat);
  profile.settings.set_milli(Id::lamp_energy, 100'000);
  Rig rig(profile);
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("M130 P0\nG1 X1 F600\n"), ElementsAre("error:20", "ok"));
  ASSERT_TRUE(host.wait_for_rest());
  EXPECT_TRUE(rig.shots().empty());
}

TEST_F(BeatLock, FiresThroughTheFirstUsableChannel) {
  start(2);
  EXPECT_THAT(host_->ask("$924=12\nM130 P0\n"), ElementsAre("ok", "ok"));
  ASSERT_TRUE(host_->stream("G1 X1 F6000\nG1 X2\n"));
  ASSERT_EQ(rig_->shots().size(), 2u);
  EXPECT_EQ(rig_->shots()[0].channel, 2);
}

/// Half the feed override takes twice the beats, from the next window on.
TEST_F(BeatLock, FollowsTheFeedOverride) {
  std::vector<std::int64_t> beats;
  for (const int lower : {0, 5}) {
    start(2);
    for (int i = 0; i < lower; ++i) host_->send(std::uint8_t{0x92});
    std::string text = "M130 P0\nF600\n";  // 0.1 mm in 10 ms: 5 beats
    for (int i = 1; i <= 100; ++i) text += fmt::format("G1 X{:.1f}\n", i / 10.0);
    ASSERT_TRUE(host_->stream(text + "M131\n"));
    ASSERT_EQ(rig_->shots().size(), 100u);
    beats.push_back(rig_->shots().back().beat - rig_->shots().front().beat);
  }
  EXPECT_EQ(beats[0], 99 * 5);
  EXPECT_EQ(beats[1], 99 * 10);
}

TEST_F(BeatLock, LeavesJobsInFramesAlone) {
  start(1, 100);
  const job::Job job = job::make_job({{1, 0, 0}, {1, 2, 0}, {3, 2, 0}}, profile_, {});
  for (std::uint32_t round = 0; round < 2; ++round) {
    const std::size_t before = rig_->shots().size();
    host_->send("M130 P1\nG90 G1 X5 Y1 F3000\nX6\n");
    host_->run_ms(20);
    EXPECT_ANY_THROW(run_job(*rig_, job));
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(rig_->shots().size(), before + 2);
    EXPECT_EQ(run_job(*rig_, job, session(100 + round)).end, JobEnd::done);
    EXPECT_EQ(rig_->shots().size(), before + 5);
    // The lock is still on.
    EXPECT_THAT(host_->ask("G91 G1 X-0.5 F600\n"), Contains("ok"));
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(stood(), steps_at(2.5, 2));
    EXPECT_EQ(rig_->shots().size(), before + 6);
  }
}

TEST_F(BeatLock, IsReadButNotRunInCheckMode) {
  start(2);
  EXPECT_THAT(host_->ask("$C\nM130 P0\nG1 X5 F100\nM131\nM2\n"), Contains("ok"));
  host_->run_ms(300);
  EXPECT_TRUE(rig_->monitor.nothing_happened());
}

TEST_F(BeatLock, JogsBetweenPointsAreNoShots) {
  start(2);
  ASSERT_TRUE(host_->stream("M130 P0\nG1 X1 F6000\n"));
  ASSERT_TRUE(host_->stream("$J=G91 X5 F3000\n"));
  EXPECT_EQ(stood(), steps_at(6, 0));
  EXPECT_EQ(rig_->shots().size(), 1u);
  ASSERT_TRUE(host_->stream("G1 X2\n"));
  EXPECT_EQ(stood(), steps_at(2, 0));
  EXPECT_EQ(rig_->shots().size(), 2u);
}

/// A hold in a dwell: the next line is of the other kind and waits too.
TEST_F(BeatLock, HoldsBetweenPointsAndLines) {
  for (const bool first_points : {true, false}) {
    start(2);
    host_->send(first_points ? "M130 P0\nG1 X1 F6000\nG4 P0.2\nM131\nG1 X5\n"
                             : "G1 X1 F6000\nG4 P0.2\nM130 P0\nG1 X5\nM131\n");
    host_->run_ms(200);
    EXPECT_EQ(stood(), steps_at(1, 0));
    host_->send("!");
    host_->run_ms(600);
    EXPECT_THAT(host_->status(), StartsWith("<Hold:0|"));
    EXPECT_EQ(stood(), steps_at(1, 0));
    host_->send("~");
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(stood(), steps_at(5, 0));
    EXPECT_EQ(rig_->shots().size(), 1u);
  }
}

/// At an open door a command to the idle machine waits until the door is closed and `~` is sent.
TEST_F(BeatLock, WaitsWhileTheDoorIsOpen) {
  start(2);
  EXPECT_THAT(host_->ask("M130 P0\n"), ElementsAre("ok"));
  open_door(true);
  host_->run_ms(2);
  EXPECT_THAT(host_->ask("G1 X1 F600\n"), ElementsAre("ok", "[MSG:Check Door]"));
  host_->run_ms(300);
  EXPECT_TRUE(rig_->monitor.nothing_happened());
  open_door(false);
  host_->run_ms(300);
  EXPECT_TRUE(rig_->monitor.nothing_happened());
  host_->send("~");
  host_->run_ms(5);
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_EQ(rig_->shots().size(), 1u);
}

}  // namespace
}  // namespace lamplock::test::beat_lock_test
