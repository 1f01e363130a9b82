// Runs one computation in the background, for a caller that must not wait.
//
// In:  a function that uses nothing of the caller. Out: its result, once.
// Who: remaining times of jobs and programs; the server, for its computations and its history.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <utility>

namespace lamplock::run {

/// Its destructor waits for the end of the computation.
template <class Result>
class Background {
 public:
  /// A computation was begun, and its result not taken.
  bool is_busy() const { return future_.valid(); }
  /// Only while it is not busy.
  void start(std::function<Result()> work) {
    future_ = std::async(std::launch::async, std::move(work));
  }
  /// The result of a computation that has ended. Throws what the computation has thrown.
  std::optional<Result> take() {
    if (!is_busy() || future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      return std::nullopt;
    return future_.get();
  }

 private:
  std::future<Result> future_;
};

}  // namespace lamplock::run
