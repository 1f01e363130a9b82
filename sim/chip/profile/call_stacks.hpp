// Where the cycles go, by the whole way that led there: what flame graphs are drawn from.
//
// In:  CoreListener's calls; the symbols of the image, if it has some.
// Out: folded stacks, one a line: "core0;main;poll;read_pins 1234", cycles of the last function
//      itself.
// A function without a symbol goes by the address it was called at. An interrupt is a frame
// "[TIMER_0]" on top of what it interrupted; sleep is "(asleep)" below the core, whoever sleeps.
// The way is a shadow of the stack: calls by BL and BLX, returns by BX and POP to where a call
// came from; a plain branch to another function counts for the caller.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/image/image.hpp"

namespace lamplock::sim::chip {

/// The stacks of one core; whoever owns it lets the core tell it.
class CallStacks final : public CoreListener {
 public:
  CallStacks(Core& core, std::span<const ImageSymbol> symbols);
  CallStacks(const CallStacks&) = delete;
  CallStacks& operator=(const CallStacks&) = delete;

  /// Lines with their ends, sorted; the sum of all counts is the cycles since the beginning.
  std::string folded();

  void exception_entered(int core, unsigned number, Cycle since, Cycle at) override;
  void exception_left(int core, unsigned number, Cycle at) override;
  void called(int core, std::uint32_t from, std::uint32_t to, Cycle at) override;
  void branched(int core, std::uint32_t to, Cycle at) override;
  void slept(int core, Cycle at) override;
  void woke(int core, Cycle at) override;
  void masked(int /*core*/, bool /*interrupts_off*/, Cycle /*at*/) override {}

 private:
  using Node = std::size_t;
  /// A place in the tree of all ways.
  struct Place {
    Node parent = 0;
    std::uint64_t key = 0;  ///< address of the function, or one of those below
    Cycle own = 0;
    std::map<std::uint64_t, Node> children;
  };
  struct Frame {
    Node node = 0;
    std::uint32_t back = 0;  ///< where it returns to; 0: not known
    unsigned exception = 0;
  };
  static constexpr std::uint64_t exception_key = std::uint64_t{1} << 32;
  static constexpr std::uint64_t asleep_key = std::uint64_t{2} << 32;
  static constexpr std::size_t deepest = 256;  ///< frames; deeper calls count for the deepest

  const ImageSymbol* symbol_at(std::uint32_t address) const;
  std::uint64_t function_key(std::uint32_t address) const;
  std::string name(std::uint64_t key) const;
  Node child(Node parent, std::uint64_t key);
  void push(Node node, std::uint32_t back, unsigned exception);
  void charge(Cycle at);
  void leave_stale_exceptions();

  Core& core_;
  std::vector<ImageSymbol> symbols_;  ///< functions by address
  std::vector<Place> places_;         ///< the first is the core
  std::vector<Frame> frames_;
  Cycle last_;
  bool sleeping_ = false;
};

}  // namespace lamplock::sim::chip
