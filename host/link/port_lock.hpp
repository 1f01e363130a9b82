// One program at a port: two would take each other's answers away and send into each other's jobs.
//
// In:  the name of a serial port. Out: it is ours until the lock goes, or who has it.
// Who: SerialTransport, before it changes anything of the port.
#pragma once

#include <string>

namespace lamplock::link {

/// An advisory lock (flock) that goes with the process, however that ends.
class PortLock {
 public:
  PortLock() = default;
  ~PortLock() { release(); }
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;

  /// False if the port cannot be opened, or if another program has it: see failure() and user().
  bool take(const std::string& port);
  /// From now on nobody but root can open the port, be it by a program that asks for no locks
  /// (TIOCEXCL); not for pseudo-terminals. To be called when the port has been opened.
  void refuse_others();
  void release();

  /// Number of the system (errno) after take() has failed.
  int failure() const { return failure_; }
  /// Another program has the port: "pid 1234, minicom", or "unknown" if that may not be seen. Empty
  /// if none has.
  const std::string& user() const { return user_; }

 private:
  int descriptor_ = -1;
  int failure_ = 0;
  std::string user_;
};

}  // namespace lamplock::link
