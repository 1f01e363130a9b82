// Where a job continues, and the restart mark of a board.
#include "host/link/continuation.hpp"

#include <gtest/gtest.h>

#include "tests/job/random_rows.hpp"
#include "tests/link/random_job.hpp"

namespace lamplock::link {
namespace {

TEST(RestartMark, IsReadFromTheStartMessageOfABoard) {
  const auto mark = parse_restart_mark("[MSG:Started by watchdog, job 7 first point not fired 12]");
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->session, 7u);
  EXPECT_EQ(mark->first_unfired, 12u);
  EXPECT_FALSE(mark->may_have_fired);
  const auto fault = parse_restart_mark(
      "[MSG:Started by fault, pc 0x10001234 lr 0x10000001 xpsr 0x61000003, job 4294967294 first "
      "point not fired 0, which may have been]");
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->session, 4294967294u);
  EXPECT_TRUE(fault->may_have_fired);
}

TEST(RestartMark, IsNotReadFromAnythingElse) {
  for (const char* line :
       {"", "[MSG:Started by power on]", "[MSG:Started by watchdog, programs had run]",
        "[MSG:Started by watchdog, job 7 first point not fired ]",
        "[MSG:Started by watchdog, job 7 first point not fired 12",
        "[MSG:Started by watchdog, job 7 first point not fired 12, which may]",
        "[MSG:Started by watchdog, job 99999999999 first point not fired 1]",
        "[MSG:job 7 first point not fired 12]"})
    EXPECT_FALSE(parse_restart_mark(line)) << line;
}

TEST(Continuation, OfPointsIsExactAndOfALineOfPixelsLeavesItOut) {
  const job::Job points = test::random_job(20, 1), rows = test::random_row_job(40, 1);
  EXPECT_EQ(continuation_options(at_rest(points, 12, 3)), "--from 12 --fired 3");
  EXPECT_FALSE(at_rest(points, 12, 3).in_doubt());
  EXPECT_EQ(at_rest(points, 25, 0).from, 20u);
  for (std::size_t line = 0; line < rows.size(); ++line) {
    const Continuation rest = at_rest(rows, line, 0);
    EXPECT_EQ(rest.first, line);
    EXPECT_EQ(rest.in_doubt(), rows.rows.lines[line].to.light);
  }
}

TEST(Continuation, AfterARestartTheShotInProgressAndPointsOfSeveralFlashesAreInDoubt) {
  job::Job job = test::random_job(20, 1);
  for (wire::Target& target : job.targets) target.shots = 1;
  job.targets[5].shots = 3;
  EXPECT_EQ(after_restart(job, {1, 4, false}).from, 4u);
  EXPECT_EQ(after_restart(job, {1, 4, true}).from, 5u);
  EXPECT_EQ(after_restart(job, {1, 5, false}).from, 6u);
  EXPECT_EQ(after_restart(job, {1, 20, true}).from, 20u);
}

TEST(Continuation, IsReportedAsOptions) {
  EXPECT_EQ(continuation_text({12, 0, 12, true}, "point", true), "continue with --from 12");
  EXPECT_EQ(continuation_text({12, 2, 12, true}, "point", false),
            "continue with --from 12 --fired 2");
  EXPECT_EQ(continuation_text({12, 0, 13, true}, "line", true),
            "continue with --from 13 (line 12 may have been fired)");
  EXPECT_EQ(continuation_text({503, 0, 687, false}, "point", false),
            "continue with --from 687 (points 503 to 686 may have been fired)");
  EXPECT_EQ(continuation_text({503, 0, 687, false}, "point", true),
            "continue with --resume, which asks the machine");
}

TEST(Continuation, CountsTheFlashesOfTheNextPoint) {
  std::vector<wire::Target> targets(4);
  for (wire::Target& target : targets) target.shots = 3;
  targets[2].shots = 0;
  EXPECT_EQ(flashes_of(targets, 0, 1, 5), 2u);
  EXPECT_EQ(flashes_of(targets, 1, 1, 1), 1u);
  EXPECT_EQ(flashes_of(targets, 0, 2, 6), 0u);
  EXPECT_EQ(flashes_of(targets, 0, 3, 7), 1u);
  EXPECT_EQ(flashes_of(targets, 0, 3, 2), 0u) << "fewer than the flashes of the preceding points";
  EXPECT_EQ(flashes_of(targets, 0, 4, 99), 0u);
}

}  // namespace
}  // namespace lamplock::link
