#include "host/run/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <system_error>
#include <thread>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

using std::chrono::milliseconds;

/// Between SIGTERM and SIGKILL.
constexpr milliseconds patience_at_end{500}, wait_step{5};

/// What posix_spawn() does in the new process.
class SpawnActions {
 public:
  SpawnActions() {
    constexpr int first_other = 3;
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files_, STDERR_FILENO, STDOUT_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&files_, first_other);
    ::posix_spawnattr_init(&attributes_);
    sigset_t all, none;
    ::sigfillset(&all);
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnActions() {
    ::posix_spawnattr_destroy(&attributes_);
    ::posix_spawn_file_actions_destroy(&files_);
  }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  const posix_spawn_file_actions_t* files() const { return &files_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

std::string end_text(int status) {
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  return code == 0 ? "" : fmt::format("ended with status {}", code);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const std::string& where) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  arguments.reserve(copies.size() + 1);
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const SpawnActions actions;
  const int error = ::posix_spawn(&process_, arguments.front(), actions.files(),
                                  actions.attributes(), arguments.data(), environ);
  if (error == 0) return;
  process_ = -1;
  throw Error(
      Exit::job_failed, where,
      fmt::format("{}: cannot be run ({})", words.front(), std::generic_category().message(error)),
      error == ENOEXEC ? "begin the script with a line such as #!/bin/sh"
                       : "check the file and its permissions");
}

ChildProcess::~ChildProcess() {
  if (process_ < 0) return;
  const pid_t process = process_;
  ::kill(-process, SIGTERM);
  if (wait(patience_at_end)) return;
  ::kill(-process, SIGKILL);
  while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<std::string> ChildProcess::wait(milliseconds patience) {
  if (process_ < 0) return "";
  const auto until = std::chrono::steady_clock::now() + patience;
  for (;;) {
    int status = 0;
    const pid_t ended = ::waitpid(process_, &status, WNOHANG);
    if (ended == process_) {
      process_ = -1;
      return end_text(status);
    }
    if (ended < 0 && errno != EINTR) {
      process_ = -1;
      return "has an unknown end";
    }
    if (std::chrono::steady_clock::now() >= until) return std::nullopt;
    std::this_thread::sleep_for(wait_step);
  }
}

}  // namespace lamplock::run
