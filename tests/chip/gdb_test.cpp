// The debugger's protocol, and the permitted effects of a debugger on the chip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "sim/chip/chip.hpp"
#include "sim/chip/gdb/accesses.hpp"
#include "sim/chip/gdb/server.hpp"
#include "sim/chip/gdb/stub.hpp"
#include "tests/chip/put_code.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::gdb::gdb_test {
namespace {

using test::put;
using test::put_word;
using test::scaled;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string framed(std::string_view payload) {
  unsigned sum = 0;
  for (const char each : payload) sum += static_cast<std::uint8_t>(each);
  const std::uint8_t check = sum & 0xff;
  return "$" + std::string(payload) + "#" + to_hex(std::span(&check, 1));
}

// --- Packets -------------------------------------------------------------------------------------

TEST(GdbPackets, ComeInPiecesOfAnySize) {
  const std::string line = "+" + framed("qC") + "\x03noise" + framed("m0,4");
  for (std::size_t cut = 0; cut <= line.size(); ++cut) {
    Packets packets;
    packets.receive(bytes_of(line.substr(0, cut)));
    packets.receive(bytes_of(line.substr(cut)));
    EXPECT_EQ(packets.next()->payload, "qC") << cut;
    EXPECT_TRUE(packets.next()->interrupt);
    EXPECT_EQ(packets.next()->payload, "m0,4");
    EXPECT_FALSE(packets.next());
    EXPECT_EQ(packets.take_output(), "++");
  }
}

TEST(GdbPackets, DamagedOnesAreRefusedAndLostOnesSentAgain) {
  Packets packets;
  for (const char* bad : {"$qC#b5", "$qC#xx", "$qD#b4", "$qC#b"}) {
    packets.receive(bytes_of(bad));
    EXPECT_FALSE(packets.next()) << bad;
  }
  packets.receive(bytes_of(framed("qC")));  // the last one above was cut off
  EXPECT_EQ(packets.next()->payload, "qC");
  EXPECT_EQ(packets.take_output(), "---+");
  packets.send("OK");
  EXPECT_EQ(packets.take_output(), "$OK#9a");
  packets.receive(bytes_of("-"));
  EXPECT_EQ(packets.take_output(), "$OK#9a");
}

TEST(GdbPackets, EscapesWorkInBothDirections) {
  Packets packets;
  packets.receive(bytes_of(framed("X0,3:}\x03}\x04}]")));
  EXPECT_EQ(packets.next()->payload, "X0,3:#$}");
  packets.take_output();
  packets.send("a#b$c}d*");
  EXPECT_EQ(packets.take_output(), framed("a}\x03"
                                          "b}\x04"
                                          "c}]d}\x0a"));
}

TEST(GdbPackets, AcknowledgementsEndAndBeginAgainWithTheNextDebugger) {
  Packets packets;
  packets.send("OK");
  packets.stop_acknowledging();
  packets.receive(bytes_of("+"));  // acknowledges that OK
  packets.receive(bytes_of(framed("?")));
  EXPECT_EQ(packets.take_output(), "$OK#9a");
  packets.receive(bytes_of("+" + framed("?")));
  EXPECT_EQ(packets.take_output(), "+");
}

TEST(GdbPackets, TooLongOnesAreDropped) {
  Packets packets;
  packets.receive(bytes_of(framed(std::string(Packets::max_size + 1, 'a'))));
  packets.receive(bytes_of(framed("?")));
  EXPECT_EQ(packets.next()->payload, "?");
}

// --- A chip with a small program -----------------------------------------------------------------

constexpr std::uint32_t data = 0x2002'0000;
constexpr std::uint32_t counter0 = data, byte_of_work = data + 5, ticks = data + 8,
                        counter1 = data + 16, log_of_ticks = data + 128;
constexpr std::uint32_t vectors = 0x2003'f000;
constexpr std::uint32_t stack = 0x2004'1000;
// Code of core 0: counts in a loop that calls a function; SysTick with a period of 500 cycles.
constexpr std::uint32_t main0 = 0x2000'0000, loop0 = main0 + 0x0e, store0 = main0 + 0x12,
                        call_work = main0 + 0x14, work = main0 + 0x1a, work_store = main0 + 0x1c,
                        work_return = main0 + 0x1e;
// Its handler logs SysTick's counter, which shows by how many cycles the handler is late.
constexpr std::uint32_t handler = main0 + 0x100;
// Code of core 1: counts by three.
constexpr std::uint32_t main1 = main0 + 0x200, loop1 = main1 + 2, store1 = main1 + 6;

std::uint32_t word(Chip& chip, std::uint32_t address) {
  std::uint32_t value = 0;
  std::memcpy(&value, chip.bus().memory_at(address).data(), sizeof value);
  return value;
}

/// Takes both cores out of the ROM to the begin of their programs.
void start(Chip& chip) {
  put(chip, main0,
      {0x4c07,          // ldr r4, =data
       0x4d08,          // ldr r5, =0xe000e010
       0x4808,          // ldr r0, =499
       0x6068,          // str r0, [r5, #4]
       0x60a8,          // str r0, [r5, #8]
       0x2007,          // movs r0, #7: processor clock, interrupt, enable
       0x6028,          // str r0, [r5]
       0x6820,          // loop0: ldr r0, [r4]
       0x3001,          // adds r0, #1
       0x6020,          // store0: str r0, [r4]
       0xf000, 0xf801,  // call_work: bl work
       0xe7f9,          // b loop0
       0xb510,          // work: push {r4, lr}
       0x7160,          // work_store: strb r0, [r4, #5]
       0xbd10});        // work_return: pop {r4, pc}
  put_word(chip, main0 + 0x20, data);
  put_word(chip, main0 + 0x24, 0xe000'e010);
  put_word(chip, main0 + 0x28, 499);
  put(chip, handler,
      {0x4805,    // ldr r0, =data
       0x6881,    // ldr r1, [r0, #8]
       0x3101,    // adds r1, #1
       0x6081,    // str r1, [r0, #8]
       0x4a04,    // ldr r2, =0xe000e010
       0x6892,    // ldr r2, [r2, #8]
       0xb2cb,    // uxtb r3, r1
       0x009b,    // lsls r3, r3, #2
       0x181b,    // adds r3, r3, r0
       0x3380,    // adds r3, #128
       0x601a,    // str r2, [r3]
       0x4770});  // bx lr
  put_word(chip, handler + 0x18, data);
  put_word(chip, handler + 0x1c, 0xe000'e010);
  put(chip, main1,
      {0x4c02,    // ldr r4, =data
       0x6920,    // loop1: ldr r0, [r4, #16]
       0x3003,    // adds r0, #3
       0x6120,    // store1: str r0, [r4, #16]
       0xe7fb});  // b loop1
  put_word(chip, main1 + 0x0c, data);
  put_word(chip, vectors, stack);
  put_word(chip, vectors + 4, main0 | 1);
  put_word(chip, vectors + 4 * 15, handler | 1);
  put_word(chip, vectors + 0x100, stack + 0x1000);
  put_word(chip, vectors + 0x104, main1 | 1);
  chip.power_on();
  chip.run_until(1000);
  chip.core(0).reset(vectors);
  chip.core(0).set_vtor(vectors);
  chip.core(1).reset(vectors + 0x100);
}

/// A debugger that sends packets.
struct Debugger {
  explicit Debugger(void (*program)(Chip&) = start) {
    program(chip);
    EXPECT_THAT(ask("qSupported:swbreak+;hwbreak+"), HasSubstr("PacketSize=4000"));
  }
  /// The answer to a packet.
  std::string ask(std::string_view packet) {
    stub.receive(bytes_of(framed(packet)));
    return answer();
  }
  /// Payload of the packet in the output; empty if there is none.
  std::string answer() {
    std::string output = stub.take_output();
    const auto first = output.find('$'), last = output.rfind('#');
    if (first == output.npos || last == output.npos) return "none";
    EXPECT_EQ(output.substr(first), framed(output.substr(first + 1, last - first - 1)));
    return output.substr(first + 1, last - first - 1);
  }
  /// Runs the chip and waits until it stops.
  std::string go(std::string_view packet) {
    EXPECT_EQ(ask(packet), "none");
    for (int i = 0; i < 1000 && stub.running(); ++i) stub.run(chip.now() + 1000);
    EXPECT_FALSE(stub.running()) << packet << " does not stop";
    return answer();
  }
  std::uint32_t pc(int core = 0) { return chip.core(core).reg(15); }

  Chip chip;
  DebugTarget target{chip};
  Stub stub{target, false};
};

std::string in_memory_order(std::uint32_t value) {
  std::array<std::uint8_t, 4> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  return to_hex(bytes);
}

std::string pc_in_reply(std::uint32_t pc) { return "f:" + in_memory_order(pc) + ";"; }

TEST(GdbStub, DocumentsComeInPieces) {
  Debugger gdb;
  for (const char* document : {"qXfer:features:read:target.xml:", "qXfer:memory-map:read::"}) {
    const std::string whole = gdb.ask(document + std::string("0,fff"));
    ASSERT_EQ(whole.front(), 'l');
    std::string pieces;
    for (unsigned offset = 0;; offset += 100) {
      std::array<char, 16> range{};
      std::snprintf(range.data(), range.size(), "%x,64", offset);
      const std::string piece = gdb.ask(document + std::string(range.data()));
      pieces += piece.substr(1);
      if (piece.front() == 'l') break;
    }
    EXPECT_EQ(pieces, whole.substr(1));
  }
  EXPECT_THAT(gdb.ask("qXfer:features:read:target.xml:0,fff"),
              HasSubstr("org.gnu.gdb.arm.m-profile"));
  EXPECT_THAT(gdb.ask("qXfer:memory-map:read::0,fff"),
              HasSubstr("type=\"flash\" start=\"268435456\" length=\"2097152\""));
  EXPECT_EQ(gdb.ask("qXfer:auxv:read::0,fff"), "");
}

TEST(GdbStub, CoresAreThreads) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("qfThreadInfo"), "m1,2");
  EXPECT_EQ(gdb.ask("qsThreadInfo"), "l");
  EXPECT_EQ(gdb.ask("qC"), "QC1");
  EXPECT_EQ(gdb.ask("T2"), "OK");
  EXPECT_THAT(gdb.ask("T3"), StartsWith("E"));
  EXPECT_EQ(gdb.ask("Hg2"), "OK");
  EXPECT_EQ(gdb.ask("pf"), in_memory_order(main1));
  EXPECT_EQ(gdb.ask("Hg1"), "OK");
  EXPECT_EQ(gdb.ask("pf"), in_memory_order(main0));
  EXPECT_THAT(gdb.ask("Hg3"), StartsWith("E"));
  EXPECT_EQ(*from_hex(gdb.ask("qThreadExtraInfo,2")), "core 1");
}

TEST(GdbStub, RegistersOfBothCoresAreReadAndWritten) {
  Debugger gdb;
  for (const char* thread : {"Hg1", "Hg2"}) {
    gdb.ask(thread);
    std::string all = gdb.ask("g");
    ASSERT_EQ(all.size(), 8 * DebugTarget::register_count);
    for (unsigned i = 0; i < 13; ++i) {
      const std::string value = in_memory_order(0x1111'1111 * (i % 9) + i);
      EXPECT_EQ(gdb.ask(std::string("P") + "0123456789abc"[i] + "=" + value), "OK");
      all.replace(8 * i, 8, value);
    }
    EXPECT_EQ(gdb.ask("g"), all);
    all.replace(8 * 2, 8, "78563412");
    all.replace(8 * 16, 8, in_memory_order(0xf100'0000));  // all flags and Thumb
    all.replace(8 * 19, 8, "01000000");                    // PRIMASK
    EXPECT_EQ(gdb.ask("G" + all), "OK");
    EXPECT_EQ(gdb.ask("g"), all);
    EXPECT_EQ(gdb.ask("p2"), "78563412");
  }
  EXPECT_TRUE(gdb.chip.core(1).primask());
  EXPECT_THAT(gdb.ask("p15"), StartsWith("E"));
  EXPECT_THAT(gdb.ask("G00"), StartsWith("E"));
}

TEST(GdbStub, MemoryIsReadAndWrittenInAnySize) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("M20020101,5:0102030405"), "OK");
  EXPECT_EQ(gdb.ask("m20020100,8"), "0001020304050000");
  EXPECT_EQ(gdb.ask("X20020103,2:}]#x"), "none");  // '#' ends the packet: damaged
  EXPECT_EQ(gdb.ask("X20020103,2:}]}\x03"), "OK");
  EXPECT_EQ(gdb.ask("m20020103,2"), "7d23");
  // The last bytes of SRAM, and none after them.
  EXPECT_EQ(gdb.ask("m20041ffe,4"), gdb.ask("m20041ffe,2"));
  EXPECT_THAT(gdb.ask("m20042000,4"), StartsWith("E"));
  EXPECT_THAT(gdb.ask("M20042000,1:00"), StartsWith("E"));
  EXPECT_THAT(gdb.ask("M20020100,4:00"), StartsWith("E"));
  // Bank 1 holds words 1, 5, 9, ... (RP2040 datasheet, 2.6.2): word 65 of SRAM is its word 16.
  EXPECT_EQ(gdb.ask("M20000104,4:aabbccdd"), "OK");
  EXPECT_EQ(gdb.ask("m21010040,4"), "aabbccdd");
  EXPECT_EQ(gdb.ask("m21010042,1"), "cc");
}

TEST(GdbStub, RegistersOfBlocksAreReadWithoutSideEffects) {
  Debugger gdb;
  // Reading a spinlock takes it (RP2040 datasheet, 2.3.1.3); SPINLOCK_ST shows all.
  EXPECT_EQ(gdb.ask("md0000100,4"), "00000000");
  EXPECT_EQ(gdb.ask("md000005c,4"), "00000000");
  // CPUID of each core in SIO (2.3.1.1).
  gdb.ask("Hg2");
  EXPECT_EQ(gdb.ask("md0000000,4"), "01000000");
  // CPUID of the Cortex-M0+ r0p1 (2.4.8).
  EXPECT_EQ(gdb.ask("me000ed00,4"), in_memory_order(0x410c'c601));
  EXPECT_THAT(gdb.ask("m60000000,4"), StartsWith("E"));
}

TEST(GdbStub, FlashIsProgrammed) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("vFlashErase:10001000,1000"), "OK");
  EXPECT_EQ(gdb.ask("vFlashWrite:10001002:abc"), "OK");
  EXPECT_EQ(gdb.ask("vFlashDone"), "OK");
  EXPECT_EQ(to_hex(gdb.chip.flash().storage().subspan(0x1000, 6)), "ffff616263ff");
  EXPECT_THAT(gdb.ask("vFlashErase:10200000,1000"), StartsWith("E"));
  EXPECT_THAT(gdb.ask("vFlashWrite:101fffff:ab"), StartsWith("E"));
}

TEST(GdbStub, BreaksBeforeAnInstruction) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("Z0,20000012,2"), "OK");
  const std::string reply = gdb.go("vCont;c");
  EXPECT_THAT(reply, StartsWith("T05"));
  EXPECT_THAT(reply, HasSubstr(pc_in_reply(store0)));
  EXPECT_THAT(reply, HasSubstr("thread:1;swbreak:;"));
  EXPECT_EQ(gdb.pc(), store0);
  EXPECT_EQ(word(gdb.chip, counter0), 0u);
  EXPECT_EQ(gdb.ask("?"), reply);
  // A debugger removes it, steps, and sets it again.
  for (std::uint32_t round = 1; round < 100; ++round) {
    gdb.ask("z0,20000012,2");
    EXPECT_THAT(gdb.go("vCont;s:1"), HasSubstr(pc_in_reply(call_work)));
    gdb.ask("Z0,20000012,2");
    gdb.go("c");
    ASSERT_EQ(gdb.pc(), store0);
    ASSERT_EQ(word(gdb.chip, counter0), round);
  }
}

TEST(GdbStub, BreaksInAnInterruptAndOnTheOtherCore) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("Z1,20000100,2"), "OK");
  EXPECT_THAT(gdb.go("vCont;c"), HasSubstr("thread:1;hwbreak:;"));
  EXPECT_EQ(gdb.chip.core(0).exception(), 15u);
  EXPECT_EQ(*from_hex(gdb.ask("qThreadExtraInfo,1")), "core 0, exception 15");
  EXPECT_EQ(gdb.ask("z1,20000100,2"), "OK");
  EXPECT_EQ(gdb.ask("Z0,20000206,2"), "OK");
  EXPECT_THAT(gdb.go("vCont;c"), HasSubstr("thread:2;swbreak:;"));
  EXPECT_EQ(gdb.pc(1), store1);
  EXPECT_EQ(gdb.ask("qC"), "QC2");
}

TEST(GdbStub, StepsFollowTheProgramAndNotItsInterrupts) {
  Debugger gdb;
  for (int i = 0; i < 7; ++i) gdb.go("vCont;s:1;c");
  const std::array<std::uint32_t, 8> round{loop0, loop0 + 2,  store0,      call_work,
                                           work,  work_store, work_return, call_work + 4};
  for (int i = 0; i < std::max(scaled(200), 200); ++i)  // until SysTick has come
    for (const std::uint32_t expected : round) {
      ASSERT_EQ(gdb.pc(), expected);
      EXPECT_THAT(gdb.go("vCont;s:1;c"), HasSubstr("thread:1;"));
    }
  EXPECT_GT(word(gdb.chip, ticks), 0u);
  // Both cores share one time: the other core has run too.
  EXPECT_GT(word(gdb.chip, counter1), 0u);
  // Steps of the other core.
  gdb.ask("Hg2");
  for (int i = 0; i < 50; ++i) {
    const std::uint32_t before = gdb.pc(1);
    EXPECT_THAT(gdb.go("vCont;s:2;c"), HasSubstr("thread:2;"));
    EXPECT_EQ(gdb.pc(1), before == main1 + 8 ? loop1 : before + 2);
  }
}

TEST(GdbStub, StepsThroughAHandlerAndOutOfIt) {
  Debugger gdb;
  gdb.ask("Z0,20000116,2");  // its last instruction
  gdb.go("c");
  EXPECT_EQ(gdb.chip.core(0).exception(), 15u);
  gdb.ask("z0,20000116,2");
  gdb.go("s");
  EXPECT_EQ(gdb.chip.core(0).exception(), 0u);
  EXPECT_LT(gdb.pc(), main0 + 0x20);
}

struct WatchCase {
  const char* packet;
  const char* reason;  ///< empty: does not stop
};

TEST(GdbStub, WatchesReadsAndWritesOfAByte) {
  for (const auto& [packet, reason] :
       {WatchCase{"Z2,20020005,1", "watch:20020005;"},
        WatchCase{"Z4,20020005,1", "awatch:20020005;"},
        WatchCase{"Z2,20020004,4", "watch:20020004;"}, WatchCase{"Z3,20020005,1", ""},
        WatchCase{"Z4,20020004,1", ""}, WatchCase{"Z4,20020006,2", ""}}) {
    Debugger gdb;
    EXPECT_EQ(gdb.ask(packet), "OK");
    gdb.ask("Z0,2000001e,2");  // after the store
    const std::string reply = gdb.go("vCont;c");
    if (*reason != 0) {
      EXPECT_THAT(reply, HasSubstr(reason)) << packet;
      EXPECT_EQ(gdb.pc(), work_store) << packet;
      EXPECT_EQ(gdb.chip.bus().memory_at(byte_of_work)[0], 0) << packet;
      // Continues from there without removing it.
      EXPECT_THAT(gdb.go("vCont;c"), HasSubstr("swbreak")) << packet;
    }
    EXPECT_EQ(gdb.pc(), work_return) << packet;
    EXPECT_EQ(gdb.chip.bus().memory_at(byte_of_work)[0], 1) << packet;
  }
}

TEST(GdbStub, WatchesReadsStacksAndLiterals) {
  const auto stops_at = [](const char* packet) {
    Debugger gdb;
    gdb.ask(packet);
    gdb.go("c");
    return gdb.pc();
  };
  EXPECT_EQ(stops_at("Z3,20020000,4"), loop0);
  EXPECT_EQ(stops_at("Z2,20040ffc,4"), work);          // PUSH of LR
  EXPECT_EQ(stops_at("Z3,20040ff8,4"), work_return);   // POP of r4
  EXPECT_EQ(stops_at("Z3,20000118,4"), handler);       // literal
  EXPECT_EQ(stops_at("Z3,e000e018,4"), handler + 10);  // SYST_CVR, inside the core
  // The frame of an exception lies below the function's pushed registers; eight words.
  Debugger gdb;
  gdb.ask("Z2,20040fd8,4");
  gdb.go("c");
  EXPECT_TRUE(gdb.chip.core(0).exception_waits());
}

TEST(GdbStub, WatchesTheOtherCore) {
  Debugger gdb;
  gdb.ask("Z2,20020010,4");
  EXPECT_THAT(gdb.go("c"), HasSubstr("thread:2;watch:20020010;"));
  EXPECT_EQ(gdb.pc(1), store1);
}

// A write by no instruction: DMA, or a function of the ROM.
class Behind final : public Timed {
 public:
  Behind(Chip& chip, Cycle when) : chip_(chip), slot_(chip.wheel().add(*this)) {
    chip.wheel().set(slot_, when);
  }
  void run(Cycle) override {
    chip_.wheel().set(slot_, never_cycle);
    put_word(chip_, data + 64, 99);
  }

 private:
  Chip& chip_;
  TimeWheel::Slot slot_;
};

TEST(GdbStub, WatchesWritesWithoutAnInstruction) {
  Debugger gdb;
  const Cycle when = gdb.chip.now() + 5000;
  const Behind behind(gdb.chip, when);
  gdb.ask("Z2,20020040,4");
  EXPECT_THAT(gdb.go("c"), HasSubstr("watch:20020040;"));
  EXPECT_GE(gdb.chip.now(), when);
  EXPECT_LT(gdb.chip.now(), when + 20);
}

TEST(GdbStub, CtrlCStopsAndTimeStops) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("vCont;c"), "none");
  gdb.stub.run(gdb.chip.now() + 5000);
  EXPECT_TRUE(gdb.stub.running());
  EXPECT_EQ(gdb.stub.take_output(), "");
  gdb.stub.receive(bytes_of("\x03"));
  EXPECT_THAT(gdb.answer(), StartsWith("T02"));
  const std::string time = gdb.ask("qRcmd," + to_hex(std::string_view("time")));
  EXPECT_THAT(*from_hex(time), HasSubstr("clk_sys 6500000 Hz"));
  EXPECT_EQ(gdb.ask("qRcmd," + to_hex(std::string_view("time"))), time);
  gdb.stub.receive(bytes_of("\x03"));  // already stopped
  EXPECT_EQ(gdb.answer(), "none");
}

TEST(GdbStub, ResetBeginsInTheRom) {
  Debugger gdb;
  gdb.ask("Z0,20000012,2");
  gdb.go("c");
  EXPECT_EQ(gdb.ask("qRcmd," + to_hex(std::string_view("reset"))), "OK");
  EXPECT_LT(gdb.pc(0), 0x4000u);
  EXPECT_LT(gdb.pc(1), 0x4000u);
  EXPECT_NE(gdb.pc(0), 0u);
}

TEST(GdbStub, DetachLetsTheChipRunAndAnotherDebuggerStopsIt) {
  Debugger gdb;
  gdb.ask("Z0,20000012,2");
  gdb.ask("Z2,20020000,4");
  EXPECT_EQ(gdb.ask("D"), "OK");
  EXPECT_TRUE(gdb.stub.running());
  gdb.stub.run(gdb.chip.now() + 10'000);
  EXPECT_TRUE(gdb.stub.running());
  EXPECT_GT(word(gdb.chip, counter0), 100u);
  EXPECT_THAT(gdb.ask("?"), StartsWith("T05"));
  EXPECT_FALSE(gdb.stub.running());
}

TEST(GdbStub, KillEndsIt) {
  Debugger gdb;
  EXPECT_EQ(gdb.ask("k"), "none");
  EXPECT_TRUE(gdb.stub.killed());
}

TEST(GdbStub, AnswersEveryPacketEvenInvalidOnes) {
  std::mt19937_64 random(7);
  constexpr std::string_view letters = "gGpPmMXZzHTvqQcsCSD?!,;:=-#0123456789abcdef";
  const std::array<std::string, 12> heads{"m",
                                          "M",
                                          "X",
                                          "Z0,",
                                          "z3,",
                                          "H",
                                          "vCont;",
                                          "P",
                                          "vFlashErase:",
                                          "qRcmd,",
                                          "qXfer:features:read:target.xml:",
                                          "G"};
  for (int i = 0; i < scaled(2000); ++i) {
    static Debugger gdb;
    std::string packet = heads[random() % heads.size()];
    for (std::size_t n = random() % 12; n > 0; --n) packet += letters[random() % letters.size()];
    if (packet.find('#') != packet.npos) continue;
    gdb.stub.receive(bytes_of(framed(packet)));
    const std::string output = gdb.stub.take_output();
    EXPECT_TRUE(gdb.stub.running() || gdb.stub.killed() || output.find('$') != output.npos)
        << packet;
    if (gdb.stub.running()) {
      gdb.stub.run(gdb.chip.now() + 10);
      gdb.stub.receive(bytes_of("\x03"));
      gdb.stub.take_output();
    }
  }
}

// --- Inspection changes nothing ------------------------------------------------------------------

struct State {
  std::vector<std::uint8_t> memory;
  std::array<std::uint32_t, 2 * DebugTarget::register_count> registers{};
  std::array<Cycle, 2> cycles{};
  bool operator==(const State&) const = default;
};

State state_of(Chip& chip) {
  State state;
  state.memory.assign(chip.bus().sram().begin(), chip.bus().sram().end());
  DebugTarget target(chip);
  for (int core = 0; core < 2; ++core) {
    state.cycles[static_cast<std::size_t>(core)] = chip.core(core).cycle();
    for (unsigned i = 0; i < DebugTarget::register_count; ++i)
      state.registers[static_cast<unsigned>(core) * DebugTarget::register_count + i] =
          target.reg(core, i);
  }
  return state;
}

/// Debugs at random up to a cycle: breakpoints, watchpoints, steps, reads, interruptions.
void debug_at_random(Debugger& gdb, Cycle end, std::mt19937_64& random) {
  constexpr std::array actions{"Z0,20000012,2",
                               "z0,20000012,2",
                               "Z1,20000100,2",
                               "z1,20000100,2",
                               "Z2,20020005,1",
                               "z2,20020005,1",
                               "Z4,20020010,4",
                               "z4,20020010,4",
                               "Z3,e000e018,4",
                               "z3,e000e018,4",
                               "Z0,20000204,2",
                               "z0,20000204,2",
                               "g",
                               "m20000000,800",
                               "me000e010,10",
                               "md0000100,80",
                               "m40054000,40",
                               "Hg1",
                               "Hg2",
                               "?"};
  constexpr std::array moves{"vCont;c", "vCont;s:1", "vCont;s:2;c", "c", "s"};
  constexpr std::array clears{"z0,20000012,2", "z1,20000100,2", "z0,20000204,2"};
  while (gdb.chip.now() < end) {
    gdb.ask(actions[random() % actions.size()]);
    // Passes a breakpoint as a debugger does: removes all, steps, sets all (or some) again.
    if (random() % 2 == 0)
      for (const char* clear : clears) gdb.ask(clear);
    gdb.ask(moves[random() % moves.size()]);
    for (std::uint64_t n = random() % 20; n > 0 && gdb.stub.running() && gdb.chip.now() < end; --n)
      gdb.stub.run(std::min(end, gdb.chip.now() + random() % 400));
    gdb.stub.receive(bytes_of("\x03"));
    gdb.stub.take_output();
  }
  gdb.ask("D");
  gdb.stub.run(end);
}

TEST(GdbStub, ADebuggerThatOnlyReadsChangesNothing) {
  constexpr Cycle end = 30'000;
  Chip alone;
  start(alone);
  alone.run_until(end);
  const State expected = state_of(alone);
  ASSERT_GT(word(alone, ticks), 50u);
  ASSERT_NE(word(alone, log_of_ticks + 4 * 20), 0u);
  for (int i = 0; i < scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    Debugger gdb;
    debug_at_random(gdb, end, random);
    EXPECT_TRUE(state_of(gdb.chip) == expected) << i;
  }
}

/// Core 0 counts and sends every 256th number to core 1, which sleeps and is woken by SIO_IRQ_PROC1
/// (RP2040 datasheet, 2.3.1.4); its handler logs core 0's count.
void start_with_sleeper(Chip& chip) {
  put(chip, main0,
      {0x4c04,    // ldr r4, =data
       0x4d05,    // ldr r5, =0xd0000000
       0x6820,    // loop: ldr r0, [r4]
       0x3001,    // adds r0, #1
       0x6020,    // str r0, [r4]
       0x0601,    // lsls r1, r0, #24
       0xd1fa,    // bne loop
       0x6568,    // str r0, [r5, #0x54]: FIFO_WR
       0xe7f8});  // b loop
  put_word(chip, main0 + 0x14, data);
  put_word(chip, main0 + 0x18, 0xd000'0000);
  put(chip, main1,
      {0x4902,    // ldr r1, =0xe000e100
       0x4a03,    // ldr r2, =1 << 16
       0x600a,    // str r2, [r1]
       0xbf30,    // loop: wfi
       0xe7fd});  // b loop
  put_word(chip, main1 + 0x0c, 0xe000'e100);
  put_word(chip, main1 + 0x10, 1u << 16);
  put(chip, handler,
      {0x4806,    // ldr r0, =data
       0x6801,    // ldr r1, [r0]
       0x6882,    // ldr r2, [r0, #8]
       0x3201,    // adds r2, #1
       0x6082,    // str r2, [r0, #8]
       0xb2d3,    // uxtb r3, r2
       0x009b,    // lsls r3, r3, #2
       0x181b,    // adds r3, r3, r0
       0x3380,    // adds r3, #128
       0x6019,    // str r1, [r3]
       0x4a02,    // ldr r2, =0xd0000000
       0x6d92,    // ldr r2, [r2, #0x58]: FIFO_RD
       0x4770});  // bx lr
  put_word(chip, handler + 0x1c, data);
  put_word(chip, handler + 0x20, 0xd000'0000);
  put_word(chip, vectors, stack);
  put_word(chip, vectors + 4, main0 | 1);
  put_word(chip, vectors + 0x100, stack + 0x1000);
  put_word(chip, vectors + 0x104, main1 | 1);
  put_word(chip, vectors + 0x100 + 4 * 32, handler | 1);
  chip.power_on();
  chip.run_until(1000);
  chip.core(0).reset(vectors);
  chip.core(1).reset(vectors + 0x100);
  chip.core(1).set_vtor(vectors + 0x100);
}

TEST(GdbStub, ASleeperWakesInTheSameCycleWatchedOrNot) {
  constexpr Cycle end = 200'000;
  Chip alone;
  start_with_sleeper(alone);
  alone.run_until(end);
  const State expected = state_of(alone);
  ASSERT_GT(word(alone, ticks), 40u);
  // The entry takes 15 cycles, then two loads; a round of core 0 takes 8.
  for (std::uint32_t i = 1; i < 40; ++i) {
    EXPECT_GE(word(alone, log_of_ticks + 4 * i), 256 * i);
    EXPECT_LE(word(alone, log_of_ticks + 4 * i), 256 * i + 4);
  }
  for (int i = 0; i < scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    Chip sliced;
    start_with_sleeper(sliced);
    while (sliced.now() < end) sliced.run_until(std::min(end, sliced.now() + 1 + random() % 1000));
    EXPECT_TRUE(state_of(sliced) == expected) << i;
    Debugger gdb(start_with_sleeper);
    debug_at_random(gdb, end, random);
    EXPECT_TRUE(state_of(gdb.chip) == expected) << i;
  }
}

// --- BKPT ----------------------------------------------------------------------------------------

constexpr std::uint32_t bkpt = main0 + 2;

/// Core 0 counts, with a BKPT between two counts; its HardFault handler counts by 256.
void start_with_bkpt(Chip& chip) {
  start(chip);
  put(chip, main0,
      {0x3001,    // adds r0, #1
       0xbe2a,    // bkpt #42
       0x3001,    // adds r0, #1
       0xe7fb});  // b main0
  put(chip, handler,
      {0x31ff,    // adds r1, #255
       0xe7fe});  // b .
  put_word(chip, vectors + 4 * 3, handler | 1);
  chip.core(0).set_reg(0, 0);
  chip.core(0).set_reg(1, 0);
}

// ARMv6-M ARM, C1.6.1: halting debug handles BKPT, and the core stops before it.
TEST(GdbBkpt, StopsBeforeItAndContinuesAfterIt) {
  for (const bool watched : {false, true}) {
    Debugger gdb(start_with_bkpt);
    if (watched) {
      EXPECT_EQ(gdb.ask("Z0,20008000,2"), "OK");
    }
    for (std::uint32_t round = 0; round < 3; ++round) {
      const std::string reply = gdb.go("c");
      EXPECT_THAT(reply, StartsWith("T05"));
      EXPECT_THAT(reply, HasSubstr("swbreak:;"));
      EXPECT_THAT(reply, HasSubstr(pc_in_reply(bkpt)));
      EXPECT_EQ(gdb.chip.core(0).reg(0), 2 * round + 1);
      EXPECT_EQ(gdb.chip.wheel().now(), gdb.chip.core(0).cycle());
    }
  }
}

TEST(GdbBkpt, IsSteppedOver) {
  Debugger gdb(start_with_bkpt);
  gdb.go("c");
  gdb.go("s");
  EXPECT_EQ(gdb.pc(), bkpt + 2);
  EXPECT_EQ(gdb.chip.core(0).reg(0), 1u);
  gdb.go("s");
  EXPECT_EQ(gdb.pc(), bkpt + 4);
  EXPECT_EQ(gdb.chip.core(0).reg(0), 2u);
}

TEST(GdbBkpt, NoInstructionIsSkippedAfterTheDebuggerMovedTheCore) {
  Debugger gdb(start_with_bkpt);
  gdb.go("c");
  gdb.chip.core(0).set_reg(15, main0);
  EXPECT_THAT(gdb.go("c"), HasSubstr(pc_in_reply(bkpt)));
  EXPECT_EQ(gdb.chip.core(0).reg(0), 2u);
}

TEST(GdbBkpt, IsAHardFaultWithoutADebugger) {
  {
    Debugger gdb(start_with_bkpt);
    gdb.go("c");
    EXPECT_EQ(gdb.ask("D"), "OK");
    gdb.chip.run_until(gdb.chip.now() + 100);
    EXPECT_EQ(gdb.chip.core(0).exception(), 3u) << "detached";
  }
  Chip chip;
  start_with_bkpt(chip);
  chip.run_until(chip.core(0).cycle() + 100);
  EXPECT_EQ(chip.core(0).exception(), 3u);
  EXPECT_EQ(chip.core(0).reg(1), 255u);
}

// --- The server ----------------------------------------------------------------------------------

/// A connection with a script: each text is sent after the other side has answered the one before.
class Script final : public ByteEndpoint {
 public:
  explicit Script(std::vector<std::string> packets) : packets_(std::move(packets)) {}
  std::size_t read(std::span<std::uint8_t> bytes) override {
    if (next_ == packets_.size() || waits_) return 0;
    const std::string& line = packets_[next_++];
    waits_ = true;
    std::copy(line.begin(), line.end(), bytes.begin());
    return line.size();
  }
  /// Accepts one byte at a time, as a connection may.
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) {
      waits_ = false;
      return 0;
    }
    heard_ += static_cast<char>(bytes.front());
    return 1;
  }
  std::string address() const override { return "script"; }
  const std::string& heard() const { return heard_; }

 private:
  std::vector<std::string> packets_;
  std::size_t next_ = 0;
  bool waits_ = false;
  std::string heard_;
};

TEST(GdbServer, WaitsForADebuggerAndEndsWithIt) {
  Chip chip;
  start(chip);
  Script script({framed("?"), framed("Z0,20000012,2"), framed("c"), framed("g"), framed("k")});
  Server server(chip, script, Start::halted);
  EXPECT_FALSE(server.run_until(1'000'000'000));
  EXPECT_EQ(chip.core(0).reg(15), store0);
  EXPECT_THAT(script.heard(), HasSubstr(pc_in_reply(store0) + "10:00000001;thread:1;"));
}

TEST(GdbServer, RunsWithoutADebugger) {
  Chip chip, other;
  start(chip);
  start(other);
  Script no_debugger({});
  Server server(chip, no_debugger, Start::running);
  EXPECT_TRUE(server.run_until(300'000));
  other.run_until(300'000);
  EXPECT_TRUE(state_of(chip) == state_of(other));
}

}  // namespace
}  // namespace lamplock::sim::chip::gdb::gdb_test
