// Runs a question as a user without rights.
//
// In:  a question whose answer is a small number. Out: that number. Who: tests of permissions.
#pragma once

#include <grp.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lamplock::usb::test {

/// Runs it in a child process without root's rights; returns 0 to 99, other numbers on failure.
template <class Question>
int as_nobody(Question&& question) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr unsigned unprivileged = 65'534;
    if (::geteuid() == 0 && (::setgroups(0, nullptr) != 0 || ::setgid(unprivileged) != 0 ||
                             ::setuid(unprivileged) != 0))
      ::_exit(100);
    ::_exit(question());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 200;
}

}  // namespace lamplock::usb::test
