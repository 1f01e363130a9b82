#include "host/cli/interrupt.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

#include "host/cli/quiet_terminal.hpp"
#include "host/cli/raw_terminal.hpp"
#include "host/file/unfinished_paths.hpp"

namespace lamplock::cli {
namespace {

constexpr int stops_at_once = 2;
constexpr int signal_status = 128;  ///< + number of the signal, as shells report it
std::atomic<int> interrupts{0};
/// SIGTERM or SIGHUP, whichever came first; 0: none.
std::atomic<int> ending_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);
/// Signals that end a program by default, with or without a memory image, and that have no meaning
/// for this one.
constexpr std::array other_signals{SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGABRT, SIGXCPU};
using Handler = void (*)(int);

void note_ending(int signal) {
  int none = 0;
  if (signal != SIGINT) ending_signal.compare_exchange_strong(none, signal);
}

void count_signal(int signal) {
  note_ending(signal);
  interrupts.fetch_add(signal == SIGINT ? 1 : stops_at_once);
}

/// What a program that ends at once must not leave: a terminal without echo, parts of files.
void clean_up() {
  QuietTerminal::leave();
  RawTerminal::leave();
  remove_unfinished_paths();
}

void leave(int signal) {
  clean_up();
  ::_exit(signal_status + signal);
}

/// The signal ends the program when the handler returns, as it does by default.
void leave_by_default(int signal) {
  clean_up();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handle(int signal, Handler handler) {
  if (std::signal(signal, handler) == SIG_IGN && signal != SIGINT && signal != SIGTERM)
    std::signal(signal, SIG_IGN);
}

}  // namespace

void end_at_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, leave);
  for (const int signal : other_signals) handle(signal, leave_by_default);
}

int status_of(Exit exit) {
  const int signal = ending_signal;
  return exit == Exit::interrupted && signal != 0 ? signal_status + signal : static_cast<int>(exit);
}

bool is_ended_by_signal() { return ending_signal != 0; }

Interrupt::Interrupt() {
  interrupts = 0;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, count_signal);
}

Interrupt::~Interrupt() = default;

int Interrupt::count() const { return interrupts; }

bool Interrupt::terminated() const { return ending_signal == SIGTERM; }

void Interrupt::forget() { interrupts = 0; }

}  // namespace lamplock::cli
