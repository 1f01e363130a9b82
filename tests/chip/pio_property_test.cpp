// The simulator's sleeping machines and instructions run ahead leave the same trace as machines
// stepped in every clock: random programs, random traffic from pins, cores and DMA, clocks that
// stop.
#include <algorithm>
#include <ostream>
#include <random>

#include "tests/chip/pio_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::test::pio::pio_property_test {
namespace {

struct Action {
  enum Kind { wait, pin_change, write, read, gate, half_way } kind;
  std::uint32_t a = 0, b = 0;
};

using Random = std::mt19937_64;

std::uint32_t below(Random& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(random() % n);
}

Word random_instruction(Random& random, bool calm) {
  const unsigned d = below(random, 3) == 0 ? below(random, 32) : 0;
  switch (below(random, calm ? 14 : 16)) {
    case 0:
    case 1:
    case 2:
      return jmp(static_cast<Condition>(below(random, 8)), below(random, 32), d);
    case 3:
      return wait(below(random, 2), static_cast<WaitFor>(below(random, 3)), below(random, 8), d);
    case 4:
      return in(pins, below(random, 32), d);
    case 5:
      return in(x, below(random, 32), d);
    case 6:
      return out(static_cast<Place>(below(random, 8)), below(random, 32), d);
    case 7:
      return out(x, below(random, 32), d);
    case 8:
      return push(below(random, 2) != 0, below(random, 2) != 0, d);
    case 9:
      return pull(below(random, 2) != 0, below(random, 2) != 0, d);
    case 10:
      return with(0xa000 | below(random, 256), d);
    case 11:
      return set(pins, below(random, 32), d);
    case 12:
      return set(x, below(random, 32), d);
    case 13:
      return set(y, below(random, 32), d);
    case 14:
      return with(0xc000 | below(random, 128), d);
    default:
      return static_cast<Word>(random());
  }
}

// Programs that count and poll; their machines sleep in loops.
void counting_program(Random& random, std::vector<Word>& words, unsigned at) {
  words[at] = mov(x, osr, below(random, 2));
  words[at + 1] = jmp(x_dec, at + 1, below(random, 4));
  words[at + 2] = jmp(x_dec, at + 3, below(random, 2));
  words[at + 3] = jmp(pin, at + 5);
  words[at + 4] = jmp(below(random, 2) != 0 ? y_dec : always, at + 2);
  words[at + 5] = set(pins, below(random, 32));
  words[at + 6] = in(x, 32);
  words[at + 7] = below(random, 2) != 0 ? push(false, false) : jmp(always, at);
}

std::uint32_t random_divider(Random& random) {
  switch (below(random, 4)) {
    case 0:
      return below(random, 5) << 16 | below(random, 256) << 8 | (1u << 16);
    case 1:
      return below(random, 40) == 0 ? 0u : 7u << 16;
    default:
      return 1u << 16;
  }
}

std::vector<Action> random_script(std::uint64_t seed) {
  Random random(seed);
  std::vector<Action> script;
  const auto add = [&](Action::Kind kind, std::uint32_t a, std::uint32_t b = 0) {
    script.push_back({kind, a, b});
  };
  const auto exec_bits = [&] {
    std::uint32_t value = wrap(below(random, 16), 16 + below(random, 16));
    if (below(random, 3) == 0) value |= static_cast<std::uint32_t>(random()) & 0x7ffe'001fu;
    value |= below(random, 16) << 24;
    return value;
  };
  const auto shift_bits = [&] {
    std::uint32_t value = static_cast<std::uint32_t>(random()) & 0x3fff'0000u;
    if (below(random, 6) == 0) value |= 1u << (30 + below(random, 2));
    return value;
  };
  for (unsigned block = 0; block < 2; ++block) {
    std::vector<Word> words(32);
    const bool calm = below(random, 2) != 0;
    for (Word& word : words) word = random_instruction(random, calm);
    for (unsigned at = 0; at < 32; at += 8)
      if (below(random, 3) == 0) counting_program(random, words, at);
    for (unsigned i = 0; i < 32; ++i)
      add(Action::write, pio_base[block] + instr_mem + 4 * i, words[i]);
    for (unsigned m = 0; m < 4; ++m) {
      const auto reg = [&](std::uint32_t r) { return pio_base[block] + sm(m, r); };
      add(Action::write, reg(clkdiv), random_divider(random));
      add(Action::write, reg(execctrl), exec_bits());
      add(Action::write, reg(shiftctrl), shift_bits());
      const unsigned spread = below(random, 2) != 0 ? 4 * m : below(random, 16);
      add(Action::write, reg(pinctrl),
          Pins{.out_base = spread,
               .set_base = spread,
               .side_base = spread + below(random, 3),
               .in_base = below(random, 16),
               .out_count = below(random, 4),
               .set_count = below(random, 4),
               .side_count = below(random, 3)}
              .word());
      add(Action::write, reg(instr), set(pindirs, 31));
      add(Action::wait, 2);
      add(Action::write, reg(instr), jmp(always, 8 * m));
      add(Action::wait, 1);
    }
    add(Action::write, pio_base[block] + irq0_inte, static_cast<std::uint32_t>(random()) & 0xfffu);
    add(Action::write, pio_base[block] + ctrl, below(random, 16));
  }
  // Memory to TX FIFOs and RX FIFOs to memory, in rings.
  for (unsigned channel = 0; channel < 6; ++channel) {
    if (below(random, 2) == 0) continue;
    const unsigned block = below(random, 2), m = below(random, 4);
    const bool tx = below(random, 2) != 0;
    const std::uint32_t base = dma_base + 0x40 * channel, buffer = ram + 0x1000 * (channel + 1);
    const std::uint32_t fifo = pio_base[block] + (tx ? txf : rxf) + 4 * m;
    add(Action::write, base + 0x0, tx ? buffer : fifo);
    add(Action::write, base + 0x4, tx ? fifo : buffer);
    add(Action::write, base + 0x8, 1 + below(random, 300));
    const unsigned dreq = block * 8 + (tx ? 0 : 4) + m;
    const unsigned treq = below(random, 6) == 0 ? 0x3b + below(random, 4) : dreq;
    add(Action::write, base + 0xc,
        1u | 2u << 2 | (tx ? 1u << 4 : 1u << 5) | 8u << 6 | (tx ? 0u : 1u << 10) |
            below(random, 12) << 11 | treq << 15 | below(random, 2) << 1);
  }
  for (unsigned timer = 0; timer < 4; ++timer)
    add(Action::write, dma_base + 0x420 + 4 * timer,
        (1 + below(random, 9)) << 16 | (1 + below(random, 90)));
  for (int i = 0; i < 120; ++i) {
    const unsigned block = below(random, 2), m = below(random, 4);
    const std::uint32_t base = pio_base[block];
    switch (below(random, 16)) {
      case 0:
      case 1:
      case 2:
        add(Action::pin_change, 16 + below(random, 8), below(random, 2));
        break;
      case 3:
      case 4:
        add(Action::write, base + txf + 4 * m, static_cast<std::uint32_t>(random()));
        break;
      case 5:
        add(Action::read, base + rxf + 4 * m);
        break;
      case 6:
        add(Action::read, base + sm(m, addr));
        break;
      case 7:
        add(Action::write, base + ctrl,
            static_cast<std::uint32_t>(random()) & (below(random, 3) == 0 ? 0xfffu : 0xfu));
        break;
      case 8:
        add(Action::write, base + sm(m, instr), random_instruction(random, true));
        break;
      case 9:
        add(Action::write, base + (below(random, 2) != 0 ? irq : irq_force), below(random, 256));
        break;
      case 10:
        switch (below(random, 5)) {
          case 0:
            add(Action::write, base + sm(m, execctrl), exec_bits());
            break;
          case 1:
            add(Action::write, base + sm(m, shiftctrl), shift_bits());
            break;
          case 2:
            add(Action::write, base + sm(m, clkdiv), random_divider(random));
            break;
          case 3:
            add(Action::write, base + bypass, static_cast<std::uint32_t>(random()));
            break;
          default:
            add(Action::write, dma_base + 0x444, 1u << below(random, 12));
        }
        break;
      case 11:
        add(Action::gate, below(random, 3), below(random, 60));
        break;
      default:
        add(Action::wait, 1 + below(random, below(random, 4) == 0 ? 5000 : 40));
    }
    if (below(random, 3) == 0) add(Action::wait, below(random, 4));
  }
  return script;
}

/// An observed value: address (0: interrupt lines, 1: contention) and time.
struct Seen {
  Cycle at = 0;
  std::uint32_t address = 0, value = 0;
  bool operator==(const Seen&) const = default;
};

struct Trace {
  std::vector<Edge> edges;
  std::vector<Seen> looked;
  std::vector<std::uint8_t> memory;
};

Trace play(const std::vector<Action>& script, std::uint64_t seed, bool every_clock, bool one_by_one,
           bool wired) {
  Rig rig(every_clock);
  Random random(seed);
  for (std::uint8_t& byte : rig.bus.sram().first(0x8000))
    byte = static_cast<std::uint8_t>(random());
  for (unsigned i = 0; i < 16; ++i) rig.connect(i, 1, i / 4 % 2);
  if (wired) {  // both blocks' pins, and an output to an input
    rig.gpio.join(1, 5, rig.now());
    rig.gpio.set_external(20, External::floating, rig.now());
    rig.gpio.join(2, 20, rig.now());
  }
  Trace trace;
  const auto record = [&](std::uint32_t address) {
    trace.looked.push_back({rig.now(), address, rig.read(address)});
  };
  const auto wait = [&](std::uint32_t cycles) {
    if (one_by_one)
      for (std::uint32_t i = 0; i < cycles; ++i) rig.run(1);
    else
      rig.run(cycles);
    trace.looked.push_back({rig.now(), 0, rig.irqs.levels()});
    trace.looked.push_back({rig.now(), 1, rig.bus.contended() ? 1u : 0u});
  };
  const auto set_clock = [&](std::uint32_t block, bool runs) {
    block < 2 ? rig.fabric.set_pio_clock(block, runs) : rig.fabric.set_dma_clock(runs);
  };
  for (const Action& action : script) {
    switch (action.kind) {
      case Action::wait:
        wait(action.a);
        break;
      case Action::gate:
        set_clock(action.a, false);
        wait(action.b);
        rig.drive(16 + action.b % 8, action.b % 3 == 0);
        wait(action.b / 2);
        set_clock(action.a, true);
        break;
      case Action::pin_change:
        rig.drive(action.a, action.b != 0);
        break;
      case Action::write:
        rig.write(action.a, action.b);
        break;
      default:
        record(action.a);
    }
    if (action.kind == Action::wait && action.a % 5 == 0) record(0x4001'4000 + 8 * (action.a % 16));
    if (action.kind == Action::wait)
      for (unsigned block = 0; block < 2; ++block)
        for (const std::uint32_t offset : {fstat, fdebug, flevel, irq, padout, padoe})
          record(pio_base[block] + offset);
  }
  // STATUS of the pins, and latched edges without an interrupt.
  for (unsigned i = 0; i < 16; ++i) record(0x4001'4000 + 8 * i);
  for (unsigned word = 0; word < 2; ++word) record(0x4001'40f0 + 4 * word);
  for (unsigned channel = 0; channel < 12; ++channel)
    for (const std::uint32_t offset : {0x0u, 0x4u, 0x8u, 0x10u, 0x800u})
      record(dma_base + 0x40 * channel + offset);
  trace.edges = rig.edges;
  const auto sram = rig.bus.sram().first(0x8000);
  trace.memory.assign(sram.begin(), sram.end());
  return trace;
}

void PrintTo(const Seen& seen, std::ostream* to) {
  *to << std::hex << "value " << seen.value << " at address " << seen.address << std::dec
      << " in cycle " << seen.at;
}

/// The first difference of two traces.
template <typename Item>
void expect_same(const std::vector<Item>& a, const std::vector<Item>& b) {
  const auto [i, k] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (i != a.end() && k != b.end()) {
    ASSERT_EQ(*i, *k);
  }
  ASSERT_EQ(a.size(), b.size());
}

TEST(PioProperty, SleepingLeavesTheTraceOfSteppingEveryClock) {
  std::size_t edges = 0;
  for (int i = 0; i < scaled(300); ++i) {
    const auto seed = static_cast<std::uint64_t>(i) + 1;
    const std::vector<Action> script = random_script(seed);
    const bool wired = i % 5 == 0;
    const Trace stepped = play(script, seed, true, false, wired);
    const Trace asleep = play(script, seed, false, i % 2 == 0, wired);
    SCOPED_TRACE(seed);
    expect_same(stepped.edges, asleep.edges);
    expect_same(stepped.looked, asleep.looked);
    ASSERT_EQ(stepped.memory, asleep.memory);
    if (HasFatalFailure()) return;
    edges += stepped.edges.size();
  }
  EXPECT_GT(edges, 10u * static_cast<std::size_t>(scaled(300)));
}

}  // namespace
}  // namespace lamplock::test::pio::pio_property_test
