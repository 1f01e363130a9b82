// The error of a machine that does not confirm its stop.
//
// In:  what was asked of the machine. Out: the error. Who: senders of jobs and programs, the
//      inquiry about a job; host/run, which must not report such an end as harmless.
#pragma once

#include "host/error.hpp"

namespace lamplock::link {

/// A machine that could not be stopped: it may still move and fire, whatever this program has sent.
class NotStopped : public Error {
 public:
  using Error::Error;
};

}  // namespace lamplock::link
