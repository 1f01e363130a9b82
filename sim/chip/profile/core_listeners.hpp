// Several listeners at one core, which has room for one.
#pragma once

#include <vector>

#include "sim/chip/cpu/core.hpp"

namespace lamplock::sim::chip {

/// Hands every call on, in the order in which they were added.
class CoreListeners final : public CoreListener {
 public:
  void add(CoreListener& listener) { all_.push_back(&listener); }

  void exception_entered(int core, unsigned number, Cycle since, Cycle at) override {
    for (CoreListener* each : all_) each->exception_entered(core, number, since, at);
  }
  void exception_left(int core, unsigned number, Cycle at) override {
    for (CoreListener* each : all_) each->exception_left(core, number, at);
  }
  void called(int core, std::uint32_t from, std::uint32_t to, Cycle at) override {
    for (CoreListener* each : all_) each->called(core, from, to, at);
  }
  void branched(int core, std::uint32_t to, Cycle at) override {
    for (CoreListener* each : all_) each->branched(core, to, at);
  }
  void slept(int core, Cycle at) override {
    for (CoreListener* each : all_) each->slept(core, at);
  }
  void woke(int core, Cycle at) override {
    for (CoreListener* each : all_) each->woke(core, at);
  }
  void masked(int core, bool interrupts_off, Cycle at) override {
    for (CoreListener* each : all_) each->masked(core, interrupts_off, at);
  }

 private:
  std::vector<CoreListener*> all_;
};

}  // namespace lamplock::sim::chip
