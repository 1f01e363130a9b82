#include "host/cli/steering.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "host/link/sender.hpp"
#include "host/text.hpp"

namespace lamplock::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds look_interval{50};

constexpr std::uint32_t job_speed_step = 10;

}  // namespace

void Steering::look() {
  progress_.update(sender_.points_fired());
  if (stopping_) return;
  const int interrupts = interrupt_.count();
  if (interrupts > 1) return stop();
  if (interrupts == 1 && !holding_) {
    holding_ = true;
    sender_.pause();
    progress_.note("holding");
  }
  const wire::MachineState state = sender_.status().state;
  if (state == wire::MachineState::door && !asking_)
    ask_to_go_on("door open, laser off: close it");
  else if (state == wire::MachineState::hold && holding_ && !asking_)
    ask_to_go_on("held, laser off");
  ask_about_hold();
  if (!asking_ && !holding_) {
    if (Clock::now() - looked_at_ < look_interval) return;
    looked_at_ = Clock::now();
    if (Keyboard::at_terminal()) take_input(std::chrono::milliseconds(0));
    return;
  }
  if (asking_ && clocking_ == Clocking::lock_step) return wait_for_user();
  take_input(std::chrono::milliseconds(0));
}

/// A hold that neither the user nor this program has asked for.
void Steering::ask_about_hold() {
  const wire::Status& status = sender_.status();
  const bool held = status.state == wire::MachineState::hold;
  const wire::HoldReason reason = held ? status.hold_reason : wire::HoldReason::none;
  const bool is_new = reason != asked_about_;
  asked_about_ = reason;
  // Somebody else may have ended it.
  if (asking_ && !holding_ && status.state == wire::MachineState::run) end_question();
  if (!is_new || asking_) return;
  if (reason == wire::HoldReason::not_made) ask_to_go_on("shot not made, held, laser off");
  if (reason == wire::HoldReason::lamp)
    ask_to_go_on("lamp does not answer its trigger, held, laser off");
  if (reason == wire::HoldReason::realtime && !sender_.auto_resume())
    ask_to_go_on("held by a hold ('!') that another program or a person sent, laser off");
}

void Steering::stop() {
  stopping_ = true;
  sender_.stop();
  progress_.note("stopping");
}

void Steering::block(const std::string& why) {
  if (stopping_) return;
  const bool is_new = obstacle_ != why;
  obstacle_ = why;
  holding_ = true;
  sender_.pause();
  if (is_new) progress_.note(why + ": holding, laser off");
}

void Steering::end(const std::string& why) {
  sender_.stop();
  if (stopping_) return;
  stopping_ = true;
  progress_.note(why + ": stopping");
}

void Steering::ask_to_go_on(const std::string& why) {
  asking_ = true;
  asked_at_ = Clock::now();
  // Where to go on is told after a stop: what the last status did not know yet may have been fired.
  progress_.note(why + "; Enter to resume, Ctrl-C again to stop");
}

/// Simulated time stands still until the user has decided.
void Steering::wait_for_user() {
  while (asking_ && interrupt_.count() < 2) take_input(look_interval);
}

void Steering::take_input(std::chrono::milliseconds wait) {
  for (const std::string& line : keyboard_.lines(wait)) take_line(line);
}

void Steering::take_line(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r"), last = line.find_last_not_of(" \t\r%");
  const bool blank = first == std::string::npos || last == std::string::npos;
  const std::string word = blank ? "" : line.substr(first, last + 1 - first);
  if (word.empty()) {
    if (asking_ || holding_) go_on();
    return;
  }
  const std::uint32_t present = sender_.job_speed();
  const auto percent = number_of<std::uint32_t>(word);
  if (word == "+")
    change_job_speed(present + job_speed_step);
  else if (word == "-")
    change_job_speed(present > job_speed_step ? present - job_speed_step : 1);
  else if (percent && *percent > 0)
    change_job_speed(*percent);
  else
    progress_.note("type a job speed in percent, + or -; a blank line goes on after a hold");
}

void Steering::change_job_speed(std::uint32_t percent) {
  percent = std::min(percent, link::highest_job_speed);
  sender_.set_job_speed(percent);
  progress_.note("job speed " + std::to_string(percent) + " %");
}

void Steering::end_question() {
  asking_ = false;
  if (asked_at_) progress_.pause_ended(Clock::now() - *asked_at_);
  asked_at_.reset();
}

void Steering::go_on() {
  if (!obstacle_.empty()) return progress_.note(obstacle_ + ": not resumed");
  holding_ = false;
  interrupt_.forget();
  end_question();
  progress_.note("resuming");
  sender_.resume();
}

}  // namespace lamplock::cli
