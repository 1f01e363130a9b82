#include "host/link/sender.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "host/error.hpp"
#include "host/link/job_refusal.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/realtime_inbox.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::link {
namespace {

using std::chrono::microseconds;

/// Bytes queued in the transport: more would only delay a hold.
constexpr std::size_t max_backlog = 2 * wire::max_frame;
constexpr microseconds reconnect_interval{200'000};
/// Refusals of points for a temporary reason before the job fails.
constexpr int max_soft_refusals = 20;
constexpr microseconds max_frame_wait{10'000};
constexpr microseconds min_frame_wait{500};
constexpr std::int64_t us_per_ms = 1'000;
/// Progress without new points is reported this often: a record on a disk takes some 10 ms.
constexpr microseconds progress_interval{500'000};

std::uint32_t choose_session(std::uint32_t wanted) {
  if (wanted != 0) return wanted;
  std::random_device random;
  return std::uniform_int_distribution<std::uint32_t>(1)(random);
}

const job::Job& check_first(const job::Job& job, std::size_t first) {
  if (first <= job.size()) return job;
  throw Error(Exit::bad_input, fmt::format("{} {}", job.item(), first),
              "is beyond the end of the job",
              fmt::format("the job has {} {}s", job.size(), job.item()));
}

/// A temporary reason, or one that STATUS shows too.
bool is_soft(Result result) {
  return result == Result::no_job || result == Result::busy || result == Result::locked ||
         result == Result::door_open;
}

}  // namespace

JobSender::JobSender(Transport& transport, const job::Job& job, SenderOptions options)
    : transport_(transport),
      job_(check_first(job, options.first_index)),
      options_(std::move(options)),
      connection_(transport),
      session_(choose_session(options_.session)),
      window_(job, options_.first_index, options_.window_frames),
      handed_over_(options_.first_index + options_.run_up_lines),
      // Tags start at random, so that an answer to another program is not taken for one to us.
      tag_(session_ & 0x7FFFFFFFu),
      job_speed_(options_.job_speed) {
  const std::int64_t dead_man_ms = job.settings.whole(settings::Id::dead_man);
  if (dead_man_ms > 0) {
    const Time quarter{dead_man_ms * us_per_ms / 4};
    options_.status_interval = std::min(options_.status_interval, quarter);
    options_.reply_timeout = std::min(options_.reply_timeout, quarter);
  }
  const Time now = transport_.now();
  started_at_ = heard_at_ = now;
  asked_at_ = now - options_.reply_timeout;
  job_status_.first_unfired = static_cast<std::uint32_t>(handed_over_);
}

JobResult JobSender::run() {
  while (step()) {
  }
  return result();
}

bool JobSender::step() {
  if (phase_ == Phase::ended) return false;
  try {
    advance();
  } catch (...) {
    const bool stopping = phase_ == Phase::stopping;
    fail(std::current_exception());
    if (stopping) throw_not_stopped();
  }
  return phase_ != Phase::ended;
}

/// One round.
void JobSender::advance() {
  receive();
  keep_connected();
  if (phase_ == Phase::stream) {
    steer();
    stream();
    report_progress_in_time();
    check_end();
  } else if (phase_ == Phase::begin) {
    begin();
  }
  if (phase_ == Phase::stopping) insist_on_stop();
  if (phase_ == Phase::ended) return;
  ask();
  connection_.flush();
  transport_.wait(pause_length());
}

/// Lines of the run-up were done in an earlier run, even if the machine counts them as not done.
void JobSender::keep(const wire::Status& status) {
  const std::uint32_t done = job_status_.first_unfired;
  job_status_ = status;
  job_status_.first_unfired = std::max(done, status.first_unfired);
}

/// The machine reports its count of shots and the first point not done. Shots beyond those of the
/// points before it were fired at this point.
std::uint32_t JobSender::flashes_fired() const {
  if (job_.header.dry) return 0;
  const std::size_t next = job_status_.first_unfired;
  const std::uint32_t before = next == options_.first_index ? options_.first_fired : 0;
  return before + flashes_of(job_.targets, options_.first_index, next, job_status_.shots);
}

/// A dry run fires nothing: it may continue at the last known point.
Continuation JobSender::rest() const {
  const std::size_t first = job_status_.first_unfired;
  if (handed_over_ <= first) return {first, flashes_fired(), first, true};
  if (job_.header.dry || is_at_rest(job_status_.state))
    return at_rest(job_, first, flashes_fired());
  if (mark_) return after_restart(job_, *mark_);
  return {first, 0, std::max(first, handed_over_), false};
}

std::string JobSender::advice() const {
  if (!options_.can_continue) return "";
  return continuation_text(rest(), job_.item(), static_cast<bool>(options_.on_progress));
}

JobResult JobSender::result() const {
  const Time elapsed = phase_ == Phase::ended ? elapsed_ : transport_.now() - started_at_;
  return {end_,        job_status_,      flashes_fired(),
          rest(),      window_.resent(), connection_.bad_frames(),
          reconnects_, elapsed};
}

void JobSender::receive() {
  while (const auto message = connection_.receive())
    std::visit([this](const auto& what) { handle(what); }, *message);
}

void JobSender::handle(const std::string& text) {
  if (text_seen_.empty()) text_seen_ = text;
  if (const auto mark = parse_restart_mark(text); mark && mark->session == session_) mark_ = mark;
  if (options_.on_text) options_.on_text(text);
}

void JobSender::handle(const wire::Status& status) {
  if (phase_ == Phase::stopping && status.version != wire::protocol_version) return;
  if (status.version != wire::protocol_version)
    throw Error(Exit::no_device, "machine",
                fmt::format("its firmware has protocol version {}, this program version {}",
                            status.version, wire::protocol_version),
                "install the firmware and the program of the same release");
  const bool answers = take_barrier(status);
  if (!synced_ && !answers) return;
  if (synced_ && status.number <= status_.number) return;
  synced_ = true;
  heard_at_ = transport_.now();
  status_ = status;
  if (phase_ == Phase::hello) {
    phase_ = Phase::begin;
    begin_at_ = heard_at_;
  }
  if (phase_ == Phase::begin && status.session == session_) {
    phase_ = Phase::stream;
    started_at_ = heard_at_;
    finish_by_.reset();
    window_.choose_frame_size(status.free_points);
  }
  if (phase_ == Phase::stopping && stop_end_ != JobEnd::restarted && status.session == session_)
    keep(status);
  if (phase_ != Phase::stream) return;
  if (status.session != session_ || status.next_number > window_.last_built() + 1 ||
      status.next_number <= window_.last_acknowledged())
    return begin_stop(JobEnd::restarted);
  keep(status);
  if (window_.acknowledge(status.next_number)) soft_refusals_ = 0;
}

/// True if the status answers one of our QUERYs. Frames that it proves lost are retransmitted.
bool JobSender::take_barrier(const wire::Status& status) {
  const auto found = std::find_if(barriers_.begin(), barriers_.end(), [&](const Barrier& barrier) {
    return barrier.tag == status.echo;
  });
  if (found == barriers_.end()) return false;
  const Barrier barrier = *found;
  barriers_.erase(barriers_.begin(), found + 1);
  const bool ours = phase_ == Phase::stream && status.session == session_;
  if (ours && status.next_number < barrier.number) window_.write_again(status.next_number);
  return true;
}

void JobSender::handle(const RefusedFrame& frame) {
  const wire::Refused& refused = frame.refused;
  if (refused.type == wire::FrameType::begin) {
    if (phase_ != Phase::begin) return;
    if (refused.result == Result::busy && options_.take_over) return take_over();
    // The hold may come from noise; BEGIN is repeated.
    if (refused.result == Result::held && options_.auto_resume)
      return connection_.send(std::array{wire::byte_resume});
    refuse_job(refused);
  }
  const bool numbered =
      refused.type == wire::FrameType::data || refused.type == wire::FrameType::end;
  if (!numbered || phase_ != Phase::stream) return;
  if (is_soft(refused.result) && ++soft_refusals_ < max_soft_refusals) return;
  // Thrown once the machine is at rest: only then it is known where the job can continue.
  stop_refusal_ = refused;
  begin_stop(JobEnd::stopped);
}

void JobSender::refuse_job(const wire::Refused& refused) const {
  throw_refusal(refused, {job_.item(), session_, status_, transport_.board(), advice()});
}

/// The machine has ended the job without a command of the host; its message about the reason was
/// lost.
void JobSender::throw_ended() const {
  refuse_job({wire::FrameType::end, Result::no_job, job_status_.first_unfired});
}

/// Notices a cut connection and tries to make a new one.
void JobSender::keep_connected() {
  const Time now = transport_.now();
  const bool hello = phase_ == Phase::hello;
  if (hello && now - started_at_ >= options_.hello_timeout) throw_no_answer();
  if (!cut_) {
    const bool silent = !hello && now - heard_at_ >= options_.silence_limit;
    if (transport_.connected() && !silent) return;
    cut_ = true;
    lost_at_ = heard_at_;
    reconnect_at_ = now;
  }
  const bool begun = phase_ == Phase::stream || phase_ == Phase::stopping;
  if (wish_ == Wish::stop && !begun) return end(JobEnd::stopped);
  if (phase_ != Phase::stopping && now - lost_at_ >= options_.reconnect_timeout)
    return end(JobEnd::lost);
  if (now < reconnect_at_) return;
  reconnect_at_ = now + reconnect_interval;
  if (!connection_.reconnect()) return;
  cut_ = false;
  ++reconnects_;
  synced_ = false;
  // Which frames the machine has is unknown: write nothing before its next STATUS.
  barriers_.clear();
  window_.write_all_again();
  heard_at_ = now;
  asked_at_ = now - options_.reply_timeout;
}

void JobSender::throw_no_answer() const {
  const std::string what = text_seen_.empty()
                               ? "does not answer"
                               : fmt::format("answers in text ('{}'), not in frames", text_seen_);
  throw Error(Exit::no_device, "machine", what,
              "check port, power and firmware, and that no other program uses the machine");
}

/// Sends a QUERY after a burst, at the status interval, and again when no answer came.
void JobSender::ask() {
  if (cut_) return;
  const Time now = transport_.now();
  const Time since = now - asked_at_;
  const bool burst_open = synced_ && barriers_.empty() && window_.any_on_the_way();
  const Time interval =
      barriers_.empty() && synced_ ? options_.status_interval : options_.reply_timeout;
  if (!burst_open && since < interval) return;
  barriers_.push_back({++tag_, window_.next_number()});
  connection_.send_query(session_, tag_);
  asked_at_ = now;
}

void JobSender::begin() {
  if (cut_ || !synced_) return;
  const Time now = transport_.now();
  if (begin_sent_ && now - begin_at_ < options_.reply_timeout) return;
  if (!begin_sent_) report_progress(handed_over_);
  std::array<std::uint8_t, wire::max_job_header_size> payload{};
  wire::ByteWriter out(payload);
  wire::write_job_header(out, job::header_from(job_, options_.first_index));
  connection_.send({wire::FrameType::begin, session_, 0}, out.written());
  begin_sent_ = true;
  begin_at_ = now;
}

/// Writes frames as far as the window and the machine's free space allow.
void JobSender::stream() {
  if (phase_ != Phase::stream || cut_ || !synced_) return;
  // No motion before the machine has the job speed.
  const bool speed_known = job_speed_ == machine_job_speed_ && command_taken();
  if (!window_.any_written() && !speed_known) return;
  while (connection_.backlog() < max_backlog) {
    const FrameWindow::Frame* frame = window_.next(session_);
    if (!frame || !window_.has_room(*frame, end_of_room(), status_.free_runs)) return;
    if (frame->end_index > progress_.may_have_fired) report_progress(end_of_room());
    handed_over_ = std::max(handed_over_, frame->end_index);
    connection_.send(frame->bytes);
    window_.written();
  }
}

/// Index up to which points, or lines, may be sent.
std::size_t JobSender::end_of_room() const {
  const std::size_t of_machine = std::size_t{status_.received} + status_.free_points;
  const std::size_t ahead = std::max(options_.points_ahead, window_.frame_points());
  return std::min(of_machine, job_status_.first_unfired + std::min(ahead, job_.size()));
}

/// Reports progress: no point from `may_have_fired` on is sent before the next report.
void JobSender::report_progress(std::size_t may_have_fired) {
  if (!options_.on_progress) return;
  progress_ = {session_, job_status_.first_unfired,
               static_cast<std::uint32_t>(std::clamp(may_have_fired, handed_over_, job_.size()))};
  progress_at_ = transport_.now();
  options_.on_progress(progress_);
}

/// Keeps the lower bound up to date, also after all points were sent.
void JobSender::report_progress_in_time() {
  const bool is_behind = job_status_.first_unfired > progress_.first_unfired;
  if (progress_.session != 0 && is_behind && transport_.now() - progress_at_ >= progress_interval)
    report_progress(progress_.may_have_fired);
}

void JobSender::check_end() {
  if (phase_ != Phase::stream) return;
  using wire::MachineState;
  const MachineState state = status_.state;
  if (state == MachineState::alarm || state == MachineState::estop) return end(JobEnd::alarm);
  const bool moving = state == MachineState::run;
  const bool all_done = window_.all_acknowledged() && status_.first_unfired >= job_.size();
  const bool unfinished = status_.first_unfired < job_.size();
  if (state == MachineState::idle && unfinished) {
    if (status_.hold_reason != wire::HoldReason::reset) throw_ended();
    was_reset_ = true;
    return begin_stop(JobEnd::stopped);
  }
  if (!all_done) return;
  if (!finish_by_) finish_by_ = transport_.now() + rest_timeout;
  if (moving && transport_.now() < *finish_by_) return;
  end(JobEnd::done);
}

void JobSender::end(JobEnd how) {
  if (phase_ == Phase::ended) return;
  elapsed_ = transport_.now() - started_at_;
  end_ = how;
  phase_ = Phase::ended;
}

JobSender::Time JobSender::pause_length() const {
  return connection_.backlog() > 0 ? Time(min_frame_wait) : Time(max_frame_wait);
}

}  // namespace lamplock::link
