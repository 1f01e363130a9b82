// A debugger at the end of a connection: who drives the chip calls run_until() here instead of at
// the chip.
//
// In:  a byte endpoint, the chip. Out: the chip's time moves, or stands while the debugger halts
// it. Between two looks at the connection the chip runs for a stretch of simulated time; where
// stretches end makes no difference to what is simulated.
#pragma once

#include <functional>
#include <string>

#include "sim/chip/gdb/debug_target.hpp"
#include "sim/chip/gdb/stub.hpp"
#include "sim/endpoint/byte_endpoint.hpp"

namespace lamplock::sim::chip::gdb {

/// What the chip does before the first debugger comes.
enum class Start : std::uint8_t { halted, running };

/// One chip with its door for debuggers. Both must outlive it.
class Server {
 public:
  Server(Chip& chip, ByteEndpoint& endpoint, Start start);

  /// Runs the chip to `until`, as Chip::run_until() would; waits as long as the debugger halts it.
  /// `give_up` is asked meanwhile; empty: for ever. False: the debugger has ended the simulation,
  /// or give_up() has.
  bool run_until(Cycle until, const std::function<bool()>& give_up = {});

 private:
  /// One look at the connection; whether anything came.
  bool exchange();

  /// 1 ms at 125 MHz: short for whoever presses ctrl-C, long against a look at the connection.
  static constexpr Cycle stretch = 125'000;

  Chip& chip_;
  ByteEndpoint& endpoint_;
  DebugTarget target_;
  Stub stub_;
  std::string unsent_;
};

}  // namespace lamplock::sim::chip::gdb
