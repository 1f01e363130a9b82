// Sender and link with rows of pixels: every line and run exactly once, never more than fits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <span>
#include <string>

#include "host/error.hpp"
#include "host/link/sender.hpp"
#include "tests/error_of.hpp"
#include "tests/job/random_rows.hpp"
#include "tests/link/fake_row_machine.hpp"
#include "tests/scale.hpp"

namespace lamplock::link::row_sender_test {
namespace {

using namespace std::chrono_literals;
using test::Faults;
using test::random_row_job;
using test::RowCable;
using testing::HasSubstr;

SenderOptions fixed_session(std::size_t first = 0) {
  SenderOptions options;
  options.session = 0x5EED;
  options.first_index = first;
  return options;
}

void expect_each_once(const RowCable& board, const job::Job& job, std::size_t first = 0) {
  const job::Rows& received = board.machine.received;
  ASSERT_EQ(received.lines.size(), job.size() - first);
  for (std::size_t i = first; i < job.size(); ++i) {
    const job::Line& wanted = job.rows.lines[i];
    ASSERT_EQ(received.lines[i - first].to, wanted.to) << i;
    ASSERT_THAT(received.runs_of(received.lines[i - first]),
                testing::ElementsAreArray(job.rows.runs_of(wanted)))
        << i;
  }
  EXPECT_EQ(board.machine.done(), job.size() - first);
}

TEST(RowSender, GoodCableSendsNothingTwiceAndNothingTooMuch) {
  RowCable board({}, 1);
  const job::Job job = random_row_job(1500, 1);
  const JobResult result = JobSender(board, job, fixed_session()).run();
  EXPECT_EQ(result.end, JobEnd::done);
  EXPECT_EQ(result.status.first_unfired, job.size());
  EXPECT_EQ(result.resent, 0u);
  EXPECT_EQ(result.status.link, wire::LinkCounters{});
  EXPECT_EQ(board.machine.refused_frames, 0);
  expect_each_once(board, job);
}

/// Already before any status report.
TEST(RowSender, LinesOfTheRunUpAreAcknowledged) {
  RowCable board({}, 1);
  const job::Job job = random_row_job(300, 3);
  SenderOptions options = fixed_session(100);
  options.run_up_lines = 2;
  JobSender sender(board, job, options);
  do {
    ASSERT_GE(sender.points_fired(), 102u);
    ASSERT_GE(sender.result().rest.first, 102u);
  } while (sender.step());
  EXPECT_EQ(sender.result().end, JobEnd::done);
}

/// Rows of single grey pixels, which need the maximum number of runs.
job::Job grey_rows(std::size_t lines, std::size_t runs_a_line) {
  job::Job job = random_row_job(lines, 2);
  job.rows.runs.clear();
  for (std::size_t i = 1; i < lines; ++i) {
    job::Line& line = job.rows.lines[i];
    line = {{line.to.steps, true, 18'000'000}, job.rows.runs.size(), runs_a_line};
    line.to.steps[0] = i % 2 == 0 ? 0 : 5000;
    line.to.steps[1] = job.rows.lines[0].to.steps[1];
    for (std::size_t k = 0; k < runs_a_line; ++k)
      job.rows.runs.push_back(
          wire::max_run(static_cast<std::uint16_t>(7919 * job.rows.runs.size()), 1));
  }
  return job;
}

TEST(RowSender, KeepsUpWithSingleGreyPixelsAtSpeed) {
  RowCable board({}, 1);
  const job::Job job = grey_rows(60, 255);
  const JobResult result = JobSender(board, job, fixed_session()).run();
  EXPECT_EQ(result.end, JobEnd::done);
  expect_each_once(board, job);
  // The lines take 5.1 s; except for the first one the machine never waits for the next.
  EXPECT_EQ(board.machine.waited, 0);
  EXPECT_LT(result.elapsed, 5.3s);
}

/// Counts the bytes sent over the cable.
class CountsBytes : public RowCable {
 public:
  CountsBytes() : RowCable({}, 1) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t taken = RowCable::write(bytes);
    written += taken;
    return taken;
  }
  std::size_t written = 0;
};

TEST(RowSender, AGreyPixelCostsTwoBytesPlusItsShareOfTheFrame) {
  CountsBytes board;
  const job::Job job = grey_rows(100, 255);
  EXPECT_EQ(JobSender(board, job, fixed_session()).run().end, JobEnd::done);
  const auto pixels = static_cast<double>(job.rows.runs.size());
  // Including frames, escapes, requests and lines. As text a pixel is four characters or more.
  EXPECT_LT(static_cast<double>(board.written) / pixels, 2.7);
  RecordProperty("bytes_per_pixel_milli",
                 static_cast<int>(1000 * static_cast<double>(board.written) / pixels));
}

TEST(RowSender, LinesOfTheMaximumNumberOfRuns) {
  RowCable board({}, 1);
  const job::Job job = grey_rows(20, wire::max_runs_a_line);
  EXPECT_EQ(JobSender(board, job, fixed_session()).run().end, JobEnd::done);
  EXPECT_EQ(board.machine.refused_frames, 0);
  expect_each_once(board, job);
}

struct Named {
  const char* name;
  Faults faults;
};
class BadRowCable : public testing::TestWithParam<Named> {};

TEST_P(BadRowCable, EveryLineOnceAndInOrder) {
  for (int seed = 0; seed < test::scaled(10); ++seed) {
    RowCable board(GetParam().faults, static_cast<std::uint64_t>(seed));
    board.places_per_ms = 12;
    const job::Job job = random_row_job(400, static_cast<std::uint64_t>(seed));
    SenderOptions options = fixed_session();
    options.auto_resume = true;  // noise may be a one-byte command
    const JobResult result = JobSender(board, job, options).run();
    ASSERT_EQ(result.end, JobEnd::done) << "seed " << seed;
    expect_each_once(board, job);
    ASSERT_EQ(board.machine.begins, 1);
    // Retransmitted frames may meet a table with fewer entries than before: never more.
    ASSERT_EQ(board.machine.refused_frames, 0) << "seed " << seed;
    if (GetParam().faults.cuts > 0) {
      ASSERT_GT(result.reconnects, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, BadRowCable,
    testing::Values(Named{"drops", {.drop = 5e-4}}, Named{"flips", {.flip = 5e-4, .resets = false}},
                    Named{"cuts", {.cuts = 6}},
                    Named{"slower", {.drop = 1e-4, .delay = std::chrono::milliseconds(400)}},
                    Named{"all",
                          {.drop = 2e-4,
                           .flip = 2e-4,
                           .duplicate = 2e-4,
                           .replay = 0.05,
                           .stray_realtime = 2e-4,
                           .resets = false,
                           .cuts = 6}}),
    [](const auto& faults) { return faults.param.name; });

TEST(RowSender, ContinuesAtALine) {
  job::Job job = random_row_job(500, 5);
  std::size_t from = 300;
  while (!job.rows.lines[from].to.light || !job.rows.lines[from - 1].to.light) ++from;
  const std::size_t first = job::continue_at(job.rows, from);
  RowCable board({}, 1);
  EXPECT_EQ(JobSender(board, job, fixed_session(first)).run().end, JobEnd::done);
  EXPECT_EQ(board.machine.header.first_index, from - 1);
  EXPECT_EQ(board.machine.header.origin_steps, job.rows.lines[from - 2].to.steps);
  expect_each_once(board, job, first);
  EXPECT_THAT(test::error_of([&] { JobSender(board, job, fixed_session(501)); }),
              HasSubstr("500 lines"));
}

TEST(RowSender, PauseStopAndContinuation) {
  RowCable board({.drop = 1e-3}, 6);
  const job::Job job = random_row_job(2000, 6);
  JobSender sender(board, job, fixed_session());
  while (board.machine.done() < 50) ASSERT_TRUE(sender.step());
  sender.pause();
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(sender.step());
  EXPECT_EQ(board.machine.reason, wire::HoldReason::host);
  sender.resume();
  while (board.machine.done() < 100) ASSERT_TRUE(sender.step());
  sender.stop();
  const JobResult result = sender.run();
  EXPECT_EQ(result.end, JobEnd::stopped);
  EXPECT_EQ(result.status.first_unfired, board.machine.done());
  EXPECT_EQ(result.flashes_fired, 0u);
}

TEST(RowSender, AMachineWithoutLaserModeIsNamedWithItsSetting) {
  RowCable board({}, 1);
  board.machine.begin_result = Result::bad_value;
  const job::Job job = random_row_job(20, 7);
  // A refusal carries a number: a board sends that of the setting, this machine its next line.
  EXPECT_THAT(test::error_of([&] { JobSender(board, job, fixed_session()).run(); }),
              HasSubstr("has a value that the machine does not allow"));
}

}  // namespace
}  // namespace lamplock::link::row_sender_test
