#include "host/cli/steering.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

namespace lamplock::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds look_interval{50};

enum class Input { nothing, line, end };

/// Waits for something on stdin, but not for long.
Input read_stdin(std::chrono::milliseconds wait) {
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (::poll(&watched, 1, static_cast<int>(wait.count())) <= 0) return Input::nothing;
  std::array<char, 256> text{};
  const ssize_t count = ::read(STDIN_FILENO, text.data(), text.size());
  return count > 0 ? Input::line : Input::end;
}

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
  if (!asking_ && !holding_) return;
  if (asking_ && clocking_ == Clocking::lock_step) return wait_for_user();
  take_input(std::chrono::milliseconds(0));
}

void Steering::stop() {
  stopping_ = true;
  sender_.stop();
  progress_.note("stopping");
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

/// Enter goes on.
void Steering::take_input(std::chrono::milliseconds wait) {
  if (input_ended_) {
    std::this_thread::sleep_for(wait);
    return;
  }
  const Input input = read_stdin(wait);
  if (input == Input::line) go_on();
  if (input == Input::end) input_ended_ = true;
}

void Steering::go_on() {
  asking_ = holding_ = false;
  interrupt_.forget();
  if (asked_at_) progress_.pause_ended(Clock::now() - *asked_at_);
  asked_at_.reset();
  progress_.note("resuming");
  sender_.resume();
}

}  // namespace lamplock::cli
