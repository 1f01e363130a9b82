// What an operator does at the machine between jobs: teach zero, go to it, to where the glass is
// changed, and back ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects
// in glass": Teach zero, Init, Sample position, Restore).
//
// In:  a port to a board that rests; what is wanted. Out: lines of G-code, sent one at a time, each
//      when the one before was answered; where the machine stands.
// Who: `lamplock operate`; `engrave` and `frame`, which ask for the taught zero. Nothing here
// fires.
//
// All of it is kept by the board over power loss: zero is G54, the sample position G28, the place
// to come back to G30. That place is where the machine stood when it left for one of the other two,
// so that going from one to the other does not lose it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/link/dialog.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::link {

enum class Operation : std::uint8_t {
  home,          ///< find the switches
  zero,          ///< teach: zero is where the machine stands
  init,          ///< go to zero
  sample,        ///< go where the glass is changed
  teach_sample,  ///< teach: that is where the machine stands
  restore        ///< go back to where it left from for zero or the sample position
};

/// Places that a board keeps, machine coordinates in mm, one number an axis.
struct Places {
  std::vector<double> machine;  ///< where it stands
  std::vector<double> zero, sample, left;
  /// G92 or a tool length shifts coordinates: zero is not where the machine's zero is.
  bool shifted = false;
};

/// Throws Error(job_failed) for places that are shifted.
void require_unshifted(const Places& places);

/// Asks a board (`$$`, `$I`, `?`, `$#`). Throws Error: no_device (no answer), job_failed (it does
/// not say where it is, or in inches).
Places ask_places(LinePort& port);

/// The lines of an operation for a machine that stands there. `axes`: letters of the axes whose
/// zero is taught, of "XYZA"; empty = all. Throws Error: bad_input for a letter that is no axis of
/// the machine, job_failed for zero and init where coordinates are shifted.
std::vector<std::string> lines_of(Operation operation, const Places& places,
                                  const std::string& axes = {});

/// Throws Error(job_failed) unless the machine rests, so that it can do an operation now; one in
/// alarm may be homed.
void require_ready(LinePort& port, Operation operation);

/// Sends lines and waits until the last one is done. `give_up`: asked all the while, true holds the
/// machine, or resets it while it homes, and ends it. Throws Error: job_failed (refused, alarm),
/// no_device, interrupted.
void run_lines(LinePort& port, const std::vector<std::string>& lines,
               const std::function<bool()>& give_up);

}  // namespace lamplock::link
