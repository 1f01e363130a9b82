#include "host/cli/line_steering.hpp"

#include "host/link/line_sender.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lamplock::cli {
namespace {

constexpr std::chrono::milliseconds line_poll_interval{50};
/// Until a board that does not show it is told again that a door is open.
constexpr std::chrono::milliseconds door_interval{500};

/// Why the machine waits, as its user understands it.
std::string why_it_waits(const link::LineSender& sender) {
  const std::size_t next = sender.next_line();
  const std::string where =
      next == 0 ? "behind the last line" : fmt::format("before line {}", next);
  if (sender.status().is("Door"))
    return sender.status().substate > 0 ? "door open: close it" : "the door was open";
  return sender.at_pause() ? "the program pauses (M0), " + where : "held, " + where;
}

}  // namespace

void LineSteering::look() {
  tell_left();
  progress_.update(sender_.answered());
  if (stopping_) return;
  if (interrupt_.count() > 0) {
    stopping_ = true;
    progress_.note("stopping");
    return sender_.stop();
  }
  look_at_board();
  if (asking_ && clocking_ == Clocking::lock_step) return wait_for_user();
  if (Clock::now() - looked_at_ < line_poll_interval) return;
  looked_at_ = Clock::now();
  if (asking_ || Keyboard::at_terminal()) take_input(std::chrono::milliseconds(0));
}

/// The plan is in the machine's time; a simulated one's is not ours.
void LineSteering::tell_left() {
  if (!planned_s_ || clocking_ == Clocking::lock_step) return;
  auto run = sender_.elapsed() - waited_;
  if (asking_) run -= sender_.elapsed() - waiting_since_;
  progress_.set_left(std::max(0.0, *planned_s_ - std::chrono::duration<double>(run).count()));
}

void LineSteering::look_at_board() {
  const bool waits = sender_.waits();
  if (waits == asking_) return;
  asking_ = waits;
  if (waits) {
    waiting_since_ = sender_.elapsed();
    progress_.note(why_it_waits(sender_) + "; Enter goes on, Ctrl-C stops");
  } else {  // somebody has pressed a button at the machine
    waited_ += sender_.elapsed() - waiting_since_;
    blocked_ = !obstacle_.empty();
  }
}

void LineSteering::block(const std::string& why) {
  if (stopping_) return;
  const bool is_new = obstacle_ != why;
  const bool again = !sender_.waits() && sender_.elapsed() - blocked_at_ >= door_interval;
  obstacle_ = why;
  blocked_ = true;
  if (!is_new && !again) return;
  blocked_at_ = sender_.elapsed();
  sender_.realtime(link::realtime::door);
  if (is_new) progress_.note(why + ": holding, laser off");
}

void LineSteering::end(const std::string& why) {
  if (broken_off_) return;
  broken_off_ = stopping_ = true;
  sender_.break_off();
  progress_.note(why + ": stopping");
}

/// Simulated time stands still until the user has decided.
void LineSteering::wait_for_user() {
  while (asking_ && interrupt_.count() == 0) {
    take_input(line_poll_interval);
    if (!asking_ || !keyboard_.ended()) continue;
    progress_.note("nobody is there to say so: it goes on");
    go_on();
  }
}

void LineSteering::take_input(std::chrono::milliseconds wait) {
  for (const std::string& line : keyboard_.lines(wait)) take_line(line);
}

void LineSteering::take_line(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  const std::string word = first == std::string::npos ? "" : line.substr(first, 1);
  if (word.empty() || word == "~") {
    if (asking_) go_on();
  } else if (word == "!") {
    sender_.hold();
    progress_.note("holding");
  } else if (word == "+") {
    feed(link::realtime::feed_plus_10, "feed + 10 %");
  } else if (word == "-") {
    feed(link::realtime::feed_minus_10, "feed - 10 %");
  } else if (word == "=") {
    feed(link::realtime::feed_full, "feed 100 %");
  } else {
    progress_.note(
        "! and Enter holds, Enter alone goes on, + - or = and Enter changes the feed; Ctrl-C "
        "stops");
  }
}

void LineSteering::feed(std::uint8_t byte, const std::string& what) {
  sender_.realtime(byte);
  progress_.note(what);
  planned_s_.reset();  // it was made for the feed of the program
  progress_.set_left(std::nullopt);
}

void LineSteering::go_on() {
  if (!obstacle_.empty()) return progress_.note(obstacle_ + ": not resumed");
  blocked_ = false;
  asking_ = false;
  waited_ += sender_.elapsed() - waiting_since_;
  progress_.note("resuming");
  sender_.resume();
}

}  // namespace lamplock::cli
