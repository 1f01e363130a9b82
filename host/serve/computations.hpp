// Computations that take too long for the thread of the server: checks of programs, clouds.
//
// In:  functions that use nothing of the server. Out: their ends, in the thread of poll().
// Who: the server. One computation runs at a time, so that requests cannot occupy the computer.
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>

#include "host/run/background.hpp"

namespace lamplock::serve {

class Computations {
 public:
  using Work = std::function<void()>;
  /// The error of the work, or null.
  using Done = std::function<void(std::exception_ptr)>;

  /// Begins it, or queues it. Throws Error(job_failed) while too many wait.
  void add(Work work, Done done);
  /// To be called regularly: ends what has ended, and begins the next one.
  void poll();
  /// Drops what has not ended; the destructor waits for the one that runs.
  void end();

 private:
  /// Far above what pages ask for at once; each may hold a file of a user in memory.
  static constexpr std::size_t max_waiting = 16;
  struct One {
    Work work;
    Done done;
  };
  void begin_next();

  std::deque<One> all_;  ///< the first one runs
  run::Background<bool> running_;
};

}  // namespace lamplock::serve
