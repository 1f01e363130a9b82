// A host at the cable of a virtual board that checks every byte: the kinds of lines, their order,
// and whether a grbl sender would understand each.
//
// In:  bytes for the board, time. Out: the board's lines, by kind. Anything that is not a line of
//      the protocol or does not end in CR LF is stored as a fault.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "tests/board/rig.hpp"

namespace lamplock::test {

enum class Said { answer, report, banner, alarm, message, start_up, setting, blank, nonsense };

struct SaidLine {
  Said kind;
  std::string text;
};

/// Kind of a line from the board, by grbl's documentation.
inline Said kind_of(const std::string& line) {
  static const std::regex answer("ok|error:[0-9]+"), alarm("ALARM:[0-9]+"),
      report("<[a-zA-Z:0-9]+[|]+.*>"), setting("\\$(N[01]|[0-9]+)=.*"),
      start_up(">.*:(ok|error:[0-9]+)"),
      message("\\[(MSG|GC|HLP|VER|OPT|G5[4-9]|G59\\.[123]|G28|G30|G92|TLO|PRB):?.*\\]");
  if (line.empty()) return Said::blank;
  if (line == "Grbl 1.1h ['$' for help]") return Said::banner;
  if (std::regex_match(line, answer)) return Said::answer;
  if (std::regex_match(line, report)) return Said::report;
  if (std::regex_match(line, alarm)) return Said::alarm;
  if (std::regex_match(line, start_up)) return Said::start_up;
  if (std::regex_match(line, setting)) return Said::setting;
  if (std::regex_match(line, message)) return Said::message;
  return Said::nonsense;
}

/// Number of steps of `step_ms` in `seconds`.
inline int rounds(double seconds, double step_ms) {
  return static_cast<int>(std::ceil(seconds * 1000 / step_ms));
}

class WireHost {
 public:
  explicit WireHost(Rig& rig) : rig_(rig) {}

  void send(std::string_view text) {
    while (!text.empty()) {
      text.remove_prefix(send_some(text));
      if (!text.empty()) run_ms(1);
    }
  }
  /// Sends as many bytes as the cable accepts now; returns their number.
  std::size_t send_some(std::string_view text) {
    return rig_.board.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void send_byte(unsigned byte) {
    const char c = static_cast<char>(byte);
    send(std::string_view(&c, 1));
  }
  void run_ms(double ms) {
    rig_.run(static_cast<sim::Picoseconds>(ms * 1e9));
    listen();
  }
  /// True if this number of answers arrives in time.
  bool wait_for(std::size_t answers, double seconds = 1) {
    const auto limit = rounds(seconds, 0.5);
    for (int i = 0; i < limit && answers_.size() < answers; ++i) run_ms(0.5);
    return answers_.size() >= answers;
  }
  /// Sends lines and waits until each is answered; returns the lines received meanwhile.
  std::vector<std::string> ask(std::string_view text, double seconds = 1) {
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    const std::size_t heard = said_.size(), before = answers_.size();
    send(text);
    wait_for(before + lines, seconds);
    return texts_from(heard);
  }
  std::vector<std::string> texts_from(std::size_t heard) const {
    std::vector<std::string> texts;
    for (std::size_t i = heard; i < said_.size(); ++i)
      if (said_[i].kind != Said::blank) texts.push_back(said_[i].text);
    return texts;
  }
  std::string status() {
    const std::size_t before = reports_;
    send("?");
    for (int i = 0; i < 200 && reports_ == before; ++i) run_ms(0.5);
    return reports_ == before ? "" : last_report_;
  }
  bool wait_for_rest(double seconds = 100) {
    for (int i = 0; i < rounds(seconds, 0.5); ++i) {
      if (rig_.state() == MachineState::idle && rig_.board.controller().program().idle())
        return true;
      run_ms(0.5);
    }
    return false;
  }

  const std::vector<std::string>& answers() const { return answers_; }
  const std::vector<SaidLine>& said() const { return said_; }
  std::size_t reports() const { return reports_; }
  const std::string& last_report() const { return last_report_; }
  std::size_t count(Said kind) const {
    return static_cast<std::size_t>(std::count_if(
        said_.begin(), said_.end(), [kind](const SaidLine& line) { return line.kind == kind; }));
  }
  bool heard(std::string_view text) const {
    return std::any_of(said_.begin(), said_.end(),
                       [text](const SaidLine& line) { return line.text == text; });
  }
  /// The first violation of the protocol, or empty.
  const std::string& fault() const { return fault_; }

  StepPosition position() const {
    const stepper::MotionState at = rig_.board.controller().runner().generator().state();
    StepPosition steps{};
    for (std::size_t a = 0; a < steps.size(); ++a) steps[a] = at.axis[a].step();
    return steps;
  }

 private:
  void listen() {
    std::array<std::uint8_t, 4096> bytes{};
    while (const std::size_t n = rig_.board.read(bytes)) {
      for (std::size_t i = 0; i < n; ++i) take(static_cast<char>(bytes[i]));
    }
  }
  void take(char c) {
    if (after_cr_ && c != '\n') note("CR without LF after " + line_);
    if (c == '\n' && !after_cr_) note("LF without CR after " + line_);
    after_cr_ = c == '\r';
    if (c == '\r') return;
    if (c != '\n') {
      line_ += c;
      return;
    }
    const SaidLine line{kind_of(line_), line_};
    if (line.kind == Said::nonsense) note("no line of the protocol: " + line_);
    if (line.kind == Said::answer) answers_.push_back(line_);
    if (line.kind == Said::report) {
      ++reports_;
      last_report_ = line_;
    }
    said_.push_back(line);
    line_.clear();
  }
  void note(const std::string& text) {
    if (fault_.empty()) fault_ = text;
  }

  Rig& rig_;
  std::string line_, last_report_, fault_;
  bool after_cr_ = false;
  std::size_t reports_ = 0;
  std::vector<SaidLine> said_;
  std::vector<std::string> answers_;
};

/// How a sender streams.
struct Streaming {
  std::size_t window = 1024;  ///< bytes under way; 0 = one line at a time
  double poll_ms = 100;       ///< between two "?"
  std::string_view end = "\n";
};

/// Streams lines and polls the state meanwhile. False if it took longer than `seconds`. Calls
/// `look(bytes under way)` after each step.
template <class Look>
bool stream_polled(WireHost& host, const std::vector<std::string>& lines, const Streaming& how,
                   double seconds, Look look) {
  constexpr double step_ms = 0.5;
  std::deque<std::size_t> under_way;
  std::size_t next = 0, bytes = 0, answered = host.answers().size();
  double to_poll = 0;
  for (int i = 0; i < rounds(seconds, step_ms); ++i) {
    for (; answered < host.answers().size() && !under_way.empty(); ++answered) {
      bytes -= under_way.front();
      under_way.pop_front();
    }
    while (next < lines.size()) {
      const std::size_t size = lines[next].size() + how.end.size();
      if (how.window == 0 ? !under_way.empty() : bytes + size > how.window) break;
      host.send(lines[next++] + std::string(how.end));
      bytes += size;
      under_way.push_back(size);
    }
    look(bytes);
    if (next == lines.size() && under_way.empty()) return true;
    to_poll -= step_ms;
    if (to_poll <= 0) {
      host.send("?");
      to_poll += how.poll_ms;
    }
    host.run_ms(step_ms);
  }
  return false;
}

}  // namespace lamplock::test
