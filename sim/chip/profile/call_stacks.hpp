// Cycles by call path, as the input of flame graphs.
//
// In:  the frames of a ShadowStack.
// Out: folded stacks, one a line: "core0;main;poll;read_pins 1234", cycles of the last function
//      itself.
// A function without a symbol is named by the address it was called at. An interrupt is a frame
// "[TIMER_0]" on top of what it interrupted; sleep is "(asleep)" below the core, in any function.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/chip/profile/shadow_stack.hpp"

namespace lamplock::sim::chip {

/// The call paths of one core.
class CallStacks final : private StackView {
 public:
  /// Must live as long as the core runs with the stack as its listener.
  explicit CallStacks(ShadowStack& stack);
  CallStacks(const CallStacks&) = delete;
  CallStacks& operator=(const CallStacks&) = delete;

  /// Lines with their ends, sorted; the sum of all counts is the cycles since the beginning.
  std::string folded() const;

 private:
  using Node = std::size_t;
  /// A node in the tree of call paths.
  struct Place {
    Node parent = 0;
    std::uint64_t key = 0;  ///< address of the function, or exception_key + number
    Cycle own = 0;
    std::map<std::uint64_t, Node> children;
  };
  static constexpr std::uint64_t exception_key = std::uint64_t{1} << 32;

  void entered(const ShadowFrame& frame) override;
  void left(const ShadowFrame& frame) override;
  std::string name(std::uint64_t key) const;
  std::string way_to(Node node) const;
  Node child(Node parent, std::uint64_t key);

  const ShadowStack& stack_;
  std::vector<Place> places_;  ///< the first is the core
  std::vector<Node> present_;  ///< of the present frames
};

}  // namespace lamplock::sim::chip
