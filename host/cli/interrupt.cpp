#include "host/cli/interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "host/cli/quiet_terminal.hpp"

namespace lamplock::cli {
namespace {

constexpr int stops_at_once = 2;
constexpr int signal_status = 128;  ///< + number of the signal, as shells report it
std::atomic<int> interrupts{0};
/// SIGTERM or SIGHUP, whichever came first; 0: none.
std::atomic<int> ending_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);
using Handler = void (*)(int);
Handler old_interrupt = SIG_DFL, old_terminate = SIG_DFL, old_hangup = SIG_DFL;

void note_ending(int signal) {
  int none = 0;
  if (signal != SIGINT) ending_signal.compare_exchange_strong(none, signal);
}

void count_signal(int signal) {
  note_ending(signal);
  interrupts.fetch_add(signal == SIGINT ? 1 : stops_at_once);
}

void leave(int signal) {
  QuietTerminal::leave();
  ::_exit(signal_status + signal);
}

/// Returns the handler before. An ignored SIGHUP stays ignored.
Handler handle(int signal, Handler handler) {
  const Handler before = std::signal(signal, handler);
  if (signal == SIGHUP && before == SIG_IGN) std::signal(signal, SIG_IGN);
  return before;
}

}  // namespace

void end_at_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, leave);
}

int status_of(Exit exit) {
  const int signal = ending_signal;
  return exit == Exit::interrupted && signal != 0 ? signal_status + signal : static_cast<int>(exit);
}

bool is_ended_by_signal() { return ending_signal != 0; }

Interrupt::Interrupt() {
  interrupts = 0;
  old_interrupt = handle(SIGINT, count_signal);
  old_terminate = handle(SIGTERM, count_signal);
  old_hangup = handle(SIGHUP, count_signal);
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, old_interrupt);
  std::signal(SIGTERM, old_terminate);
  std::signal(SIGHUP, old_hangup);
}

int Interrupt::count() const { return interrupts; }

bool Interrupt::terminated() const { return ending_signal == SIGTERM; }

void Interrupt::forget() { interrupts = 0; }

}  // namespace lamplock::cli
