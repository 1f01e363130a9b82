// A sender of programs at the cable of a virtual board: counts characters as senders do and stores
// the board's lines.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "tests/board/rig.hpp"

namespace lamplock::test {

class ProgramHost {
 public:
  explicit ProgramHost(Rig& rig) : rig_(rig) {
    run(ps_per_ms);  // the banner
    said_.clear();
  }

  /// Sends these bytes at once.
  void send(std::string_view text) {
    while (!text.empty()) {
      const std::size_t n =
          rig_.board.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
      text.remove_prefix(n);
      if (!text.empty()) run(ps_per_ms);
    }
  }
  void send(std::uint8_t byte) { send(std::string_view(reinterpret_cast<const char*>(&byte), 1)); }

  /// Runs the board and receives its lines.
  void run(sim::Picoseconds time) {
    rig_.run(time);
    listen();
  }
  void run_ms(double ms) { run(static_cast<sim::Picoseconds>(ms * 1e9)); }

  /// Sends lines; returns the board's lines until all are answered or the time is over.
  std::vector<std::string> ask(std::string_view text, double seconds = 1) {
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    const std::size_t before = answers_.size(), heard = said_.size();
    send(text);
    const auto limit = static_cast<int>(seconds * 1000);
    for (int ms = 0; ms < limit && answers_.size() < before + lines; ++ms) run_ms(1);
    return {said_.begin() + static_cast<std::ptrdiff_t>(heard), said_.end()};
  }

  /// Streams a program with at most the board's window under way until all lines are answered and
  /// the machine is at rest. False if that took longer.
  bool stream(std::string_view text, double seconds = 100) {
    std::deque<std::size_t> under_way;
    std::size_t bytes = 0, answered = answers_.size();
    const auto end = rig_.board.now() + static_cast<sim::Picoseconds>(seconds * 1e12);
    while (rig_.board.now() < end) {
      for (; answered < answers_.size() && !under_way.empty(); ++answered) {
        bytes -= under_way.front();
        under_way.pop_front();
      }
      while (!text.empty()) {
        const std::size_t size = std::min(text.find('\n'), text.size() - 1) + 1;
        if (bytes + size > window) break;
        send(text.substr(0, size));
        text.remove_prefix(size);
        bytes += size;
        under_way.push_back(size);
      }
      if (text.empty() && under_way.empty()) return wait_for_rest(seconds);
      run_ms(0.5);
    }
    return false;
  }
  /// Runs until the machine is at rest with nothing left to do; false if that took longer.
  bool wait_for_rest(double seconds = 100) {
    const auto end = rig_.board.now() + static_cast<sim::Picoseconds>(seconds * 1e12);
    while (rig_.board.now() < end) {
      if (rig_.state() == MachineState::idle && rig_.board.controller().program().idle())
        return true;
      run_ms(0.5);
    }
    return false;
  }

  /// Answers "ok" and "error:N", in order.
  const std::vector<std::string>& answers() const { return answers_; }
  /// Every line of the board, including status reports.
  const std::vector<std::string>& said() const { return said_; }
  bool has_said(std::string_view line) const {
    return std::find(said_.begin(), said_.end(), line) != said_.end();
  }
  std::string status() {
    send("?");
    for (int i = 0; i < 20; ++i) {
      run_ms(0.5);
      if (!said_.empty() && said_.back().starts_with("<")) return said_.back();
    }
    return "";
  }

  StepPosition position() const {
    const stepper::MotionState at = rig_.board.controller().runner().generator().state();
    StepPosition steps{};
    for (std::size_t a = 0; a < steps.size(); ++a) steps[a] = at.axis[a].step();
    return steps;
  }

  static constexpr std::size_t window = 1024;

 private:
  void listen() {
    std::array<std::uint8_t, 4096> bytes{};
    while (const std::size_t n = rig_.board.read(bytes)) {
      for (std::size_t i = 0; i < n; ++i) take(static_cast<char>(bytes[i]));
    }
  }
  void take(char c) {
    // The stream also has frames of a running job.
    constexpr char begin = 0x02, end = 0x03;
    if (c == begin || c == end) in_frame_ = c == begin;
    if (c == '\r' || c == end || in_frame_) return;
    if (c != '\n') {
      line_ += c;
      return;
    }
    if (line_ == "ok" || line_.starts_with("error:")) answers_.push_back(line_);
    if (!line_.empty()) said_.push_back(line_);
    line_.clear();
  }

  Rig& rig_;
  bool in_frame_ = false;
  std::string line_;
  std::vector<std::string> said_, answers_;
};

}  // namespace lamplock::test
