// How fast a line of pixels may be run: the processor has time for so many runs a second.
//
// In:  the lengths of the runs of a list (runs.hpp), in cells. Out: the minimum time of the
//      line. Who: the board's power table, as runs arrive; the host, to predict the same time.
//
// All cells of a list are equally long, so the shortest 32 runs in succession limit the speed of
// the whole line. Fewer are no load: motion is handed out earlier than they take.
#pragma once

#include <array>
#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::wire {

/// Average time of a run in which the fill interrupt divides it into steps of power, and the main
/// loop reads the next one. Measured on the simulated chip in frames (docs/testing.md, pixels a
/// second): at 125 MHz the board keeps up with 22 000 runs a second, 45 us each, and not with
/// 24 000; at 200 MHz with 28 000.
inline constexpr std::uint32_t min_run_us = clock_hz == 200'000'000 ? 33 : 48;

class RunPace {
 public:
  void begin_list() { runs_ = cells_ = cells_in_window_ = 0, min_window_cells_ = ~0u; }
  /// At most 65535 cells in all.
  void add(std::uint32_t cells) {
    std::uint16_t& slot = window_[runs_ % window];
    cells_in_window_ += cells;
    if (runs_ >= window) cells_in_window_ -= slot;
    slot = static_cast<std::uint16_t>(cells);
    ++runs_;
    cells_ += cells;
    if (runs_ >= window && cells_in_window_ < min_window_cells_)
      min_window_cells_ = cells_in_window_;
  }
  /// Of a line with this list.
  std::uint32_t min_us() const {
    if (runs_ < window) return runs_ * min_run_us;
    return cells_ * (window * min_run_us) / min_window_cells_;
  }

 private:
  static constexpr std::uint32_t window = 32;
  static_assert(std::uint64_t{0xffff} * window * min_run_us <= ~0u);

  std::array<std::uint16_t, window> window_{};  ///< cells of the last runs
  std::uint32_t runs_ = 0, cells_ = 0;
  std::uint32_t cells_in_window_ = 0, min_window_cells_ = ~0u;
};

}  // namespace lamplock::wire
