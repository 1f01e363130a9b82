// Which exceptions of a core are pending, enabled and active, and which one is next (ARMv6-M
// Architecture Reference Manual, B1.5 and B3.4).
//
// In:  levels of the interrupt lines, requests of the core itself, writes to NVIC registers.
// Out: the exception that would be taken next, and the priority the core executes at.
// Numbers are exception numbers: 2 NMI, 3 HardFault, 11 SVCall, 14 PendSV, 15 SysTick, 16.. lines.
// All 32 lines have latches; those from 26 on are never driven and can be pended by software.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace lamplock::sim::chip {

enum class Exception : std::uint8_t {
  none = 0,
  reset = 1,
  nmi = 2,
  hard_fault = 3,
  svcall = 11,
  pendsv = 14,
  systick = 15,
  irq0 = 16
};
constexpr unsigned number_of(Exception exception) { return static_cast<unsigned>(exception); }

/// Exception states of one core.
class Nvic {
 public:
  static constexpr unsigned exception_count = 16 + 32;
  /// Priority of the thread with nothing active and nothing masked: below all others (3).
  static constexpr int thread_priority = 4;

  void reset() { *this = Nvic(); }

  /// Samples the lines. A line pends its interrupt when it rises, and as long as it is high and the
  /// interrupt is not active; a pending interrupt remains pending when the line falls. True if an
  /// interrupt became pending (for SEVONPEND).
  bool sample(std::uint32_t levels) {
    const std::uint32_t rising = levels & ~levels_;
    levels_ = levels;
    const std::uint64_t before = pending_;
    pending_ |= lines(rising) | (lines(levels) & ~active_);
    return pending_ != before;
  }

  void pend(unsigned number) { pending_ |= bit(number); }
  /// Clears the pending state; a line that is still high and not active pends its interrupt again.
  void unpend(unsigned number) { unpend_all(bit(number)); }
  bool pending(unsigned number) const { return (pending_ & bit(number)) != 0; }
  bool active(unsigned number) const { return (active_ & bit(number)) != 0; }
  unsigned active_count() const { return static_cast<unsigned>(std::popcount(active_)); }
  bool any_line_pending() const { return (pending_ >> 16) != 0; }

  /// Pending becomes active.
  void activate(unsigned number) {
    pending_ &= ~bit(number);
    active_ |= bit(number);
    find_active_priority();
  }
  void deactivate(unsigned number) {
    active_ &= ~bit(number);
    pending_ |= lines(levels_) & bit(number);
    find_active_priority();
  }

  int priority(unsigned number) const { return priorities_[number]; }
  /// 0..3; fixed for NMI and HardFault.
  void set_priority(unsigned number, unsigned priority) {
    priorities_[number] = static_cast<std::int8_t>(priority & 3);
    find_active_priority();
  }
  /// Priority of the active exceptions, without PRIMASK.
  int active_priority() const { return active_priority_; }

  /// The pending and enabled exception of the highest priority, of equal ones the lowest number; 0:
  /// none.
  unsigned best() const {
    std::uint64_t candidates = pending_ & enabled_;
    unsigned best = 0;
    while (candidates != 0) {
      const auto number = static_cast<unsigned>(std::countr_zero(candidates));
      candidates &= candidates - 1;
      if (best == 0 || priorities_[number] < priorities_[best]) best = number;
    }
    return best;
  }

  // The registers: one bit for each line.
  std::uint32_t enabled_lines() const { return static_cast<std::uint32_t>(enabled_ >> 16); }
  std::uint32_t pending_lines() const { return static_cast<std::uint32_t>(pending_ >> 16); }
  void enable_lines(std::uint32_t mask) { enabled_ |= lines(mask); }
  void disable_lines(std::uint32_t mask) { enabled_ &= ~lines(mask); }
  void pend_lines(std::uint32_t mask) { pending_ |= lines(mask); }
  void unpend_lines(std::uint32_t mask) { unpend_all(lines(mask)); }

 private:
  static constexpr std::uint64_t bit(unsigned number) { return std::uint64_t{1} << number; }
  static constexpr std::uint64_t lines(std::uint32_t mask) { return std::uint64_t{mask} << 16; }
  void unpend_all(std::uint64_t mask) {
    pending_ &= ~mask;
    pending_ |= mask & lines(levels_) & ~active_;
  }
  void find_active_priority() {
    active_priority_ = thread_priority;
    for (std::uint64_t left = active_; left != 0; left &= left - 1) {
      const int priority = priorities_[static_cast<unsigned>(std::countr_zero(left))];
      if (priority < active_priority_) active_priority_ = priority;
    }
  }

  std::uint64_t pending_ = 0;
  std::uint64_t active_ = 0;
  std::uint64_t enabled_ = 0xffff;  ///< exceptions of the system cannot be disabled
  std::uint32_t levels_ = 0;
  int active_priority_ = thread_priority;
  std::array<std::int8_t, exception_count> priorities_{0, -3, -2, -1};
};

}  // namespace lamplock::sim::chip
