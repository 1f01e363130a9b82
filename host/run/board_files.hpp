// Files about what a simulated board did, whole or not there: pins as VCD, shots as CSV.
//
// In:  a board, while it runs or afterwards. Out: the files. Who: jobs on simulated boards, `sim`.
#pragma once

#include <filesystem>
#include <fstream>

#include "host/file/staged_file.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"
#include "sim/board.hpp"
#include "sim/trace/vcd.hpp"

namespace lamplock::run {

/// Traces a board from now on. Without finish() there is no file.
class PinTrace {
 public:
  /// Throws Error(bad_input) if the file cannot be written. The board must outlive the trace's use.
  PinTrace(const std::filesystem::path& file, sim::Board& board);

  /// The trace ends at the board's present time. Throws Error(bad_input) if the disk is full.
  void finish();

 private:
  sim::Board& board_;
  StagedFile file_;
  std::ofstream stream_;
  sim::VcdWriter writer_;
};

/// Resolution of every axis, steps/mm.
PerAxis<double> steps_per_mm(const settings::Values& values);

/// Writes the shots of a board with these settings, whatever they were fired for. Throws
/// Error(bad_input).
void write_shots(const std::filesystem::path& file, const sim::Board& board,
                 const settings::Values& values);

}  // namespace lamplock::run
