// The sender of text at the cable of any simulated board.
//
// In:  lines and bytes to send, time.
// Out: the board's lines, whole answers and their times; the first violation of the protocol.
//      Frames of a job between the lines are skipped.
// Used by tests and benchmarks of both boards. Counts characters as senders do, and continues after
// an error.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/board.hpp"

namespace lamplock::test {

enum class Said { answer, report, banner, alarm, message, start_up, setting, nonsense };

/// Kind of a line from the board, by grbl's documentation.
inline Said kind_of(const std::string& line) {
  static const std::array<std::pair<std::regex, Said>, 6> kinds{
      {{std::regex("ok|error:[0-9]+"), Said::answer},
       {std::regex("<[a-zA-Z:0-9]+[|]+.*>"), Said::report},
       {std::regex("ALARM:[0-9]+"), Said::alarm},
       {std::regex(">.*:(ok|error:[0-9]+)"), Said::start_up},
       {std::regex("\\$(N[01]|[0-9]+)=.*"), Said::setting},
       {std::regex("\\[(MSG|GC|HLP|VER|OPT|BOARD|G5[4-9]|G59\\.[123]|G28|G30|G92|TLO|ROT|TOOL|PRB):"
                   "?.*\\]"),
        Said::message}}};
  if (line == "Grbl 1.1h ['$' for help]") return Said::banner;
  for (const auto& [pattern, kind] : kinds)
    if (std::regex_match(line, pattern)) return kind;
  return Said::nonsense;
}

class ProgramSender {
 public:
  /// `window`: the number of bytes that may be unanswered; 0 = one line at a time.
  explicit ProgramSender(sim::Board& board, std::size_t window = 1024)
      : board_(board), window_(window) {}

  /// Sends as many bytes as the cable accepts now; returns their number.
  std::size_t send_some(std::string_view text) {
    return board_.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  /// Sends all bytes, whatever the window.
  void send(std::string_view text) {
    while (!text.empty()) {
      text.remove_prefix(send_some(text));
      if (!text.empty()) run_ms(1);
    }
  }
  void send(std::uint8_t byte) { send(std::string_view(reinterpret_cast<const char*>(&byte), 1)); }

  /// Runs the board and receives its lines.
  void run(sim::Picoseconds time) {
    board_.run_until(board_.now() + time);
    listen();
  }
  void run_ms(double ms) { run(static_cast<sim::Picoseconds>(ms * 1e9)); }
  void listen() {
    std::array<std::uint8_t, 4096> bytes;
    while (const std::size_t n = board_.read(bytes)) {
      heard.append(reinterpret_cast<const char*>(bytes.data()), n);
      for (std::size_t i = 0; i < n; ++i) take(static_cast<char>(bytes[i]));
    }
  }

  /// True if this number of answers arrives in time.
  bool wait_for(std::size_t answers, double seconds = 1) {
    const sim::Picoseconds end = board_.now() + picoseconds(seconds);
    while (answers_.size() < answers && board_.now() < end) run_ms(0.5);
    return answers_.size() >= answers;
  }
  /// Sends lines; returns the board's lines until all are answered or the time is over.
  std::vector<std::string> ask(std::string_view text, double seconds = 1) {
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    const std::size_t before = answers_.size(), said = said_.size();
    send(text);
    wait_for(before + lines, seconds);
    return said_from(said);
  }
  /// All text from the board after a line, up to the line's answer.
  std::string answer(std::string_view line, sim::Picoseconds limit = 600 * sim::ps_per_ms) {
    listen();
    const std::size_t begin = heard.size(), answers = answers_.size();
    send(std::string(line) + "\n");
    const bool answered = wait_for(answers + 1, sim::seconds(limit));
    return heard.substr(begin) + (answered ? "" : "<silence>");
  }
  /// Asks for a status report.
  std::string status() {
    const std::size_t before = reports_;
    send("?");
    for (int i = 0; i < 200 && reports_ == before; ++i) run_ms(0.5);
    return reports_ == before ? "<silence>" : last_report_;
  }

  /// Appends whole lines to the program, which is sent as the window permits.
  void give(std::string_view text) { program_.append(text); }
  /// Sends what the board has room for, runs the board, and receives.
  void step(sim::Picoseconds time = 100 * sim::ps_per_us) {
    while (next_ < program_.size()) {
      std::size_t end = std::min(program_.find_first_of("\r\n", next_), program_.size() - 1) + 1;
      if (program_[end - 1] == '\r' && program_[end] == '\n') ++end;
      const std::size_t size = end - next_;
      if (!under_way_.empty() && bytes_under_way_ + size > window_) break;
      send(std::string_view(program_).substr(next_, size));
      next_ = end;
      bytes_under_way_ += size;
      under_way_.push_back(size);
    }
    run(time);
  }
  bool all_sent() const { return next_ == program_.size(); }
  /// True if the whole program is sent and answered.
  bool answered() const { return all_sent() && under_way_.empty(); }
  bool run_until_answered(sim::Picoseconds end) {
    while (!answered() && board_.now() < end) step();
    return answered();
  }
  /// Runs until the machine reports that it is idle; false if it does not by `end`.
  bool run_until_idle(sim::Picoseconds end) {
    while (board_.now() < end) {
      const std::size_t before = reports_;
      send("?");
      step(sim::ps_per_ms);
      if (reports_ != before && last_report_.starts_with("<Idle")) return true;
    }
    return false;
  }

  /// Answers "ok" and "error:N", in order, and their arrival times.
  const std::vector<std::string>& answers() const { return answers_; }
  const std::vector<sim::Picoseconds>& answer_times() const { return answer_times_; }
  std::size_t errors() const {
    return answers_.size() -
           static_cast<std::size_t>(std::count(answers_.begin(), answers_.end(), "ok"));
  }
  /// Every line of the board that is not empty, including status reports.
  const std::vector<std::string>& said() const { return said_; }
  std::vector<std::string> said_from(std::size_t first) const {
    return {said_.begin() + static_cast<std::ptrdiff_t>(first), said_.end()};
  }
  bool has_said(std::string_view line) const {
    return std::find(said_.begin(), said_.end(), line) != said_.end();
  }
  std::size_t count(Said kind) const {
    return static_cast<std::size_t>(
        std::count_if(said_.begin(), said_.end(),
                      [kind](const std::string& line) { return kind_of(line) == kind; }));
  }
  std::size_t reports() const { return reports_; }
  const std::string& last_report() const { return last_report_; }
  /// The first violation of the protocol, or empty.
  std::string fault() const {
    if (!fault_.empty()) return fault_;
    for (const std::string& line : said_)
      if (kind_of(line) == Said::nonsense) return "no line of the protocol: " + line;
    return "";
  }
  /// All bytes from the board; tests may clear them.
  std::string heard;

 protected:
  static sim::Picoseconds picoseconds(double seconds) {
    return static_cast<sim::Picoseconds>(seconds * 1e12);
  }
  void forget_lines() { said_.clear(); }

 private:
  /// A frame has neither CR nor LF; another reader may have taken its begin or its end.
  void take(char c) {
    constexpr char begin = 0x02, end = 0x03;
    if (c == begin) note("a frame after " + line_);
    if (c == end && !in_frame_) line_.clear();
    in_frame_ = c == begin || (in_frame_ && c != end && c != '\r' && c != '\n');
    if (c == end || in_frame_) return;
    if (after_cr_ != (c == '\n')) note("CR and LF are not together after " + line_);
    after_cr_ = c == '\r';
    if (c == '\n')
      end_line();
    else if (c != '\r')
      line_ += c;
  }
  void end_line() {
    if (line_ == "ok" || line_.starts_with("error:")) {
      answers_.push_back(line_);
      answer_times_.push_back(board_.now());
      if (!under_way_.empty()) {
        bytes_under_way_ -= under_way_.front();
        under_way_.pop_front();
      }
    }
    if (line_.starts_with("<")) {
      ++reports_;
      last_report_ = line_;
    }
    if (!line_.empty()) said_.push_back(std::exchange(line_, {}));
  }
  void note(const std::string& text) {
    if (fault_.empty()) fault_ = text;
  }

  sim::Board& board_;
  std::size_t window_;
  std::string program_;
  std::size_t next_ = 0;  ///< first byte of the program not sent
  std::deque<std::size_t> under_way_;
  std::size_t bytes_under_way_ = 0;
  bool in_frame_ = false, after_cr_ = false;
  std::string line_, last_report_, fault_;
  std::size_t reports_ = 0;
  std::vector<std::string> said_, answers_;
  std::vector<sim::Picoseconds> answer_times_;
};

}  // namespace lamplock::test
