// What somebody without rights gets.
//
// In:  a question whose answer is a small number. Out: that number. Who: tests of permissions.
#pragma once

#include <grp.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lamplock::usb::test {

/// Runs it in another process, without root's rights; 0 to 99, other numbers if that fails.
template <class Question>
int as_nobody(Question&& question) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr unsigned nobody = 65'534;
    if (::geteuid() == 0 &&
        (::setgroups(0, nullptr) != 0 || ::setgid(nobody) != 0 || ::setuid(nobody) != 0))
      ::_exit(100);
    ::_exit(question());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 200;
}

}  // namespace lamplock::usb::test
