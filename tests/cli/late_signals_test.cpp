// Signals before the first shot, after the last shot, and signals that end the program at once:
// outputs are whole or absent, and the terminal is usable.
#include <gmock/gmock.h>
#include <termios.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::late_signals {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::vector<std::string> parts_in(const Folder& folder) {
  std::vector<std::string> parts;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    if (entry.path().extension() == ".part") parts.push_back(entry.path().string());
  return parts;
}

/// The summary is printed before the pictures are written.
TEST(LateSignals, AfterTheLastShotDoNotInterruptTheReport) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(1500, 4, 0.05)));
  const std::string report = folder / "report";
  Running engrave({"engrave", points, "--json", "--report", report});
  ASSERT_TRUE(engrave.wait_for("points fired"));
  engrave.terminate();
  engrave.interrupt();
  const Finished done = engrave.finish();
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(nlohmann::json::parse(done.out)["end"], "done");
  for (const char* name : {"report.json", "report.html", "shots.csv", "shots.ply", "cloud.png"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(report) / name)) << name;
}

/// The folder and report.json are reserved before the board begins.
TEST(EarlySignals, LeaveNoPartOfAReport) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(2000, 4, 0.05)));
  constexpr int rounds = 12;
  for (int i = 0; i < rounds; ++i) {
    const std::filesystem::path report = folder.path() / std::to_string(i);
    Running engrave({"engrave", points, "--report", report / "inner"});
    const auto until = std::chrono::steady_clock::now() + 5s;
    while (!std::filesystem::exists(report) && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(200us);
    std::this_thread::sleep_for(i * 500us);
    engrave.terminate();
    const int status = engrave.finish().status;
    EXPECT_THAT(status, testing::AnyOf(0, 128 + SIGTERM));
    EXPECT_THAT(parts_in(folder), testing::IsEmpty());
    EXPECT_EQ(std::filesystem::exists(report),
              std::filesystem::exists(report / "inner" / "report.json"));
  }
}

TEST(SignalsThatEndAtOnce, RestoreTheTerminal) {
  const Folder folder;
  const std::string points = folder.write("p.xyz", xyz(walk(3000, 4, 0.05)));
  for (const int signal : {SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM}) {
    InTerminal engrave(
        {"engrave", points, "--pause-every", "1", "--pause-beats", "15000", "--hold-at", "1"});
    ASSERT_TRUE(engrave.wait_for("holding for a second"));
    EXPECT_EQ(engrave.modes().c_lflag & tcflag_t{ECHO}, 0u);
    engrave.send_signal(signal);
    EXPECT_EQ(engrave.finish().status, 128 + signal);
    EXPECT_EQ(engrave.modes().c_lflag & tcflag_t{ECHO | ICANON}, tcflag_t{ECHO | ICANON});
  }
}

}  // namespace
}  // namespace lamplock::cli::test::late_signals
