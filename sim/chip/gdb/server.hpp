// Serves a debugger over a connection: the owner of the chip calls run_until() here instead of at
// the chip.
//
// In:  a byte endpoint, the chip. Out: the chip's time advances, or stops while the debugger halts
//      it. The chip runs for a stretch of simulated time between two polls of the connection; the
//      length of stretches does not change the simulation.
#pragma once

#include <functional>
#include <string>

#include "sim/chip/gdb/debug_target.hpp"
#include "sim/chip/gdb/stub.hpp"
#include "sim/endpoint/byte_endpoint.hpp"

namespace lamplock::sim::chip::gdb {

/// State of the chip before the first debugger connects.
enum class Start : std::uint8_t { halted, running };

/// One chip with its connection for debuggers. Both must outlive it.
class Server {
 public:
  Server(Chip& chip, ByteEndpoint& endpoint, Start start);

  /// Runs the chip to `until`, as Chip::run_until() would; waits as long as the debugger halts it.
  /// Calls `is_cancelled` meanwhile, if not empty. False: the debugger has ended the simulation, or
  /// is_cancelled() has.
  bool run_until(Cycle until, const std::function<bool()>& is_cancelled = {});

 private:
  /// Polls the connection once; returns whether anything came.
  bool exchange();

  /// 1 ms at 125 MHz: a short delay for ctrl-C, yet long compared with a poll of the connection.
  static constexpr Cycle stretch = 125'000;

  Chip& chip_;
  ByteEndpoint& endpoint_;
  DebugTarget target_;
  Stub stub_;
  std::string unsent_;
};

}  // namespace lamplock::sim::chip::gdb
