// The chip's side of the GDB remote serial protocol (manual "Debugging with GDB", appendix E).
//
// In:  bytes of a debugger; stops of the chip. Out: bytes for the debugger; whether the chip runs.
// Who: Server with a connection, tests without one:
//
//        stub.receive(bytes); send(stub.take_output());
//        if (stub.running()) stub.run(until); // otherwise time does not advance
//
// All-stop: the debugger sends packets only while the chip is halted. While it runs only ctrl-C is
// expected; a packet then means that another debugger has connected, and the chip halts. Thread 1
// is core 0, thread 2 core 1. An unknown packet is answered by an empty one, a wrong one by an
// error.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/chip/gdb/debug_target.hpp"
#include "sim/chip/gdb/packets.hpp"

namespace lamplock::sim::chip::gdb {

class Stub {
 public:
  /// The chip is halted until a debugger continues it, or (`running`) runs until one connects.
  Stub(DebugTarget& target, bool running) : target_(target), running_(running) {}

  void receive(std::span<const std::uint8_t> bytes);
  std::string take_output() { return packets_.take_output(); }

  /// The chip must run, by run() only.
  bool running() const { return running_; }
  /// Runs the chip until it stops, which is reported to the debugger, or has reached `until`.
  void run(Cycle until);
  /// The debugger has requested the end of the simulation.
  bool killed() const { return killed_; }

 private:
  std::string answer(std::string_view packet);
  std::string query(std::string_view packet);
  std::string transfer(std::string_view request);
  std::string supported(std::string_view features);
  std::string select_thread(std::string_view rest);
  std::string thread_alive(std::string_view rest) const;
  std::string thread_info(std::string_view rest);
  std::string read_registers();
  std::string write_registers(std::string_view rest);
  std::string read_register(std::string_view rest);
  std::string write_register(std::string_view rest);
  std::string read_memory(std::string_view rest);
  std::string write_memory(std::string_view rest, bool binary);
  std::string breakpoint(std::string_view packet, bool set);
  std::string flash(std::string_view packet);
  std::string monitor(std::string_view command);
  std::string continue_some(std::string_view actions);
  std::string continue_at(std::string_view rest, bool step);
  void resume(bool step, int core);
  void halt(Stop stop, unsigned signal);
  std::string stop_reply() const;

  DebugTarget& target_;
  Packets packets_;
  bool running_;
  bool killed_ = false;
  bool swbreak_ = false, hwbreak_ = false;  ///< the debugger understands these reasons
  int general_core_ = 0;                    ///< of register and memory packets
  int continue_core_ = 0;                   ///< of step packets without a thread
  Stop stop_;                               ///< the last one
  unsigned signal_ = 5;
};

}  // namespace lamplock::sim::chip::gdb
