// A LineRun in a thread of its own: the planner needs most of the time of a program, and nothing of
// its result is needed before the end, so that reading the program and planning run side by side.
//
// In:  the same calls as of LineRun. Out: the LineRun after all of them, the same as without a
//      thread. Who: programs of G-code (program_run.hpp).
//
//   caller  read lines ─ portion ─ portion ─ portion ─ wait()
//   thread               plan      plan      plan      ┘
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "host/program/line_run.hpp"

namespace lamplock::program_run {

class LineThread {
 public:
  /// Throws as LineRun.
  explicit LineThread(const settings::Values& values) : run_(values) {}
  ~LineThread();
  LineThread(const LineThread&) = delete;
  LineThread& operator=(const LineThread&) = delete;
  LineThread(LineThread&&) = delete;
  LineThread& operator=(LineThread&&) = delete;

  // As those of LineRun.
  void receive(std::size_t bytes) { received_ += bytes; }
  void take(const motion::LineTarget& line) { add({CallKind::take, received_, 0, line}); }
  void finish() { add({CallKind::finish, received_, 0, {}}); }
  void dwell(std::uint32_t us) { add({CallKind::dwell, received_, us, {}}); }

  /// The run after all calls. Throws what one of them has thrown.
  LineRun& wait();

 private:
  enum class CallKind : std::uint8_t { take, finish, dwell };
  struct Call {
    CallKind kind;
    std::size_t received;  ///< bytes before it
    std::uint32_t us;      ///< of a dwell
    motion::LineTarget line;
  };
  using Portion = std::vector<Call>;

  void add(const Call& call);
  void call(const Portion& portion);
  void push(Portion portion);
  void work();
  void close();

  LineRun run_;
  std::size_t received_ = 0;  ///< since the last call
  Portion next_;              ///< calls that the thread has not got yet
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Portion> portions_;
  bool is_closed_ = false;
  std::exception_ptr failure_;  ///< of the thread
};

}  // namespace lamplock::program_run
