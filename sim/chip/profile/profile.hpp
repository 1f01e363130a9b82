// Where the cycles go: per function and per interrupt, from what a core tells of its calls.
//
// In:  CoreListener's calls; the symbols of the image. Out: plain numbers and a text.
// Functions: calls by BL and BLX, returns by BX and POP; the time of a function is its own, without
// what it called and without interrupts. A tail call by a plain branch counts for the caller.
// Interrupts: from the beginning of the entry to the last instruction, nested ones included.
// Costs nothing unless the core listens to it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/bus.hpp"
#include "sim/chip/cpu/core.hpp"
#include "sim/chip/image/image.hpp"

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
class Profile final : public CoreListener {
 public:
  /// Listens to `core`, whose listener it becomes; `symbols` of the image, and more (of the ROM).
  Profile(Core& core, std::span<const ImageSymbol> symbols);
  ~Profile() override;
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  /// Begins again, from the core's present cycle.
  void clear();
  /// What there is so far: functions by their time, exceptions by number. Entries without a call
  /// are left out.
  std::vector<ProfileEntry> functions() const;
  std::vector<ProfileEntry> exceptions() const;
  /// Cycles since clear(), and how many of them asleep.
  Cycle cycles() const;
  Cycle asleep() const { return asleep_; }
  /// Longest time with PRIMASK set.
  Cycle longest_masked() const { return longest_masked_; }
  /// All of it as a table, the `lines` costliest functions.
  std::string text(std::size_t lines = 40) const;

  void exception_entered(int core, unsigned number, Cycle since, Cycle at) override;
  void exception_left(int core, unsigned number, Cycle at) override;
  void called(int core, std::uint32_t from, std::uint32_t to, Cycle at) override;
  void branched(int core, std::uint32_t to, Cycle at) override;
  void slept(int core, Cycle at) override;
  void woke(int core, Cycle at) override;
  void masked(int core, bool interrupts_off, Cycle at) override;

 private:
  /// What runs or waits for its callee.
  struct Frame {
    std::size_t function = 0;
    std::uint32_t back = 0;  ///< where it returns to; 0: not known
    Cycle own = 0;           ///< its own time so far
    unsigned exception = 0;  ///< number, of the frame of an exception
    Cycle since = 0;
  };
  std::size_t function_at(std::uint32_t address) const;
  void charge(Cycle at);
  void push(std::size_t function, std::uint32_t back, unsigned exception, Cycle since);
  void pop();

  Core& core_;
  std::vector<ImageSymbol> symbols_;   ///< functions by address
  std::vector<ProfileEntry> entries_;  ///< one each, and the last for what has no symbol
  std::array<ProfileEntry, 48> exceptions_{};
  std::vector<Frame> frames_;
  Cycle first_ = 0, last_ = 0;
  Cycle asleep_ = 0;
  bool sleeping_ = false;
  bool masked_ = false;
  Cycle masked_since_ = 0, longest_masked_ = 0;
};

/// Measures how far down a stack has grown: fills it with a pattern and looks for what changed.
class StackGauge {
 public:
  /// The stack's memory, `low` to `high`, in SRAM; throws std::invalid_argument otherwise.
  StackGauge(std::string name, Bus& bus, std::uint32_t low, std::uint32_t high);
  /// Fills everything; before the program starts.
  void fill();
  const std::string& name() const { return name_; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(memory_.size()); }
  /// Bytes used at most so far; size() may mean that it ran over.
  std::uint32_t used() const;

 private:
  std::string name_;
  std::span<std::uint8_t> memory_;
};

}  // namespace lamplock::sim::chip
