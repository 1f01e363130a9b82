// Operations at the machine between jobs: teach zero, move to zero, to the sample position (where
// the glass is changed), and back ("Mechatronic positioning of a pulsed laser beam in devices
// forming 3-D objects in glass": Teach zero, Init, Sample position, Restore).
//
// In:  a port to an idle board; the operation. Out: lines of G-code, each sent after the answer to
//      the one before; the position of the machine.
// Who: `lamplock operate`; `engrave` and `frame`, which ask for the taught zero. No operation
// fires.
//
// The board keeps the positions over power loss: zero is G54, the sample position G28, the position
// to return to G30. G30 is stored when the machine leaves for one of the other two, except between
// these two, which would lose it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/link/dialog.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::link {

enum class Operation : std::uint8_t {
  home,          ///< home the axes
  zero,          ///< teach the current position as zero
  init,          ///< move to zero
  sample,        ///< move to the sample position
  teach_sample,  ///< teach the current position as the sample position
  restore        ///< move back to the position before init or sample
};

/// Positions that a board stores, machine coordinates in mm, one number per axis.
struct Places {
  std::string state;            ///< of the board: "Idle", "Alarm"
  std::vector<double> machine;  ///< current position
  std::vector<double> zero, sample, left;
  /// G92 or a tool length shifts coordinates: zero is not where the machine's zero is.
  bool shifted = false;
};

/// Throws Error(job_failed) if coordinates are shifted.
void require_unshifted(const Places& places);

/// Asks a board (`$$`, `$I`, `?`, `$#`). Throws Error: no_device (no answer), job_failed (it does
/// not report its position, or in inches).
Places ask_places(LinePort& port);

/// The lines of an operation for a machine at places.machine. `axes`: letters of the axes whose
/// zero is taught, of "XYZA"; empty = all. Throws Error: bad_input for a letter that is no axis of
/// the machine, job_failed for zero and init where coordinates are shifted.
std::vector<std::string> lines_of(Operation operation, const Places& places,
                                  const std::string& axes = {});

/// Throws Error(job_failed) unless the machine is idle; a machine in alarm may be homed.
void require_ready(LinePort& port, Operation operation);

/// Sends lines and waits until the last one is done. `is_cancelled` is called every round; true
/// holds the machine, or resets it while it homes, and ends the call. Throws Error: job_failed
/// (refused, alarm), no_device, interrupted.
void run_lines(LinePort& port, const std::vector<std::string>& lines,
               const std::function<bool()>& is_cancelled);

}  // namespace lamplock::link
