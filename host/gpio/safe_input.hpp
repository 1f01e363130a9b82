// An input that protects: a contact that has to be closed, its bouncing left out.
//
// In:  a line, the time. Out: whether all is well. Who: the guard.
//
// The two directions are not alike. One look at the active level, or one edge since the last look,
// and the input has tripped at once; it is released when it was quiet for the debounce time. Chips
// without edges have the looks only: what is shorter than the time between two of them may be
// missed. A line that cannot be read any more is not well, for good.
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

  /// Not well until it has been looked at for the debounce time.
  SafeInput(std::unique_ptr<Input> input, std::string place, Time debounce)
      : input_(std::move(input)), place_(std::move(place)), debounce_(debounce) {}

  /// To be called all the while. `now`: any clock that does not go back.
  void look(Time now);

  bool well() const { return well_; }
  /// The chip is gone.
  bool lost() const { return lost_; }
  /// As it was asked for, for texts.
  const std::string& place() const { return place_; }

 private:
  std::unique_ptr<Input> input_;
  std::string place_;
  Time debounce_;
  Time quiet_since_{};
  bool looked_ = false, well_ = false, lost_ = false;
};

}  // namespace lamplock::gpio
