// Standard error that is full, closed, broken or stalled neither ends nor delays a job on a port.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/program_start.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test::lost_remarks {
namespace {

constexpr std::size_t points = 130;  // progress is shown after half a second

/// A simulated board and the command of a job on it.
struct Bench {
  explicit Bench(const Folder& folder, const std::string& name)
      : shots(folder / (name + ".csv")),
        sim({"sim", "--pty", folder / name, "--lamp", "200", "--shots", shots}),
        list(folder.write(name + ".xyz", xyz(walk(static_cast<int>(points), 4, 0.05)))),
        port(folder / name) {}
  std::vector<std::string> engrave() const {
    return {"engrave", list, "--lamp", "200", "--board", port, "--yes"};
  }
  std::string shell_line() const {
    std::string line = program_path();
    for (const std::string& word : engrave()) line += " " + word;
    return line;
  }
  std::size_t shots_fired() {
    sim.interrupt();
    sim.finish();
    return read_shots(shots).size();
  }
  std::string shots;
  Running sim;
  std::string list, port;
};

TEST(LostRemarks, DoNotEndAJob) {
  const Folder folder;
  const std::vector<std::string> lost{"{ JOB; } 2>/dev/full", "{ JOB; } 2>&-",
                                      "{ { JOB; } 3>&1 1>&2 2>&3 | true; } 2>OUT",
                                      "{ JOB; } >&- 2>&-", "{ JOB; } >/dev/full 2>/dev/full"};
  constexpr std::array statuses{0, 0, 0, 1, 1};
  std::vector<std::unique_ptr<Bench>> benches;
  std::string script;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    benches.push_back(std::make_unique<Bench>(folder, "p" + std::to_string(i)));
    std::string line = lost[i];
    const std::string status = folder / ("status" + std::to_string(i));
    line.replace(line.find("JOB"), 3, benches[i]->shell_line() + "; echo $? >" + status);
    if (const auto at = line.find("OUT"); at != std::string::npos)
      line.replace(at, 3, folder / "out");
    script += line + " &\n";
  }
  for (const auto& bench : benches) ASSERT_TRUE(bench->sim.wait_for("Ctrl-C"));
  ASSERT_EQ(std::system((script + "wait").c_str()), 0);  // NOLINT(cert-env33-c)
  for (std::size_t i = 0; i < lost.size(); ++i) {
    EXPECT_EQ(read(folder / ("status" + std::to_string(i))), std::to_string(statuses.at(i)) + "\n")
        << lost[i];
    EXPECT_EQ(benches[i]->shots_fired(), points) << lost[i];
  }
}

/// A pipe that another program has filled and does not read.
TEST(LostRemarks, ThatAreNotReadDoNotDelayAJob) {
  const Folder folder;
  Bench bench(folder, "port");
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK), 0);
  const std::string page(4096, '.');
  while (::write(pipe[1], page.data(), page.size()) > 0) continue;
  ::fcntl(pipe[1], F_SETFL, 0);  // the program waits in a write
  ASSERT_TRUE(bench.sim.wait_for("Ctrl-C"));
  ProgramStart program(bench.engrave());
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open("/dev/null", O_RDWR), STDIN_FILENO);
    ::dup2(STDIN_FILENO, STDOUT_FILENO);
    ::dup2(pipe[1], STDERR_FILENO);
    ::alarm(20);
    program.become_program();
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(bench.shots_fired(), points);
  for (const int end : pipe) ::close(end);
}

/// Ctrl-S stops the terminal; the job is done, and its report is shown after Ctrl-Q.
TEST(LostRemarks, OfAStoppedTerminalWait) {
  const Folder folder;
  Bench bench(folder, "port");
  ASSERT_TRUE(bench.sim.wait_for("Ctrl-C"));
  InTerminal job(bench.engrave());
  ASSERT_TRUE(job.wait_for("engraving"));
  job.type("\x13");
  job.watch(std::chrono::milliseconds(1200));
  EXPECT_EQ(bench.shots_fired(), points);
  job.type("\x11");
  EXPECT_EQ(job.finish().status, 0);
}

}  // namespace
}  // namespace lamplock::cli::test::lost_remarks
