#include "host/cli/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace lamplock::cli {
namespace {

constexpr int stops_at_once = 2;
std::atomic<int> interrupts{0};
std::atomic<bool> terminate{false};
static_assert(std::atomic<int>::is_always_lock_free);
using Handler = void (*)(int);
Handler old_interrupt = SIG_DFL, old_terminate = SIG_DFL, old_hangup = SIG_DFL;

void count_signal(int signal) {
  if (signal == SIGTERM) terminate = true;
  interrupts.fetch_add(signal == SIGINT ? 1 : stops_at_once);
}

}  // namespace

Interrupt::Interrupt() {
  interrupts = 0;
  terminate = false;
  old_interrupt = std::signal(SIGINT, count_signal);
  old_terminate = std::signal(SIGTERM, count_signal);
  old_hangup = std::signal(SIGHUP, count_signal);
  if (old_hangup == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, old_interrupt);
  std::signal(SIGTERM, old_terminate);
  std::signal(SIGHUP, old_hangup);
}

int Interrupt::count() const { return interrupts; }

bool Interrupt::terminated() const { return terminate; }

void Interrupt::forget() { interrupts = 0; }

}  // namespace lamplock::cli
