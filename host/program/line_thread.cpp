#include "host/program/line_thread.hpp"

#include <utility>

namespace lamplock::program_run {
namespace {

// Calls that are passed at once. Programs with fewer of them need no thread.
constexpr std::size_t portion_size = 1024;
// Portions that wait at most: a bound of the memory, some 3 MB.
constexpr std::size_t max_portions = 16;

}  // namespace

LineThread::~LineThread() { close(); }

LineRun& LineThread::wait() {
  close();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  call(std::exchange(next_, {}));
  run_.receive(std::exchange(received_, 0));
  return run_;
}

void LineThread::add(const Call& call) {
  next_.push_back(call);
  received_ = 0;
  if (next_.size() < portion_size) return;
  push(std::exchange(next_, {}));
  next_.reserve(portion_size);
}

void LineThread::call(const Portion& portion) {
  for (const Call& one : portion) {
    run_.receive(one.received);
    switch (one.kind) {
      case CallKind::take:
        run_.take(one.line);
        break;
      case CallKind::finish:
        run_.finish();
        break;
      case CallKind::dwell:
        run_.dwell(one.us);
        break;
    }
  }
}

void LineThread::push(Portion portion) {
  if (!thread_.joinable()) {
    is_closed_ = false;
    thread_ = std::thread([this] { work(); });
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return portions_.size() < max_portions; });
  portions_.push_back(std::move(portion));
  lock.unlock();
  changed_.notify_all();
}

/// Of the thread. After a failure portions are dropped, so that the caller never waits.
void LineThread::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !portions_.empty() || is_closed_; });
    if (portions_.empty()) return;
    const Portion portion = std::move(portions_.front());
    portions_.pop_front();
    lock.unlock();
    changed_.notify_all();
    if (failure_) continue;
    try {
      call(portion);
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
}

/// Ends the thread after its last portion.
void LineThread::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

}  // namespace lamplock::program_run
