#include "host/run/jog_session.hpp"

#include <algorithm>
#include <exception>
#include <thread>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"

namespace lamplock::run {
namespace {

using namespace std::chrono_literals;
using pendant::Event;
using settings::Id;

constexpr std::chrono::microseconds loop_interval = 2ms;
/// Interval between two searches for a missing pendant, at rest.
constexpr auto search_interval = 1s;
/// An escape byte that no other follows for so long is the key Esc.
constexpr auto escape_time = 50ms;
/// A simulated board that lags more does not catch up with the wall clock.
constexpr auto max_lag = 100ms;
/// Longest wait for the end of braking.
constexpr auto rest_time = 5s;

pendant::JogLimits limits_of(link::LinePort& port) {
  const link::BoardSettings settings = link::read_settings(port);
  if (settings.values.whole(Id::report_inches) != 0)
    throw Error(Exit::job_failed, "machine", "reports its position in inches", "set $13=0");
  return pendant::jog_limits(settings.values);
}

}  // namespace

JogSession::JogSession(SupervisedBoard& board, const JogChoice& choice, Frontend& frontend,
                       JogView& view)
    : board_(board.link),
      supervisor_(board.supervisor),
      choice_(choice),
      interrupts_(frontend.interrupts()),
      view_(view) {
  const bool with_pendant = choice.pendant != "none";
  if (with_pendant) find_pendant(choice.pendant != "auto");
  // Without a terminal keys come from a pipe, but not beside a pendant, whose user has none.
  if (view.has_keyboard() || !pendant_) keyboard_ = view.open_keys();
  jogger_.emplace(board.link.port(), limits_of(board.link.port()), choice.map);
  if (choice.step_mm) jogger_->choose_step(*choice.step_mm);
  if (pendant_) jogger_->use_pendant(pendant_->has_switch());
  jogger_->set_mode(
      choice.mode.value_or(pendant_ ? pendant::Mode::step : pendant::Mode::continuous));
}

JogSession::~JogSession() {
  try {
    if (jogger_) jogger_->stop_motion();  // holds a macro, too
    board_.port().drop_unbegun_lines();
    board_.port().send_realtime(link::realtime::jog_cancel);
    board_.port().flush();
  } catch (const std::exception&) {
    // The board is gone: its last line ends by itself.
  }
}

void JogSession::run() {
  if (view_.has_keyboard()) view_.note(pendant::keys_text);
  while (!is_to_end()) {
    round();
    take_pendant();
    if (keyboard_) take_keys();
  }
  stop_and_wait();
  if (pendant_lost_ && !keyboard_)
    throw Error(Exit::no_device, pendant_name_, "was disconnected; the machine was stopped",
                "plug it in and begin again");
}

void JogSession::find_pendant(bool must_be) {
  searched_at_ = Clock::now();
  const auto found = pendant::find_pendants(choice_.pendant);
  for (const pendant::HidInfo& info : found) {
    try {
      use(info);
      return;
    } catch (const Error& error) {
      if (must_be) throw;
      view_.note(error.what());
    }
  }
  if (must_be)
    throw Error(Exit::no_device, "--pendant " + choice_.pendant, "is not plugged in",
                "plug in its receiver, or leave it to --pendant auto");
}

void JogSession::use(const pendant::HidInfo& info) {
  const pendant::Variant variant{choice_.map.hb04_keys};
  pendant_.emplace(*info.id, pendant::open_pendant(info), pendant::open_pendant(info), variant);
  pendant_name_ = info.id->name;
  pendant_lost_ = false;
  if (jogger_) jogger_->use_pendant(pendant_->has_switch());
  view_.note(fmt::format("{} at {}", info.id->name, info.path));
}

void JogSession::take_pendant() {
  if (!pendant_) {
    const bool wanted = choice_.pendant != "none" && pendant_lost_ && jogger_->rests();
    if (wanted && Clock::now() - searched_at_ >= search_interval) find_pendant(false);
    return;
  }
  for (const Event& event : pendant_->poll()) jogger_->take(event);
  if (!pendant_->gone()) return pendant_->show(jogger_->display(), board_.port().transport().now());
  jogger_->stop_motion();
  pendant_.reset();
  pendant_lost_ = true;
  view_.note(pendant_name_ + " was disconnected: stopped");
}

void JogSession::take_keys() {
  const std::string bytes = keyboard_->read();
  auto keys = keys_.take(bytes);
  if (!bytes.empty()) key_at_ = Clock::now();
  if (keys_.inside() && Clock::now() - key_at_ >= escape_time) keys = keys_.pause();
  for (const std::string& key : keys) jogger_->press(key);
}

bool JogSession::is_to_end() {
  if (jogger_->wants_to_quit() || interrupts_->count() > 0) return true;
  if (keyboard_) return keyboard_->ended();
  return pendant_lost_;
}

void JogSession::stop_and_wait() {
  jogger_->stop_motion();
  const auto until = Clock::now() + rest_time;
  // At least one report, so that the result has a position. A hold keeps what it holds.
  const auto is_at_rest = [this] {
    const pendant::MachineNow& machine = jogger_->machine();
    return machine.reports > 0 && (jogger_->rests() || machine.status.waits());
  };
  while (!is_at_rest() && Clock::now() < until) round();
}

/// One exchange with the board.
void JogSession::round() {
  pass_time();
  jogger_->poll();
  supervisor_.poll(board_.port());
  for (const std::string& note : jogger_->take_notes()) view_.note(note);
  view_.show(*jogger_);
}

void JogSession::pass_time() {
  link::Transport& transport = board_.port().transport();
  if (board_.simulated() == nullptr) return transport.wait(loop_interval);
  std::this_thread::sleep_for(loop_interval);
  const auto now = Clock::now();
  passed_until_ = std::max(passed_until_, now - max_lag);
  const auto due =
      transport.now() + std::chrono::duration_cast<std::chrono::microseconds>(now - passed_until_);
  passed_until_ = now;
  while (transport.now() < due) {
    transport.wait(std::min(loop_interval, due - transport.now()));
    if (transport.now() < due) jogger_->poll();
  }
}

}  // namespace lamplock::run
