#include "host/run/program_control.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/link/line_sender.hpp"

namespace lamplock::run {
namespace {

/// Until the door byte is sent again to a board that does not show the door state.
constexpr std::chrono::milliseconds door_interval{500};

/// Why the machine waits, in words of its user.
std::string why_it_waits(const link::LineSender& sender) {
  const std::size_t next = sender.next_line();
  const std::string where = next == 0 ? "after the last line" : fmt::format("before line {}", next);
  if (sender.status().is("Door"))
    return sender.status().substate > 0 ? "door open: close it" : "the door was open";
  return sender.at_pause() ? "the program pauses (M0), " + where : "held, " + where;
}

}  // namespace

/// The plan counts the machine's time; that of a simulated machine is not ours.
void ProgramControl::show_progress() {
  if (planned_s_ && clocking_ == Clocking::wall) {
    auto run = sender_.elapsed() - waited_;
    if (asking_) run -= sender_.elapsed() - waiting_since_;
    progress_.set_left(std::max(0.0, *planned_s_ - std::chrono::duration<double>(run).count()));
  }
  progress_.update(sender_.answered());
}

void ProgramControl::take_interrupts(int count) {
  if (count < interrupts_to_stop()) return;
  stopping_ = true;
  note("stopping");
  sender_.stop();
}

void ProgramControl::watch_machine() {
  const bool waits = sender_.waits();
  if (waits == asking_) return;
  asking_ = waits;
  if (waits) {
    waiting_since_ = sender_.elapsed();
    note(why_it_waits(sender_) + "; Enter resumes, Ctrl-C stops");
  } else {  // a button at the machine has resumed
    waited_ += sender_.elapsed() - waiting_since_;
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

void ProgramControl::take_end_of_input() {
  note("no terminal input: continuing");
  resume();
}

void ProgramControl::take_word(const std::string& word) {
  switch (word.front()) {
    case '!':
      sender_.hold();
      return note("holding");
    case '+':
      return feed(link::realtime::feed_plus_10, "feed + 10 %");
    case '-':
      return feed(link::realtime::feed_minus_10, "feed - 10 %");
    case '=':
      return feed(link::realtime::feed_full, "feed 100 %");
    default:
      note(
          "! and Enter holds, Enter alone resumes, + - or = and Enter changes the feed; Ctrl-C "
          "stops");
  }
}

void ProgramControl::feed(std::uint8_t byte, const std::string& what) {
  sender_.realtime(byte);
  note(what);
  planned_s_.reset();  // it holds for the feed of the program
  progress_.set_left(std::nullopt);
}

void ProgramControl::resume_machine() {
  if (asking_) waited_ += sender_.elapsed() - waiting_since_;
  blocked_ = asking_ = false;
  sender_.resume();
}

}  // namespace lamplock::run
