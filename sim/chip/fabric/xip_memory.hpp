// The flash as the bus sees it at 0x10000000 to 0x13ffffff: through the cache, at the cost of the
// serial interface (RP2040 datasheet, 2.6.3).
//
// In:  accesses of the masters; settings of XIP_CTRL; whether the SSI can read, and the time that a
//      line takes.
// Out: values and wait states: none for a hit, the SSI's transfer of a line for a miss, and for a
//      second master the rest of the first one's wait, or of a streamed word; faults.
// The time of a miss beyond the clocks of the transfer itself is not documented and assumed to be
// 0. It is also assumed that an access which does not allocate transfers a whole line.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/flash_use.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/xip_cache.hpp"
#include "sim/chip/fabric/xip_stream.hpp"

namespace lamplock::sim::chip {

/// One port on the crossbar: accesses of two masters follow each other.
class XipMemory {
 public:
  /// `flash`: size is a power of two; it repeats. `line_fill` in cycles of clk_sys.
  XipMemory(std::span<std::uint8_t> flash, std::function<std::uint32_t()> line_fill,
            XipStream& stream, NotModelled not_modelled);

  /// The SSI can read the flash. A line in the cache can be read even if it cannot.
  void set_readable(bool on) { readable_ = on; }
  /// XIP_CTRL CTRL.
  void set_enabled(bool on) { enabled_ = on; }
  void set_bad_write_fault(bool on) { bad_write_fault_ = on; }
  /// Takes flush_cycles, during which accesses wait.
  void flush(Cycle at);
  bool flushing(Cycle at) const { return at < flush_end_; }
  /// Cycles that an access which begins at `at` waits for the flush to be done.
  std::uint32_t flush_wait(Cycle at) const;

  /// Registers behind the same port (XIP_CTRL, the SSI's): cycles that an access which begins at
  /// `at` waits for another master's.
  std::uint32_t port_wait(Master master, Cycle at) const {
    const bool taken = master != holder_ && at >= begin_ && at < end_;
    return taken ? static_cast<std::uint32_t>(end_ - at) : 0;
  }

  Access read(std::uint32_t address, Width width, Master master, Cycle at);
  /// Writes never reach the flash: through the first alias they drop the line, through the others
  /// they are refused or ignored.
  Access write(std::uint32_t address, Master master, Cycle at);

  /// The flash itself at an address; empty while the SSI cannot read it.
  std::span<std::uint8_t> flash_at(std::uint32_t address) const;
  XipCache& cache() { return cache_; }
  /// Counts the reads from now on; null: none.
  void count_use(FlashUse* use) { use_ = use; }

  /// The tags are cleared one set a cycle: "just over 1024 clock cycles" (2.6.3.2).
  static constexpr Cycle flush_cycles = XipCache::set_count;

 private:
  std::uint32_t occupy(Master master, Cycle at, Cycle transfer);

  std::span<std::uint8_t> flash_;
  std::function<std::uint32_t()> line_fill_;
  XipStream& stream_;
  NotModelled not_modelled_;
  XipCache cache_;
  FlashUse* use_ = nullptr;
  bool readable_ = false;
  bool enabled_ = true;
  bool bad_write_fault_ = true;
  Cycle flush_end_ = 0;
  Master holder_ = Master::core0;  ///< of the port, the last of those since begin_
  Cycle begin_ = 0, end_ = 0;      ///< the port is in use from cycle begin_ to end_ - 1
};

}  // namespace lamplock::sim::chip
