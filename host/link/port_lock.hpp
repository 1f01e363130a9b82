// One program at a port: two would take each other's answers away and send into each other's jobs.
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
  /// Has no effect on pseudo-terminals. To be called when the port has been opened.
  void refuse_others();
  void release();

  /// Number of the system (errno) after take() has failed.
  int failure() const { return failure_; }
  /// Another program has the port: "pid 1234, minicom", or "unknown" if that may not be seen. Empty
  /// if none has.
  const std::string& user() const { return user_; }

 private:
  int descriptor_ = -1;
  bool refuses_ = false;  ///< others, by TIOCEXCL
  int failure_ = 0;
  std::string user_;
};

}  // namespace lamplock::link
