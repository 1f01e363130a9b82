// A program of the user, run beside this one, without a shell.
//
// In:  a file and arguments. Out: how it ended. Who: user commands.
//
// It has its own process group, so that Ctrl-C in a terminal does not reach it before this program
// ends it; its stdin is empty, its stdout is stderr, and no other file of this program is open.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::run {

class ChildProcess {
 public:
  /// Throws Error(job_failed) about `where` if the file cannot be run.
  ChildProcess(const std::vector<std::string>& words, const std::string& where);
  /// Ends it, if it runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits at most this time: empty if it still runs; "" if it ended with status 0, else how it
  /// ended: "ended with status 3".
  std::optional<std::string> wait(std::chrono::milliseconds patience);

 private:
  pid_t process_ = -1;
};

}  // namespace lamplock::run
