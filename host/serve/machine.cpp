#include "host/serve/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include "host/error.hpp"
#include "host/link/program_lines.hpp"
#include "host/run/program_control.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;

constexpr auto reopen_interval = 1s;
constexpr std::size_t max_console_lines = 500, max_console_text = 400;
constexpr std::size_t max_queued_lines = 100;

/// A jog by the line that a user would type.
std::string step_line(int axis, double mm, double feed_mm_min) {
  return fmt::format("$J=G91G21{}{:.3f}F{:.0f}", axis_letters[static_cast<std::size_t>(axis)], mm,
                     feed_mm_min);
}

}  // namespace

Machine::Machine(BoardOpener open, run::BoardOptions options, run::MachineOptions machine, Now now)
    : open_(std::move(open)),
      options_(std::move(options)),
      machine_(std::move(machine)),
      now_(std::move(now)) {
  thread_ = std::thread([this] { run(); });
}

Machine::~Machine() { end(); }

void Machine::end() {
  if (!thread_.joinable()) return;
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

std::optional<geometry::Bounds> Machine::area() const {
  const std::lock_guard lock(mutex_);
  return area_;
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
  show_locked(text);
}

/// With the lock.
void Machine::show_locked(const std::string& text) {
  console_.push_back({++last_line_, text.substr(0, max_console_text)});
  if (console_.size() > max_console_lines) console_.pop_front();
}

bool Machine::runs_dry_job() const {
  const std::lock_guard lock(mutex_);
  return requests_ && view_.job.is_running && view_.job.is_dry;
}

void Machine::show_last(const JobView& job) {
  show(fmt::format("job: {}: {}: {}", job.name, job.end, job.message));
  const std::lock_guard lock(mutex_);
  view_.job = job;
}

// Requests of the server.

void Machine::stop() {
  const std::lock_guard lock(mutex_);
  lease_.reset();
  step_.reset();
  if (std::exchange(next_job_, std::nullopt)) words_.clear();
  lines_.clear();
  barred_since_ = now_();
  if (requests_) return requests_->stop();
  view_.job.is_running = false;  // a job that had not begun
  stop_ = true;
}

void Machine::hold() { type("!"); }

void Machine::resume() { type("~"); }

void Machine::change_feed(const std::string& word) { type(word); }

/// To the running job, or to the idle machine.
void Machine::type(const std::string& word) {
  const std::lock_guard lock(mutex_);
  if (requests_) {
    requests_->type(word);
    return;
  }
  if (words_.size() < max_queued_lines) words_.push_back(word);
}

/// With the lock.
void Machine::check_is_free() const {
  if (!view_.board.is_connected)
    throw Refusal(Exit::no_device, "no-board", {{"board", options_.board}});
  if (view_.job.is_running) throw Refusal(Exit::job_failed, "job-runs", {{"job", view_.job.name}});
}

/// With the lock. What is held may have the laser on, and its board executes other lines only after
/// a resume: the user resumes or stops it first.
void Machine::check_is_not_held(const std::string& what) const {
  const std::string& state = view_.board.state;
  if (state.starts_with("Hold") || state.starts_with("Door"))
    throw Refusal(Exit::job_failed, "machine-held", {{"what", what}});
}

/// With the lock.
void Machine::check_can_jog() const {
  check_is_free();
  check_is_not_held("jog");
  if (view_.board.state.starts_with("Alarm")) throw Refusal(Exit::job_failed, "jog-in-alarm");
}

void Machine::start(const JobStart& job) {
  const std::lock_guard lock(mutex_);
  check_is_free();
  if (!job.resumes) check_is_not_held(job.name);
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
  check_is_not_held("settings");
  posted_.push_back({std::move(work), std::move(done)});
}

/// Whether a program waits for a tool, so that its sender accepts lines of the user. Needs the
/// lock.
bool Machine::changes_tool() const { return requests_ && view_.job.word == run::tool_change_word; }

/// Needs the lock.
void Machine::send_in_tool_change(const std::string& line) {
  if (!requests_->type(line)) throw Refusal(Exit::job_failed, "many-lines");
}

void Machine::send_lines(const std::vector<std::string>& lines) {
  std::unique_lock lock(mutex_);
  if (changes_tool()) {
    if (lines.size() != 1) throw Refusal(Exit::job_failed, "one-line");
    // Words that begin so are keys of a program (run::ProgramControl).
    constexpr std::string_view keys = "!+-=~";
    const std::string first = lines.front().substr(0, 1);
    if (!first.empty() && keys.find(first) != std::string_view::npos)
      throw Refusal(Exit::bad_input, "no-user-line", {{"character", first}});
    send_in_tool_change(lines.front());
    lock.unlock();
    return show("> " + lines.front());
  }
  check_is_free();
  check_is_not_held("console");
  if (lines_.size() + lines.size() > max_queued_lines)
    throw Refusal(Exit::job_failed, "many-lines");
  lines_.insert(lines_.end(), lines.begin(), lines.end());
}

void Machine::run_jog(const pendant::Direction& direction, double feed_mm_min,
                      std::chrono::milliseconds lease) {
  {
    const std::lock_guard lock(mutex_);
    const auto now = now_();
    if (barred_since_ && now - *barred_since_ <= lease_time) {
      barred_since_ = now;
      throw Refusal(Exit::job_failed, "jog-stopped");
    }
    barred_since_.reset();
  }
  lend({direction, std::nullopt, feed_mm_min, {}}, lease);
}

void Machine::go_to(const Place& place, double feed_mm_min, std::chrono::milliseconds lease) {
  {
    const std::lock_guard lock(mutex_);
    if (view_.board.jogs) throw Refusal(Exit::job_failed, "machine-moves");
  }
  check_in_area(place);
  lend({std::nullopt, place, feed_mm_min, {}}, lease);
}

void Machine::check_in_area(const Place& place) const {
  const std::optional<geometry::Bounds> travel = area();
  if (!travel || !has_soft_limits_) return;
  const std::array low{travel->low.x, travel->low.y, travel->low.z};
  const std::array high{travel->high.x, travel->high.y, travel->high.z};
  for (std::size_t a = 0; a < low.size(); ++a)
    if (place[a] && high[a] > low[a] && (*place[a] < low[a] || *place[a] > high[a]))
      throw Refusal(Exit::bad_input, "outside-travel",
                    {{"axis", std::string(1, axis_letters[a])},
                     {"place", fmt::format("{:.3f}", *place[a])},
                     {"low", fmt::format("{:.3f}", low[a])},
                     {"high", fmt::format("{:.3f}", high[a])}});
}

void Machine::renew_jog(std::chrono::milliseconds lease) { lend({}, lease); }

void Machine::lend(Lease lease, std::chrono::milliseconds time) {
  const std::lock_guard lock(mutex_);
  if (changes_tool()) throw Refusal(Exit::job_failed, "only-steps");
  check_can_jog();
  lease.until = now_() + std::min(time, lease_time);
  // A way that has not begun keeps its place.
  if (!lease.direction && !lease.place && lease_ && lease_->place) {
    lease_->until = lease.until;
    return;
  }
  lease_ = lease;
}

void Machine::step_jog(int axis, double mm, double feed_mm_min) {
  const std::lock_guard lock(mutex_);
  if (changes_tool()) return send_in_tool_change(step_line(axis, mm, feed_mm_min));
  check_can_jog();
  step_ = Step{axis, mm, feed_mm_min};
}

void Machine::stop_jog() {
  const std::lock_guard lock(mutex_);
  lease_.reset();
  step_.reset();
  jog_stop_ = true;
}

void Machine::bar_jog() {
  const std::lock_guard lock(mutex_);
  barred_since_ = now_();
}

void Machine::release_jog() {
  const std::lock_guard lock(mutex_);
  barred_since_.reset();
}

std::vector<EndedJob> Machine::take_ended() {
  const std::lock_guard lock(mutex_);
  return std::exchange(ended_, {});
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
      lose_board(message_of(std::current_exception()));
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
    area_.reset();
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
    words_.clear();
    stop_ = false;
    posted.swap(posted_);
  }
  if (is_new) show("no connection: " + why);
  for (const Posted& each : posted)
    each.done(std::make_exception_ptr(
        Error(Exit::no_device, options_.board, "the board is not connected", why)));
}

}  // namespace lamplock::serve
