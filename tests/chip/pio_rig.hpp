// A chip without cores: wheel, bus, pins, both PIO blocks and the DMA; a hand assembler; a trace.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/pio_dma_clock.hpp"

namespace lamplock::test::pio {

using namespace lamplock::sim::chip;  // NOLINT: the tests use no other names

inline constexpr std::uint32_t pio_base[2] = {0x5020'0000, 0x5030'0000};
inline constexpr std::uint32_t dma_base = 0x5000'0000;
inline constexpr std::uint32_t ram = 0x2000'0000;

// Offsets of a PIO block.
inline constexpr std::uint32_t ctrl = 0x00, fstat = 0x04, fdebug = 0x08, flevel = 0x0c, txf = 0x10,
                               rxf = 0x20, irq = 0x30, irq_force = 0x34, bypass = 0x38,
                               padout = 0x3c, padoe = 0x40, cfginfo = 0x44, instr_mem = 0x48,
                               intr = 0x128, irq0_inte = 0x12c, irq0_intf = 0x130,
                               irq0_ints = 0x134, irq1_inte = 0x138;
inline constexpr std::uint32_t clkdiv = 0xc8, execctrl = 0xcc, shiftctrl = 0xd0, addr = 0xd4,
                               instr = 0xd8, pinctrl = 0xdc;
constexpr std::uint32_t sm(unsigned machine, std::uint32_t reg) { return reg + 0x18 * machine; }

// Instructions.
using Word = std::uint16_t;
constexpr Word with(unsigned word, unsigned bits_12_8) {
  return static_cast<Word>(word | bits_12_8 << 8);
}
enum Condition : unsigned { always, not_x, x_dec, not_y, y_dec, x_ne_y, pin, not_osre };
constexpr Word jmp(Condition c, unsigned target, unsigned d = 0) {
  return with(c << 5 | target, d);
}
enum WaitFor : unsigned { gpio_source, pin_source, irq_source };
constexpr Word wait(unsigned level, WaitFor source, unsigned index, unsigned d = 0) {
  return with(0x2000 | level << 7 | source << 5 | index, d);
}
enum Place : unsigned {
  pins = 0,
  x = 1,
  y = 2,
  null = 3,
  pindirs = 4,
  status = 5,
  pc = 5,
  isr = 6,
  osr = 7,
  exec = 7,
  mov_exec = 4
};
constexpr Word in(Place source, unsigned n, unsigned d = 0) {
  return with(0x4000u | source << 5 | (n & 31), d);
}
constexpr Word out(Place to, unsigned n, unsigned d = 0) {
  return with(0x6000u | to << 5 | (n & 31), d);
}
constexpr Word push(bool if_full = false, bool block = true, unsigned d = 0) {
  return with(0x8000u | (if_full ? 0x40u : 0u) | (block ? 0x20u : 0u), d);
}
constexpr Word pull(bool if_empty = false, bool block = true, unsigned d = 0) {
  return with(0x8080u | (if_empty ? 0x40u : 0u) | (block ? 0x20u : 0u), d);
}
constexpr Word mov(Place to, Place from, unsigned operation = 0, unsigned d = 0) {
  return with(0xa000u | to << 5 | operation << 3 | from, d);
}
constexpr Word nop(unsigned d = 0) { return mov(y, y, 0, d); }
constexpr Word irq_set(unsigned index, bool wait_too = false, unsigned d = 0) {
  return with(0xc000u | (wait_too ? 0x20u : 0u) | index, d);
}
constexpr Word irq_clear(unsigned index) { return static_cast<Word>(0xc040u | index); }
constexpr Word set(Place to, unsigned value, unsigned d = 0) {
  return with(0xe000u | to << 5 | value, d);
}

/// SMx_PINCTRL.
struct Pins {
  unsigned out_base = 0, set_base = 0, side_base = 0, in_base = 0, out_count = 0, set_count = 0,
           side_count = 0;
  constexpr std::uint32_t word() const {
    return out_base | set_base << 5 | side_base << 10 | in_base << 15 | out_count << 20 |
           set_count << 26 | side_count << 29;
  }
};
constexpr std::uint32_t wrap(unsigned bottom, unsigned top) { return bottom << 7 | top << 12; }
constexpr std::uint32_t both_right = 3u << 18;

struct Edge {
  unsigned gpio;
  bool level;
  Cycle at;
  bool operator==(const Edge&) const = default;
  friend void PrintTo(const Edge& edge, std::ostream* to) {
    *to << "pin " << edge.gpio << (edge.level ? " rises" : " falls") << " in cycle " << edge.at;
  }
};

class Rig : private PadListener {
 public:
  explicit Rig(bool every_clock = false) {
    for (unsigned i = 0; i < 2; ++i) bus.map(pio_base[i], i == 0 ? fabric.pio0() : fabric.pio1());
    bus.map(dma_base, fabric.dma());
    bus.map(0x4001'4000, gpio.io_bank());
    bus.map(0x4001'c000, gpio.pads_bank());
    for (unsigned i = 0; i < gpio_count; ++i) gpio.set_external(i, External::low, 0);
    gpio.listen(static_cast<PadListener&>(*this));
    if (every_clock) fabric.set_step_every_clock(true);
    run_to(10);
  }

  void run_to(Cycle to) { wheel.advance_to(to); }
  void run(Cycle cycles) { run_to(wheel.now() + cycles); }
  Cycle now() const { return wheel.now(); }
  void write(std::uint32_t address, std::uint32_t value) {
    EXPECT_FALSE(bus.write(address, value, Width::word, Master::core0, now()).fault);
  }
  std::uint32_t read(std::uint32_t address) {
    return bus.read(address, Width::word, Master::core0, now()).value;
  }
  void pio(std::uint32_t offset, std::uint32_t value, unsigned block = 0) {
    write(pio_base[block] + offset, value);
  }
  std::uint32_t read_pio(std::uint32_t offset, unsigned block = 0) {
    return read(pio_base[block] + offset);
  }
  void dma(std::uint32_t offset, std::uint32_t value) { write(dma_base + offset, value); }
  std::uint32_t read_dma(std::uint32_t offset) { return read(dma_base + offset); }

  /// Connects pins to a block; they float outside from then on.
  void connect(unsigned first, unsigned count, unsigned block = 0) {
    for (unsigned i = first; i < first + count; ++i) {
      gpio.set_external(i, External::floating, now());
      write(0x4001'4004 + 8 * i, 6 + block);
    }
  }
  void load(const std::vector<Word>& program, unsigned at = 0, unsigned block = 0) {
    for (const Word word : program) pio(instr_mem + 4 * at++, word, block);
  }
  /// A whole machine: pins, program from `at` with wrap over all of it, program counter set.
  void machine(unsigned number, const std::vector<Word>& program, const Pins& pin_map,
               unsigned at = 0, unsigned block = 0, std::uint32_t shift = both_right,
               std::uint32_t exec_bits = 0) {
    load(program, at, block);
    pio(sm(number, pinctrl), pin_map.word(), block);
    const auto top = at + static_cast<unsigned>(program.size()) - 1;
    pio(sm(number, execctrl), wrap(at, top) | exec_bits, block);
    pio(sm(number, shiftctrl), shift, block);
    outputs(number, pin_map, block);
    pio(sm(number, instr), jmp(always, at), block);
    run(2);
  }
  /// Sets directions by instructions, as a driver does.
  void outputs(unsigned number, const Pins& map, unsigned block) {
    const auto group = [&](unsigned base, unsigned count) {
      while (count > 0) {
        const unsigned n = count < 5 ? count : 5;
        pio(sm(number, pinctrl), Pins{.set_base = base, .set_count = n}.word(), block);
        pio(sm(number, instr), set(pindirs, 31), block);
        run(2);
        base += n;
        count -= n;
      }
    };
    group(map.out_base, map.out_count);
    group(map.set_base, map.set_count);
    group(map.side_base, map.side_count);
    pio(sm(number, pinctrl), map.word(), block);
  }
  /// Enables machines; their first instruction executes in the cycle returned.
  Cycle start(unsigned mask, unsigned block = 0) {
    edges.clear();
    pio(ctrl, mask | mask << 8, block);
    return now() + 1;
  }
  void drive(unsigned number, bool level) {
    gpio.set_external(number, level ? External::high : External::low, now());
  }
  /// Cycles of the edges of one pin, relative to `from`.
  std::vector<long> edges_of(unsigned number, Cycle from) const {
    std::vector<long> result;
    for (const Edge& edge : edges)
      if (edge.gpio == number)
        result.push_back(static_cast<long>(edge.at) - static_cast<long>(from));
    return result;
  }

  std::vector<std::string> messages;
  TimeWheel wheel;
  IrqLines irqs;
  Timing timing;
  Gpio gpio{wheel, irqs, [this](const std::string& what) { messages.push_back(what); }};
  Bus bus{wheel, timing, [this](const std::string& what) { messages.push_back(what); }};
  PioDmaClock fabric{wheel, bus,    gpio,
                     irqs,  timing, [this](const std::string& what) { messages.push_back(what); }};
  std::vector<Edge> edges;

 private:
  void pad_changed(unsigned number, bool level, Cycle at) override {
    edges.push_back({number, level, at});
  }
};

}  // namespace lamplock::test::pio
