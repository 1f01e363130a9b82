#include "host/pendant/board_dialog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/link/dialog.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;

/// Intervals of status requests. grbl recommends at most 10 a second; during manual motion a stop
/// must be detected sooner.
constexpr Time idle_interval = 100ms, hurried_interval = 20ms;
/// No increment is sent after this silence: a silent board may not receive a cancel either.
constexpr Time silence = 250ms;
constexpr Time max_silence = 5s;

}  // namespace

std::vector<double> MachineNow::place(bool of_work) const {
  std::vector<double> place = status.position;
  if (status.of_work == of_work || work_offset.size() != place.size()) return place;
  for (std::size_t a = 0; a < place.size(); ++a)
    place[a] += of_work ? -work_offset[a] : work_offset[a];
  return place;
}

void BoardDialog::send(std::string_view line, LineKind kind) {
  port_.send_line(line);
  sent_.push_back({kind, std::string(line), 0});
}

std::vector<Answered> BoardDialog::drop_lines() {
  const auto count = static_cast<std::ptrdiff_t>(port_.drop_unbegun_lines());
  std::vector<Answered> dropped(sent_.end() - count, sent_.end());
  sent_.erase(sent_.end() - count, sent_.end());
  return dropped;
}

void BoardDialog::forget_lines() {
  port_.drop_lines();
  sent_.clear();
}

std::vector<Answered> BoardDialog::poll(bool hurry) {
  std::vector<Answered> answers;
  while (const auto line = port_.receive()) {
    heard_at_ = now();
    take(*line, answers);
  }
  link::expect_connected(port_);
  if (now() - heard_at_ >= max_silence)
    throw Error(
        Exit::no_device, "machine", "no longer answers",
        "press its emergency stop if it moves or its laser is on; then check power and cable");
  if (now() - asked_at_ >= (hurry ? hurried_interval : idle_interval)) {
    asked_at_ = now();
    send_byte(link::realtime::status);
  }
  port_.flush();
  return answers;
}

void BoardDialog::take(const std::string& line, std::vector<Answered>& answers) {
  if (const auto status = link::parse_status(line)) return take_status(*status);
  if (const auto error = link::parse_answer(line)) {
    // An answer without a line: to an earlier program.
    if (sent_.empty()) return;
    answers.push_back(std::move(sent_.front()));
    answers.back().error = *error;
    sent_.pop_front();
    return;
  }
  if (on_line_) on_line_(line);
  if (link::is_banner(line)) {
    forget_lines();
    ++restarts_;
  }
  if (const auto alarm = link::parse_alarm(line))
    messages_.push_back(link::alarm_text(*alarm));
  else if (line.starts_with('['))
    messages_.push_back(line);
}

void BoardDialog::take_status(const link::BoardStatus& status) {
  machine_.status = status;
  ++machine_.reports;
  if (!status.work_offset.empty()) machine_.work_offset = status.work_offset;
  if (!status.overrides.empty()) machine_.overrides = status.overrides;
}

std::vector<std::string> BoardDialog::take_messages() { return std::exchange(messages_, {}); }

bool BoardDialog::answers() const { return now() - heard_at_ < silence; }

std::size_t BoardDialog::unanswered(LineKind kind) const {
  return static_cast<std::size_t>(std::count_if(
      sent_.begin(), sent_.end(), [kind](const Answered& line) { return line.kind == kind; }));
}

bool BoardDialog::homing_unanswered() const {
  return std::any_of(sent_.begin(), sent_.end(), [](const Answered& line) {
    return line.line.starts_with("$H") || line.line.starts_with("$h");
  });
}

}  // namespace lamplock::pendant
