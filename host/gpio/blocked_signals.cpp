#include "host/gpio/blocked_signals.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>

namespace lamplock::gpio {
namespace {

/// Signals from outside that end or stop a program (signal(7)).
constexpr std::array held{SIGHUP,  SIGINT,  SIGQUIT, SIGTERM, SIGPIPE, SIGALRM,
                          SIGUSR1, SIGUSR2, SIGTSTP, SIGTTIN, SIGTTOU};

std::array<std::atomic<bool>, held.size()> came;
static_assert(std::atomic<bool>::is_always_lock_free);
std::array<struct sigaction, held.size()> before;

void note(int signal) {
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i] == signal) came[i] = true;
}

}  // namespace

LaterSignals::LaterSignals() {
  struct sigaction wait {};
  wait.sa_handler = note;
  wait.sa_flags = SA_RESTART;
  ::sigemptyset(&wait.sa_mask);
  for (std::size_t i = 0; i < held.size(); ++i) {
    came[i] = false;
    ::sigaction(held[i], nullptr, &before[i]);
    if (before[i].sa_handler != SIG_IGN) ::sigaction(held[i], &wait, nullptr);
  }
}

LaterSignals::~LaterSignals() {
  for (std::size_t i = 0; i < held.size(); ++i) ::sigaction(held[i], &before[i], nullptr);
  for (std::size_t i = 0; i < held.size(); ++i)
    if (came[i]) ::raise(held[i]);
}

}  // namespace lamplock::gpio
