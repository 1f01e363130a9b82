// Signals and every kind of standard input: the program ends, with the status of the table in the
// manual, and a stopped job says where to continue.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/chip/tiny_image.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/program_start.hpp"

namespace lamplock::cli::test::signals {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

enum class Input { null_device, closed, pipe };
constexpr std::array inputs{Input::null_device, Input::closed, Input::pipe};
constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};

/// The program in the background, with this kind of input; a pipe has a writer and no data.
class WithInput {
 public:
  WithInput(const std::vector<std::string>& arguments, Input input) {
    EXPECT_EQ(::pipe2(pipe_, O_CLOEXEC), 0);
    ProgramStart program(arguments);
    process_ = ::fork();
    if (process_ != 0) return;
    redirect_streams(input);
    program.become_program();
  }
  ~WithInput() {
    for (const int end : pipe_) ::close(end);
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  WithInput(const WithInput&) = delete;
  WithInput& operator=(const WithInput&) = delete;

  bool wait_for(const std::string& text) const {
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (output().find(text) == std::string::npos) {
      if (std::chrono::steady_clock::now() > until) return false;
      std::this_thread::sleep_for(2ms);
    }
    return true;
  }
  /// Sends a signal, and waits for the end: the exit status, 1000 + signal for a program that the
  /// signal has killed, -1 for one that does not end.
  int end_by(int signal) {
    ::kill(process_, signal);
    const auto until = std::chrono::steady_clock::now() + 20s;
    int status = 0;
    while (::waitpid(process_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > until) return -1;
      std::this_thread::sleep_for(2ms);
    }
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  std::string output() const { return read(folder_ / "out"); }

 private:
  void redirect_streams(Input input) const {
    const int out = ::open((folder_ / "out").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    ::close(out);
    if (input == Input::null_device) ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    if (input == Input::pipe) ::dup2(pipe_[0], STDIN_FILENO);
    if (input == Input::closed) ::close(STDIN_FILENO);
  }

  Folder folder_;
  int pipe_[2] = {-1, -1};
  pid_t process_ = -1;
};

/// A job that does not end by itself within the test: long pauses, simulated. Its hold of a second
/// shows that it runs.
std::vector<std::string> long_job(const Folder& folder) {
  const std::string list = folder.write("p.xyz", xyz(walk(3000, 4, 0.05)));
  return {"engrave", list, "--pause-every", "1", "--pause-beats", "15000", "--hold-at", "1"};
}

TEST(Signals, stop_a_job_at_once_without_terminal_input) {
  const Folder folder;
  const auto job = long_job(folder);
  for (const int signal : ending_signals)
    for (const Input input : inputs) {
      SCOPED_TRACE(signal);
      SCOPED_TRACE(static_cast<int>(input));
      WithInput engrave(job, input);
      ASSERT_TRUE(engrave.wait_for("holding for a second"));
      EXPECT_EQ(engrave.end_by(signal), 128 + signal);
      EXPECT_THAT(engrave.output(), HasSubstr("Stopped at "));
      EXPECT_THAT(engrave.output(), HasSubstr("--from "));
    }
}

TEST(Signals, hold_only_by_ctrl_c_in_a_terminal) {
  const Folder folder;
  const auto job = long_job(folder);
  for (const int signal : {SIGTERM, SIGHUP}) {
    InTerminal engrave(job);
    ASSERT_TRUE(engrave.wait_for("engraving"));
    engrave.send_signal(signal);
    EXPECT_EQ(engrave.finish().status, 128 + signal);
  }
  InTerminal held(job);
  ASSERT_TRUE(held.wait_for("engraving"));
  ASSERT_TRUE(held.wait_for(", pause"));
  held.type("\x03");
  ASSERT_TRUE(held.wait_for("held, laser off; Enter to resume, Ctrl-C again to stop"));
  held.type("\x03");
  const Finished stopped = held.finish();
  EXPECT_EQ(stopped.status, 130);
  EXPECT_THAT(stopped.out, HasSubstr("--from "));
  // Ctrl-D ends the input: the job cannot be resumed any more.
  InTerminal left(job);
  ASSERT_TRUE(left.wait_for("engraving"));
  left.type("\x04");
  std::this_thread::sleep_for(200ms);
  left.type("\x03");
  EXPECT_EQ(left.finish().status, 130);
}

/// `!` is a hold in jobs too; Ctrl-C remains one.
TEST(Signals, the_key_of_a_hold_holds_a_job) {
  const Folder folder;
  InTerminal job(long_job(folder));
  ASSERT_TRUE(job.wait_for("engraving"));
  for (const char* hold : {"!\n", "8!"}) {
    job.type(hold);
    ASSERT_TRUE(job.wait_for("held, laser off; Enter to resume, Ctrl-C to stop")) << hold;
    job.type("\x1b[A\n");  // another key ends the time in which Enter belongs to the hold
    ASSERT_TRUE(job.wait_for("resuming")) << hold;
  }
  job.type("!");
  ASSERT_TRUE(job.wait_for("held, laser off"));
  job.type("\x03");
  const Finished stopped = job.finish();
  EXPECT_EQ(stopped.status, 130);
  EXPECT_THAT(stopped.out, testing::Not(HasSubstr("job speed 8 %")));
}

TEST(Signals, a_lamp_that_does_not_flash_is_named) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 4, 0.05)));
  Running sim({"sim", "--pty", folder / "port", "--lamp", "200", "--dropouts", "100"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  InTerminal job({"engrave", list, "--lamp", "200", "--board", folder / "port", "--yes"});
  ASSERT_TRUE(job.wait_for("no lamp"));
  job.type("\x03");
  ASSERT_TRUE(job.wait_for("Ctrl-C again to stop"));
  job.type("\x03");
  EXPECT_EQ(job.finish().status, 130);
}

/// A pipe at its end is not asked for a line: the machine alone can resume.
TEST(Signals, a_hold_without_an_input_says_so) {
  const Folder folder;
  const std::string list = folder.write("p.ngc", "G1 X1 F600\nM0\nG1 X2\n");
  Running sim({"sim", "--pty", folder / "port"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  WithInput send({"send", list, "--board", folder / "port", "--yes"}, Input::null_device);
  ASSERT_TRUE(send.wait_for("only the machine resumes, SIGINT stops"));
  EXPECT_EQ(send.end_by(SIGINT), 130) << send.output();
}

TEST(Signals, end_other_commands_with_the_same_statuses) {
  for (const int signal : ending_signals)
    for (const Input input : {Input::null_device, Input::pipe}) {
      SCOPED_TRACE(signal);
      WithInput sim({"sim", "--tcp", "127.0.0.1:0"}, input);
      ASSERT_TRUE(sim.wait_for("Ctrl-C"));
      EXPECT_EQ(sim.end_by(signal), signal == SIGINT ? 0 : 128 + signal);
    }
  const Folder folder;
  for (const int signal : ending_signals) {
    SCOPED_TRACE(signal);
    WithInput console({"console"}, Input::pipe);
    WithInput jog({"jog", "--pendant", "none"}, Input::pipe);
    ASSERT_TRUE(jog.wait_for("| Idle |"));
    EXPECT_EQ(jog.end_by(signal), 128 + signal);
    EXPECT_EQ(console.end_by(signal), 128 + signal);
  }
}

/// Ctrl-C is the usual end only of a run that has no other one.
TEST(Signals, end_a_run_of_the_chip_before_its_until) {
  const Folder folder;
  const auto image = lamplock::test::pin_image();
  std::vector<std::string> chip{"chip", folder.write("pins.bin", {image.begin(), image.end()}),
                                "--pty"};
  for (const bool has_until : {false, true}) {
    if (has_until) chip.insert(chip.end(), {"--until", "3600s"});
    for (const int signal : ending_signals) {
      SCOPED_TRACE(signal);
      WithInput run(chip, Input::null_device);
      ASSERT_TRUE(run.wait_for("USB is "));
      EXPECT_EQ(run.end_by(signal), signal == SIGINT && !has_until ? 0 : 128 + signal);
    }
  }
}

/// A closed standard input must not become the number of the port, which is a terminal too.
TEST(Signals, a_closed_input_is_an_input_at_its_end) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(20, 4, 0.05)));
  Running sim({"sim", "--pty", folder / "port", "--lamp", "200"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  WithInput engrave({"engrave", list, "--lamp", "200", "--board", folder / "port", "--yes"},
                    Input::closed);
  EXPECT_EQ(engrave.end_by(0), 0) << engrave.output();
}

}  // namespace
}  // namespace lamplock::cli::test::signals
