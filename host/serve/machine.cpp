#include "host/serve/machine.hpp"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/board_text.hpp"
#include "host/link/program_lines.hpp"
#include "host/run/report_job.hpp"
#include "host/run/run_program.hpp"
#include "host/run/send_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/lent_transport.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;
using settings::Id;

constexpr std::chrono::microseconds loop_interval = 2ms;
constexpr auto reopen_interval = 1s;
constexpr std::size_t max_console_lines = 500, max_console_text = 400;
constexpr std::size_t max_queued_lines = 100;

std::string text_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& known) {
    return std::string(known.message());
  } catch (const std::exception& other) {
    return other.what();
  }
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

Machine::Machine(BoardOpener open, run::BoardOptions options, run::MachineOptions machine)
    : open_(std::move(open)), options_(std::move(options)), machine_(std::move(machine)) {
  thread_ = std::thread([this] { run(); });
}

Machine::~Machine() {
  const MachineView last = view();
  const bool is_quiet = last.board.state == "Idle" || last.board.state == "Alarm";
  if (last.job.is_running || !is_quiet) stop();
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

MachineView Machine::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

std::vector<ConsoleLine> Machine::lines_after(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  std::vector<ConsoleLine> lines;
  for (const ConsoleLine& line : console_)
    if (line.number > number) lines.push_back(line);
  return lines;
}

void Machine::show(const std::string& text) {
  const std::lock_guard lock(mutex_);
  console_.push_back({++last_line_, text.substr(0, max_console_text)});
  if (console_.size() > max_console_lines) console_.pop_front();
}

// Requests of the server.

void Machine::stop() {
  const std::lock_guard lock(mutex_);
  lease_.reset();
  step_.reset();
  next_job_.reset();
  lines_.clear();
  if (requests_) return requests_->stop();
  view_.job.is_running = false;  // a job that had not begun
  stop_ = true;
}

void Machine::hold() {
  const std::lock_guard lock(mutex_);
  if (requests_) return requests_->type("!");
  bytes_.push_back(link::realtime::hold);
}

void Machine::resume() {
  const std::lock_guard lock(mutex_);
  if (requests_) return requests_->type("~");
  bytes_.push_back(link::realtime::resume);
}

void Machine::change_feed(const std::string& word) {
  const std::lock_guard lock(mutex_);
  if (requests_) return requests_->type(word);
  bytes_.push_back(word == "+"   ? link::realtime::feed_plus_10
                   : word == "-" ? link::realtime::feed_minus_10
                                 : link::realtime::feed_full);
}

/// With the lock.
void Machine::check_is_free() const {
  if (!view_.board.is_connected)
    throw Error(Exit::no_device, options_.board, "the board is not connected",
                "connect it; the server opens it again by itself");
  if (view_.job.is_running)
    throw Error(Exit::job_failed, view_.job.name, "the job runs", "wait for its end, or stop it");
}

void Machine::start(const JobStart& job) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  lease_.reset();
  next_job_ = job;
  view_.job = {};
  view_.job.is_running = true;
  view_.job.name = job.name;
  view_.job.is_dry = job.is_dry;
}

void Machine::post(Work work, Done done) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  posted_.push_back({std::move(work), std::move(done)});
}

void Machine::send_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  if (lines_.size() >= max_queued_lines)
    throw Error(Exit::job_failed, "console", "too many lines wait for the board", "wait for them");
  lines_.push_back(line);
}

void Machine::run_jog(const pendant::Direction& direction, double feed_mm_min) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  lease_ = Lease{direction, feed_mm_min, Clock::now() + lease_time};
}

void Machine::step_jog(int axis, double mm, double feed_mm_min) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  step_ = Step{axis, mm, feed_mm_min};
}

void Machine::stop_jog() {
  const std::lock_guard lock(mutex_);
  lease_.reset();
  step_.reset();
  jog_stop_ = true;
}

// The thread of the machine.

void Machine::run() {
  const auto is_ending = [this] {
    const std::lock_guard lock(mutex_);
    return ending_;
  };
  while (!is_ending()) {
    try {
      open_board();
      while (!is_ending()) converse();
    } catch (...) {
      lose_board(text_of(std::current_exception()));
    }
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, reopen_interval, [this] { return ending_; });
  }
}

void Machine::open_board() {
  if (!transport_) transport_ = open_();
  limits_.reset();
}

void Machine::lose_board(const std::string& why) {
  supervisor_.reset();
  transport_.reset();
  std::deque<Posted> posted;
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    is_new = view_.board.problem != why;
    const bool is_job = view_.job.is_running;
    view_.board = {};
    view_.board.problem = why;
    if (is_job) {
      view_.job.is_running = false;
      view_.job.end = "failed";
      view_.job.message = why;
    }
    // Nothing that was asked for before acts on a board that is connected later.
    next_job_.reset();
    lease_.reset();
    step_.reset();
    lines_.clear();
    bytes_.clear();
    stop_ = false;
    posted.swap(posted_);
  }
  if (is_new) show("no connection: " + why);
  for (const Posted& each : posted)
    each.done(std::make_exception_ptr(
        Error(Exit::no_device, options_.board, "the board is not connected", why)));
}

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
  lock.unlock();
  run_job(job);
  return false;
}

void Machine::take_answers(Talk& talk) {
  for (const pendant::Answered& answer : talk.board.poll(talk.moves())) {
    talk.reports_then = talk.board.machine().reports;
    if (answer.kind == pendant::LineKind::jog && talk.jogs) talk.jogs->take(answer);
    if (answer.error != 0)
      show(fmt::format("{}: {}", answer.line, link::error_text(answer.error)));
    else if (answer.kind == pendant::LineKind::command)
      show("ok");
  }
  talk.board.take_messages();  // shown by on_line()
  if (talk.restarts == talk.board.restarts()) return;
  talk.restarts = talk.board.restarts();
  if (talk.jogs) talk.jogs->forget();
}

/// A stop of a jog keeps the rest of the machine as it is. What lines have begun is ended by the
/// door byte, which switches the laser off before the machine brakes, and a reset at rest.
void Machine::take_stop(Talk& talk) {
  bool stops = false, stops_jog = false;
  std::deque<std::uint8_t> bytes;
  {
    const std::lock_guard lock(mutex_);
    stops = std::exchange(stop_, false);
    stops_jog = std::exchange(jog_stop_, false);
    bytes.swap(bytes_);
  }
  for (const std::uint8_t byte : bytes) talk.board.send_byte(byte);
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
  if (lease) {
    const auto left =
        std::chrono::duration_cast<std::chrono::microseconds>(lease->until - Clock::now());
    if (left.count() > 0)
      talk.jogs->run(lease->direction, lease->feed_mm_min, talk.board.now() + left);
  }
  if (step)
    talk.jogs->step(step->axis, std::abs(step->mm), step->mm > 0 ? 1 : -1, step->feed_mm_min);
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
  board.machine_mm = machine.place(false);
  board.work_mm = machine.place(true);
  board.overrides = machine.overrides;
  board.jogs = talk.moves();
}

void Machine::read_limits() {
  link::LinePort port(*transport_);
  const link::BoardSettings settings = link::read_settings(port);
  limits_ = pendant::jog_limits(settings.values);
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

run::BoardOptions Machine::options_for(const JobStart& job) const {
  run::BoardOptions options = options_;
  options.opener = [this] { return std::make_unique<LentTransport>(*transport_); };
  options.yes = true;  // the server has the permission
  options.dry = job.is_dry;
  options.resume = job.resumes;
  options.from = job.from;
  return options;
}

void Machine::run_job(const JobStart& job) {
  supervisor_.reset();
  const std::shared_ptr<JobRequests> requests = requests_;
  PageFrontend frontend(*requests,
                        {[this](const std::string& text) { show(text); },
                         [this](const std::function<void(BoardView&, JobView&)>& change) {
                           const std::lock_guard lock(mutex_);
                           change(view_.board, view_.job);
                         }});
  {
    const std::lock_guard lock(mutex_);
    view_.board.state = "Run";
  }
  std::string end;
  try {
    run::BoardOptions options = options_for(job);
    if (run::kind_of_sent_file(job.path) == run::SentKind::program) {
      const run::ProgramOutcome outcome =
          run::run_program(job.path, options, {false, machine_}, frontend);
      end = end_name(outcome);
      run::judge_program(outcome, options.board, frontend);
    } else {
      const run::SentJob sent = run::send_job(job.path, options, frontend);
      end = end_name(sent.outcome);
      if (sent.prepared.job.is_rows())
        run::judge_end(sent.outcome, options, sent.prepared.job.item(), frontend);
      else
        run::judge_points(sent.outcome, options, frontend);
    }
    end_job(end, "");
  } catch (...) {
    end_job(end.empty() || end == "done" ? "failed" : end, text_of(std::current_exception()));
  }
}

void Machine::end_job(const std::string& end, const std::string& message) {
  show(message.empty() ? "job: " + end : "job: " + end + ": " + message);
  const std::lock_guard lock(mutex_);
  requests_.reset();
  stop_ = false;
  view_.job.is_running = false;
  view_.job.end = end;
  view_.job.message = message;
  if (end == "done") view_.job.done = view_.job.total;  // the last progress is not shown
  view_.job.word.clear();
  view_.job.left_s.reset();
}

}  // namespace lamplock::serve
