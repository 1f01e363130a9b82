#include "host/run/program_control.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/link/line_sender.hpp"

namespace lamplock::run {
namespace {

/// Until the door byte is sent again to a board that does not show the door state.
constexpr std::chrono::milliseconds door_interval{500};

/// So many interrupts at once are a stop that is no pause (frontend.hpp).
constexpr int urgent_interrupts = 2;

/// Feed overrides of grbl, percent.
constexpr int feed_step = 10, min_feed_percent = 10, max_feed_percent = 200;

/// Why the machine waits, in words of its user.
std::string why_it_waits(const link::LineSender& sender) {
  const std::size_t next = sender.next_line();
  const std::string where = next == 0 ? "after the last line" : fmt::format("before line {}", next);
  if (sender.status().is("Door"))
    return sender.status().substate > 0 ? "door open: close it" : "the door was open";
  if (sender.status().is("Tool"))
    return "tool change, " + where + ": jog ($J=...), probe and touch off by typing lines";
  return sender.at_pause() ? "the program pauses (M0), " + where : "held, " + where;
}

}  // namespace

/// Time of the program without the lines of the host.
std::chrono::microseconds ProgramControl::machine_time() const {
  return sender_.elapsed() - sender_.host_time();
}

/// Time of the machine without waits [s].
double ProgramControl::run_s() const {
  auto run = machine_time() - waited_;
  if (asking_) run -= machine_time() - waiting_since_;
  return std::chrono::duration<double>(run).count();
}

/// The plan counts the machine's time; that of a simulated machine is not ours.
void ProgramControl::update_progress() {
  const std::vector<int>& reported = sender_.status().overrides;
  if (reported.size() > 1 && reported[0] > 0 && reported[1] > 0) {
    feed_percent_ = reported[0];
    rapid_percent_ = reported[1];
  }
  if (clocking_ == Clocking::wall)
    progress_.set_left(time_.left_s(run_s(), feed_percent_, rapid_percent_));
  progress_.update(sender_.executed());
}

std::string ProgramControl::keys() const {
  return "keys: ! holds, Enter resumes, + - = and Enter feed, Ctrl-C stops";
}

ProgressState ProgramControl::state() const {
  ProgressState shown;
  if (stopping_)
    shown.word = "stopping";
  else if (sender_.status().is("Door"))
    shown.word = "door open";
  else if (sender_.status().is("Tool"))
    shown.word = tool_change_word;
  else if (sender_.runs_host_line())
    shown.word = "user command";
  else if (asking_ || sender_.status().is("Hold"))
    shown.word = sender_.at_pause() ? pause_word : held_word;
  if (!sender_.status().of_work) shown.place = sender_.status().position;
  if (feed_percent_ != full_percent) shown.speed = fmt::format("feed {} %", feed_percent_);
  return shown;
}

void ProgramControl::take_interrupts(int count) {
  if (count < interrupts_to_stop()) return;
  stopping_ = true;
  note("stopping");
  // A stop that is no pause: the laser is off before the machine brakes, and the position is kept.
  if (count >= urgent_interrupts) sender_.realtime(link::realtime::door);
  sender_.stop();
}

void ProgramControl::watch_machine() {
  send_users_lines();
  const bool waits = sender_.waits();
  if (waits == asking_) return;
  asking_ = waits;
  if (waits) {
    waiting_since_ = machine_time();
    ask_user(why_it_waits(sender_), "Enter resumes, Ctrl-C stops");
  } else {  // a button at the machine has resumed
    waited_ += machine_time() - waiting_since_;
    blocked_ = holding_ = !obstacle_.empty();
  }
}

void ProgramControl::hold_for_obstacle(bool is_new) {
  const bool is_due = !sender_.waits() && sender_.elapsed() - door_sent_at_ >= door_interval;
  blocked_ = true;
  if (!is_new && !is_due) return;
  door_sent_at_ = sender_.elapsed();
  sender_.realtime(link::realtime::door);
}

void ProgramControl::end_machine(bool is_ended) {
  if (!is_ended) sender_.break_off();
}

/// Only the pauses of the program itself are continued: a machine that holds for a fault would hold
/// again, or continue with the fault.
void ProgramControl::take_end_of_input() {
  if (sender_.at_pause() || sender_.status().is("Tool")) {
    note("no terminal input: continuing");
    return resume();
  }
  note("no terminal input to resume the program");
  stopping_ = lacks_user_ = true;
  note("stopping");
  sender_.stop();
}

/// The next line of the user in a tool change, if the board has answered the one before.
void ProgramControl::send_users_lines() {
  if (users_lines_.empty()) return;
  if (stopping_ || !sender_.status().is("Tool")) {
    for (const std::string& line : users_lines_)
      note(fmt::format("not sent: {} (the tool change has ended)", line));
    return users_lines_.clear();
  }
  if (!sender_.send_users_line(users_lines_.front())) return;
  users_lines_.pop_front();
  if (asking_) waited_ += machine_time() - waiting_since_;
  asking_ = false;
}

void ProgramControl::take_word(const std::string& word) {
  const std::string_view keys = "!+-=";
  if (sender_.status().is("Tool") && keys.find(word.front()) == std::string_view::npos) {
    users_lines_.push_back(word);
    return send_users_lines();
  }
  switch (word.front()) {
    case '!':
      is_holding_ = true;
      sender_.hold();
      return note(asking_ ? "held; Enter resumes" : "holding");
    case '+':
      return feed(link::realtime::feed_plus_10, feed_percent_ + feed_step);
    case '-':
      return feed(link::realtime::feed_minus_10, feed_percent_ - feed_step);
    case '=':
      return feed(link::realtime::feed_full, full_percent);
    default:
      note("! holds, Enter alone resumes, + - or = and Enter changes the feed; Ctrl-C stops");
  }
}

/// A board that reports its overrides corrects the value with its next report.
void ProgramControl::feed(std::uint8_t byte, int percent) {
  sender_.realtime(byte);
  feed_percent_ = std::clamp(percent, min_feed_percent, max_feed_percent);
  note(fmt::format("feed {} %", feed_percent_));
}

void ProgramControl::resume_machine() {
  if (asking_) waited_ += machine_time() - waiting_since_;
  blocked_ = asking_ = is_holding_ = false;
  sender_.resume();
}

}  // namespace lamplock::run
