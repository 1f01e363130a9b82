// Result of a job that was sent to a machine.
//
// In:  the last STATUS of the job, counts of the link. Out: how it ended and where a next run
//      continues. Who: the sender, which makes it; use cases and reports, which read it.
#pragma once

#include <chrono>
#include <cstdint>

#include "host/link/continuation.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// How a job ended.
enum class JobEnd : std::uint8_t {
  done,       ///< every point fired
  stopped,    ///< by the user of this program
  alarm,      ///< alarm or e-stop, see status.state and status.alarm
  lost,       ///< the connection is lost
  restarted,  ///< the machine has lost the job by a power loss or a watchdog reset
  replaced,   ///< the machine has a job of another program
};

/// Result of a job that was begun.
struct JobResult {
  JobEnd end = JobEnd::done;
  wire::Status status;              ///< last one of this session, before any restart
  std::uint32_t flashes_fired = 0;  ///< of the point status.first_unfired
  Continuation rest;                ///< where a next run continues
  std::uint64_t resent = 0;         ///< frames retransmitted
  std::uint64_t bad_frames = 0;     ///< corrupt frames from the machine
  std::uint64_t reconnects = 0;
  std::chrono::microseconds elapsed{0};
};

}  // namespace lamplock::link
