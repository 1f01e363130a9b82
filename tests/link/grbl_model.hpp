// A small model of a board that behaves like grbl 1.1, with a cable: receive buffer, planner queue,
// hold, reset, alarm.
//
// In:  lines and real-time bytes. Out: answers after random delays, status reports; a record of
// what arrived, and whether the receive buffer ever overflowed. A line leaves the buffer with its
// answer, later than in grbl, so that a host that exceeds the buffer by one byte is detected.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/bad_cable.hpp"

namespace lamplock::test {

/// The board. Motions last 1 to `max_move`; lines take 0 to `max_answer` to be answered.
class GrblModel : public BadCable {
 public:
  explicit GrblModel(std::uint64_t seed = 1, Faults faults = {})
      : BadCable(faults, seed), random_(seed + 1) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t count = BadCable::write(bytes.first(std::min(bytes.size(), max_written)));
    lines_written += static_cast<std::size_t>(
        std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count), '\n'));
    return count;
  }

  // Configuration.
  std::size_t window = 128, planner_blocks = 15;
  std::size_t max_written = 4096;  ///< bytes that the cable takes at a time
  Time max_answer{2'000}, max_move{20'000}, braking{30'000};
  std::map<std::string, int> refused;  ///< lines with their error numbers
  std::string alarm_line;              ///< a line that causes ALARM:1
  std::string lost_ok_line;            ///< a line whose ok is lost
  bool tells_version = true, tells_options = true, deaf = false;
  bool obeys_hold = true, answers_pause_first = false;
  std::string state = "Idle";
  std::map<std::uint32_t, std::string> settings;
  /// False if the board must reject these settings.
  std::function<bool(const std::map<std::uint32_t, std::string>&)> allows;

  // Record of events.
  std::vector<std::string> lines;        ///< lines executed or refused, without `$I`
  std::vector<std::uint8_t> bytes_seen;  ///< real-time bytes without `?`
  std::size_t max_used = 0;
  std::size_t lines_written = 0;  ///< written to the cable by the host
  bool overrun = false, reset_in_motion = false;
  int resets = 0, polls = 0;
  bool moving() const { return !moves_.empty() && (state == "Run" || state == "Hold:1"); }
  std::size_t waiting() const { return rx_.size(); }

  /// Sends an unsolicited line.
  void reply(const std::string& text) { tx_ += text + "\r\n"; }
  void restart() {
    rx_.clear();
    moves_.clear();
    busy_ = was_paused_ = false;
    state = "Idle";
    reply("");
    reply("Grbl 1.1h ['$' for help]");
  }

 private:
  void machine_receive(std::span<const std::uint8_t> bytes) override {
    if (deaf) return;
    for (const std::uint8_t byte : bytes)
      if (byte == '?' || byte == '!' || byte == '~' || byte == 0x18 || byte >= 0x80)
        realtime(byte);
      else
        rx_.push_back(static_cast<char>(byte));
    max_used = std::max(max_used, rx_.size());
    overrun = overrun || rx_.size() > window;
  }
  void machine_reconnected() override {}
  std::size_t machine_transmit(std::span<std::uint8_t> bytes) override {
    const std::size_t count = std::min(bytes.size(), tx_.size());
    std::copy_n(tx_.begin(), count, bytes.begin());
    tx_.erase(0, count);
    return count;
  }
  void machine_run() override {
    if (!moves_.empty() && state == "Idle") state = "Run";
    if (state == "Run" && !moves_.empty() && now() >= move_until_) next_move();
    if (state == "Run" && moves_.empty()) state = "Idle";
    if (state == "Hold:1" && now() >= braked_at_) state = "Hold:0";
    if (state == "Hold:0" || state == "Hold:1") return;
    if (!busy_) take_line();
    if (busy_ && now() >= answer_at_) finish_line();
  }

  void next_move() {
    moves_.pop_front();
    if (!moves_.empty()) move_until_ = now() + moves_.front();
  }

  void take_line() {
    const auto end = std::find(rx_.begin(), rx_.end(), '\n');
    if (end == rx_.end()) return;
    line_.assign(rx_.begin(), end);
    busy_ = true;
    answer_at_ = now() + random_time(max_answer);
    if (line_.starts_with("G4 P"))
      answer_at_ += Time(static_cast<Time::rep>(std::stod(line_.substr(4)) * 1e6));
  }

  /// Runs the line at the front, if the planner has room for it, and answers it.
  void finish_line() {
    const bool motion = line_.starts_with("G1");
    const bool drains = line_.starts_with("M0") || line_.starts_with("G4");
    if (motion && moves_.size() >= planner_blocks) return;
    if (drains && !moves_.empty()) return;
    if (line_.starts_with("M0") && !was_paused_) {
      state = "Hold:0";
      was_paused_ = true;
      if (!answers_pause_first) return;
    }
    was_paused_ = false;
    answer(motion);
    rx_.erase(rx_.begin(), rx_.begin() + static_cast<std::ptrdiff_t>(line_.size()) + 1);
    busy_ = false;
  }

  void answer(bool motion) {
    if (line_ == "$I") return identify();
    if (line_ == "$$") return list_settings();
    lines.push_back(line_);
    if (line_ == "$X" && state == "Alarm") {
      state = "Idle";
      return reply("ok");
    }
    if (state == "Alarm") return reply("error:9");
    if (line_ == alarm_line) {
      state = "Alarm";
      moves_.clear();
      return reply("ALARM:1");
    }
    if (const auto found = refused.find(line_); found != refused.end())
      return reply(fmt::format("error:{}", found->second));
    if (line_.starts_with('$') && line_.find('=') != std::string::npos) return change_setting();
    if (motion) {
      if (moves_.empty()) move_until_ = now() + max_move;
      moves_.push_back(random_time(max_move));
    }
    if (line_ != lost_ok_line) reply("ok");
  }

  void identify() {
    if (tells_version) reply("[VER:1.1h.20190830:model]");
    if (tells_options) reply(fmt::format("[OPT:V,{},{}]", planner_blocks, window));
    reply("ok");
  }

  void list_settings() {
    for (const auto& [number, value] : settings) reply(fmt::format("${}={}", number, value));
    reply("ok");
  }

  void change_setting() {
    const auto equals = line_.find('=');
    auto changed = settings;
    changed[static_cast<std::uint32_t>(std::stoul(line_.substr(1)))] = line_.substr(equals + 1);
    const bool allowed = !allows || allows(changed);
    if (allowed) settings = changed;
    reply(allowed ? "ok" : "error:52");
  }

  void realtime(std::uint8_t byte) {
    if (byte == '?') {
      ++polls;
      return reply(fmt::format("<{}|MPos:1.500,-2.000,0.000|Bf:{},{}|FS:0,0|WCO:1.000,0.000,0.000>",
                               state, planner_blocks - moves_.size(),
                               window - std::min(window, rx_.size())));
    }
    bytes_seen.push_back(byte);
    if (byte == '!' && obeys_hold && (state == "Run" || state == "Idle")) {
      state = state == "Run" ? "Hold:1" : "Hold:0";
      braked_at_ = now() + braking;
    }
    if (byte == '~' && state == "Hold:0") {
      state = moves_.empty() ? "Idle" : "Run";
      if (!moves_.empty()) move_until_ = now() + moves_.front();
    }
    if (byte == 0x18) reset();
  }

  void reset() {
    ++resets;
    reset_in_motion = reset_in_motion || moving();
    restart();
  }

  Time random_time(Time longest) {
    return Time(std::uniform_int_distribution<Time::rep>(0, longest.count())(random_));
  }

  std::mt19937_64 random_;
  std::deque<char> rx_;
  std::string tx_, line_;
  std::deque<Time> moves_;
  Time move_until_{}, answer_at_{}, braked_at_{};
  bool busy_ = false, was_paused_ = false;
};

}  // namespace lamplock::test
