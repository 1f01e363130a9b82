// Functions that a core has called and not returned from, each with its own cycles.
//
// In:  CoreListener's calls; the symbols of the image, if it has some.
// Out: frames as they begin and end, reported to the views (Profile, CallStacks).
//
// Calls by BL and BLX; returns by BX and POP to the place of a call. Any other jump by these to
// another function replaces the frame; without a symbol only a jump to another memory does (from
// the ROM to the second-stage boot, from there to the program). A plain branch to another function
// counts for the caller. Sleep counts for no function.
// Below `deepest` frames a call is taken as a jump, so that the stack of a program that never
// returns (one that switches stacks) stays bounded. A reset of the chip ends all handlers without a
// report: the next call of a core in thread mode is in none of them.
// Costs nothing unless the core listens to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/profile/function_table.hpp"

namespace lamplock::sim::chip {

/// A function that runs or waits for the one it called.
struct ShadowFrame {
  std::uint32_t function = 0;  ///< its symbol's address; without a symbol where it was entered
  std::size_t symbol = 0;      ///< in the FunctionTable; its size(): none
  std::uint32_t back = 0;      ///< where it returns to; 0: not known
  unsigned exception = 0;      ///< number, of the frame of an exception
  Cycle since = 0;             ///< when it was entered
  Cycle own = 0;               ///< its own time so far
};

/// Receives frames and their time.
class StackView {
 public:
  virtual ~StackView() = default;
  /// The frame is on top now.
  virtual void entered(const ShadowFrame& frame) = 0;
  /// The frame that was on top is over.
  virtual void left(const ShadowFrame& frame) = 0;
  /// A handler has returned, these cycles after its entry began.
  virtual void handled(unsigned /*exception*/, Cycle /*cycles*/) {}
  /// PRIMASK has changed.
  virtual void masked(bool /*interrupts_off*/, Cycle /*at*/) {}
};

/// The frames of one core, whose listener it is.
class ShadowStack final : public CoreListener {
 public:
  static constexpr std::size_t deepest = 256;

  ShadowStack(Core& core, std::span<const ImageSymbol> symbols);
  ~ShadowStack() override;
  ShadowStack(const ShadowStack&) = delete;
  ShadowStack& operator=(const ShadowStack&) = delete;

  /// Reports to a view from now on, starting with the present frames; it must live as long as this
  /// object receives calls.
  void add(StackView& view);
  const FunctionTable& functions() const { return functions_; }
  const Core& core() const { return core_; }
  /// The frames with their time up to the core's present cycle, the outermost first.
  std::vector<ShadowFrame> frames() const;
  /// Cycles up to the present, and how many of them asleep.
  Cycle cycles() const { return core_.cycle() - first_; }
  Cycle asleep() const { return asleep_ + (sleeping_ ? not_charged() : 0); }

  void exception_entered(int core, unsigned number, Cycle since, Cycle at) override;
  void exception_left(int core, unsigned number, Cycle at) override;
  void called(int core, std::uint32_t from, std::uint32_t to, Cycle at) override;
  void branched(int core, std::uint32_t to, Cycle at) override;
  void slept(int core, Cycle at) override;
  void woke(int core, Cycle at) override;
  void masked(int core, bool interrupts_off, Cycle at) override;

 private:
  ShadowFrame frame_at(std::uint32_t address, Cycle since) const;
  Cycle not_charged() const { return core_.cycle() > last_ ? core_.cycle() - last_ : 0; }
  void charge(Cycle at);
  void push(const ShadowFrame& frame);
  void pop_to(std::size_t depth);
  void jump(const ShadowFrame& to);
  void leave_stale_exceptions();

  Core& core_;
  FunctionTable functions_;
  std::vector<StackView*> views_;
  std::vector<ShadowFrame> frames_;
  Cycle first_, last_;
  Cycle asleep_ = 0;
  bool sleeping_ = false;
};

}  // namespace lamplock::sim::chip
