// Commands of the jogger other than jogs: homing, macros, reset; how they end and are stopped.
#include <fmt/format.h>

#include "host/link/line_port.hpp"
#include "host/pendant/jogger.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
namespace realtime = link::realtime;

/// Interval of stop bytes until the commands have ended.
constexpr Time ending_interval = 50ms;

}  // namespace

/// The machine homes, or will home by a line that was sent.
bool Jogger::homes() const { return machine().status.is("Home") || talk_.homing_unanswered(); }

void Jogger::end_commands() {
  ended_at_ = talk_.now();
  // Only a reset ends homing (grbl 1.1), and before the end of homing the position is unknown.
  if (homes()) return reset();
  // A macro may move by jogs or by programs; start-up lines run after homing.
  if (!macro_runs_ && !machine().status.is("Run")) return;
  talk_.send_byte(realtime::jog_cancel);
  talk_.send_byte(realtime::hold);
}

/// Repeats the stop: a line that was sent in part may begin after the byte, and a byte may be lost.
void Jogger::keep_ending() {
  if (!ending_) return;
  const bool held =
      machine().status.waits() && machine().reports >= reports_at_ending_ + sure_reports;
  ending_ = commands_ && !held;
  if (ending_ && talk_.now() - ended_at_ >= ending_interval) end_commands();
}

void Jogger::stop() {
  const link::BoardStatus& status = machine().status;
  const bool ours = commands_;
  stop_motion();
  if (status.is("Jog") && !stream_.moves()) talk_.send_byte(realtime::jog_cancel);
  if (status.is("Run") && !ours) talk_.send_byte(realtime::hold);
}

void Jogger::start_or_pause() {
  const link::BoardStatus& status = machine().status;
  // Homing does not obey a hold.
  if (status.is("Jog") || homes() || stream_.moves()) return stop();
  talk_.send_byte(status.is("Run") ? realtime::hold : realtime::resume);
}

/// Commands count as under way until reports say that the machine is at rest.
void Jogger::reset() {
  macro_.clear();
  macro_runs_ = false;
  commands_ = true;
  reports_then_ = machine().reports;
  stream_.stop();
  stream_.forget();
  talk_.forget_lines();
  talk_.send_byte(realtime::reset);
}

void Jogger::begin_macro(std::size_t number) {
  const Macro& macro = map_.macros[number];
  if (macro_runs_) return note(fmt::format("wait for the end of macro {}", macro_name_));
  if (!may_command()) return;
  macro_.assign(macro.lines.begin(), macro.lines.end());
  // M3 or M4 of an earlier program may still be in force.
  if (!macro.laser) macro_.push_front("M5");
  macro_name_ = macro.name;
  commands_ = macro_runs_ = true;
}

void Jogger::continue_macro() {
  if (macro_.empty() || talk_.unanswered(LineKind::command) != 0) return;
  send(macro_.front());
  macro_.pop_front();
}

/// Commands are completed when all lines are answered and later reports say that the machine is
/// idle, or in alarm.
void Jogger::settle_commands() {
  if (!commands_ || !macro_.empty() || talk_.unanswered(LineKind::command) != 0) return;
  const link::BoardStatus& status = machine().status;
  if (machine().reports < reports_then_ + sure_reports) return;
  if (status.is_at_rest() && !status.waits()) commands_ = macro_runs_ = false;
}

void Jogger::send(const std::string& line) {
  talk_.send(line, LineKind::command);
  reports_then_ = machine().reports;
  commands_ = true;
}

}  // namespace lamplock::pendant
