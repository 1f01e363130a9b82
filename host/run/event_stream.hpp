// Lines for another program, written while a machine works: a file, a named pipe or stdout.
//
// In:  lines. Out: the same lines in the same order; a loss, once. Never waits for the reader,
//      except for a terminal that its user has stopped, and never throws once it is open: a machine
//      must not stop because a log cannot be written.
// Who: `send --events`.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace lamplock::run {

class EventStream {
 public:
  /// Name of stdout.
  static constexpr const char* standard_output = "-";
  /// Bytes that wait for a slow reader; more are a loss.
  static constexpr std::size_t max_waiting = 16u << 20;

  /// Proves that the file can be written, and changes nothing. Throws Error(bad_input).
  static void check(const std::string& path);
  /// Makes or empties the file; a named pipe needs its reader. Throws Error(bad_input).
  explicit EventStream(const std::string& path);
  ~EventStream();
  EventStream(const EventStream&) = delete;
  EventStream& operator=(const EventStream&) = delete;

  /// Adds a line, without its end.
  void add(const std::string& line);
  /// Writes what the reader takes at once.
  void poll();
  /// Writes the rest; what a reader does not take in this time is lost.
  void finish(std::chrono::milliseconds patience = std::chrono::milliseconds{1000});
  /// Why lines were lost; empty: none were. Later lines are dropped.
  const std::string& loss() const { return loss_; }

 private:
  bool is_writable(std::chrono::milliseconds patience);
  void lose(const std::string& why);

  int descriptor_ = -1;
  bool is_owned_ = false;
  std::string waiting_;
  std::size_t written_ = 0;  ///< bytes of waiting_
  std::string loss_;
};

}  // namespace lamplock::run
