// Text for people, apart from data for programs.
//
// In:  lines and phases with their time. Out: stdout, or stderr when stdout carries JSON.
// Who: every command.
#pragma once

#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include "host/cli/json.hpp"

namespace lamplock::cli {

/// The two streams of one command.
class Console {
 public:
  /// `json`: stdout is for one JSON document.
  explicit Console(bool json) : json_(json), out_(json ? stderr : stdout) {}

  bool json() const { return json_; }

  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) {
    line(fmt::format(format, std::forward<Args>(args)...));
  }
  /// Prints one line, printable whatever is in it, and a line end.
  void line(const std::string& text);
  /// Prints text as it is.
  void text(const std::string& text);

  /// Ends a phase that began at the end of the phase before: its name, what came of it, its time.
  void phase(const std::string& name, const std::string& what);
  /// The next phase begins now.
  void restart_clock() { phase_start_ = Clock::now(); }

  /// Prints the JSON document if one is wanted.
  void document(const Json& json);

 private:
  using Clock = std::chrono::steady_clock;
  bool json_;
  std::FILE* out_;
  Clock::time_point phase_start_ = Clock::now();
};

}  // namespace lamplock::cli
