// Listeners at a simulated chip, for tests: pads, cores, steps.
//
// In:  the events of the simulation; out: records of them. Used by the tests that look at pins or
//      at the cycles of a core.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "sim/chip/chip.hpp"

namespace lamplock::sim::chip::rigs {

/// The level after an edge of a pad, and its cycle.
using Edge = std::pair<bool, Cycle>;
using EdgeList = std::vector<Edge>;

/// Edges in these cycles; the first one leads to `level`.
inline EdgeList alternating(bool level, const std::vector<Cycle>& cycles) {
  EdgeList edges;
  for (const Cycle at : cycles) {
    edges.emplace_back(level, at);
    level = !level;
  }
  return edges;
}

/// Records the edges of all pads, and has wires between pads.
struct Pads : PadListener {
  explicit Pads(Gpio& pins) : gpio(pins) { gpio.listen(*this); }
  void pad_changed(unsigned pin, bool level, Cycle at) override {
    edges.at(pin).emplace_back(level, at);
    for (const auto& [from, to] : wires)
      if (from == pin) gpio.set_external(to, level ? External::high : External::low, at);
  }
  void wire(unsigned from, unsigned to, Cycle at) {
    wires.emplace_back(from, to);
    const bool level = (gpio.pad_levels() >> from & 1u) != 0;
    gpio.set_external(to, level ? External::high : External::low, at);
  }
  void clear() { edges = {}; }
  std::vector<Cycle> cycles(unsigned pin) const {
    std::vector<Cycle> all;
    for (const auto& [level, at] : edges.at(pin)) all.push_back(at);
    return all;
  }

  Gpio& gpio;
  std::array<EdgeList, gpio_count> edges;
  std::vector<std::pair<unsigned, unsigned>> wires;
};

/// Ignores the events that a test does not override.
struct QuietListener : CoreListener {
  void exception_entered(int, unsigned, Cycle, Cycle) override {}
  void exception_left(int, unsigned, Cycle) override {}
  void called(int, std::uint32_t, std::uint32_t, Cycle) override {}
  void branched(int, std::uint32_t, Cycle) override {}
  void slept(int, Cycle) override {}
  void woke(int, Cycle) override {}
  void masked(int, bool, Cycle) override {}
};

/// Observes nothing and permits everything, but makes the chip run step by step.
struct Onlooker final : StepWatcher {
  bool before_step(Core& /*core*/) override { return true; }
};

}  // namespace lamplock::sim::chip::rigs
