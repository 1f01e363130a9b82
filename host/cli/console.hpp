// The terminal as the frontend of the use cases: text for people, and JSON for programs.
//
// In:  lines and phases with their time. Out: stdout, or stderr when stdout carries JSON; progress,
//      notices and questions on stderr. Who: every command.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include "host/cli/json.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// The two streams of one command.
class Console : public run::Frontend {
 public:
  /// `json`: stdout is for one JSON document.
  explicit Console(bool json) : json_(json), out_(json ? stderr : stdout) {}

  bool json() const { return json_; }

  void line(const std::string& text) override;
  void text(const std::string& text) override;
  void require_output() override;
  void notice(const std::string& text) override;
  void phase(const std::string& name, const std::string& what) override;
  void restart_clock() override { phase_start_ = Clock::now(); }
  std::unique_ptr<run::Progress> progress(std::string title, std::size_t total,
                                          std::size_t first) override;
  std::unique_ptr<run::Interrupts> interrupts() override;
  std::unique_ptr<run::LineInput> line_input() override;
  std::unique_ptr<run::LineInput> dialogue_input() override;
  bool can_ask() const override;
  bool confirms(const std::string& question) override;

  /// Prints the JSON document if one is wanted.
  void document(const Json& json);

 private:
  using Clock = std::chrono::steady_clock;
  bool json_;
  std::FILE* out_;
  Clock::time_point phase_start_ = Clock::now();
};

}  // namespace lamplock::cli
