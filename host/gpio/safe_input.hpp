// A safety input: a contact that must be closed, debounced.
//
// In:  a line, the time. Out: whether the input is well. Who: the guard.
//
// The input trips at once, by one read of the active level or one edge since the last read; it is
// released after the debounce time without either. On chips without edges a pulse shorter than the
// time between two reads may be missed. A line that can no longer be read is never well again.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// One input over the time of a job.
class SafeInput {
 public:
  using Time = std::chrono::microseconds;

  /// Not well until poll() was called for the debounce time.
  SafeInput(std::unique_ptr<Input> input, std::string place, Time debounce)
      : input_(std::move(input)), place_(std::move(place)), debounce_(debounce) {}

  /// Call it in every round. `now`: any monotonic clock.
  void poll(Time now);

  bool well() const { return well_; }
  /// The chip is unplugged.
  bool lost() const { return lost_; }
  /// The place of the request, for texts.
  const std::string& place() const { return place_; }

 private:
  std::unique_ptr<Input> input_;
  std::string place_;
  Time debounce_;
  Time quiet_since_{};
  bool polled_ = false, well_ = false, lost_ = false;
};

}  // namespace lamplock::gpio
