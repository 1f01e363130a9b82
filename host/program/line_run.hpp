// Runs lines through the firmware's line planner as the board feeds it (line_work.hpp): a plan
// depends on the lines and on their number in the queue when a batch is planned.
//
// In:  lines with their number of bytes on the cable; dwells; changes of the overrides. It starts
//      at machine zero, at rest.
// Out: the ticks in which the machine is in motion, exactly; the tick at which each line ends, to a
//      batch. Who: programs of G-code (program_run.hpp), rows of pixels (host/raster).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/machine/runners/line_work.hpp"
#include "host/program/speed_change.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

/// One run.
class LineRun {
 public:
  /// Throws Error(bad_input) for a machine that cannot move.
  explicit LineRun(const settings::Values& values);

  /// This number of bytes arrives over the cable.
  void receive(std::size_t bytes);
  void take(const motion::LineTarget& line);
  /// Runs until the machine is at rest.
  void finish();
  void dwell(std::uint32_t us);
  /// Changes of the overrides, in the order of their times, which count from now.
  void change_speed(std::vector<SpeedChange> changes);
  /// Ticks in motion.
  std::uint64_t ticks() const { return ticks_; }
  /// ticks() at the end of each line, in the order of the lines; for lines with the numbers 1,
  /// 2, 3... (LineTarget::line) only.
  const std::vector<std::uint64_t>& line_ends() const { return line_ends_; }

 private:
  void round();
  machine::LineOrders orders() const;
  void note_ends();

  /// The laser power along a line does not change its motion.
  const stepper::PowerTable no_powers_;
  std::unique_ptr<machine::LineWork> work_ = std::make_unique<machine::LineWork>();
  std::size_t bytes_ = 0;  ///< received in this round
  std::uint64_t now_ = 0, end_ = 0, ticks_ = 0;
  std::uint64_t dwelt_ticks_ = 0, changes_begin_ = 0;  ///< changes_begin_: of motion and dwells
  std::vector<SpeedChange> changes_;
  std::uint32_t last_line_ = 0;  ///< highest number taken
  std::vector<std::uint64_t> line_ends_;
};

}  // namespace lamplock::program_run
