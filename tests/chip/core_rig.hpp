// One core with memory only, for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/fabric/timing.hpp"
#include "tests/chip/put_code.hpp"

namespace lamplock::test {

/// Calls functions at set cycles, in order.
class Alarm final : public sim::chip::Timed {
 public:
  explicit Alarm(sim::chip::TimeWheel& wheel) : wheel_(wheel), slot_(wheel.add(*this)) {}
  void at(sim::chip::Cycle when, std::function<void()> action) {
    when_ = when;
    action_ = std::move(action);
    wheel_.set(slot_, when_);
  }
  void run(sim::chip::Cycle to) override {
    if (to < when_) return;
    when_ = sim::chip::never_cycle;
    wheel_.set(slot_, when_);
    action_();
  }

 private:
  sim::chip::TimeWheel& wheel_;
  sim::chip::TimeWheel::Slot slot_;
  sim::chip::Cycle when_ = sim::chip::never_cycle;
  std::function<void()> action_;
};

/// Code at `code`, vectors at `vectors` (exception n: handler_of(n), filled with NOPs and BX LR),
/// data at `data`, main stack below `stack`.
struct CoreRig {
  static constexpr std::uint32_t code = 0x2000'0000;
  static constexpr std::uint32_t data = 0x2002'0000;
  static constexpr std::uint32_t stack = 0x2002'1000;
  static constexpr std::uint32_t handlers = 0x2003'0000;
  static constexpr std::uint32_t handler_size = 64;
  static constexpr std::uint32_t vectors = 0x2004'0000;

  explicit CoreRig(const sim::chip::Timing& assumed = {})
      : timing(assumed),
        bus(wheel, timing, [this](const std::string& what) { reports.push_back(what); }),
        core(0, bus, wheel, irqs, timing,
             [this](const std::string& what) { reports.push_back(what); }) {
    put_word(vectors, stack);
    put_word(vectors + 4, code | 1);
    for (unsigned n = 2; n < sim::chip::Nvic::exception_count; ++n) {
      put_word(vectors + 4 * n, handler_of(n) | 1);
      put(handler_of(n), {0xbf00, 0x4770});  // nop; bx lr
    }
    restart();
  }

  /// Restarts from reset, with the vectors in place.
  void restart() {
    core.reset(vectors);
    core.set_vtor(vectors);
  }
  static std::uint32_t handler_of(unsigned number) { return handlers + handler_size * number; }
  void put(std::uint32_t address, std::initializer_list<unsigned> halfwords) {
    test::put(bus, address, halfwords);
  }
  void put_word(std::uint32_t address, std::uint32_t value) { test::put_word(bus, address, value); }
  std::uint32_t word(std::uint32_t address) {
    std::uint32_t value = 0;
    std::memcpy(&value, bus.memory_at(address).data(), sizeof value);
    return value;
  }
  /// A store by the core's own bus port, registers in the core included.
  void poke(std::uint32_t address, std::uint32_t value) {
    const std::uint32_t pc = core.reg(15), r0 = core.reg(0), r1 = core.reg(1);
    put(scratch, {0x6001});  // str r1, [r0]
    core.set_reg(0, address);
    core.set_reg(1, value);
    core.set_reg(15, scratch);
    core.step();
    core.set_reg(0, r0);
    core.set_reg(1, r1);
    if (core.reg(15) == scratch + 2) core.set_reg(15, pc);
  }
  std::uint32_t peek(std::uint32_t address) {
    const std::uint32_t pc = core.reg(15), r0 = core.reg(0), r1 = core.reg(1);
    put(scratch, {0x6801});  // ldr r1, [r0]
    core.set_reg(0, address);
    core.set_reg(15, scratch);
    core.step();
    const std::uint32_t value = core.reg(1);
    core.set_reg(0, r0);
    core.set_reg(1, r1);
    if (core.reg(15) == scratch + 2) core.set_reg(15, pc);
    return value;
  }

  static constexpr std::uint32_t scratch = 0x2004'1f00;
  std::vector<std::string> reports;
  sim::chip::TimeWheel wheel;
  sim::chip::Timing timing;
  sim::chip::IrqLines irqs;
  sim::chip::Bus bus;
  sim::chip::Core core;
};

}  // namespace lamplock::test
