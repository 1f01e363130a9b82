// One expectation of a script while it is open.
//
// In:  the edges of pads and the bytes of ports so far, up to the present cycle.
// Out: open, met (and when), or not met (and what was seen instead).
// Who: the runner, which calls poll() at due() after everything up to then is known.
#pragma once

#include <memory>
#include <string>

#include "sim/chip/script/pad_log.hpp"
#include "sim/chip/script/serial_ports.hpp"

namespace lamplock::sim::chip::script {

/// Maximum delay in simulated time until an edge is found: the interval at which a script polls.
inline constexpr Picoseconds poll_interval = ps_per_us;
/// Wait at the end of a window for the instruction in progress to finish its access.
inline constexpr Cycle settle_cycles = 16;

/// Result so far.
struct CheckResult {
  enum class State : std::uint8_t { open, met, failed };
  State state = State::open;
  Moment at{};       ///< met or failed: when
  std::string seen;  ///< failed: what was seen
};

/// State that checks read.
struct Scene {
  const Chip& chip;
  PadLog& pads;
  SerialPorts& ports;
  const TimeWheel& wheel() const { return chip.wheel(); }
};

class Check {
 public:
  virtual ~Check() = default;
  /// Checks with everything before cycle `now` known.
  virtual CheckResult poll(Cycle now) = 0;
  /// Cycle of the next poll, later than `now`.
  virtual Cycle due(Cycle now) const = 0;
  /// Edges before this cycle are not needed any more.
  virtual Cycle needs_from() const = 0;
};

/// The check for an expectation that begins at `start`; null for a step without an expectation.
std::unique_ptr<Check> make_check(const Action& action, const Scene& scene, const Moment& start);
/// The pads whose edges an action uses.
std::uint32_t pins_of(const Action& action);

}  // namespace lamplock::sim::chip::script
