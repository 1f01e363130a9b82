// The job of a server that was killed: the next server says how far it was.
#include "host/serve/running_job.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/serve/running_server.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;
using lamplock::test::TemporaryFolder;
using testing::HasSubstr;

JobView job_at(std::size_t done, const std::string& name = "part.ngc") {
  JobView job;
  job.is_running = true;
  job.name = name;
  job.done = done;
  job.total = 400;
  return job;
}

TEST(RunningJob, is_left_by_a_killed_server) {
  const TemporaryFolder folder;
  const std::filesystem::path place = folder.file("");
  Clock::time_point now{};
  {
    RunningJob running(place);
    running.note(job_at(0), now);
    for (int i = 1; i <= 20; ++i, std::this_thread::sleep_for(10ms))
      running.note(job_at(static_cast<std::size_t>(i)), now += 600ms);
  }
  const auto left = RunningJob(place).take_left();
  ASSERT_TRUE(left);
  EXPECT_EQ(left->view.name, "part.ngc");
  EXPECT_EQ(left->view.end, "interrupted");
  EXPECT_GE(left->view.done, 18u);
  EXPECT_EQ(left->view.total, 400u);
  EXPECT_FALSE(left->view.is_running);
  EXPECT_THAT(left->view.message,
              HasSubstr("lines were done; resume or stop what the board still has of it"));
  EXPECT_FALSE(RunningJob(place).take_left()) << "once";
  RunningJob(place).note(job_at(7, "cloud.llj"), now);
  const auto points = RunningJob(place).take_left();
  ASSERT_TRUE(points);
  EXPECT_THAT(points->view.message, HasSubstr("continue the last run"));
}

TEST(RunningJob, leaves_nothing_when_it_has_ended) {
  const TemporaryFolder folder;
  const std::filesystem::path place = folder.file("");
  RunningJob running(place);
  running.note(job_at(3), {});
  std::this_thread::sleep_for(50ms);
  JobView ended = job_at(400);
  ended.is_running = false;
  running.note(ended, {});
  EXPECT_FALSE(RunningJob(place).take_left());
  running.note(job_at(3), {});
  running.end();
  EXPECT_FALSE(RunningJob(place).take_left());
  for (const char* wrong : {"", "{", "[]", R"({"name":"a.ngc"})", R"({"name":7,"dry":1})"}) {
    folder.write(".running.json", wrong);
    EXPECT_FALSE(RunningJob(place).take_left()) << wrong;
  }
}

TEST(RunningJob, is_shown_and_kept_by_the_next_server) {
  RunningServer server(
      {.left_job =
           R"({"name":"part.ngc","dry":false,"done":120,"total":400,"begin":1700000000,"seen":1700000060})"});
  RawClient client = server.controller();
  client.call("subscribe");
  client.watch(200ms);
  EXPECT_EQ(client.status()["job"]["name"], "part.ngc");
  EXPECT_EQ(client.status()["job"]["end"], "interrupted");
  EXPECT_EQ(client.status()["job"]["done"], 120);
  nlohmann::json jobs;
  comes_true([&] {
    jobs = client.call("history.list")["result"];
    return !jobs.empty();
  });
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(jobs[0]["result"], "interrupted");
  EXPECT_EQ(jobs[0]["begin"], "2023-11-14T22:13:20Z");
  server.add_file("next.ngc", "G21G91\nG1X1F3000\n");
  EXPECT_EQ(error_of(client.call("job.start", {{"name", "next.ngc"}})), "");
  EXPECT_EQ(server.wait_for_end(), "done");
}

}  // namespace
}  // namespace lamplock::serve::test
