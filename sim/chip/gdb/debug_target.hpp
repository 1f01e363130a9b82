// The simulated chip as a debugger sees it: run, step, stop; registers, memory, breakpoints.
//
// In:  commands of the debugger. Out: why the chip stopped, values.
// Who: Stub. While there is a breakpoint, a watchpoint or a step to end, the chip asks before each
//      step of a core (StepWatcher); otherwise it runs as usual. Watching does not change the run:
//      the same instructions at the same cycles. The whole chip has one time: when one core is
//      stepped, the other runs for as many cycles.
//
// A step is one instruction at the core's present exception level: an interrupt that comes first
// runs to its end unless a breakpoint in it stops. A sleeping core is stepped when it wakes.
// BKPT stops a core before the instruction, as halting debug does (ARMv6-M, C1.6); continuing skips
// it, as debug probes do. Without a debugger, or after it has detached, BKPT is a HardFault. A core
// stops before the instruction that makes a watched access. A change of watched memory by another
// master (DMA, functions of the ROM) stops the chip at the next step of a core.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/chip.hpp"

namespace lamplock::sim::chip::gdb {

enum class WatchKind : std::uint8_t { write, read, access };

/// Why a run ended.
struct Stop {
  enum class Reason : std::uint8_t {
    none,  ///< the limit of time was reached
    step,
    software_breakpoint,
    hardware_breakpoint,
    watch
  };
  Reason reason = Reason::none;
  int core = 0;
  std::uint32_t address = 0;  ///< of a watchpoint, as it was set
  WatchKind kind = WatchKind::write;
};

/// One chip under a debugger.
class DebugTarget final : private StepWatcher {
 public:
  /// r0-r12, sp, lr, pc, xpsr, msp, psp, primask, control.
  static constexpr unsigned register_count = 21;

  explicit DebugTarget(Chip& chip);
  ~DebugTarget() override;
  DebugTarget(const DebugTarget&) = delete;
  DebugTarget& operator=(const DebugTarget&) = delete;

  /// Setting an address again has no effect; both kinds stop before the instruction.
  void set_breakpoint(std::uint32_t address, bool hardware);
  void clear_breakpoint(std::uint32_t address, bool hardware);
  void set_watch(std::uint32_t address, std::uint32_t size, WatchKind kind);
  void clear_watch(std::uint32_t address, std::uint32_t size, WatchKind kind);
  /// Removes everything that the debugger has set; the chip then runs as without a debugger.
  void clear_all();

  /// Lets the chip continue; the core in `step`, if any, for one step.
  void resume(std::optional<int> step);
  /// Runs until a stop, or all cores are at `until`.
  Stop run(Cycle until);

  std::uint32_t reg(int core, unsigned number);
  void set_reg(int core, unsigned number, std::uint32_t value);
  /// Reads without side effects, as the core sees it; returns how many of the bytes exist.
  std::size_t read(int core, std::uint32_t address, std::span<std::uint8_t> bytes);
  /// Writes over the bus, in words where possible; false: an access was refused.
  bool write(int core, std::uint32_t address, std::span<const std::uint8_t> bytes);
  /// Erases or programs flash at once: blank, or the given contents.
  bool erase_flash(std::uint32_t address, std::uint32_t size);
  bool program_flash(std::uint32_t address, std::span<const std::uint8_t> bytes);
  /// Power-on reset; both cores stop before their first instruction, if they have one.
  void reset();

  Chip& chip() { return chip_; }

 private:
  struct Breakpoint {
    std::uint32_t address;
    bool hardware;
    bool operator==(const Breakpoint&) const = default;
  };
  struct Watch {
    std::uint32_t address, size;
    WatchKind kind;
    std::vector<std::uint8_t> contents;  ///< as last seen, if it is memory
  };

  bool before_step(Core& core) override;
  bool halt(Core& core, Stop stop);
  bool take_breakpoint(Core& core);
  bool step_ends(const Core& core);
  const Breakpoint* breakpoint_at(std::uint32_t address) const;
  const Watch* watch_before(Core& core);
  const Watch* watch_hit(Core& core);
  const Watch* watch_changed();
  void poll_memory(Watch& watch);
  std::optional<std::uint32_t> register_word(int core, std::uint32_t address);
  void place_filter();

  Chip& chip_;
  std::vector<Breakpoint> breakpoints_;
  std::uint64_t filter_ = 0;  ///< bit (address / 2) % 64: there may be a breakpoint
  std::vector<Watch> watches_;
  std::optional<int> stepping_;
  unsigned step_level_ = 0;               ///< exception number at which the step began
  std::optional<std::uint32_t> stepped_;  ///< address of the instruction, once it has begun
  /// The step before which a watchpoint stopped: it is executed when the run continues.
  struct Passed {
    int core;
    Cycle cycle;
  };
  std::optional<Passed> passed_;
  bool attached_ = false;  ///< a debugger has resumed the chip and not detached
  /// Address of the BKPT at which a core has stopped; it is skipped when the core continues.
  std::array<std::optional<std::uint32_t>, 2> at_breakpoint_;
  Stop stop_;
};

}  // namespace lamplock::sim::chip::gdb
