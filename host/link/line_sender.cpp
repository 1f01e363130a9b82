#include "host/link/line_sender.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/link/not_ready.hpp"

namespace lamplock::link {
namespace {

using Time = std::chrono::microseconds;

constexpr Time max_line_wait{20'000};
constexpr Time min_wait{1'000};
/// Idle reports in a row at the end: one may come between an ok and the motion of its line.
constexpr int idle_reports_at_end = 2;
/// Reports in a row without a line in progress: the motion of a planned line may begin after one.
constexpr int still_reports_of_dwell = 2;
constexpr double us_per_s = 1e6;
/// Limit for P words that are not dwell times, which could make the sender wait for days.
constexpr double max_dwell_us = 3'600 * us_per_s;

/// Bytes of a line in the board's buffer, with its end.
std::size_t size_of(const std::string& text) { return text.size() + 1; }

/// The line changes the board's memory or state: no other line is sent until it is answered.
bool goes_alone(const std::string& text) { return text.starts_with('$'); }

/// The first line ends an alarm: homing or unlocking.
bool unlocks(const std::vector<ProgramLine>& lines) {
  if (lines.empty()) return false;
  const std::string& first = lines.front().text;
  return first.starts_with("$H") || first.starts_with("$h") || first == "$X" || first == "$x";
}

}  // namespace

LineSender::LineSender(LinePort& port, std::vector<ProgramLine> lines, LineOptions options)
    : port_(port), lines_(std::move(lines)), options_(std::move(options)) {}

bool LineSender::step() {
  if (phase_ == Phase::ended) return false;
  if (phase_ == Phase::greeting) {
    begin();
    return true;
  }
  receive();
  if (phase_ != Phase::ended) check_connection();
  if (phase_ == Phase::streaming) send_early_hold();
  if (phase_ == Phase::streaming) fill_window();
  if (phase_ == Phase::streaming) run_host_line();
  if (phase_ == Phase::streaming) check_end();
  if (phase_ == Phase::streaming) check_answers();
  if (phase_ == Phase::alarmed) await_rest_in_alarm();
  if (phase_ == Phase::stopping) insist_on_stop();
  if (phase_ == Phase::ended) {
    if (stop_error_) std::rethrow_exception(stop_error_);
    return false;
  }
  poll();
  port_.flush();
  port_.transport().wait(port_.backlog() > 0 ? min_wait : max_line_wait);
  return true;
}

void LineSender::begin() {
  greeting_ = greet(port_, options_.greeting);
  status_ = greeting_.status;
  unlocks_ = status_.is("Alarm") && unlocks(lines_);
  if (!status_.rests() && !unlocks_) {
    const NotReady reason = why_not_ready(status_, port_.transport().board(), ask_homing(port_));
    throw Error(Exit::job_failed, "machine", reason.what, reason.remedy);
  }
  if (greeting_.identity.version.find("lamplock") != std::string::npos) number_lines();
  check_lengths();
  const auto locked = std::ranges::find_if(
      lines_, [](const ProgramLine& line) { return may_lock_to_beat(line.text); });
  first_locked_ = static_cast<std::size_t>(locked - lines_.begin());
  const Time now = port_.transport().now();
  started_at_ = heard_at_ = now;
  asked_at_ = now - options_.status_interval;
  phase_ = Phase::streaming;
}

/// Numbers of the file, unless lines are repeated: the board could not say which run it executes.
void LineSender::number_lines() {
  is_numbered_ = true;
  has_index_numbers_ = std::ranges::adjacent_find(lines_, std::ranges::greater_equal{},
                                                  &ProgramLine::number) != lines_.end();
  if (!has_index_numbers_) {
    lines_ = with_numbers(std::move(lines_));
    return;
  }
  std::vector<std::size_t> numbers;
  numbers.reserve(lines_.size());
  for (ProgramLine& line : lines_) {
    numbers.push_back(line.number);
    line.number = numbers.size();
  }
  lines_ = with_numbers(std::move(lines_));
  for (std::size_t i = 0; i < lines_.size(); ++i) lines_[i].number = numbers[i];
}

void LineSender::check_lengths() const {
  for (const ProgramLine& line : lines_)
    if (size_of(line.text) > greeting_.window_bytes)
      throw Error(Exit::bad_input, fmt::format("line {}", line.number),
                  fmt::format("has {} characters, the board's buffer {}", size_of(line.text),
                              greeting_.window_bytes),
                  "shorten the line");
}

void LineSender::receive() {
  while (phase_ != Phase::ended) {
    const auto line = port_.receive();
    if (!line) return;
    heard_at_ = port_.transport().now();
    take(*line);
  }
}

void LineSender::take(const std::string& line) {
  if (auto status = parse_status(line)) return take_status(std::move(*status));
  if (const auto answer = parse_answer(line)) return take_answer(*answer);
  if (const auto alarm = parse_alarm(line)) return take_alarm(*alarm);
  if (is_banner(line)) return take_banner();
  if (options_.on_text) options_.on_text(line);
}

void LineSender::take_status(BoardStatus status) {
  if (status.work_offset.empty()) status.work_offset = std::move(status_.work_offset);
  status_ = std::move(status);
  status_of_ = asked_;
  status_open_ = false;
  // With the numbers of this program: lines before the first answer are those of another one.
  const std::size_t at = index_of(status_.line);
  if (at < lines_.size() && answered_ != 0) {
    at_ = at;
    at_line_ = lines_[at].number;
    done_ = std::max(done_, std::min(at_, answered_));
  }
  idle_reports_ = fresh() && status_.rests() ? idle_reports_ + 1 : 0;
  if (idle_reports_ >= idle_reports_at_end) done_ = answered_;
  note_done_at_rest();
  // A program that begins with $H or $X ends the alarm by its first line.
  const bool ends_alarm = unlocks_ && answered_ == 0;
  if (phase_ == Phase::alarmed) stop_by_ = port_.transport().now() + options_.status_timeout;
  if (status_.is("Alarm") && phase_ == Phase::streaming && !ends_alarm) end(LineEnd::alarm);
}

/// Every line that was answered has ended, if the machine is at rest: a hold keeps the rest of its
/// line in the planner. Points on the beat are in another queue.
bool LineSender::has_empty_planner() const {
  const std::size_t lines = greeting_.identity.planner_lines;
  return lines != 0 && status_.free_lines == lines && answered_ <= first_locked_;
}

/// A pause, a tool change or a dwell is answered at its end; the lines before it have ended when it
/// begins.
void LineSender::note_done_at_rest() {
  const bool waits = status_.is("Tool") || (status_.waits() && has_empty_planner());
  const bool dwells = status_.is("Run") && status_.line == 0 && status_.feed == 0 &&
                      answered_ < sent_ && runs_at_rest(lines_[answered_].text) &&
                      has_empty_planner();
  still_reports_ = fresh() && dwells ? still_reports_ + 1 : 0;
  if ((fresh() && waits) || still_reports_ >= still_reports_of_dwell) done_ = answered_;
}

void LineSender::take_answer(int error) {
  if (std::exchange(users_line_open_, false)) {
    asked_held_ = asked_;
    if (error != 0 && options_.on_text) options_.on_text(error_text(error));
    return;
  }
  if (answered_ == sent_) return;  // an answer to another program
  bytes_under_way_ -= size_of(lines_[answered_].text);
  ++answered_;
  asked_before_ = asked_;
  idle_reports_ = still_reports_ = 0;
  idle_short_ = false;
  if (error != 0) return take_error(error);
  accepted_ = answered_;
  if (runs_at_rest(lines_[answered_ - 1].text)) done_ = answered_;
}

/// Of the line with an N word that the board reports. The number of lines if it is none of this
/// program, or if the N words are those of the file.
std::size_t LineSender::index_of(std::size_t number) const {
  if (!is_numbered_ || number == 0) return lines_.size();
  if (has_index_numbers_) return number - 1;
  const auto at = std::ranges::lower_bound(lines_, number, {}, &ProgramLine::number);
  return static_cast<std::size_t>(at - lines_.begin());
}

/// Errors between the first one and the stop are its consequences and not reported.
void LineSender::take_error(int error) {
  if (phase_ != Phase::streaming) return;
  errors_.push_back({lines_[answered_ - 1].number, error, answered_ - 1});
  if (!options_.ignore_errors) begin_stop(LineEnd::error);
}

void LineSender::take_alarm(int number) {
  alarm_ = number;
  if (phase_ == Phase::alarmed) return;
  phase_ = Phase::alarmed;
  port_.drop_lines();
  stop_host_line();
  const Time now = port_.transport().now();
  asked_before_ = asked_;
  stop_by_ = now + options_.status_timeout;
  asked_at_ = now - options_.status_timeout;  // ask at once
}

void LineSender::take_banner() {
  if (phase_ == Phase::alarmed) return end(LineEnd::alarm);
  if (phase_ == Phase::stopping && reset_) return finish_stop();
  end(LineEnd::restarted);
}

void LineSender::poll() {
  const Time since = port_.transport().now() - asked_at_;
  if (since < (status_open_ ? options_.status_timeout : options_.status_interval)) return;
  port_.send_realtime(realtime::status);
  asked_at_ = port_.transport().now();
  ++asked_;
  status_open_ = true;
}

bool LineSender::fits(const std::string& text) const {
  const bool alone = sent_ == answered_;
  if (goes_alone(text) && !alone) return false;
  if (!alone && goes_alone(lines_[sent_ - 1].text)) return false;
  return bytes_under_way_ + size_of(text) <= greeting_.window_bytes;
}

void LineSender::fill_window() {
  while (sent_ < lines_.size() && !is_host_line(sent_) && fits(lines_[sent_].text)) {
    const std::string& text = lines_[sent_].text;
    port_.send_line(text);
    bytes_under_way_ += size_of(text);
    ++sent_;
  }
}

bool LineSender::is_host_line(std::size_t index) const {
  return options_.host_lines != nullptr && options_.host_lines->has(index);
}

/// Begins a line of the host after everything before it has been executed, as at the end of a
/// program.
void LineSender::run_host_line() {
  if (sent_ == lines_.size() || !is_host_line(sent_)) return;
  if (!host_line_runs_) {
    if (answered_ != sent_ || idle_reports_ < idle_reports_at_end) return;
    host_line_runs_ = true;
    at_ = sent_;
    at_line_ = lines_[at_].number;
    host_since_ = port_.transport().now();
    return;  // the caller sees what is done before the line begins
  }
  try {
    if (!options_.host_lines->run(sent_)) return;
  } catch (...) {
    return begin_stop(LineEnd::stopped, std::current_exception());
  }
  host_time_ = host_time();
  host_line_runs_ = false;
  ++sent_;
  done_ = ++answered_;
  asked_before_ = asked_;
  idle_reports_ = 0;
}

LineSender::Time LineSender::host_time() const {
  return host_time_ + (host_line_runs_ ? port_.transport().now() - host_since_ : Time{0});
}

void LineSender::stop_host_line() {
  if (!host_line_runs_) return;
  host_time_ = host_time();
  host_line_runs_ = false;
  options_.host_lines->stop();
}

void LineSender::check_connection() {
  const Time silence = port_.transport().now() - heard_at_;
  if (port_.transport().connected() && silence < options_.silence_limit) return;
  end(LineEnd::lost);
}

void LineSender::check_end() {
  if (answered_ == lines_.size() && idle_reports_ >= idle_reports_at_end) end(LineEnd::done);
}

/// An idle board with missing answers has lost them, or never received the lines.
void LineSender::check_answers() {
  const bool idle_short = status_.rests() && answered_ < sent_;
  const Time now = port_.transport().now();
  if (idle_short && !idle_short_) idle_since_ = now;
  idle_short_ = idle_short;
  if (idle_short && now - idle_since_ > answers_due()) begin_stop(LineEnd::unanswered);
}

LineSender::Time LineSender::answers_due() const {
  double dwell_us = 0;
  for (std::size_t i = answered_; i < sent_; ++i)
    dwell_us += max_dwell_s(lines_[i].text) * us_per_s;
  return options_.answer_timeout + Time(static_cast<Time::rep>(std::min(dwell_us, max_dwell_us)));
}

void LineSender::hold() {
  is_held_early_ = phase_ == Phase::greeting;
  if (phase_ == Phase::streaming || phase_ == Phase::alarmed) port_.send_realtime(realtime::hold);
}

/// A hold that came before the first line: the board receives it before any line. A locked machine
/// ignores a hold, so it follows the line that ends the alarm.
void LineSender::send_early_hold() {
  if (!is_held_early_ || (unlocks_ && answered_ == 0)) return;
  hold();
}

void LineSender::resume() {
  is_held_early_ = false;
  if (phase_ != Phase::streaming) return;
  port_.send_realtime(realtime::resume);
  asked_held_ = asked_before_ = asked_;
  idle_reports_ = 0;
}

void LineSender::stop() {
  if (phase_ == Phase::greeting) return end(LineEnd::stopped);
  if (phase_ == Phase::streaming || phase_ == Phase::alarmed) begin_stop(LineEnd::stopped);
}

void LineSender::break_off() {
  stop();
  if (phase_ != Phase::stopping) return;
  // As at rest: from here on the reset is repeated.
  held_ = reset_ = true;
  port_.send_realtime(realtime::reset);
}

bool LineSender::send_users_line(std::string_view text) {
  if (phase_ != Phase::streaming || !status_.is("Tool") || users_line_open_) return false;
  // Bytes that are sent before a real-time byte stay before it.
  if (port_.inside_line() || port_.backlog() != 0) return false;
  port_.send_realtime(realtime::tool_change);
  port_.flush();
  port_.send_line(text);
  users_line_open_ = true;
  asked_held_ = asked_;
  return true;
}

void LineSender::fail(std::exception_ptr error) {
  if (phase_ == Phase::streaming || phase_ == Phase::alarmed)
    return begin_stop(LineEnd::stopped, std::move(error));
  if (phase_ != Phase::stopping) std::rethrow_exception(error);
  if (!stop_error_) stop_error_ = std::move(error);
}

bool LineSender::waits() const {
  return phase_ == Phase::streaming && status_.waits() && status_of_ > asked_held_;
}

std::size_t LineSender::next_line() const {
  return answered_ < lines_.size() ? lines_[answered_].number : 0;
}

/// Some boards answer the line of a pause before the pause, some after it.
bool LineSender::at_pause() const {
  const bool next = answered_ < sent_ && is_pause(lines_[answered_].text);
  return next || (answered_ > 0 && is_pause(lines_[answered_ - 1].text));
}

Time LineSender::elapsed() const {
  if (phase_ == Phase::greeting) return Time{0};
  return phase_ == Phase::ended ? elapsed_ : port_.transport().now() - started_at_;
}

std::size_t LineSender::executed() const {
  if (at_line_ == 0 || (answered_ == lines_.size() && status_.rests())) return answered_;
  return std::min(answered_, at_);
}

LineResult LineSender::result() const {
  LineResult result;
  result.end = end_;
  result.sent = sent_;
  result.answered = answered_;
  result.executed = executed();
  result.last_line = accepted_ == 0 ? 0 : lines_[accepted_ - 1].number;
  result.at_line = at_line_;
  result.errors = errors_;
  result.alarm = alarm_;
  result.status = status_;
  result.elapsed = elapsed();
  return result;
}

}  // namespace lamplock::link
