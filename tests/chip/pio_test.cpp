// PIO timing to the cycle, by the rules of the RP2040 datasheet, chapter 3. Also chip_images/pio:
// pins past and behind the synchroniser, side-set, autopull at full rate, flags between machines.
#include "tests/chip/pio_rig.hpp"

namespace lamplock::test::pio::pio_test {
namespace {

using Longs = std::vector<long>;

// Machine 0 runs `program`; SET writes pin 0. Records the pin from the first instruction on.
struct OneMachine {
  explicit OneMachine(const std::vector<Word>& program, std::uint32_t shift = both_right,
                      std::uint32_t exec_bits = 0)
      : OneMachine(program, Pins{.set_base = 0, .set_count = 1}, shift, exec_bits) {}
  OneMachine(const std::vector<Word>& program, const Pins& pin_map, std::uint32_t shift,
             std::uint32_t exec_bits) {
    rig.connect(0, 8);
    rig.machine(0, program, pin_map, 0, 0, shift, exec_bits);
  }
  /// Starts the machine; edges and times are relative to the cycle of the first instruction.
  void start() { first = rig.start(1); }
  Longs edges(unsigned number = 0) const { return rig.edges_of(number, first); }
  void run_to(long cycle) { rig.run_to(first + static_cast<Cycle>(cycle)); }
  Rig rig;
  Cycle first = 0;
};

// Cycles of each kind of instruction without a stall: pin up, the instruction, pin down.
TEST(PioTiming, EveryInstructionTakesOneCycleAndItsDelay) {
  const std::vector<std::vector<Word>> instructions = {
      {jmp(always, 2), jmp(not_x, 2), jmp(x_dec, 2), jmp(not_y, 2)},
      {jmp(y_dec, 2), jmp(x_ne_y, 2), jmp(pin, 2), jmp(not_osre, 2)},
      {wait(0, gpio_source, 20), wait(0, pin_source, 20), wait(0, irq_source, 3)},
      {in(pins, 3), in(x, 32), in(null, 1), in(isr, 5), in(osr, 8)},
      {out(pins, 1), out(x, 7), out(y, 32), out(null, 1), out(pindirs, 1), out(isr, 4)},
      {push(), push(true), push(false, false), pull(false, false), pull(true, false)},
      {mov(x, y), mov(y, x, 1), mov(isr, x, 2)},
      {mov(osr, null), mov(x, status), mov(pins, null)},
      {irq_set(1), irq_clear(1), set(x, 5), set(y, 31), set(pindirs, 1)}};
  std::vector<Word> all;
  for (const auto& kind : instructions) all.insert(all.end(), kind.begin(), kind.end());
  for (const Word word : all)
    for (const unsigned delay : {0u, 1u, 7u, 31u}) {
      OneMachine m({set(pins, 1), with(word, delay), set(pins, 0, 31)});
      m.start();
      m.run_to(60);
      const Longs edges = m.edges();
      ASSERT_GE(edges.size(), 2u) << word;
      EXPECT_EQ(edges[0], 1) << word;
      EXPECT_EQ(edges[1], 2 + 1 + static_cast<long>(delay)) << word;
    }
}

TEST(PioTiming, ExecInstructionTakesTwoCyclesAndItsOwnDelayIsIgnored) {
  // X holds `set pins, 0` with a delay of 2; the delay of MOV EXEC does not count.
  OneMachine m({set(pins, 1), mov(mov_exec, x, 0, 9), set(pins, 1), jmp(always, 3)});
  m.rig.pio(txf, set(pins, 0, 2));
  m.rig.pio(instr, pull());
  m.rig.run(2);
  m.rig.pio(instr, mov(x, osr));
  m.rig.run(2);
  m.start();
  m.run_to(30);
  // 0 set, 1 MOV EXEC, 2 executed with delay to 4, 5 set.
  EXPECT_EQ(m.edges(), (Longs{1, 3, 6}));
}

// The example of a developer of the chip (raspberrypi/pico-feedback, issue 280): IN PINS in the
// whole memory, side-set 1 in its first half; measures how much later the machine reads its own
// output.
TEST(PioTiming, MachineSeesItsOwnOutputAfterFourCyclesOrTwo) {
  for (const bool bypassed : {false, true}) {
    std::vector<Word> program;
    for (unsigned i = 0; i < 32; ++i) program.push_back(in(pins, 1, i < 16 ? 0x10 : 0));
    OneMachine m(program, Pins{.side_base = 0, .side_count = 1}, both_right | 1u << 16, 0);
    if (bypassed) m.rig.pio(bypass, 1);
    m.start();
    m.run_to(64);
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(m.rig.read_pio(rxf), bypassed ? 0xffffu << 2 : 0xffffu << 4);
  }
}

// A machine inverts its own pin: others measured 16.67 MHz on a Pico at 133 MHz.
TEST(PioTiming, RingOscillatorHasAPeriodOfEight) {
  OneMachine m({mov(pins, pins, 1)}, Pins{.out_base = 0, .out_count = 1}, both_right, 0);
  m.start();
  m.run_to(20);
  EXPECT_EQ(m.edges(), (Longs{1, 5, 9, 13, 17}));
}

TEST(PioTiming, DividersSpreadFractionsByFirstOrderDelta) {
  struct Case {
    std::uint32_t divider;
    Longs edges;  ///< of a toggling pin
  };
  for (const Case& c :
       {Case{2u << 16 | 64u << 8, {1, 3, 5, 7, 10, 12, 14, 16, 19, 21, 23, 25, 28, 30}},  // 2.25
        Case{0, {1, 65537, 131073}}}) {  // zero means 65536
    OneMachine m({set(pins, 1), set(pins, 0)});
    m.rig.pio(clkdiv, c.divider);
    m.start();
    m.run_to(c.edges.back());
    EXPECT_EQ(m.edges(), c.edges);
  }
}

TEST(PioTiming, DividersRestartTogether) {
  Rig rig;
  rig.connect(0, 2);
  rig.machine(0, {set(pins, 1), set(pins, 0)}, Pins{.set_base = 0, .set_count = 1}, 0);
  rig.machine(1, {set(pins, 1), set(pins, 0)}, Pins{.set_base = 1, .set_count = 1}, 2);
  rig.pio(sm(0, clkdiv), 37u << 16);
  rig.run(11);
  rig.pio(sm(1, clkdiv), 37u << 16);
  rig.run(1000);
  const Cycle first = rig.start(3);
  rig.run(500);
  EXPECT_EQ(rig.edges_of(0, first), rig.edges_of(1, first));
}

TEST(PioTiming, CountingLoopsTakeTheirCount) {
  for (const unsigned count : {0u, 1u, 5u, 31u})
    for (const unsigned delay : {0u, 3u}) {
      OneMachine m(
          {set(x, count), set(pins, 1), jmp(x_dec, 2, delay), set(pins, 0), jmp(always, 4)});
      m.start();
      m.run_to(400);
      const long loop = (static_cast<long>(count) + 1) * (1 + static_cast<long>(delay));
      EXPECT_EQ(m.edges(), (Longs{2, 3 + loop}));
    }
}

TEST(PioTiming, LongCountIsExactAndCheap) {
  OneMachine m({pull(), mov(x, osr), set(pins, 1), jmp(x_dec, 3, 1), set(pins, 0), jmp(always, 5)});
  m.rig.pio(txf, 0xffff'ffffu);
  m.start();
  m.run_to(20'000'000'000);
  EXPECT_EQ(m.edges(), (Longs{3, 4 + (1L << 33)}));
}

// ---------------------------------------------------------------------------------------------
// FIFOs and shift registers

/// A program and the words that it takes from its TX FIFO and leaves in its RX FIFO.
struct Exchange {
  const char* what;
  std::vector<Word> program;
  std::vector<std::uint32_t> sent, received;
  std::uint32_t shift = both_right, exec_bits = 0;
};

TEST(PioFifo, ProgramsExchangeWords) {
  constexpr std::uint32_t autopush = 1u << 16, autopull = 1u << 17, in_right = 1u << 18,
                          out_right = 1u << 19;
  constexpr auto push_at = [](unsigned bits) { return autopush | bits << 20; };
  constexpr std::uint32_t pull_at_8 = both_right | autopull | 8u << 25;
  const std::vector<Word> status_program{mov(isr, status), push(), jmp(always, 2)},
      outs{pull(), out(isr, 12), push(), out(isr, 8), push(), jmp(always, 5)},
      nibbles{set(x, 5), in(x, 4), jmp(always, 1)};
  constexpr std::uint32_t tx_below_3 = 3;  // STATUS_SEL 0, STATUS_N
  const std::vector<Exchange> all{
      {"JMP X-- decrements whether it jumps or not",
       {set(x, 0), jmp(x_dec, 0), in(x, 32), push(), jmp(always, 4)},
       {},
       {~0u}},
      {"PULL NOBLOCK without a word takes X",
       {set(x, 21), pull(false, false), mov(isr, osr), push(), jmp(always, 4)},
       {},
       {21}},
      {"autopull at 8 bits; PULL has no effect while there is data",
       {pull(), out(x, 8), mov(isr, x), push(), jmp(always, 0)},
       {0x11, 0x22, 0x33},
       {0x11, 0x22, 0x33},
       pull_at_8},
      {"autopush of 12 bits to the right", nibbles, {}, {0x5550'0000}, push_at(12) | both_right},
      {"autopush of 12 bits to the left", nibbles, {}, {0x555}, push_at(12) | out_right},
      {"OUT to the right", outs, {0x1234'5678}, {0x678, 0x45}, in_right | out_right},
      {"OUT to the left", outs, {0x1234'5678}, {0x123, 0x45}, in_right},
      {"PULL IFEMPTY, PUSH IFFULL: the second pull and the first push do nothing",
       {pull(true), out(x, 16), pull(true), out(y, 16), pull(true), in(y, 16), push(true),
        in(x, 16), push(true), jmp(always, 9)},
       {0xaaaa'bbbb, 0xcccc},
       {0xbbbb'aaaa}},
      {"MOV plain, inverted, reversed",
       {pull(), mov(isr, osr), push(), mov(isr, osr, 1), push(), mov(isr, osr, 2), push(),
        jmp(always, 7)},
       {0x8000'0123},
       {0x8000'0123, 0x7fff'fedc, 0xc480'0001}},
      {"STATUS of an empty FIFO", status_program, {}, {~0u}, both_right, tx_below_3},
      {"STATUS of two words", status_program, {0, 0}, {~0u}, both_right, tx_below_3},
      {"STATUS of three words", status_program, {0, 0, 0}, {0}, both_right, tx_below_3},
  };
  for (const Exchange& each : all) {
    SCOPED_TRACE(each.what);
    OneMachine m(each.program, each.shift, each.exec_bits);
    for (const std::uint32_t word : each.sent) m.rig.pio(txf, word);
    m.start();
    m.run_to(60);
    const std::uint32_t left = m.rig.read_pio(flevel);
    EXPECT_EQ(left & 15u, each.program == status_program ? each.sent.size() : 0u);
    // Autopush continues until its FIFO is full, and then stalls.
    const bool pushes_on = (each.shift & autopush) != 0;
    EXPECT_EQ(left >> 4 & 15u, pushes_on ? 4u : each.received.size());
    EXPECT_EQ(m.rig.read_pio(fdebug) & 0xfu, pushes_on ? 1u : 0u);
    for (const std::uint32_t word : each.received) EXPECT_EQ(m.rig.read_pio(rxf), word);
  }
}

TEST(PioFifo, InPinsRotatesByBase) {
  OneMachine m({in(pins, 4), push(), jmp(always, 2)}, Pins{.in_base = 20}, 0, 0);
  for (const unsigned gpio : {20u, 22u}) m.rig.drive(gpio, true);
  m.rig.run(3);
  m.start();
  m.run_to(10);
  EXPECT_EQ(m.rig.read_pio(rxf), 5u);
}

TEST(PioFifo, PullStallsUntilAWordArrives) {
  OneMachine m({pull(), set(pins, 1), jmp(always, 2)});
  m.start();
  m.run_to(48);
  m.rig.pio(fdebug, ~0u);
  EXPECT_EQ(m.rig.read_pio(fdebug), 0u);
  m.run_to(50);
  EXPECT_EQ(m.rig.read_pio(fdebug), 1u << 24) << "set again while the stall lasts";
  m.rig.pio(txf, 1);  // written in 50: pull 51, set 52, pad 53
  m.run_to(60);
  EXPECT_EQ(m.edges(), (Longs{53}));
}

TEST(PioFifo, PushStallsOrDrops) {
  for (const bool block : {true, false}) {
    OneMachine m(
        {set(x, 7), in(x, 32), push(false, block), set(pins, 1), set(pins, 0), jmp(always, 1)});
    m.start();
    m.run_to(200);
    EXPECT_EQ(m.rig.read_pio(fdebug), 1u);
    EXPECT_EQ(m.rig.read_pio(flevel), 4u << 4);
    const Longs edges = m.edges();
    if (!block) {
      EXPECT_GT(edges.size(), 60u);
      continue;
    }
    EXPECT_EQ(edges.size(), 8u);
    EXPECT_EQ(m.rig.read_pio(rxf), 7u);  // popped in 200: push 201, set 202, pad 203
    m.run_to(300);
    ASSERT_EQ(m.edges().size(), 10u);
    EXPECT_EQ(m.edges()[8], 203);
  }
}

TEST(PioFifo, AutopullFillsInTheBackground) {
  // The OSR fills while other instructions execute, so the OUT does not lose a cycle.
  OneMachine m({nop(3), out(pins, 32), set(y, 1)}, Pins{.out_base = 0, .out_count = 1},
               both_right | 1u << 17, 0);
  m.start();
  m.run_to(2);  // in the delay of the first instruction
  m.rig.pio(txf, 1);
  m.run_to(3);
  EXPECT_EQ(m.rig.read_pio(flevel), 0u);  // pulled in cycle 3, a tick of the delay
  m.run_to(20);
  EXPECT_EQ(m.edges(), (Longs{5}));  // OUT in cycle 4
}

TEST(PioFifo, JoinGivesEightAndFlushes) {
  Rig rig;
  rig.pio(txf, 1);
  rig.pio(shiftctrl, both_right | 1u << 30);
  EXPECT_EQ(rig.read_pio(flevel), 0u);
  for (int i = 0; i < 8; ++i) rig.pio(txf, 1);
  EXPECT_EQ(rig.read_pio(flevel), 8u);
  EXPECT_EQ(rig.read_pio(fdebug), 0u);
  rig.pio(txf, 1);
  EXPECT_EQ(rig.read_pio(fdebug), 1u << 16);
  EXPECT_EQ(rig.read_pio(flevel), 8u);
  rig.read_pio(rxf);
  EXPECT_EQ(rig.read_pio(fdebug), 1u << 16 | 1u << 8);
  rig.pio(fdebug, 1u << 8);
  EXPECT_EQ(rig.read_pio(fdebug), 1u << 16);
}

// ---------------------------------------------------------------------------------------------
// Side-set, several machines, flags

TEST(PioSideSet, HappensAtOnceEvenIfTheInstructionStalls) {
  // Two side-set bits, one of them the enable.
  const auto side = [](Word word, unsigned v) { return with(word, (2u | v) << 3); };
  OneMachine m({nop(), side(pull(), 1), nop(), side(nop(), 0), jmp(always, 4)},
               Pins{.side_base = 2, .side_count = 2}, both_right, 1u << 30);
  m.start();
  m.run_to(40);
  EXPECT_EQ(m.edges(2), (Longs{2}));
  m.rig.pio(txf, 0);
  m.run_to(60);
  EXPECT_EQ(m.edges(2), (Longs{2, 44}));  // pull 41, nop 42, side 43, pad 44
}

TEST(PioSideSet, WinsOverSetAndCanDriveDirections) {
  OneMachine m({with(set(pins, 1), 0u << 4)},
               Pins{.set_base = 0, .side_base = 0, .set_count = 2, .side_count = 1}, both_right, 0);
  m.start();
  m.run_to(10);
  EXPECT_TRUE(m.edges().empty());
  OneMachine d({with(nop(), 1u << 4), with(nop(), 0)}, Pins{.side_base = 5, .side_count = 1},
               both_right, 1u << 29);
  d.start();
  d.run_to(1);
  EXPECT_EQ(d.rig.read_pio(padoe) >> 5 & 1u, 0u);
  d.run_to(2);
  EXPECT_EQ(d.rig.read_pio(padoe) >> 5 & 1u, 1u);
}

TEST(PioPins, HighestMachineWins) {
  Rig rig;
  rig.connect(0, 1);
  const Pins map{.set_base = 0, .set_count = 1};
  rig.machine(0, {set(pins, 1), set(pins, 1), set(pins, 1)}, map, 0);
  rig.machine(2, {set(pins, 0), nop(), set(pins, 1)}, map, 4);
  const Cycle first = rig.start(5);
  rig.run(6);
  EXPECT_EQ(rig.edges_of(0, first), (Longs{2, 4, 5}));
}

// Groups of pins wrap after 31 (3.5.6): from 28, the fifth is GPIO0.
TEST(PioPins, GroupsWrapAfterThirtyOne) {
  Rig rig;
  rig.connect(28, 2);
  rig.connect(0, 2);
  const Pins map{.set_base = 28, .set_count = 5};
  rig.machine(0, {set(pins, 0b10001), set(pins, 0), jmp(always, 2)}, map);
  const Cycle first = rig.start(1);
  rig.run(10);
  for (const unsigned gpio : {28u, 0u})
    EXPECT_EQ(rig.edges_of(gpio, first), (Longs{1, 2})) << "gpio" << gpio;
  for (const unsigned gpio : {29u, 1u}) EXPECT_EQ(rig.edges_of(gpio, first), Longs{});
}

TEST(PioPins, StickyAssertsAgainAndInlineEnableReleases) {
  // Machine 1 is sticky and higher: machine 0 cannot change the pin until the enable bit is 0.
  Rig rig;
  rig.connect(0, 1);
  rig.machine(0, {set(pins, 0, 7)}, Pins{.set_base = 0, .set_count = 1}, 0);
  rig.machine(1, {out(pins, 2), nop(20), out(pins, 2), jmp(always, 7)},
              Pins{.out_base = 0, .out_count = 1}, 4, 0, both_right | 1u << 17,
              1u << 17 | 1u << 18 | 1u << 19);
  rig.pio(txf + 4, 0b0011);  // first 1 with enable, then 0 without
  rig.run(1);
  const Cycle first = rig.start(3);
  rig.run(60);
  // OUT in 1 (0 fills the OSR); nop to 22; OUT in 23 releases; machine 0 writes in 24.
  EXPECT_EQ(rig.edges_of(0, first), (Longs{2, 25}));
}

TEST(PioIrq, IrqWaitStallsUntilItIsCleared) {
  OneMachine m({irq_set(3, true, 2), set(pins, 1), jmp(always, 2)});
  m.start();
  m.run_to(50);
  EXPECT_EQ(m.rig.read_pio(irq), 8u);
  m.rig.pio(irq, 8);  // seen low in 51, two cycles of delay, SET 54
  m.run_to(60);
  EXPECT_EQ(m.edges(), (Longs{55}));
}

TEST(PioIrq, RelativeAddsTheMachineNumberModuloFour) {
  Rig rig;
  rig.machine(3, {irq_set(0x10 | 2), irq_set(0x10 | 6), jmp(always, 2)}, Pins{}, 0);
  rig.start(8);
  rig.run(10);
  EXPECT_EQ(rig.read_pio(irq), 1u << 1 | 1u << 5);
  rig.pio(irq_force, 0x80);
  EXPECT_EQ(rig.read_pio(irq), 1u << 1 | 1u << 5 | 0x80u);
}

TEST(PioIrq, LinesFollowFlagsAndFifos) {
  Rig rig;
  const auto line = [&](Irq which) {
    return (rig.irqs.levels() >> static_cast<unsigned>(which) & 1u) != 0;
  };
  EXPECT_EQ(rig.read_pio(intr), 0xf0u);  // TX not full
  rig.pio(irq0_inte, 1u << 8);
  rig.pio(irq1_inte, 1u << 1);
  EXPECT_FALSE(line(Irq::pio0_0));
  rig.pio(irq_force, 1);
  EXPECT_TRUE(line(Irq::pio0_0));
  EXPECT_EQ(rig.read_pio(irq0_ints), 1u << 8);
  rig.pio(irq, 1);
  EXPECT_FALSE(line(Irq::pio0_0));
  rig.machine(1, {push(), jmp(always, 1)}, Pins{});
  rig.start(2);
  EXPECT_FALSE(line(Irq::pio0_1));
  rig.run(1);
  EXPECT_TRUE(line(Irq::pio0_1));
  rig.read_pio(rxf + 4);
  EXPECT_FALSE(line(Irq::pio0_1));
  rig.pio(irq0_intf, 4);
  EXPECT_TRUE(line(Irq::pio0_0));
  EXPECT_EQ(rig.read_pio(irq0_ints), 4u);
}

// ---------------------------------------------------------------------------------------------
// Forced instructions, restart, registers

TEST(PioExec, ForcedInstructionIgnoresDividerAndDelayAndKeepsThePlace) {
  OneMachine m({set(y, 1), jmp(always, 1)});
  m.rig.pio(clkdiv, 1000u << 16);
  m.start();
  m.run_to(500);
  m.rig.pio(instr, set(pins, 1, 31));
  m.run_to(502);
  EXPECT_EQ(m.edges(), (Longs{502}));
  EXPECT_EQ(m.rig.read_pio(addr), 1u);
  m.rig.pio(instr, jmp(always, 9));
  m.rig.run(1);
  EXPECT_EQ(m.rig.read_pio(addr), 9u);
}

TEST(PioExec, StalledForcedInstructionIsLatched) {
  OneMachine m({set(pins, 1), set(pins, 0)});
  m.rig.pio(instr, pull());
  m.rig.run(5);
  EXPECT_NE(m.rig.read_pio(execctrl) >> 31, 0u);
  m.start();
  m.run_to(10);
  EXPECT_TRUE(m.edges().empty());  // the program waits for it
  m.rig.pio(txf, 0);               // pull in 11, SET in 12
  m.run_to(12);
  EXPECT_EQ(m.rig.read_pio(execctrl) >> 31, 0u);
  m.run_to(13);
  EXPECT_EQ(m.edges(), (Longs{13}));
}

TEST(PioExec, RestartClearsTheStateListedInTheDatasheet) {
  OneMachine m({set(x, 3), in(x, 8), out(y, 4), irq_set(1, true, 31), jmp(always, 4)});
  m.start();
  m.run_to(20);
  m.rig.pio(ctrl, 0);
  m.rig.pio(ctrl, 1u << 4);
  m.rig.pio(instr, mov(x, isr));  // ISR is 0, X is not otherwise
  m.rig.run(2);
  m.rig.pio(instr, in(x, 32));
  m.rig.run(2);
  m.rig.pio(instr, push());
  m.rig.run(2);
  EXPECT_EQ(m.rig.read_pio(rxf), 0u);
  EXPECT_EQ(m.rig.read_pio(addr), 3u);
  EXPECT_EQ(m.rig.read_pio(irq), 2u);
}

TEST(PioExec, DisabledMachineKeepsItsDelay) {
  OneMachine m({set(pins, 1, 20), set(pins, 0, 20)});
  m.start();
  m.run_to(10);
  m.rig.pio(ctrl, 0);  // 10 ticks of the delay done
  m.rig.run(100);
  m.rig.pio(ctrl, 1);
  m.rig.run(30);
  EXPECT_EQ(m.edges(), (Longs{1, 122}));
}

TEST(PioRegisters, ResetValues) {
  Rig rig;
  EXPECT_EQ(rig.read_pio(fstat), 0x0f00'0f00u);
  EXPECT_EQ(rig.read_pio(cfginfo), 0x0020'0404u);
  EXPECT_EQ(rig.read_pio(clkdiv), 0x0001'0000u);
  EXPECT_EQ(rig.read_pio(execctrl), 0x0001'f000u);
  EXPECT_EQ(rig.read_pio(shiftctrl), 0x000c'0000u);
  EXPECT_EQ(rig.read_pio(pinctrl), 0x1400'0000u);
  EXPECT_TRUE(rig.messages.empty());
  rig.read_pio(0x200);
  EXPECT_EQ(rig.messages.size(), 1u);
}

// In a loop in which the machine sleeps, and in instructions run ahead without visible effects.
TEST(PioRegisters, APeekShowsThePresentAddress) {
  const std::vector<Word> program{set(x, 31),       nop(2), set(y, 3),   jmp(y_dec, 3),
                                  jmp(x_dec, 4, 1), nop(),  set(pins, 1)};
  Rig asleep;
  Rig stepped{true};
  for (Rig* rig : {&asleep, &stepped}) {
    rig->connect(0, 1);
    rig->machine(0, program, Pins{.set_count = 1});
    rig->start(1);
  }
  for (int i = 0; i < 200; ++i) {
    for (const std::uint32_t offset : {addr, instr}) {
      EXPECT_EQ(asleep.bus.peek(pio_base[0] + offset, Master::core0), stepped.read_pio(offset))
          << i;
      EXPECT_EQ(asleep.read_pio(offset), stepped.read_pio(offset)) << i;
    }
    asleep.run(1);
    stepped.run(1);
  }
  EXPECT_EQ(asleep.edges, stepped.edges);
}

// For flags that a written 1 clears, an alias clears the written bits.
TEST(PioRegisters, AliasesSetAndClearBitsAndClearOnlyTheWrittenFlags) {
  Rig rig;
  rig.pio(pinctrl + 0x2000, 0x1f);
  EXPECT_EQ(rig.read_pio(pinctrl), 0x1400'001fu);
  rig.pio(pinctrl + 0x3000, 0x1000'0001u);
  EXPECT_EQ(rig.read_pio(pinctrl), 0x0400'001eu);
  rig.pio(irq_force, 0x0f);
  rig.pio(irq + 0x2000, 0x01);
  EXPECT_EQ(rig.read_pio(irq), 0x0eu);
  rig.pio(irq + 0x3000, 0x02);
  EXPECT_EQ(rig.read_pio(irq), 0x0cu);
  for (int i = 0; i < 5; ++i) rig.pio(txf, 0);  // TXOVER 0
  rig.read_pio(rxf + 4);                        // RXUNDER 1
  rig.pio(fdebug + 0x3000, 1u << 16);
  EXPECT_EQ(rig.read_pio(fdebug), 1u << 9);
}

// ---------------------------------------------------------------------------------------------
// Kernels of the scheme for ticks and lamp

// TICK: words of (count - 1, low time): OUT count, OUT low; low, then high for 56 - overhead.
// low + 56 clocks per tick, 2 more per word.
std::vector<Word> tick_kernel() {
  return {
      out(x, 8),         // ticks of the word - 1
      out(isr, 24),      // clocks low
      mov(y, isr),       // start of a tick
      jmp(y_dec, 3),     // low + 1
      set(pins, 1, 26),  // 27 high
      nop(24),           // 25 high
      set(pins, 0),      // low again
      jmp(x_dec, 2),
  };
}

TEST(PioKernel, TickIsItsLowTimeAnd56AndTwoAWord) {
  OneMachine m(tick_kernel(), Pins{.set_base = 0, .set_count = 1}, both_right | 1u << 17, 0);
  // 3 ticks with 69, 2 with 10.
  m.rig.pio(txf, 69u << 8 | 2u);
  m.rig.pio(txf, 10u << 8 | 1u);
  m.start();
  m.run_to(2000);
  Longs rises;
  for (std::size_t i = 0; i < m.edges().size(); i += 2) rises.push_back(m.edges()[i]);
  ASSERT_EQ(rises.size(), 5u);
  EXPECT_EQ(rises[1] - rises[0], 69 + 56);
  EXPECT_EQ(rises[2] - rises[1], 69 + 56);
  EXPECT_EQ(rises[3] - rises[2], 10 + 56 + 2);
  EXPECT_EQ(rises[4] - rises[3], 10 + 56);
}

TEST(PioKernel, AxesOfBothBlocksStepFiveClocksAfterTheTick) {
  Rig rig;
  rig.connect(0, 6, 0);
  rig.connect(6, 2, 1);
  rig.connect(25, 1, 1);
  const std::vector<Word> axis = {wait(1, gpio_source, 25), out(pins, 2), wait(0, gpio_source, 25),
                                  set(pins, 0)};
  for (unsigned i = 0; i < 4; ++i) {
    const unsigned block = i == 3 ? 1 : 0, number = i == 3 ? 0 : i;
    rig.machine(number, axis,
                Pins{.out_base = 2 * i, .set_base = 2 * i, .out_count = 2, .set_count = 1}, 0,
                block, both_right | 1u << 17);
    rig.pio(txf + 4 * number, 0b01'00'01'01, block);
  }
  rig.machine(2, tick_kernel(), Pins{.set_base = 25, .set_count = 1}, 8, 1, both_right | 1u << 17);
  rig.load({jmp(y_dec, 11)}, 11, 1);
  rig.load({jmp(x_dec, 10)}, 15, 1);
  rig.pio(txf + 8, 69u << 8 | 3u, 1);
  rig.run(5);
  rig.start(7, 0);
  rig.pio(ctrl, 5, 1);
  const Cycle from = rig.now();
  rig.run(1000);
  const Longs ticks = rig.edges_of(25, from);
  ASSERT_EQ(ticks.size(), 8u);
  for (unsigned i = 0; i < 4; ++i) {
    const Longs steps = rig.edges_of(2 * i, from);
    // Steps on ticks 0, 1 and 3; each pulse as long as the tick line is high.
    EXPECT_EQ(steps, (Longs{ticks[0] + 5, ticks[1] + 5, ticks[2] + 5, ticks[3] + 5, ticks[6] + 5,
                            ticks[7] + 5}))
        << i;
  }
}

// FIRE: filter of 32 samples of LAMP SYNC 8 clocks apart, then one decision by ARM (the JMP pin)
// and the token in the FIFO.
std::vector<Word> fire_kernel() {
  return {
      wait(0, pin_source, 0),
      wait(1, pin_source, 0),
      set(y, 31),
      mov(osr, pins),  // 3: sample; bit 0 is LAMP SYNC
      out(x, 1),
      jmp(not_x, 0),     // low: start again
      jmp(y_dec, 3, 4),  // 8 clocks a sample
      jmp(pin, 9),       // 7: the one decision: armed?
      jmp(always, 16),
      set(x, 0),
      pull(false, false),  // 10: the token, or 0
      mov(x, osr),
      jmp(not_x, 16),
      jmp(x_dec, 13),  // 13: delay; falls through with X = all ones
      mov(isr, x),     // 14: fire; the result is all ones
      jmp(always, 17),
      mov(isr, null),  // 16: not fired: 0
      push(false, false),
  };
}

TEST(PioKernel, FireFiltersAndDecidesOnce) {
  const auto shot = [](bool armed, unsigned delay, Cycle length) {
    Rig rig;
    rig.connect(9, 1);
    const auto program = fire_kernel();
    // The pulse begins by side-set on MOV ISR, X: one side-set bit with enable.
    std::vector<Word> words = program;
    words[14] = with(words[14], 0b11 << 3);
    words[0] = with(words[0], 0b10 << 3);
    words[6] = with(jmp(y_dec, 3), 4);  // delay below the side-set bits
    rig.machine(3, words, Pins{.side_base = 9, .in_base = 8, .side_count = 2}, 0, 0, both_right,
                1u << 30 | 10u << 24);
    rig.drive(10, armed);
    if (delay != 0) rig.pio(txf + 12, delay);
    rig.run(10);
    rig.start(8);
    rig.run(100);
    rig.drive(8, true);
    const Cycle edge = rig.now();
    rig.run(length);
    rig.drive(8, false);
    rig.run(3000);
    Longs result = rig.edges_of(9, edge);
    result.push_back(rig.read_pio(flevel) >> 28 & 15u);
    result.push_back(static_cast<long>(rig.read_pio(rxf + 12)));
    return result;
  };
  const Longs fired = shot(true, 100, 400);
  ASSERT_EQ(fired.size(), 4u);
  EXPECT_EQ(fired[3], 0xffff'ffffL);
  const Longs later = shot(true, 1100, 400);
  EXPECT_EQ(later[0] - fired[0], 1000);
  // WAIT sees the edge in +3; samples are taken in +5, +13, ... +253, of levels three clocks older.
  EXPECT_EQ(shot(true, 100, 250).size(), 2u);
  EXPECT_EQ(shot(true, 100, 251)[0], fired[0]);
  // The last sample, 8 clocks to the end of the loop, 5 for the decision, the delay loop, the
  // latch.
  EXPECT_EQ(fired[0], 253 + 8 + 5 + 101 + 1);
  // Neither without ARM nor without a token.
  EXPECT_EQ(shot(false, 100, 400).size(), 2u);
  EXPECT_EQ(shot(true, 0, 400).size(), 2u);
}

// STAMP: X counts down every two clocks while the pin is polled; each edge costs four clocks and
// two counts, so that the count keeps pace.
TEST(PioKernel, StampTimesEdgesToTwoClocks) {
  const std::vector<Word> stamp = {
      jmp(pin, 2),   jmp(x_dec, 0),                 // low
      in(x, 32),     jmp(x_dec, 4), jmp(x_dec, 5),  // it rose
      jmp(pin, 9),                                  // high
      in(x, 32),     jmp(x_dec, 8), jmp(x_dec, 0),  // it fell
      jmp(x_dec, 5),
  };
  Rig rig;
  rig.machine(0, stamp, Pins{.in_base = 8}, 0, 0, both_right | 1u << 16, 8u << 24);
  rig.pio(instr, mov(x, null, 1));
  rig.run(2);
  const Cycle first = rig.start(1);
  bool level = false;
  for (const Cycle gap : {100'001u, 778u, 500'000'000u, 20'002u, 17u}) {
    rig.run(gap);
    level = !level;
    rig.drive(8, level);
    const long real = static_cast<long>(rig.now() - first);
    rig.run(8);
    const long counted = 2 * static_cast<long>(0xffff'ffffu - rig.read_pio(rxf));
    EXPECT_GE(counted, real + 3);  // the input's flip-flops
    EXPECT_LE(counted, real + 4);  // and a poll every two clocks
  }
}

}  // namespace
}  // namespace lamplock::test::pio::pio_test
