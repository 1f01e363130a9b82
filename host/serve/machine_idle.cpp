// The machine at rest: reports, jogs, lines of the console, work with the port of the board.
#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <utility>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/board_text.hpp"
#include "host/number_text.hpp"
#include "host/run/prepare.hpp"
#include "host/serve/machine.hpp"
#include "host/units.hpp"
#include "shared/gcode_errors.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;
using settings::Id;

constexpr std::chrono::microseconds loop_interval = 2ms;

/// The real-time byte of a word that a job would take.
std::uint8_t byte_of(const std::string& word) {
  return word == "!"   ? link::realtime::hold
         : word == "~" ? link::realtime::resume
         : word == "+" ? link::realtime::feed_plus_10
         : word == "-" ? link::realtime::feed_minus_10
                       : link::realtime::feed_full;
}

std::string state_text(const link::BoardStatus& status) {
  return status.substate < 0 ? status.state : fmt::format("{}:{}", status.state, status.substate);
}

}  // namespace

/// The dialogue with an idle board.
class Machine::Talk {
 public:
  Talk(link::Transport& transport, const std::optional<pendant::JogLimits>& limits)
      : port(transport), board(port) {
    if (limits) jogs.emplace(board, *limits);
  }
  bool moves() const { return jogs && jogs->moves(); }
  bool is_quiet() const { return !moves() && board.unanswered(pendant::LineKind::command) == 0; }
  bool rests() const {
    return is_quiet() && board.machine().reports >= reports_then + pendant::sure_reports &&
           board.machine().status.is_at_rest();
  }

  link::LinePort port;
  pendant::BoardDialog board;
  std::optional<pendant::JogStream> jogs;
  std::size_t restarts = 0;
  std::size_t reports_then = 0;  ///< count of reports when the last line was sent or answered
};

/// Until a job has run, or work was done: these have the connection for themselves.
void Machine::converse() {
  Talk talk(*transport_, limits_);
  talk.board.on_line([this](const std::string& line) {
    const auto alarm = link::parse_alarm(line);
    show(alarm ? link::alarm_text(*alarm) : line);
  });
  while (round(talk)) transport_->wait(loop_interval);
}

bool Machine::round(Talk& talk) {
  take_answers(talk);
  take_stop(talk);
  take_jogs(talk);
  send_next_line(talk);
  if (talk.jogs) talk.jogs->poll();
  supervise(talk);
  talk.port.flush();
  publish(talk);
  if (!talk.rests()) return true;
  if (!limits_ && talk.board.machine().status.rests()) return read_limits(), false;
  std::unique_lock lock(mutex_);
  if (ending_) return false;
  if (!posted_.empty()) {
    const Posted posted = std::move(posted_.front());
    posted_.pop_front();
    lock.unlock();
    do_work(posted);
    return false;
  }
  if (!next_job_ || !lines_.empty()) return true;
  const JobStart job = *std::exchange(next_job_, std::nullopt);
  requests_ = std::make_shared<JobRequests>();
  for (const std::string& word : std::exchange(words_, {})) requests_->type(word);
  lock.unlock();
  run_job(job);
  return false;
}

void Machine::take_answers(Talk& talk) {
  for (const pendant::Answered& answer : talk.board.poll(talk.moves())) {
    talk.reports_then = talk.board.machine().reports;
    if (answer.kind == pendant::LineKind::jog && talk.jogs) talk.jogs->take(answer);
    if (answer.kind == pendant::LineKind::command)
      take_command_answer(answer);
    else
      take_jog_answer(answer);
  }
  talk.board.take_messages();  // shown by on_line()
  if (talk.restarts == talk.board.restarts()) return;
  talk.restarts = talk.board.restarts();
  if (talk.jogs) talk.jogs->forget();
}

void Machine::take_command_answer(const pendant::Answered& answer) {
  if (answer.error == 0) return show("ok");
  show(fmt::format("{}: {}", answer.line, link::error_text(answer.error)));
  // The lines that follow, of a macro, may rely on the refused one.
  const std::lock_guard lock(mutex_);
  if (!lines_.empty()) show_locked("not sent after it: " + count_text(lines_.size(), "line"));
  lines_.clear();
}

/// The increments at the end of the travel are refused again and again while a key is held.
void Machine::take_jog_answer(const pendant::Answered& answer) {
  constexpr auto end_of_travel = static_cast<int>(GcodeError::jog_out_of_travel);
  const bool is_end = answer.error == end_of_travel;
  if (answer.error != 0 && !(is_end && is_at_end_))
    show(fmt::format("{}: {}", answer.line, link::error_text(answer.error)));
  is_at_end_ = is_end;
}

/// A stop of a jog keeps the rest of the machine as it is. What lines have begun is ended by the
/// door byte, which switches the laser off before the machine brakes, and a reset at rest.
void Machine::take_stop(Talk& talk) {
  bool stops = false, stops_jog = false;
  std::deque<std::string> words;
  {
    const std::lock_guard lock(mutex_);
    stops = std::exchange(stop_, false);
    stops_jog = std::exchange(jog_stop_, false);
    // What an idle machine is asked before a job begins is meant for the job.
    const pendant::MachineNow& machine = talk.board.machine();
    const bool is_idle = talk.is_quiet() && (machine.reports == 0 || machine.status.rests());
    if (!next_job_ || !is_idle) words.swap(words_);
  }
  for (const std::string& word : words) talk.board.send_byte(byte_of(word));
  if (talk.jogs && (stops || stops_jog)) talk.jogs->stop();
  if (stops && !talk.moves()) {
    talk.board.drop_lines();
    if (!talk.board.machine().status.is_at_rest()) talk.board.send_byte(link::realtime::door);
    talk.reports_then = talk.board.machine().reports;
    resets_at_rest_ = true;
    show("stop");
  }
  if (!resets_at_rest_) return;
  const pendant::MachineNow& machine = talk.board.machine();
  if (machine.reports < talk.reports_then + pendant::sure_reports) return;
  if (!machine.status.is_at_rest()) return;
  resets_at_rest_ = false;
  if (!machine.status.is("Alarm")) talk.board.send_byte(link::realtime::reset);
}

void Machine::take_jogs(Talk& talk) {
  std::optional<Lease> lease;
  std::optional<Step> step;
  {
    const std::lock_guard lock(mutex_);
    lease = std::exchange(lease_, std::nullopt);
    step = std::exchange(step_, std::nullopt);
  }
  if (!lease && !step) return;
  if (!talk.jogs) return show("jog: the settings of the board are not known");
  if (lease && lease->until > now_()) take_lease(talk, *lease);
  if (step)
    talk.jogs->step(step->axis, std::abs(step->mm), step->mm > 0 ? 1 : -1, step->feed_mm_min);
}

void Machine::take_lease(Talk& talk, const Lease& lease) {
  const pendant::Time until =
      talk.board.now() +
      std::chrono::duration_cast<std::chrono::microseconds>(lease.until - now_());
  if (lease.direction) return talk.jogs->run(*lease.direction, lease.feed_mm_min, until);
  if (!lease.place) return talk.jogs->extend(until);
  const std::vector<double> at = talk.board.machine().place(false);
  PerAxis<double> way{};
  for (std::size_t a = 0; a < std::min(at.size(), way.size()); ++a)
    if ((*lease.place)[a]) way[a] = *(*lease.place)[a] - at[a];
  if (talk.rests()) talk.jogs->travel(way, lease.feed_mm_min, until);
  const std::lock_guard lock(mutex_);
  if (!talk.rests() && !lease_) lease_ = lease;  // the report of its place comes first
}

void Machine::send_next_line(Talk& talk) {
  if (!talk.is_quiet() || resets_at_rest_) return;
  std::string line;
  {
    const std::lock_guard lock(mutex_);
    if (lines_.empty()) return;
    line = std::move(lines_.front());
    lines_.pop_front();
  }
  show("> " + line);
  talk.board.send(line, pendant::LineKind::command);
  const bool is_setting = line.size() > 1 && line[0] == '$' && line[1] >= '0' && line[1] <= '9';
  if (is_setting) limits_.reset();  // read again at rest
  talk.reports_then = talk.board.machine().reports;
}

/// The lines of the computer are watched while jogs or lines may move the machine.
void Machine::supervise(Talk& talk) {
  const bool may_move = !talk.is_quiet() || (talk.board.machine().reports > 0 &&
                                             !talk.board.machine().status.is_at_rest());
  if (!may_move) return supervisor_.reset();
  try {
    if (!supervisor_) {
      supervisor_.emplace(options_, *transport_);
      supervisor_->begin(gpio::LaserUse::motion);
    }
    supervisor_->poll(talk.port);
    complaint_.clear();
  } catch (const Error& error) {
    if (talk.jogs) talk.jogs->stop();
    talk.board.drop_lines();
    if (std::exchange(complaint_, error.message()) != error.message())
      show(std::string(error.message()));
    const std::lock_guard lock(mutex_);
    lines_.clear();
    lease_.reset();
  }
}

void Machine::publish(const Talk& talk) {
  const pendant::MachineNow& machine = talk.board.machine();
  if (machine.reports == 0) return;
  const std::lock_guard lock(mutex_);
  BoardView& board = view_.board;
  board.is_connected = true;
  board.problem.clear();
  board.state = state_text(machine.status);
  board.machine_mm = in_mm(machine.place(false));
  board.work_mm = in_mm(machine.place(true));
  board.overrides = machine.overrides;
  board.jogs = talk.moves();
}

std::vector<double> Machine::in_mm(std::vector<double> place) const {
  for (std::size_t a = 0; a < place.size(); ++a)
    if (inches_.has(static_cast<int>(a))) place[a] *= mm_per_inch;
  return place;
}

void Machine::read_limits() {
  link::LinePort port(*transport_);
  const link::BoardSettings settings = link::read_settings(port);
  limits_ = pendant::jog_limits(settings.values);
  inches_ = inch_axes(settings.values);
  {
    const std::lock_guard lock(mutex_);
    area_.reset();
    if (settings.has(Id::travel_x)) area_ = run::work_space_mm(settings.values);
    has_soft_limits_ = settings.has(Id::soft_limits) && settings.values.whole(Id::soft_limits) != 0;
  }
  if (settings.values.whole(Id::report_inches) == 0) return;
  limits_ = pendant::JogLimits{};  // no axis moves
  show("no jogs: the machine reports its position in inches; set report_inches ($13) to 0");
}

void Machine::do_work(const Posted& posted) {
  std::exception_ptr error;
  try {
    link::LinePort port(*transport_);
    posted.work(port);
    read_limits();  // the work may have changed settings
  } catch (...) {
    error = std::current_exception();
  }
  posted.done(error);
}

}  // namespace lamplock::serve
