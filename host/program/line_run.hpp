// Lines on their way through the firmware's line planner as the board feeds it (line_work.hpp): how
// many it knows of when it plans a batch is what a plan depends on beside the lines themselves.
//
// In:  lines, and how many bytes of the cable they were; dwells. It starts at machine zero, at
// rest. Out: the ticks that the machine is in motion, to the tick. Who: programs of G-code
// (program_run.hpp), rows of pixels (host/raster).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "firmware/machine/line_work.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

/// One run.
class LineRun {
 public:
  /// Throws Error(bad_input) for a machine that cannot move.
  explicit LineRun(const settings::Values& values);

  /// So many bytes come over the cable.
  void receive(std::size_t bytes);
  void take(const motion::LineTarget& line);
  /// Lets the machine come to rest.
  void finish();
  void dwell(std::uint32_t us);
  /// In motion.
  std::uint64_t ticks() const { return ticks_; }

 private:
  void round();

  /// What the laser does along a line does not change how it is run.
  const stepper::PowerTable no_powers_;
  std::unique_ptr<machine::LineWork> work_ = std::make_unique<machine::LineWork>();
  std::size_t bytes_ = 0;  ///< that have come in this round
  std::uint64_t now_ = 0, end_ = 0, ticks_ = 0;
};

}  // namespace lamplock::program_run
