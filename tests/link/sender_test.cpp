// Sender and link over a bad cable: every point arrives exactly once and in order.
#include "host/link/sender.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "tests/link/faulty_transport.hpp"
#include "tests/link/random_job.hpp"
#include "tests/scale.hpp"

namespace lamplock::link::sender_test {
namespace {

using namespace std::chrono_literals;
using test::FakeMachine;
using test::Faults;
using test::FaultyTransport;
using test::random_job;
using testing::HasSubstr;

/// Options with a fixed session number, the same in every run.
SenderOptions fixed_session() {
  SenderOptions options;
  options.session = 0x5EED;
  return options;
}

/// For a cable whose noise may be a one-byte command.
SenderOptions with_auto_resume() {
  SenderOptions options = fixed_session();
  options.auto_resume = true;
  return options;
}

void expect_each_once(const FaultyTransport& board, const job::Job& job, std::size_t first = 0) {
  ASSERT_EQ(board.machine.received.size(), job.targets.size() - first);
  for (std::size_t i = first; i < job.targets.size(); ++i)
    ASSERT_TRUE(test::same(board.machine.received[i - first], job.targets[i])) << i;
  ASSERT_EQ(board.machine.fired.size(), job.targets.size() - first);
  for (std::size_t i = first; i < job.targets.size(); ++i)
    ASSERT_EQ(board.machine.fired[i - first], i);
}

struct Failure {
  Exit exit;
  std::string text;
};
Failure failure_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& error) {
    return {error.exit(), error.what()};
  }
  return {Exit::done, "no error"};
}
Failure failure_of(FaultyTransport& board, const job::Job& job, SenderOptions options = {}) {
  return failure_of([&] { JobSender(board, job, std::move(options)).run(); });
}

/// A job of random points on its way to a board.
template <class Board = FaultyTransport>
struct Sending {
  template <class... Arguments>
  Sending(std::size_t points, std::uint64_t seed, const SenderOptions& options, Arguments... cable)
      : board(cable...), job(random_job(points, seed)), sender(board, job, options) {}
  Sending(std::size_t points, std::uint64_t seed, Faults faults = {})
      : Sending(points, seed, fixed_session(), faults, seed) {}
  void steps(int count = 20) {
    for (int i = 0; i < count; ++i) ASSERT_TRUE(sender.step());
  }
  void until_fired(std::size_t points) {
    while (board.machine.fired.size() < points) ASSERT_TRUE(sender.step());
  }
  /// The job is completed, every point once.
  void expect_done(std::size_t first = 0) {
    EXPECT_EQ(sender.run().end, JobEnd::done);
    expect_each_once(board, job, first);
  }

  Board board;
  job::Job job;
  JobSender sender;
};

TEST(Sender, GoodCableSendsNothingTwice) {
  Sending<> s(5000, 1);
  std::size_t seen = 0;
  while (s.sender.step()) {
    EXPECT_GE(s.sender.points_fired(), seen);
    seen = s.sender.points_fired();
  }
  EXPECT_EQ(s.sender.points_fired(), s.job.targets.size());
  const JobResult result = s.sender.result();
  EXPECT_EQ(result.end, JobEnd::done);
  EXPECT_EQ(result.resent, 0u);
  EXPECT_EQ(result.bad_frames, 0u);
  EXPECT_EQ(result.reconnects, 0u);
  EXPECT_EQ(result.status.link, wire::LinkCounters{});
  expect_each_once(s.board, s.job);
}

TEST(Sender, KeepsTheQueueFull) {
  Sending<> s(20'000, 2);
  s.board.points_per_ms = 10;  // 10 000 points per second
  const JobResult result = s.sender.run();
  EXPECT_EQ(result.end, JobEnd::done);
  // Firing takes 2 s; a time more than a few per cent above it means that the queue ran empty.
  EXPECT_LT(result.elapsed, 2200ms);
}

/// A machine that reads its port only at intervals because it plans meanwhile. Its port buffers
/// 4 KB, like that of the board (firmware/boards/rp2040/usb/usb_serial.hpp), and drops further
/// bytes.
class BusyMachine final : public FaultyTransport {
 public:
  BusyMachine(std::chrono::microseconds interval, std::uint32_t points_a_ms, std::uint64_t seed)
      : FaultyTransport({}, seed), interval_(interval) {
    points_per_ms = points_a_ms;
  }
  std::size_t dropped = 0, max_kept = 0;

 private:
  void machine_receive(std::span<const std::uint8_t> bytes) override {
    constexpr std::size_t capacity = 4096;
    const std::size_t taken = std::min(bytes.size(), capacity - kept_.size());
    kept_.insert(kept_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    dropped += bytes.size() - taken;
    max_kept = std::max(max_kept, kept_.size());
  }
  void machine_run() override {
    if (now() % 1ms == 0us) machine.fire(points_per_ms);
    if (now() % interval_ != 0us) return;
    link.receive(kept_, machine);
    kept_.clear();
    link.poll(machine);
  }

  std::vector<std::uint8_t> kept_;
  std::chrono::microseconds interval_;
};

/// Moves back and forth; every delta is a byte that must be escaped.
job::Job job_of_escapes(std::size_t points) {
  constexpr std::int32_t there = 126;  // '~'; the move back is 0x82, a real-time command
  job::Job job;
  job.header.points_total = static_cast<std::uint32_t>(points);
  for (std::size_t i = 0; i < points; ++i) {
    wire::Target target;
    for (std::size_t axis = 0; axis < 3; ++axis) target.steps[axis] = i % 2 == 0 ? there : 0;
    job.targets.push_back(target);
  }
  return job;
}

TEST(Sender, BytesInFlightFitThePortOfABusyMachineEvenIfAllAreEscaped) {
  for (int seed = 0; seed < test::scaled(5); ++seed)
    for (const bool slow : {false, true}) {
      BusyMachine board(slow ? 60ms : 30ms, slow ? 8 : 40, static_cast<std::uint64_t>(seed));
      const job::Job job =
          seed == 0 ? job_of_escapes(5000) : random_job(4000, static_cast<std::uint64_t>(seed));
      const JobResult result = JobSender(board, job, fixed_session()).run();
      EXPECT_EQ(result.end, JobEnd::done);
      EXPECT_EQ(board.dropped, 0u);
      EXPECT_GT(board.max_kept, 2048u) << "the port's buffer was not used";
      EXPECT_EQ(result.resent, 0u);
      EXPECT_EQ(result.status.link, wire::LinkCounters{});
      expect_each_once(board, job);
    }
}

struct Named {
  const char* name;
  Faults faults;
};
class BadCable : public testing::TestWithParam<Named> {};

TEST_P(BadCable, EveryPointOnceAndInOrder) {
  for (int seed = 0; seed < test::scaled(15); ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    SenderOptions options = with_auto_resume();
    options.session = static_cast<std::uint32_t>(seed) * 7919 + 1;
    options.first_index = seed % 3 == 1 ? 1234 : 0;
    Sending<> s(4000, number, options, GetParam().faults, number);
    const JobResult result = s.sender.run();
    ASSERT_EQ(result.end, JobEnd::done) << "seed " << seed;
    expect_each_once(s.board, s.job, options.first_index);
    ASSERT_EQ(s.board.machine.begins, 1);
    if (GetParam().faults.cuts > 0) {
      ASSERT_GT(result.reconnects, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, BadCable,
    testing::Values(
        Named{"drops", {.drop = 5e-4}}, Named{"flips", {.flip = 5e-4}},
        Named{"duplicates", {.duplicate = 5e-4}}, Named{"replays", {.replay = 0.2}},
        Named{"strays", {.stray_realtime = 1e-3}}, Named{"cuts", {.cuts = 10}},
        Named{"slow", {.flip = 1e-4, .delay = std::chrono::milliseconds(40)}},
        // The delay exceeds the sender's time-out: it asks repeatedly and must not be confused.
        Named{"slower", {.drop = 1e-4, .delay = std::chrono::milliseconds(400)}},
        Named{"all",
              {.drop = 2e-4,
               .flip = 2e-4,
               .duplicate = 2e-4,
               .replay = 0.05,
               .stray_realtime = 2e-4,
               .cuts = 10}}),
    [](const auto& faults) { return faults.param.name; });

TEST(Sender, EachLostFrameCostsAtMostAWindow) {
  Sending<> s(20'000, 3, {.drop = 1e-4});
  const JobResult result = s.sender.run();
  expect_each_once(s.board, s.job);
  // About 14 of the 140 000 bytes are lost; each costs at most a window of frames.
  EXPECT_GT(result.resent, 0u);
  EXPECT_LT(result.resent, 14u * 3 * 16);
}

TEST(Sender, ResumesAfterItsOwnSilenceAndOnRequestAfterNoise) {
  for (const auto reason :
       {wire::HoldReason::dead_man, wire::HoldReason::realtime, wire::HoldReason::reset}) {
    SenderOptions options = fixed_session();
    options.auto_resume = reason != wire::HoldReason::dead_man;
    Sending<> s(2000, 5, options, Faults{}, 5u);
    s.steps();
    s.board.machine.hold(reason);
    s.expect_done();
  }
}

TEST(Sender, ATypedHoldAndADoorLastUntilTheUserResumes) {
  for (const bool door : {false, true}) {
    Sending<> s(2000, 5);
    s.steps();
    if (door)
      s.board.machine.state = wire::MachineState::door;
    else
      s.board.machine.on_realtime('!');
    const std::size_t held_at = s.board.machine.fired.size();
    s.steps(1000);
    EXPECT_EQ(s.board.machine.fired.size(), held_at);
    EXPECT_EQ(s.board.machine.state, door ? wire::MachineState::door : wire::MachineState::hold);
    EXPECT_EQ(s.sender.status().hold_reason,
              door ? wire::HoldReason::none : wire::HoldReason::realtime);
    s.sender.resume();
    s.expect_done();
  }
}

TEST(Sender, ATypedResetStopsTheJobAndIsReported) {
  Sending<> s(2000, 5);
  s.steps();
  s.board.machine.on_realtime(0x18);
  const std::size_t fired = s.board.machine.fired.size();
  const Failure failure = failure_of([&] { s.sender.run(); });
  EXPECT_EQ(failure.exit, Exit::job_failed);
  EXPECT_THAT(failure.text, HasSubstr("0x18"));
  EXPECT_THAT(failure.text, HasSubstr(fmt::format("--from {}", fired)));
  EXPECT_EQ(s.board.machine.fired.size(), fired);
  EXPECT_EQ(s.board.machine.state, wire::MachineState::idle);
  EXPECT_EQ(s.sender.result().end, JobEnd::stopped);
}

TEST(Sender, PauseHoldsUntilResume) {
  Sending<> s(3000, 6, with_auto_resume(), Faults{.drop = 1e-3, .flip = 1e-3}, 6u);
  s.until_fired(500);
  s.sender.pause();
  s.steps(200);
  const std::size_t held_at = s.board.machine.fired.size();
  EXPECT_EQ(s.board.machine.reason, wire::HoldReason::host);
  s.steps(500);
  EXPECT_EQ(s.board.machine.fired.size(), held_at);
  s.sender.resume();
  s.expect_done();
}

TEST(Sender, PauseBeforeTheBeginHolds) {
  Sending<> s(3000, 6);
  s.sender.pause();
  s.steps(300);
  const std::size_t held_at = s.board.machine.fired.size();
  EXPECT_EQ(s.board.machine.reason, wire::HoldReason::host);
  EXPECT_LT(held_at, 100u);
  s.steps(300);
  EXPECT_EQ(s.board.machine.fired.size(), held_at);
  s.sender.resume();
  s.expect_done();
}

TEST(Sender, PauseTakesOverAHoldOfAnotherReason) {
  Sending<> s(2000, 6);
  s.steps();
  s.sender.pause();
  s.board.machine.hold(wire::HoldReason::realtime);
  s.steps(200);
  EXPECT_EQ(s.board.machine.reason, wire::HoldReason::host);
  s.sender.resume();
  s.expect_done();
}

TEST(Sender, StopEndsTheJob) {
  Sending<> s(3000, 7, {.drop = 1e-3});
  s.until_fired(500);
  s.sender.stop();
  const JobResult result = s.sender.run();
  EXPECT_EQ(result.end, JobEnd::stopped);
  EXPECT_EQ(s.board.machine.state, wire::MachineState::idle);
  EXPECT_EQ(result.status.first_unfired, s.board.machine.fired.size());
  EXPECT_LT(s.board.machine.fired.size(), 3000u);
}

TEST(Sender, AlarmEndsTheJob) {
  Sending<> s(5000, 9);
  s.steps();
  s.board.machine.state = wire::MachineState::alarm;
  s.board.machine.alarm = 1;
  const JobResult result = s.sender.run();
  EXPECT_EQ(result.end, JobEnd::alarm);
  EXPECT_EQ(result.status.alarm, 1);
}

TEST(Sender, AMachineThatLostTheJobGetsNoMorePoints) {
  Sending<> s(5000, 10);
  s.steps();
  s.board.link.forget_session();
  const std::size_t seen = s.sender.points_fired();
  const JobResult result = s.sender.run();
  EXPECT_EQ(result.end, JobEnd::restarted);
  EXPECT_EQ(s.board.machine.begins, 1);
  // The last position reported for this job is a lower bound, the points sent an upper one.
  EXPECT_FALSE(result.rest.settled);
  EXPECT_GE(result.rest.first, seen);
  EXPECT_LE(result.rest.first, s.board.machine.fired.size());
  EXPECT_GE(result.rest.from, s.board.machine.fired.size());
}

/// Progress is reported before points are sent: the machine receives no unreported point.
TEST(Sender, ReportsProgressBeforeItSends) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    FaultyTransport board({.drop = 5e-4, .flip = 5e-4, .cuts = 3},
                          static_cast<std::uint64_t>(seed));
    const job::Job job = random_job(5000, 14);
    SenderOptions options = with_auto_resume();
    options.first_index = 100;
    std::vector<JobProgress> reports;
    options.on_progress = [&](const JobProgress& progress) {
      ASSERT_LE(progress.first_unfired, 100 + board.machine.fired.size());
      reports.push_back(progress);
    };
    JobSender sender(board, job, options);
    while (sender.step()) {
      ASSERT_TRUE(board.machine.received.empty() || !reports.empty());
      ASSERT_TRUE(reports.empty() ||
                  100 + board.machine.received.size() <= reports.back().may_have_fired);
    }
    EXPECT_EQ(sender.result().end, JobEnd::done);
    EXPECT_EQ(reports.front().may_have_fired, 100u) << "reported when the job begins";
    EXPECT_EQ(reports.front().session, sender.session());
    EXPECT_EQ(reports.front().first_unfired, 100u);
    EXPECT_EQ(reports.back().may_have_fired, job.size());
    EXPECT_LT(reports.size(), 200u) << "each one is a record on the disk";
  }
}

TEST(Sender, AFailureToRecordProgressStopsTheJob) {
  FaultyTransport board({}, 1);
  SenderOptions options = fixed_session();
  int records = 0;
  options.on_progress = [&](const JobProgress&) {
    if (++records == 5) throw Error(Exit::job_failed, "a.progress", "cannot be written", "look");
  };
  EXPECT_THAT(failure_of(board, random_job(20'000, 15), options).text,
              HasSubstr("cannot be written"));
  EXPECT_EQ(board.machine.state, wire::MachineState::idle);
}

TEST(Sender, GivesUpOnACableThatStaysCut) {
  Sending<> s(50'000, 11, {.cuts = 1, .cut_span = 100ms});
  s.board.unplugged = true;
  const JobResult result = s.sender.run();
  EXPECT_EQ(result.end, JobEnd::lost);
  EXPECT_GE(result.elapsed, SenderOptions{}.reconnect_timeout);
}

TEST(Sender, ASilentPortIsAnErrorAndAMachineThatSpeaksOnlyTextIsNamed) {
  for (const bool speaks : {false, true}) {
    FaultyTransport board({}, 1);
    board.silent = true;
    if (speaks) board.link.send_text("\r\nGrbl 1.1h ['$' for help]\r\n");
    const Failure failure = failure_of(board, random_job(10, 1));
    EXPECT_EQ(failure.exit, Exit::no_device);
    EXPECT_THAT(failure.text, HasSubstr(speaks ? "Grbl 1.1h" : "does not answer"));
  }
}

TEST(Sender, ACableThatIsPluggedInJustBeforeTheTimeoutIsAccepted) {
  Sending<>(100, 1, {.cuts = 1, .cut_span = 0ms}).expect_done();
}

const std::string other_version = fmt::format("protocol version {}", wire::protocol_version + 1);

/// A STATUS of another version and another length.
std::vector<std::uint8_t> status_of_another_version() {
  std::vector<std::uint8_t> content(16);
  wire::ByteWriter out(content);
  wire::write_header(out, {wire::FrameType::status, 0, 1});
  out.put(static_cast<std::uint16_t>(wire::protocol_version + 1));
  content.resize(out.size());
  return content;
}

TEST(Sender, OtherProtocolVersionIsAnErrorAndNothingMoves) {
  struct OtherVersion : FaultyTransport {
    OtherVersion() : FaultyTransport({}, 1) {}
    std::size_t read(std::span<std::uint8_t> bytes) override {
      return wire::encode_frame(status_of_another_version(), bytes);
    }
  } board;
  const Failure failure = failure_of(board, random_job(10, 1));
  EXPECT_EQ(failure.exit, Exit::no_device);
  EXPECT_THAT(failure.text, HasSubstr(other_version));
  EXPECT_EQ(board.machine.begins, 0);
}

TEST(Sender, RefusalsNameTheReason) {
  struct Case {
    Result result;
    std::uint32_t value;
    Exit exit;
    const char* text;
  };
  for (const Case& c : {Case{Result::locked, 0, Exit::job_failed, "locked"},
                        Case{Result::door_open, 0, Exit::job_failed, "door"},
                        Case{Result::busy, 0, Exit::job_failed, "another job"},
                        Case{Result::bad_value, 901, Exit::bad_input, "$901 (lamp_frequency)"},
                        Case{Result::settings_mismatch, 0, Exit::bad_input, "other settings"}}) {
    FaultyTransport board({}, 1);
    board.machine.begin_result = c.result;
    board.machine.refused = c.value;
    const Failure failure = failure_of(board, random_job(10, 1));
    EXPECT_EQ(failure.exit, c.exit);
    EXPECT_THAT(failure.text, HasSubstr(c.text));
    EXPECT_TRUE(board.machine.received.empty());
  }
}

/// A cable that loses the first commands completely and can return an unexpected status frame.
class LosesCommands : public FaultyTransport {
 public:
  LosesCommands(int count, Faults faults) : FaultyTransport(faults, 21), left_(count) {}
  explicit LosesCommands(int count) : LosesCommands(count, {}) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    constexpr std::array<std::uint8_t, 2> start{
        wire::frame_start, static_cast<std::uint8_t>(wire::FrameType::command)};
    const bool command =
        std::search(bytes.begin(), bytes.end(), start.begin(), start.end()) != bytes.end();
    if (!command || left_ == 0) return FaultyTransport::write(bytes);
    --left_;
    return bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    if (odd_status.empty()) return FaultyTransport::read(bytes);
    const std::size_t size = wire::encode_frame(odd_status, bytes);
    odd_status.clear();
    return size;
  }
  /// Loses every command.
  static constexpr int all = 1'000'000;
  std::vector<std::uint8_t> odd_status;

 private:
  int left_;
};

TEST(Sender, NothingIsSentBeforeTheMachineConfirmsItsJobSpeed) {
  SenderOptions options = fixed_session();
  options.job_speed = 40;
  Sending<LosesCommands> s(3000, 8, options, 4);
  while (s.sender.step())
    if (s.board.machine.job_speed != 40) {
      ASSERT_TRUE(s.board.machine.received.empty());
    }
  EXPECT_EQ(s.board.machine.commands,
            (std::vector<wire::CommandRequest>{{wire::Command::job_speed, 40}}));
  expect_each_once(s.board, s.job);
}

TEST(Sender, TheJobSpeedFollowsTheUserThroughHoldsAndABadCable) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    Sending<> s(20'000, 8, with_auto_resume(), Faults{.drop = 5e-4, .flip = 5e-4, .cuts = 3},
                static_cast<std::uint64_t>(seed));
    std::size_t round = 0;
    std::uint32_t wanted = 100;
    while (s.sender.step() && s.board.machine.fired.size() < 15'000) {
      if (++round % 50 == 0) s.sender.set_job_speed(wanted = 1 + (wanted * 7 + 13) % 140);
      if (round % 170 == 0) s.sender.pause();
      if (round % 170 == 60) s.sender.resume();
    }
    s.sender.resume();
    s.expect_done();
    EXPECT_EQ(s.board.machine.job_speed, wanted);
  }
}

TEST(Sender, CountsTheFiredFlashesOfTheNextPoint) {
  LosesCommands board(0);
  job::Job job = random_job(3000, 8);
  for (wire::Target& target : job.targets) target.shots = 4;
  SenderOptions options = fixed_session();
  options.first_index = 500;
  options.first_fired = 2;
  JobSender sender(board, job, options);
  while (board.machine.received.empty()) ASSERT_TRUE(sender.step());
  EXPECT_EQ(sender.result().flashes_fired, sender.points_fired() == 500 ? 2u : 0u);
  while (board.machine.fired.size() < 500) ASSERT_TRUE(sender.step());
  board.machine.shots += 3;  // of the point that is being fired
  sender.pause();
  while (sender.status().state != wire::MachineState::hold) ASSERT_TRUE(sender.step());
  EXPECT_EQ(sender.result().flashes_fired, 3u);
}

job::Job job_with_a_bad_point(const FaultyTransport& board) {
  job::Job job = random_job(5000, 12);
  job.targets[4321].steps[2] = board.machine.limits.max[2] + 1;
  return job;
}

TEST(Sender, ARefusedPointIsNamedAndTheStopIsRepeatedUntilTheMachineIsIdle) {
  for (const int lost : {0, 5}) {
    LosesCommands board(lost);
    const Failure failure = failure_of(board, job_with_a_bad_point(board));
    EXPECT_EQ(board.machine.state, wire::MachineState::idle);
    EXPECT_EQ(failure.exit, Exit::bad_input);
    EXPECT_THAT(failure.text, HasSubstr("error: point 4321"));
  }
}

TEST(Sender, ARefusedPointStopsTheMachineOverABadCable) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    FaultyTransport board({.drop = 1e-3, .flip = 1e-3, .cuts = 5},
                          static_cast<std::uint64_t>(seed));
    const Failure failure = failure_of(board, job_with_a_bad_point(board), with_auto_resume());
    ASSERT_EQ(board.machine.state, wire::MachineState::idle) << "seed " << seed;
    ASSERT_THAT(failure.text, HasSubstr("point 4321"));
  }
}

TEST(Sender, AMachineThatCannotBeStoppedIsReportedWithTheFirstError) {
  LosesCommands board(LosesCommands::all);
  const Failure failure = failure_of(board, job_with_a_bad_point(board));
  EXPECT_EQ(failure.exit, Exit::job_failed);  // it may still move
  EXPECT_THAT(failure.text, HasSubstr("could not be stopped"));
  EXPECT_THAT(failure.text, HasSubstr("emergency stop"));
  EXPECT_THAT(failure.text, HasSubstr("point 4321"));
  EXPECT_LT(board.now(), 20s);
}

TEST(Sender, AnErrorOfAnyKindInAJobStopsTheMachine) {
  Sending<LosesCommands> s(50'000, 17, fixed_session(), 2);
  s.until_fired(500);
  s.board.odd_status = status_of_another_version();
  EXPECT_THAT(failure_of([&] { s.sender.run(); }).text, HasSubstr(other_version));
  EXPECT_EQ(s.board.machine.state, wire::MachineState::idle);
  EXPECT_FALSE(s.sender.step());
}

TEST(Sender, TheContinuationIsThePointWhereTheMachineStopped) {
  Sending<LosesCommands> s(50'000, 18, fixed_session(), 3);
  s.until_fired(500);
  s.board.machine.data_result = Result::locked;
  const Failure failure = failure_of([&] { s.sender.run(); });
  EXPECT_EQ(failure.exit, Exit::job_failed);
  EXPECT_EQ(s.board.machine.state, wire::MachineState::idle);
  EXPECT_THAT(failure.text, HasSubstr(fmt::format("--from {}", s.board.machine.fired.size())));
}

TEST(Sender, AStopByTheUserWaitsForACutCable) {
  for (const bool plugged_in_again : {true, false}) {
    Sending<> s(50'000, 11, {.cuts = 1, .cut_span = 100ms});
    s.board.unplugged = !plugged_in_again;
    while (s.board.connected()) ASSERT_TRUE(s.sender.step());
    s.sender.stop();
    const Failure failure = failure_of([&] { s.sender.run(); });
    if (plugged_in_again) {
      EXPECT_EQ(s.sender.result().end, JobEnd::stopped);
      EXPECT_EQ(s.board.machine.state, wire::MachineState::idle);
      continue;
    }
    // It is unknown whether the machine stopped.
    EXPECT_EQ(failure.exit, Exit::job_failed);
    EXPECT_THAT(failure.text, HasSubstr("could not be stopped"));
    EXPECT_LT(s.board.now(), 20s);
  }
}

TEST(Sender, AJobThatTheMachineHasEndedDoesNotHangTheProgram) {
  // An unreachable point also ends the job; the single frame that reports it may be lost.
  Sending<> s(500, 16);
  FakeMachine& machine = s.board.machine;
  while (machine.received.size() < s.job.targets.size()) ASSERT_TRUE(s.sender.step());
  machine.hold(wire::HoldReason::host);
  s.steps();
  ASSERT_LT(machine.fired.size(), s.job.targets.size());
  machine.state = wire::MachineState::idle;
  const Failure failure = failure_of([&s] {
    for (int i = 0; i < 1000; ++i) s.sender.step();
  });
  EXPECT_EQ(failure.exit, Exit::job_failed);
  EXPECT_THAT(failure.text, HasSubstr("ended by the machine"));
  EXPECT_THAT(failure.text, HasSubstr(fmt::format("--from {}", machine.fired.size())));
}

TEST(Sender, TakesOverFromAHostThatHasGone) {
  Sending<> gone(5000, 14, SenderOptions{}, Faults{}, 1u);
  gone.steps();
  const job::Job second = random_job(500, 15);
  EXPECT_EQ(failure_of(gone.board, second).exit, Exit::job_failed);
  SenderOptions options;
  options.take_over = true;
  gone.board.machine.received.clear();
  gone.board.machine.fired.clear();
  EXPECT_EQ(JobSender(gone.board, second, options).run().end, JobEnd::done);
  EXPECT_EQ(gone.board.machine.begins, 4);
}

TEST(Sender, RefusesAStartBeyondTheJob) {
  FaultyTransport board({}, 1);
  SenderOptions options;
  options.first_index = 11;
  EXPECT_EQ(failure_of(board, random_job(10, 1), options).exit, Exit::bad_input);
}

}  // namespace
}  // namespace lamplock::link::sender_test
