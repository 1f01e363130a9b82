// Keeps a port to one program: two would read each other's answers and send into each other's jobs.
//
// In:  the name of a serial port. Out: a lock on it, or the program that has it.
// Who: SerialTransport, before it changes anything of the port.
#pragma once

#include <string>

namespace lamplock::link {

/// An advisory lock (flock). The kernel releases it when the process ends, also when it is killed.
class PortLock {
 public:
  PortLock() = default;
  ~PortLock() { release(); }
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;

  /// False if the port cannot be opened, or if another program has it: see failure() and user().
  bool take(const std::string& port);
  /// From now on only root can open the port, even with a program that ignores locks (TIOCEXCL).
  /// Has no effect on pseudo-terminals. Call it after the port was opened.
  void refuse_others();
  void release();

  /// errno after take() has failed.
  int failure() const { return failure_; }
  /// The program that has the port: "pid 1234, minicom", or "unknown" if the system hides it. Empty
  /// if no program has it.
  const std::string& user() const { return user_; }

 private:
  int descriptor_ = -1;
  bool refuses_ = false;  ///< TIOCEXCL is set
  int failure_ = 0;
  std::string user_;
};

}  // namespace lamplock::link
