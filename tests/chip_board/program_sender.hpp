// A sender of programs at the cable of any simulated board: counts characters as senders do,
// continues after an error, stores the board's text.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "sim/board.hpp"

namespace lamplock::test {

class ProgramSender {
 public:
  explicit ProgramSender(sim::Board& board) : board_(board) {}

  /// Appends whole lines to the text to be sent.
  void give(std::string_view text) { text_.append(text); }
  /// Sends what the board has room for, runs the board, and receives.
  void step(sim::Picoseconds time = 100 * sim::ps_per_us) {
    while (next_ < text_.size()) {
      const std::size_t size = text_.find('\n', next_) + 1 - next_;
      if (bytes_under_way_ + size > window) break;
      type(std::string_view(text_).substr(next_, size));
      next_ += size;
      bytes_under_way_ += size;
      under_way_.push_back(size);
    }
    board_.run_until(board_.now() + time);
    listen();
  }
  bool all_sent() const { return next_ == text_.size(); }
  /// True if everything is sent and answered.
  bool answered() const { return all_sent() && under_way_.empty(); }
  /// Runs until everything is answered; false if it is not by `end`.
  bool run_until_answered(sim::Picoseconds end) {
    while (!answered() && board_.now() < end) step();
    return answered();
  }
  /// Runs until the machine is at rest with nothing left to do; false if it is not by `end`.
  bool run_until_idle(sim::Picoseconds end) {
    while (board_.now() < end) {
      type("?");
      const std::size_t from = heard_.size();
      step(sim::ps_per_ms);
      if (heard_.find("<Idle", from) != std::string::npos) return true;
    }
    return false;
  }

  /// Answers "ok" and "error:N", in order.
  const std::vector<std::string>& answers() const { return answers_; }
  /// Their arrival times.
  const std::vector<sim::Picoseconds>& answer_times() const { return answer_times_; }
  std::size_t errors() const {
    return answers_.size() -
           static_cast<std::size_t>(std::count(answers_.begin(), answers_.end(), "ok"));
  }
  /// All text from the board.
  const std::string& heard() const { return heard_; }

  static constexpr std::size_t window = 1024;

 private:
  void type(std::string_view text) {
    board_.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void listen() {
    std::array<std::uint8_t, 4096> bytes;
    while (const std::size_t n = board_.read(bytes))
      heard_.append(reinterpret_cast<const char*>(bytes.data()), n);
    for (std::size_t end = heard_.find("\r\n", read_); end != std::string::npos;
         end = heard_.find("\r\n", read_)) {
      std::string line = heard_.substr(read_, end - read_);
      read_ = end + 2;
      if ((line != "ok" && !line.starts_with("error:")) || under_way_.empty()) continue;
      answers_.push_back(std::move(line));
      answer_times_.push_back(board_.now());
      bytes_under_way_ -= under_way_.front();
      under_way_.pop_front();
    }
  }

  sim::Board& board_;
  std::string text_, heard_;
  std::size_t next_ = 0, read_ = 0;  ///< first byte not sent, first byte not parsed
  std::deque<std::size_t> under_way_;
  std::size_t bytes_under_way_ = 0;
  std::vector<std::string> answers_;
  std::vector<sim::Picoseconds> answer_times_;
};

}  // namespace lamplock::test
