// Measures a core's sleep and counts its interrupts.
#pragma once

#include "sim/chip/cpu/core.hpp"

namespace lamplock::test {

/// Watches from construction on; must be the core's only listener.
class SleepWatch final : public sim::chip::CoreListener {
 public:
  explicit SleepWatch(sim::chip::Core& core) : core_(core) { core.listen(this); }
  ~SleepWatch() override { core_.listen(nullptr); }
  SleepWatch(const SleepWatch&) = delete;
  SleepWatch& operator=(const SleepWatch&) = delete;

  /// Number of sleeps.
  int count() const { return count_; }
  /// Cycles asleep, the present sleep included, and awake.
  sim::chip::Cycle asleep() const { return asleep_ + (sleeping_ ? core_.cycle() - since_ : 0); }
  sim::chip::Cycle awake() const { return core_.cycle() - begin_ - asleep(); }
  /// Number of exceptions entered.
  int interrupts() const { return interrupts_; }

 private:
  void exception_entered(int, unsigned, sim::chip::Cycle, sim::chip::Cycle) override {
    ++interrupts_;
  }
  void exception_left(int, unsigned, sim::chip::Cycle) override {}
  void called(int, std::uint32_t, std::uint32_t, sim::chip::Cycle) override {}
  void branched(int, std::uint32_t, sim::chip::Cycle) override {}
  void slept(int, sim::chip::Cycle at) override {
    ++count_;
    sleeping_ = true;
    since_ = at;
  }
  void woke(int, sim::chip::Cycle at) override {
    sleeping_ = false;
    asleep_ += at - since_;
  }
  void masked(int, bool, sim::chip::Cycle) override {}

  sim::chip::Core& core_;
  bool sleeping_ = core_.sleeping();
  int count_ = 0, interrupts_ = 0;
  sim::chip::Cycle begin_ = core_.cycle(), since_ = begin_, asleep_ = 0;
};

}  // namespace lamplock::test
