// Sender and link over a bad cable: every point arrives exactly once and in order.
#include "host/link/sender.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "tests/link/faulty_transport.hpp"
#include "tests/link/random_job.hpp"
#include "tests/scale.hpp"

namespace lamplock::link::sender_test {
namespace {

using namespace std::chrono_literals;
using test::Faults;
using test::FaultyTransport;
using test::random_job;
using testing::HasSubstr;

std::unique_ptr<FaultyTransport> cable(Faults faults = {}, std::uint64_t seed = 1) {
  return std::make_unique<FaultyTransport>(faults, seed);
}

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
Failure failure_of(FaultyTransport& board, const job::Job& job, SenderOptions options = {}) {
  try {
    JobSender(board, job, std::move(options)).run();
  } catch (const Error& error) {
    return {error.exit(), error.what()};
  }
  return {Exit::done, "no error"};
}

TEST(Sender, GoodCableSendsNothingTwice) {
  auto board = cable();
  const job::Job job = random_job(5000, 1);
  JobSender sender(*board, job, fixed_session());
  std::size_t seen = 0;
  while (sender.step()) {
    EXPECT_GE(sender.points_fired(), seen);
    seen = sender.points_fired();
  }
  EXPECT_EQ(sender.points_fired(), job.targets.size());
  const JobResult result = sender.result();
  EXPECT_EQ(result.end, JobEnd::done);
  EXPECT_EQ(result.resent, 0u);
  EXPECT_EQ(result.bad_frames, 0u);
  EXPECT_EQ(result.reconnects, 0u);
  EXPECT_EQ(result.status.link, wire::LinkCounters{});
  expect_each_once(*board, job);
}

TEST(Sender, KeepsTheQueueFull) {
  auto board = cable();
  board->points_per_ms = 10;  // 10 000 points per second
  const job::Job job = random_job(20'000, 2);
  const JobResult result = JobSender(*board, job, fixed_session()).run();
  EXPECT_EQ(result.end, JobEnd::done);
  // Firing takes 2 s; a time more than a few per cent above it means that the queue ran empty.
  EXPECT_LT(result.elapsed, 2200ms);
}

/// A machine that reads its port only at intervals because it plans meanwhile. Its port buffers
/// 4 KB, like that of the board, and drops further bytes.
class BusyMachine final : public FaultyTransport {
 public:
  using FaultyTransport::FaultyTransport;
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
    if (now() >= looks_at_) {
      looks_at_ = now() + 60ms;
      link.receive(kept_, machine);
      kept_.clear();
    }
    if (now().count() % 1000 == 0) machine.fire(points_per_ms);
    link.poll(machine);
  }

  std::vector<std::uint8_t> kept_;
  std::chrono::microseconds looks_at_{0};
};

TEST(Sender, SendsNoMoreThanTheBufferOfABusyMachine) {
  for (int seed = 0; seed < test::scaled(5); ++seed) {
    BusyMachine board({}, static_cast<std::uint64_t>(seed));
    const job::Job job = random_job(3000, static_cast<std::uint64_t>(seed));
    const JobResult result = JobSender(board, job, fixed_session()).run();
    EXPECT_EQ(result.end, JobEnd::done);
    EXPECT_EQ(board.dropped, 0u);
    EXPECT_GT(board.max_kept, 2000u) << "the window was not used";
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
    auto board = cable(GetParam().faults, static_cast<std::uint64_t>(seed));
    const job::Job job = random_job(4000, static_cast<std::uint64_t>(seed));
    SenderOptions options;
    options.session = static_cast<std::uint32_t>(seed) * 7919 + 1;
    options.auto_resume = true;  // noise may be a one-byte command
    const JobResult result = JobSender(*board, job, options).run();
    ASSERT_EQ(result.end, JobEnd::done) << "seed " << seed;
    expect_each_once(*board, job);
    ASSERT_EQ(board->machine.begins, 1);
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
  auto board = cable({.drop = 1e-4}, 3);
  const job::Job job = random_job(20'000, 3);
  const JobResult result = JobSender(*board, job, fixed_session()).run();
  expect_each_once(*board, job);
  // About 14 of the 140 000 bytes are lost; each costs at most a window of frames.
  EXPECT_GT(result.resent, 0u);
  EXPECT_LT(result.resent, 14u * 3 * 16);
}

/// Reads its port every 30 ms, like a machine that plans; the port drops what it cannot buffer.
class RarelyLooking final : public FaultyTransport {
 public:
  RarelyLooking() : FaultyTransport({}, 1) { points_per_ms = 40; }
  std::size_t most_kept = 0, dropped = 0;

 private:
  static constexpr std::size_t port_size = 4096;  // firmware/boards/rp2040/usb/usb_serial.hpp
  void machine_receive(std::span<const std::uint8_t> bytes) override {
    const std::size_t count = std::min(bytes.size(), port_size - kept_.size());
    kept_.insert(kept_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    dropped += bytes.size() - count;
    most_kept = std::max(most_kept, kept_.size());
  }
  void machine_run() override {
    if (now() % 1ms == 0us) machine.fire(points_per_ms);
    if (now() % 30ms != 0us) return;
    link.receive(kept_, machine);
    kept_.clear();
    link.poll(machine);
  }
  std::vector<std::uint8_t> kept_;
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

TEST(Sender, BytesInFlightFitThePortEvenIfAllAreEscaped) {
  for (const job::Job& job : {job_of_escapes(5'000), random_job(5'000, 9)}) {
    RarelyLooking board;
    const JobResult result = JobSender(board, job, fixed_session()).run();
    EXPECT_EQ(result.end, JobEnd::done);
    EXPECT_EQ(board.dropped, 0u);
    EXPECT_EQ(result.resent, 0u);
    EXPECT_EQ(result.status.link, wire::LinkCounters{});
    EXPECT_GT(board.most_kept, 2'048u) << "the port's buffer was not used";
    expect_each_once(board, job);
  }
}

TEST(Sender, StartsInTheMiddle) {
  auto board = cable();
  const job::Job job = random_job(3000, 4);
  SenderOptions options = fixed_session();
  options.first_index = 1234;
  const JobResult result = JobSender(*board, job, options).run();
  EXPECT_EQ(result.end, JobEnd::done);
  expect_each_once(*board, job, 1234);
}

TEST(Sender, ResumesAfterItsOwnSilenceAndOnRequestAfterNoise) {
  for (const auto reason :
       {wire::HoldReason::dead_man, wire::HoldReason::realtime, wire::HoldReason::reset}) {
    auto board = cable();
    const job::Job job = random_job(2000, 5);
    SenderOptions options = fixed_session();
    options.auto_resume = reason != wire::HoldReason::dead_man;
    JobSender sender(*board, job, options);
    for (int i = 0; i < 20; ++i) sender.step();
    board->machine.hold(reason);
    EXPECT_EQ(sender.run().end, JobEnd::done);
    expect_each_once(*board, job);
  }
}

TEST(Sender, ATypedHoldLastsUntilTheUserResumes) {
  auto board = cable();
  const job::Job job = random_job(2000, 5);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  board->machine.on_realtime('!');
  const std::size_t held_at = board->machine.fired.size();
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(sender.step());
  EXPECT_EQ(board->machine.fired.size(), held_at);
  EXPECT_EQ(sender.status().hold_reason, wire::HoldReason::realtime);
  sender.resume();
  EXPECT_EQ(sender.run().end, JobEnd::done);
  expect_each_once(*board, job);
}

TEST(Sender, ATypedResetStopsTheJobAndIsReported) {
  auto board = cable();
  const job::Job job = random_job(2000, 5);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  board->machine.on_realtime(0x18);
  const std::size_t fired = board->machine.fired.size();
  try {
    sender.run();
    FAIL() << "the job continued";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    EXPECT_THAT(error.what(), testing::HasSubstr("0x18"));
    EXPECT_THAT(error.what(), testing::HasSubstr(fmt::format("--from {}", fired)));
  }
  EXPECT_EQ(board->machine.fired.size(), fired);
  EXPECT_EQ(board->machine.state, wire::MachineState::idle);
  EXPECT_EQ(sender.result().end, JobEnd::stopped);
}

TEST(Sender, PauseHoldsUntilResume) {
  auto board = cable({.drop = 1e-3, .flip = 1e-3}, 6);
  const job::Job job = random_job(3000, 6);
  JobSender sender(*board, job, with_auto_resume());
  while (board->machine.fired.size() < 500) ASSERT_TRUE(sender.step());
  sender.pause();
  for (int i = 0; i < 200; ++i) sender.step();
  const std::size_t held_at = board->machine.fired.size();
  EXPECT_EQ(board->machine.reason, wire::HoldReason::host);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(sender.step());
  EXPECT_EQ(board->machine.fired.size(), held_at);
  sender.resume();
  EXPECT_EQ(sender.run().end, JobEnd::done);
  expect_each_once(*board, job);
}

TEST(Sender, PauseTakesOverAHoldOfAnotherReason) {
  auto board = cable();
  const job::Job job = random_job(2000, 6);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  sender.pause();
  board->machine.hold(wire::HoldReason::realtime);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(sender.step());
  EXPECT_EQ(board->machine.reason, wire::HoldReason::host);
  sender.resume();
  EXPECT_EQ(sender.run().end, JobEnd::done);
}

TEST(Sender, StopEndsTheJob) {
  auto board = cable({.drop = 1e-3}, 7);
  const job::Job job = random_job(3000, 7);
  JobSender sender(*board, job, fixed_session());
  while (board->machine.fired.size() < 500) ASSERT_TRUE(sender.step());
  sender.stop();
  const JobResult result = sender.run();
  EXPECT_EQ(result.end, JobEnd::stopped);
  EXPECT_EQ(board->machine.state, wire::MachineState::idle);
  EXPECT_EQ(result.status.first_unfired, board->machine.fired.size());
  EXPECT_LT(board->machine.fired.size(), 3000u);
}

TEST(Sender, DoesNotOpenADoorHoldByItself) {
  auto board = cable();
  const job::Job job = random_job(2000, 8);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  board->machine.state = wire::MachineState::door;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(sender.step());
  EXPECT_EQ(board->machine.state, wire::MachineState::door);
  sender.resume();
  EXPECT_EQ(sender.run().end, JobEnd::done);
  expect_each_once(*board, job);
}

TEST(Sender, AlarmEndsTheJob) {
  auto board = cable();
  const job::Job job = random_job(5000, 9);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  board->machine.state = wire::MachineState::alarm;
  board->machine.alarm = 1;
  const JobResult result = sender.run();
  EXPECT_EQ(result.end, JobEnd::alarm);
  EXPECT_EQ(result.status.alarm, 1);
}

TEST(Sender, AMachineThatLostTheJobGetsNoMorePoints) {
  auto board = cable();
  const job::Job job = random_job(5000, 10);
  JobSender sender(*board, job, fixed_session());
  for (int i = 0; i < 20; ++i) sender.step();
  board->link.forget_session();
  const std::size_t seen = sender.points_fired();
  const JobResult result = sender.run();
  EXPECT_EQ(result.end, JobEnd::restarted);
  EXPECT_EQ(board->machine.begins, 1);
  // The last position reported for this job is a lower bound, the points sent an upper one.
  EXPECT_FALSE(result.rest.settled);
  EXPECT_GE(result.rest.first, seen);
  EXPECT_LE(result.rest.first, board->machine.fired.size());
  EXPECT_GE(result.rest.from, board->machine.fired.size());
}

/// Progress is reported before points are sent: the machine receives no unreported point.
TEST(Sender, ReportsProgressBeforeItSends) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    auto board = cable({.drop = 5e-4, .flip = 5e-4, .cuts = 3}, static_cast<std::uint64_t>(seed));
    const job::Job job = random_job(5000, 14);
    SenderOptions options = with_auto_resume();
    options.first_index = 100;
    std::vector<JobProgress> reports;
    options.on_progress = [&](const JobProgress& progress) {
      ASSERT_LE(progress.first_unfired, 100 + board->machine.fired.size());
      reports.push_back(progress);
    };
    JobSender sender(*board, job, options);
    while (sender.step()) {
      ASSERT_TRUE(board->machine.received.empty() || !reports.empty());
      ASSERT_TRUE(reports.empty() ||
                  100 + board->machine.received.size() <= reports.back().may_have_fired);
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
  auto board = cable();
  SenderOptions options = fixed_session();
  int records = 0;
  options.on_progress = [&](const JobProgress&) {
    if (++records == 5) throw Error(Exit::job_failed, "a.progress", "cannot be written", "look");
  };
  const Failure failure = failure_of(*board, random_job(20'000, 15), options);
  EXPECT_THAT(failure.text, HasSubstr("cannot be written"));
  EXPECT_EQ(board->machine.state, wire::MachineState::idle);
}

TEST(Sender, GivesUpOnACableThatStaysCut) {
  auto board = cable({.cuts = 1, .cut_span = 100ms}, 11);
  board->unplugged = true;
  const job::Job job = random_job(50'000, 11);
  const JobResult result = JobSender(*board, job, fixed_session()).run();
  EXPECT_EQ(result.end, JobEnd::lost);
  EXPECT_GE(result.elapsed, SenderOptions{}.give_up);
}

TEST(Sender, SilentPortIsAnError) {
  auto board = cable();
  board->silent = true;
  const Failure failure = failure_of(*board, random_job(10, 1));
  EXPECT_EQ(failure.exit, Exit::no_device);
  EXPECT_THAT(failure.text, HasSubstr("does not answer"));
}

TEST(Sender, ACableThatIsPluggedInJustBeforeTheTimeoutIsAccepted) {
  auto board = cable({.cuts = 1, .cut_span = 0ms}, 1);
  const job::Job job = random_job(100, 1);
  EXPECT_EQ(JobSender(*board, job, fixed_session()).run().end, JobEnd::done);
  expect_each_once(*board, job);
}

TEST(Sender, MachineThatSpeaksOnlyTextIsNamed) {
  auto board = cable();
  board->silent = true;
  board->link.send_text("\r\nGrbl 1.1h ['$' for help]\r\n");
  const Failure failure = failure_of(*board, random_job(10, 1));
  EXPECT_EQ(failure.exit, Exit::no_device);
  EXPECT_THAT(failure.text, HasSubstr("Grbl 1.1h"));
}

/// A firmware of another version: its STATUS has another version and another length.
class OtherVersion : public FaultyTransport {
 public:
  OtherVersion() : FaultyTransport({}, 1) {}
  std::size_t read(std::span<std::uint8_t> bytes) override {
    std::array<std::uint8_t, 16> content{};
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::status, 0, 1});
    out.put(static_cast<std::uint16_t>(wire::protocol_version + 1));
    return wire::encode_frame(out.written(), bytes);
  }
};

TEST(Sender, OtherProtocolVersionIsAnErrorAndNothingMoves) {
  OtherVersion board;
  const Failure failure = failure_of(board, random_job(10, 1));
  EXPECT_EQ(failure.exit, Exit::no_device);
  EXPECT_THAT(failure.text, HasSubstr(std::string("protocol version ") +
                                      std::to_string(wire::protocol_version + 1)));
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
    auto board = cable();
    board->machine.begin_result = c.result;
    board->machine.refused = c.value;
    const Failure failure = failure_of(*board, random_job(10, 1));
    EXPECT_EQ(failure.exit, c.exit);
    EXPECT_THAT(failure.text, HasSubstr(c.text));
    EXPECT_TRUE(board->machine.received.empty());
  }
}

TEST(Sender, ARefusedPointStopsTheJobAndIsNamed) {
  auto board = cable();
  job::Job job = random_job(5000, 12);
  job.targets[4321].steps[2] = board->machine.limits.max[2] + 1;
  const Failure failure = failure_of(*board, job);
  EXPECT_EQ(failure.exit, Exit::bad_input);
  EXPECT_THAT(failure.text, HasSubstr("point 4321"));
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
  LosesCommands board(4);
  const job::Job job = random_job(3000, 8);
  SenderOptions options = fixed_session();
  options.job_speed = 40;
  JobSender sender(board, job, options);
  while (sender.step())
    if (board.machine.job_speed != 40) {
      ASSERT_TRUE(board.machine.received.empty());
    }
  EXPECT_EQ(board.machine.commands,
            (std::vector<wire::CommandRequest>{{wire::Command::job_speed, 40}}));
  expect_each_once(board, job);
}

TEST(Sender, TheJobSpeedFollowsTheUserThroughHoldsAndABadCable) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    auto board = cable({.drop = 5e-4, .flip = 5e-4, .cuts = 3}, static_cast<std::uint64_t>(seed));
    const job::Job job = random_job(20'000, 8);
    JobSender sender(*board, job, with_auto_resume());
    std::size_t round = 0;
    std::uint32_t wanted = 100;
    while (sender.step() && board->machine.fired.size() < 15'000) {
      if (++round % 50 == 0) sender.set_job_speed(wanted = 1 + (wanted * 7 + 13) % 140);
      if (round % 170 == 0) sender.pause();
      if (round % 170 == 60) sender.resume();
    }
    sender.resume();
    EXPECT_EQ(sender.run().end, JobEnd::done);
    EXPECT_EQ(board->machine.job_speed, wanted);
    expect_each_once(*board, job);
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

TEST(Sender, AStopIsRepeatedUntilTheMachineIsIdle) {
  LosesCommands board(5);
  const Failure failure = failure_of(board, job_with_a_bad_point(board));
  EXPECT_EQ(board.machine.state, wire::MachineState::idle);
  EXPECT_EQ(failure.exit, Exit::bad_input);
  EXPECT_THAT(failure.text, HasSubstr("error: point 4321"));
}

TEST(Sender, ARefusedPointStopsTheMachineOverABadCable) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    auto board = cable({.drop = 1e-3, .flip = 1e-3, .cuts = 5}, static_cast<std::uint64_t>(seed));
    job::Job job = random_job(2000, 12);
    job.targets[1500].steps[2] = board->machine.limits.max[2] + 1;
    const Failure failure = failure_of(*board, job, with_auto_resume());
    ASSERT_EQ(board->machine.state, wire::MachineState::idle) << "seed " << seed;
    ASSERT_THAT(failure.text, HasSubstr("point 1500"));
  }
}

TEST(Sender, AMachineThatCannotBeStoppedIsReportedWithTheFirstError) {
  LosesCommands board(LosesCommands::all);
  const Failure failure = failure_of(board, job_with_a_bad_point(board));
  EXPECT_EQ(failure.exit, Exit::bad_input);
  EXPECT_THAT(failure.text, HasSubstr("could not be stopped"));
  EXPECT_THAT(failure.text, HasSubstr("emergency stop"));
  EXPECT_THAT(failure.text, HasSubstr("point 4321"));
  EXPECT_LT(board.now(), 20s);
}

TEST(Sender, AnErrorOfAnyKindInAJobStopsTheMachine) {
  LosesCommands board(2);
  const job::Job job = random_job(50'000, 17);
  JobSender sender(board, job, fixed_session());
  while (board.machine.fired.size() < 500) ASSERT_TRUE(sender.step());
  std::array<std::uint8_t, 16> content{};
  wire::ByteWriter out(content);
  wire::write_header(out, {wire::FrameType::status, 0, 1});
  out.put(static_cast<std::uint16_t>(wire::protocol_version + 1));
  board.odd_status.assign(out.written().begin(), out.written().end());
  std::string text;
  try {
    sender.run();
  } catch (const Error& error) {
    text = error.what();
  }
  EXPECT_THAT(text, HasSubstr(std::string("protocol version ") +
                              std::to_string(wire::protocol_version + 1)));
  EXPECT_EQ(board.machine.state, wire::MachineState::idle);
  EXPECT_FALSE(sender.step());
}

TEST(Sender, TheContinuationIsThePointWhereTheMachineStopped) {
  LosesCommands board(3);
  const job::Job job = random_job(50'000, 18);
  JobSender sender(board, job, fixed_session());
  while (board.machine.fired.size() < 500) ASSERT_TRUE(sender.step());
  board.machine.data_result = Result::locked;
  std::string text;
  try {
    sender.run();
  } catch (const Error& error) {
    text = error.what();
  }
  EXPECT_EQ(board.machine.state, wire::MachineState::idle);
  EXPECT_THAT(text, HasSubstr("--from " + std::to_string(board.machine.fired.size())));
}

TEST(Sender, AStopByTheUserWaitsForACutCable) {
  for (const bool plugged_in_again : {true, false}) {
    auto board = cable({.cuts = 1, .cut_span = 100ms}, 11);
    board->unplugged = !plugged_in_again;
    const job::Job job = random_job(50'000, 11);
    JobSender sender(*board, job, fixed_session());
    while (board->connected()) ASSERT_TRUE(sender.step());
    sender.stop();
    if (plugged_in_again) {
      EXPECT_EQ(sender.run().end, JobEnd::stopped);
      EXPECT_EQ(board->machine.state, wire::MachineState::idle);
      continue;
    }
    try {
      sender.run();
      ADD_FAILURE() << "it is unknown whether the machine stopped";
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::job_failed);
      EXPECT_THAT(error.what(), HasSubstr("could not be stopped"));
    }
    EXPECT_LT(board->now(), 20s);
  }
}

TEST(Sender, ATemporaryRefusalDoesNotHangTheJob) {
  auto board = cable();
  const job::Job job = random_job(5000, 13);
  board->machine.data_result = Result::locked;
  const Failure failure = failure_of(*board, job);
  EXPECT_EQ(failure.exit, Exit::job_failed);
}

TEST(Sender, AJobThatTheMachineHasEndedDoesNotHangTheProgram) {
  // An unreachable point also ends the job; the single frame that reports it may be lost.
  auto board = cable();
  const job::Job job = random_job(500, 16);
  JobSender sender(*board, job, fixed_session());
  while (board->machine.received.size() < job.targets.size()) ASSERT_TRUE(sender.step());
  board->machine.hold(wire::HoldReason::host);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(sender.step());
  ASSERT_LT(board->machine.fired.size(), job.targets.size());
  board->machine.state = wire::MachineState::idle;
  std::string text;
  try {
    for (int i = 0; i < 1000 && text.empty(); ++i) sender.step();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    text = error.what();
  }
  EXPECT_THAT(text, HasSubstr("ended by the machine"));
  EXPECT_THAT(text, HasSubstr("--from " + std::to_string(board->machine.fired.size())));
}

TEST(Sender, TakesOverFromAHostThatHasGone) {
  auto board = cable();
  const job::Job first = random_job(5000, 14);
  JobSender gone(*board, first);
  for (int i = 0; i < 20; ++i) gone.step();
  const job::Job second = random_job(500, 15);
  EXPECT_EQ(failure_of(*board, second).exit, Exit::job_failed);
  SenderOptions options;
  options.take_over = true;
  board->machine.received.clear();
  board->machine.fired.clear();
  EXPECT_EQ(JobSender(*board, second, options).run().end, JobEnd::done);
  EXPECT_EQ(board->machine.begins, 4);
}

TEST(Sender, RefusesAStartBeyondTheJob) {
  auto board = cable();
  SenderOptions options;
  options.first_index = 11;
  EXPECT_EQ(failure_of(*board, random_job(10, 1), options).exit, Exit::bad_input);
}

}  // namespace
}  // namespace lamplock::link::sender_test
