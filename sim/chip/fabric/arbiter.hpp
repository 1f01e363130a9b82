// Which master gets a port of the crossbar when two request it in the same cycle (RP2040 datasheet,
// 2.1.1).
//
// In:  accesses in the order of the simulation, which is not exactly the order of time; priorities
//      from BUSCTRL.
// Out: the cycles that an access waits for its port, and the cycles that an access granted earlier
//      must add because another one goes first; counts of contested accesses.
// Rules: high priority before low; between equals the master whose last access to the port is older
// (2.1.1.1 says only round-robin: the turns of three masters, and that among those that never had
// the port the lower number goes first, are assumed). An access that has begun is not interrupted.
// The loser of a clash on SRAM takes one cycle more, as measured with two cores in step (Z.
// Madaoui, rp2040-experiments, bus_behavior). Used only while there are two masters:
// Bus::contend(). XIP has its own rule: XipMemory.
// Not modelled: counts of accesses without a clash.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// Ports in the order of the events of BUSCTRL PERFSEL: 2 n contested accesses, 2 n + 1 all.
enum class BusPort : std::uint8_t {
  apb,
  fast_peripherals,
  sram5,
  sram4,
  sram3,
  sram2,
  sram1,
  sram0,
  xip,
  rom
};
inline constexpr std::size_t bus_port_count = 10;

/// The four upstream ports, in the order of BUSCTRL BUS_PRIORITY's fields.
enum class Requester : std::uint8_t { core0, core1, dma_read, dma_write };

class Arbiter {
 public:
  /// Bits 0, 4, 8, 12: high priority of core 0, core 1, DMA reads, DMA writes.
  void set_priorities(std::uint32_t bus_priority) { priorities_ = bus_priority; }

  /// Requests a port for `cycles` cycles from `at` on; returns the cycles that the access waits
  /// before.
  std::uint32_t request(BusPort port, Requester requester, Cycle at, std::uint32_t cycles) {
    Port& here = ports_[static_cast<std::size_t>(port)];
    const auto me = static_cast<std::size_t>(requester);
    if (at <= here.latest && occupant(here, me, at) != no_master) [[unlikely]]
      return clash(here, me, at, cycles);
    here.users[me].occupy(at, cycles);
    here.latest = std::max(here.latest, at + cycles - 1);
    return 0;
  }
  /// Sets `flag` whenever that master owes cycles.
  void attach_flag(Requester requester, bool& flag) {
    flags_[static_cast<std::size_t>(requester)] = &flag;
  }
  /// Cycles that a master must add because an access of another one was served first.
  bool owes(Requester requester) const { return owed_[static_cast<std::size_t>(requester)] != 0; }
  std::uint32_t take_owed(Requester requester) {
    return std::exchange(owed_[static_cast<std::size_t>(requester)], 0);
  }

  std::uint32_t contested(BusPort port) const {
    return ports_[static_cast<std::size_t>(port)].contested;
  }

 private:
  static constexpr std::size_t no_master = 4;
  static constexpr int max_moves = 64;
  /// The cycles in which a master has a port: a bit for each, bit 0 the latest.
  struct User {
    std::uint64_t bits = 0;
    Cycle latest = 0;
    Cycle begun = 0, before = 0;  ///< the last two accesses
    std::uint32_t length = 0;     ///< of the last one
    bool has(Cycle at) const {
      return at <= latest && latest - at < 64 && (bits >> (latest - at) & 1u) != 0;
    }
    void occupy(Cycle start, std::uint32_t cycles) {
      before = std::exchange(begun, start);
      length = cycles;
      mark(start);
      for (std::uint32_t i = 1; i < cycles; ++i) mark(start + i);
    }
    /// True if an access begins then: the last one, or one of a list of words, a cycle each.
    bool begins(Cycle at) const { return begun == at || length == 1; }
    /// The cycle of the access before the one that begins then.
    Cycle before_that(Cycle at) const {
      if (begun < at) return begun;
      if (before < at) return before;
      const Cycle back = latest - at + 1;
      const std::uint64_t older = back < 64 ? bits >> back : 0;
      return older != 0 ? at - 1 - static_cast<Cycle>(std::countr_zero(older)) : 0;
    }
    /// The access that begins then takes place later. The recorded cycles of following words do not
    /// move: their delay shows in the next accesses.
    void put_off(Cycle at, std::uint32_t cycles) {
      for (std::uint32_t i = 0; i < length; ++i) clear(at + i);
      if (begun == at) begun += cycles;
      for (std::uint32_t i = 0; i < length; ++i) mark(at + cycles + i);
    }
    void clear(Cycle at) {
      if (at <= latest && latest - at < 64) bits &= ~(std::uint64_t{1} << (latest - at));
    }
    void mark(Cycle at) {
      if (at > latest) {
        bits = at - latest < 64 ? bits << (at - latest) : 0;
        latest = at;
      }
      if (latest - at < 64) bits |= std::uint64_t{1} << (latest - at);
    }
  };
  struct Port {
    std::array<User, 4> users{};
    Cycle latest = 0;  ///< latest cycle of any master
    std::uint32_t contested = 0;
  };

  static std::size_t occupant(const Port& port, std::size_t me, Cycle at) {
    for (std::size_t other = 0; other < port.users.size(); ++other)
      if (other != me && port.users[other].has(at)) return other;
    return no_master;
  }
  bool high(std::size_t requester) const { return (priorities_ >> (4 * requester) & 1u) != 0; }
  /// Decides between two accesses that began in the same cycle, one of which already has the port.
  bool wins(const Port& port, std::size_t me, std::size_t granted, Cycle at) const {
    if (high(me) != high(granted)) return high(me);
    const Cycle mine = port.users[me].begun, its = port.users[granted].before_that(at);
    return mine != its ? mine < its : me < granted;
  }

  /// Another master has the port in that cycle.
  [[gnu::noinline]] std::uint32_t clash(Port& here, std::size_t me, Cycle at,
                                        std::uint32_t cycles) {
    Cycle start = at;
    for (int moved = 0; moved < max_moves; ++moved) {
      const std::size_t other = occupant(here, me, start);
      if (other == no_master) break;
      if (start == at && here.users[other].begins(at) && wins(here, me, other, at)) {
        owed_[other] += cycles;
        if (flags_[other] != nullptr) *flags_[other] = true;
        here.users[other].put_off(at, cycles);
        here.latest = std::max(here.latest, here.users[other].latest);
        break;
      }
      ++start;
    }
    ++here.contested;
    here.users[me].occupy(start, cycles);
    here.latest = std::max(here.latest, here.users[me].latest);
    return static_cast<std::uint32_t>(start - at);
  }

  std::array<Port, bus_port_count> ports_{};
  std::array<std::uint32_t, 4> owed_{};
  std::array<bool*, 4> flags_{};
  std::uint32_t priorities_ = 0;
};

}  // namespace lamplock::sim::chip
