#include "host/cli/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace lamplock::cli {
namespace {

constexpr int stops_at_once = 2;
std::atomic<int> interrupts{0};
static_assert(std::atomic<int>::is_always_lock_free);
using Handler = void (*)(int);
Handler old_interrupt = SIG_DFL, old_terminate = SIG_DFL;

void count_signal(int signal) { interrupts.fetch_add(signal == SIGTERM ? stops_at_once : 1); }

}  // namespace

Interrupt::Interrupt() {
  interrupts = 0;
  old_interrupt = std::signal(SIGINT, count_signal);
  old_terminate = std::signal(SIGTERM, count_signal);
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, old_interrupt);
  std::signal(SIGTERM, old_terminate);
}

int Interrupt::count() const { return interrupts; }

void Interrupt::forget() { interrupts = 0; }

}  // namespace lamplock::cli
