// Cycles per function and per interrupt.
//
// In:  the frames of a ShadowStack. Out: plain numbers and a text.
// The time of a function is its own, without its callees and without interrupts; that of an
// interrupt is from the beginning of the entry to the last instruction, nested ones included.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/profile/shadow_stack.hpp"

namespace lamplock::sim::chip {

/// Times of one function or interrupt, in cycles.
struct ProfileEntry {
  std::string name;
  std::uint64_t count = 0;
  Cycle total = 0;
  Cycle longest = 0;
  double mean() const {
    return count == 0 ? 0.0 : static_cast<double>(total) / static_cast<double>(count);
  }
};

/// The profile of one core.
class Profile final : private StackView {
 public:
  /// Must live as long as the core runs with the stack as its listener.
  explicit Profile(ShadowStack& stack);
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  /// Results so far: functions by their time, exceptions by number. Entries without a call are
  /// omitted.
  std::vector<ProfileEntry> functions() const;
  std::vector<ProfileEntry> exceptions() const;
  /// Cycles since the beginning, and those asleep: the others are those of functions().
  Cycle cycles() const { return stack_.cycles(); }
  Cycle asleep() const { return stack_.asleep(); }
  /// Longest time with PRIMASK set.
  Cycle max_masked() const { return max_masked_; }
  /// The whole profile as a table, with the `lines` most expensive functions.
  std::string text(std::size_t lines = 40) const;

 private:
  void entered(const ShadowFrame& /*frame*/) override {}
  void left(const ShadowFrame& frame) override;
  void handled(unsigned exception, Cycle cycles) override;
  void masked(bool interrupts_off, Cycle at) override;

  const ShadowStack& stack_;
  std::vector<ProfileEntry> entries_;  ///< one for each function, and one for code without a symbol
  std::array<ProfileEntry, 48> exceptions_{};
  bool masked_ = false;
  Cycle masked_since_ = 0, max_masked_ = 0;
};

/// Measures the depth of a stack: fills it with a pattern and looks for changes.
class StackGauge {
 public:
  /// The stack's memory, `low` to `high`, in SRAM; throws std::invalid_argument otherwise.
  StackGauge(std::string name, Bus& bus, std::uint32_t low, std::uint32_t high);
  /// Fills the memory; must be called before the program starts.
  void fill();
  const std::string& name() const { return name_; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(memory_.size()); }
  /// Maximum of bytes used so far; size() may mean an overflow.
  std::uint32_t used() const;

 private:
  std::string name_;
  std::span<std::uint8_t> memory_;
};

}  // namespace lamplock::sim::chip
