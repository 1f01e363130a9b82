#include "host/run/job_control.hpp"

namespace lamplock::run {
namespace {

constexpr std::chrono::milliseconds input_interval{50};
/// A simulated job that takes longer can be controlled by keys.
constexpr std::chrono::milliseconds long_simulation{1000};

}  // namespace

void JobControl::poll() {
  if (!keys_shown_) show_keys();
  show_progress();
  if (stopping_) return;
  take_interrupts(interrupts_->count());
  if (stopping_) return;
  watch_machine();
  if (asking_ && resumes_at_rest_ && !has_lines_to_send()) resume();
  if (asking_ && clocking_ == Clocking::lock_step) return wait_for_user();
  if (Clock::now() - polled_at_ < input_interval) return;
  polled_at_ = Clock::now();
  if (asking_ || holding_ || input_->is_typed()) take_input(std::chrono::milliseconds(0));
}

/// A simulated job is over before a user would press a key, unless it is long.
void JobControl::show_keys() {
  if (clocking_ == Clocking::lock_step && Clock::now() - begun_at_ < long_simulation) return;
  keys_shown_ = true;
  if (can_answer() && input_->needs_keys_shown()) note(keys());
}

void JobControl::show_progress() {
  ProgressState shown = state();
  shown.typed = input_->begun();
  progress_.set_state(shown);
  update_progress();
}

void JobControl::ask_user(const std::string& question, const std::string& keys) {
  if (can_answer()) return note(input_->needs_keys_shown() ? question + "; " + keys : question);
  input_->read_ahead();
  note(question + (input_->ended() ? "; without a terminal only the machine resumes, SIGINT stops"
                                   : "; a line of the input resumes, SIGINT stops"));
}

void JobControl::block(const std::string& why) {
  if (stopping_) return;
  const bool is_new = obstacle_ != why;
  obstacle_ = why;
  holding_ = true;
  hold_for_obstacle(is_new);
  if (is_new) note(why + ": holding, laser off");
}

void JobControl::end(const std::string& why) {
  end_machine(ended_);
  if (ended_) return;
  ended_ = stopping_ = true;
  note(why + ": stopping");
}

/// Simulated time does not pass until the user has answered.
void JobControl::wait_for_user() {
  while (asking_ && interrupts_->count() < interrupts_to_stop()) {
    show_progress();
    take_input(input_interval);
    if (asking_ && input_->ended()) return take_end_of_input();
  }
}

void JobControl::take_input(std::chrono::milliseconds wait) {
  for (const std::string& line : input_->lines(wait)) take_line(line);
}

void JobControl::take_line(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r"), last = line.find_last_not_of(" \t\r");
  const std::string word = first == std::string::npos ? "" : line.substr(first, last + 1 - first);
  if (!word.empty() && word.front() != '~') return take_word(word);
  if ((asking_ || holding_) && !has_lines_to_send())
    resume();
  else
    resumes_at_rest_ = awaits_hold() || has_lines_to_send();
}

void JobControl::resume() {
  resumes_at_rest_ = false;
  if (!obstacle_.empty()) return note(obstacle_ + ": not resumed");
  holding_ = false;
  note("resuming");
  resume_machine();
}

}  // namespace lamplock::run
