// `lamplock chip` with programs that fault: one image for each kind of fault.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/chip/tiny_image.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::chip_faults {
namespace {

using lamplock::test::boot_image;
using lamplock::test::elf_file;
using lamplock::test::Store;
using lamplock::test::tiny_base;
using lamplock::test::tiny_image;
using lamplock::test::TinySymbol;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

using Code = std::vector<std::uint16_t>;

/// start calls die, which lies at offset 0x20.
const std::vector<TinySymbol> start_and_die{{"start", 0, 0x20}, {"die", 0x20, 0xd0}};

std::string start_calls(const Code& die) {
  Code code{0xf000, 0xf80e};  // start: bl die
  code.resize(0x10, 0xbf00);  // nop
  code.insert(code.end(), die.begin(), die.end());
  return elf_file(boot_image(code), start_and_die);
}

/// die loads `literal`, and one instruction uses it.
std::string die_with(std::uint16_t instruction, std::uint32_t literal) {
  return start_calls({0x4801,       // 20: ldr r0, =literal
                      instruction,  // 22
                      0xe7fe,       // 24: b .
                      0xbf00, static_cast<std::uint16_t>(literal),
                      static_cast<std::uint16_t>(literal >> 16)});
}

/// Expected properties of a fault; an empty `lr` accepts any.
struct Expected {
  std::string kind, title, cause, pc, symbol, lr, lr_symbol;
  int core = 0;
};

const Expected from_die{.kind = "hardfault",
                        .title = "HardFault",
                        .cause = "",
                        .pc = "0x20041f22",
                        .symbol = "die + 0x2",
                        .lr = "0x20041f05",
                        .lr_symbol = "start + 0x4"};

Expected with_cause(Expected expected, const std::string& cause) {
  expected.cause = cause;
  return expected;
}

class ChipFaults : public testing::Test {
 protected:
  /// Runs the image without a script: status 1, and the faults are `expected`, in order.
  void expect_death(const std::string& file, const std::vector<Expected>& expected) {
    const std::string image = folder_.write("image.elf", file);
    const Finished dead = run({"chip", image, "--until", "30ms", "--json"});
    EXPECT_EQ(dead.status, 1);
    const nlohmann::json faults = nlohmann::json::parse(dead.out)["faults"];
    ASSERT_EQ(faults.size(), expected.size()) << dead.out;
    for (std::size_t i = 0; i < expected.size(); ++i)
      expect_fault(faults[i], expected[i], dead.err);
    const std::vector<std::string> said = lines(dead.err);
    const std::string error = said.empty() ? "" : said.back();
    EXPECT_THAT(error,
                MatchesRegex("error: [^\n]+/image.elf: [^\n]+; correct the image, or [^\n]+"));
    EXPECT_THAT(error, HasSubstr(text_of(faults[0], expected[0])));
    expect_allowed(image, expected);
  }

 private:
  static std::string place(const std::string& address, const std::string& symbol) {
    return symbol.empty() ? address : address + " (" + symbol + ")";
  }
  /// The part of a fault's line without the time.
  static std::string text_of(const nlohmann::json& fault, const Expected& expected) {
    return expected.title + " on core " + std::to_string(expected.core) + ", " + expected.cause +
           ", pc " + place(expected.pc, expected.symbol) + ", lr " +
           place(fault["lr"], expected.lr_symbol) + ", cycle " + fault["cycle"].dump() + ", at ";
  }
  static void expect_fault(const nlohmann::json& fault, const Expected& expected,
                           const std::string& summary) {
    SCOPED_TRACE(fault.dump());
    EXPECT_EQ(fault["kind"], expected.kind);
    EXPECT_EQ(fault["core"], expected.core);
    EXPECT_EQ(fault["cause"], expected.cause);
    EXPECT_EQ(fault["pc"], expected.pc);
    EXPECT_EQ(fault["symbol"], expected.symbol);
    if (!expected.lr.empty()) {
      EXPECT_EQ(fault["lr"], expected.lr);
    }
    EXPECT_EQ(fault["lr_symbol"], expected.lr_symbol);
    EXPECT_EQ(fault["allowed"], false);
    EXPECT_GT(fault["cycle"], 1000);
    EXPECT_GT(fault["at_ps"], 1'000'000'000);
    EXPECT_LT(fault["at_ps"], 30'000'000'000);
    EXPECT_THAT(summary, HasSubstr("fault     " + text_of(fault, expected)));
  }
  /// A script that permits all faults passes; a script that permits all but the last fails.
  void expect_allowed(const std::string& image, const std::vector<Expected>& expected) {
    std::string script;
    for (const Expected& each : expected) {
      const std::string less = folder_.write("less.script", script + "at 30ms\nend\n");
      EXPECT_EQ(run({"chip", image, "--script", less}).status, 1);
      script += "allow " + each.kind + '\n';
    }
    script = folder_.write("allow.script", script + "at 30ms\nend\n");
    const Finished passed = run({"chip", image, "--script", script, "--json"});
    EXPECT_EQ(passed.status, 0) << passed.err;
    EXPECT_THAT(passed.err, HasSubstr(" (allowed)\n"));
    const nlohmann::json document = nlohmann::json::parse(passed.out);
    for (const nlohmann::json& fault : document["faults"]) EXPECT_EQ(fault["allowed"], true);
  }

  const Folder folder_;
};

TEST_F(ChipFaults, UndefinedInstruction) {
  Expected expected = with_cause(from_die, "undefined instruction");
  expected.pc = "0x20041f20";
  expected.symbol = "die + 0x0";
  expect_death(start_calls({0xde00, 0xe7fe}), {expected});  // udf #0
}

TEST_F(ChipFaults, BreakpointWithoutADebugger) {
  Expected expected = with_cause(from_die, "BKPT without a debugger");
  expected.pc = "0x20041f20";
  expected.symbol = "die + 0x0";
  expect_death(start_calls({0xbe00, 0xe7fe}), {expected});
}

TEST_F(ChipFaults, ReadFromABadAddress) {
  expect_death(die_with(0x6800, 0x3000'0000),  // ldr r0, [r0]
               {with_cause(from_die, "read from 0x30000000 failed")});
}

TEST_F(ChipFaults, WriteToABadAddress) {
  expect_death(die_with(0x6000, 0x3000'0000),  // str r0, [r0]
               {with_cause(from_die, "write to 0x30000000 failed")});
}

TEST_F(ChipFaults, UnalignedAccess) {
  expect_death(die_with(0x6800, 0x2000'0002),
               {with_cause(from_die, "unaligned access to 0x20000002")});
}

TEST_F(ChipFaults, BranchToAnEvenAddress) {
  Expected expected = with_cause(from_die, "branch to an even address (Thumb bit clear)");
  expected.pc = "0x20041f24";
  expected.symbol = "die + 0x4";
  expect_death(die_with(0x4700, tiny_base + 0x24), {expected});  // bx r0
}

TEST_F(ChipFaults, BranchToAnAddressWithoutCode) {
  Expected expected = with_cause(from_die, "fetch from 0x40000000 failed");
  expected.pc = "0x40000000";
  expected.symbol = "";
  expect_death(die_with(0x4700, 0x4000'0001), {expected});
}

// The vector table is the program itself: entry 3, HardFault, is the word at offset 12.
TEST_F(ChipFaults, FaultInTheFaultHandlerLocksUp) {
  Code code{0xe00e};  // 00: b begin
  code.resize(0x06, 0xbf00);
  code.insert(code.end(), {0x1f61, 0x2004});  // 0c: the handler at 60, with the Thumb bit
  code.resize(0x10, 0xbf00);
  code.insert(code.end(), {0x4801,            // 20: begin: ldr r0, =VTOR
                           0x4902,            // 22: ldr r1, =table
                           0x6001,            // 24: str r1, [r0]
                           0xde00,            // 26: udf #0
                           0xed08, 0xe000,    // 28: VTOR
                           0x1f00, 0x2004});  // 2c: table
  code.resize(0x30, 0xbf00);
  code.insert(code.end(), {0xbf00, 0xde00});  // 60: handler: nop; udf #0
  const std::string image =
      elf_file(boot_image(code), {{"begin", 0x20, 0x20}, {"handler", 0x60, 0x10}});
  expect_death(image, {{"hardfault", "HardFault", "undefined instruction", "0x20041f26",
                        "begin + 0x6", "0x00000000", ""},
                       {"lockup", "lock-up", "undefined instruction", "0x20041f62", "handler + 0x2",
                        "0xfffffff9", ""}});
}

TEST_F(ChipFaults, BadStackPointerAtBootLocksUp) {
  const std::string image = start_calls({0x4801,            // 20: ldr r0, =stack
                                         0x4685,            // 22: mov sp, r0
                                         0xb500,            // 24: push {lr}
                                         0xe7fe,            // 26: b .
                                         0x0000, 0x3000});  // 28: stack
  Expected push = with_cause(from_die, "write to 0x2ffffffc failed");
  push.pc = "0x20041f24";
  push.symbol = "die + 0x4";
  Expected frame = push;
  frame.kind = "lockup";
  frame.title = "lock-up";
  frame.cause = "the exception frame cannot be written to 0x2fffffe0";
  expect_death(image, {push, frame});
}

TEST_F(ChipFaults, RandomBytesHaveABadBootBlock) {
  const Folder folder;
  std::mt19937 random(1);
  std::string noise(4096, '\0');
  for (char& byte : noise) byte = static_cast<char>(random());
  const std::string image = folder.write("noise.bin", noise);
  const Finished dead = run({"chip", image, "--until", "30ms", "--json"});
  EXPECT_EQ(dead.status, 1);
  const nlohmann::json faults = nlohmann::json::parse(dead.out)["faults"];
  ASSERT_EQ(faults.size(), 1u) << dead.out;
  EXPECT_EQ(faults[0]["kind"], "bootblock");
  EXPECT_EQ(faults[0]["core"], 0);
  EXPECT_EQ(faults[0]["symbol"], "boot ROM");
  EXPECT_GT(faults[0]["cycle"], 1000);
  EXPECT_THAT(dead.err, HasSubstr("noise.bin: bad boot block on core 0, the checksum of the first "
                                  "256 bytes of the flash is wrong, pc 0x0000"));
  const std::string script = folder.write("t.script", "allow bootblock\nat 30ms\nend\n");
  EXPECT_EQ(run({"chip", image, "--script", script}).status, 0);
}

// PSM_WDSEL: all but the oscillators; ticks of 12 cycles; two counts a tick (erratum E1).
const std::vector<Store> watchdog_set_up{
    {0x4001'0008, 0x1'fffc}, {0x4005'802c, 1u << 9 | 12}, {0x4005'8004, 100}};

TEST_F(ChipFaults, WatchdogThatIsNotFed) {
  std::vector<Store> stores = watchdog_set_up;
  stores.emplace_back(0x4005'a000, 1u << 30);  // ENABLE
  const std::string image = elf_file(tiny_image({0xe7fe, 0xbf00}, stores), {{"hang", 12, 4}});
  expect_death(image, {{"watchdog", "watchdog reset", "its time ran out", "0x20041f0c",
                        "hang + 0x0", "0x00000000", ""}});
}

TEST_F(ChipFaults, WatchdogThatIsForced) {
  std::vector<Store> stores = watchdog_set_up;
  stores.emplace_back(0x4005'a000, 1u << 31);  // TRIGGER
  const std::string image =
      elf_file(tiny_image({0xe7fe, 0xbf00}, stores), {{"start", 0, 12}, {"hang", 12, 4}});
  expect_death(image, {{"watchdog", "watchdog reset", "forced by TRIGGER", "0x20041f08",
                        "start + 0x8", "0x00000000", ""}});
}

// Core 0 starts core 1 by the words of the datasheet, 2.8.2, and keeps running; entry 3 of the
// vector table of core 1 is code, an even number.
TEST_F(ChipFaults, CoreOneDiesWhileCoreZeroLives) {
  const Code code{
      0x200d,                                          // 00: movs r0, #13
      0x0700,                                          // 02: lsls r0, r0, #28: SIO
      0xa40b,                                          // 04: again: adr r4, words
      0xcc02,                                          // 06: next: ldmia r4!, {r1}
      0x2900,                                          // 08: cmp r1, #0
      0xd104,                                          // 0a: bne send
      0x6d02,                                          // 0c: drain: ldr r2, [r0, #0x50], FIFO_ST
      0x0852,                                          // 0e: lsrs r2, r2, #1: VLD
      0xd301,                                          // 10: bcc send
      0x6d82,                                          // 12: ldr r2, [r0, #0x58], FIFO_RD
      0xe7fa,                                          // 14: b drain
      0x6541,                                          // 16: send: str r1, [r0, #0x54], FIFO_WR
      0xbf40,                                          // 18: sev
      0x6d02,                                          // 1a: wait: ldr r2, [r0, #0x50]
      0x0852,                                          // 1c: lsrs r2, r2, #1
      0xd3fc,                                          // 1e: bcc wait
      0x6d82,                                          // 20: ldr r2, [r0, #0x58]
      0x428a,                                          // 22: cmp r2, r1
      0xd1ee,                                          // 24: bne again
      0xa509,                                          // 26: adr r5, end of words
      0x42ac,                                          // 28: cmp r4, r5
      0xd1ec,                                          // 2a: bne next
      0xe7fe,                                          // 2c: b .
      0xbf00,                                          // 2e
      0xde00, 0xbf00,                                  // 30: core1: udf #0
      0,      0,      0,      0,      1,      0,       // 34: words: 0, 0, 1,
      0x1f00, 0x2004, 0x0000, 0x2004, 0x1f31, 0x2004,  // VTOR, SP, entry
  };
  const std::string image = elf_file(boot_image(code), {{"start", 0, 0x30}, {"core1", 0x30, 4}});
  expect_death(image, {{"hardfault", "HardFault", "undefined instruction", "0x20041f30",
                        "core1 + 0x0", "", "boot ROM", 1},
                       {"lockup", "lock-up", "branch to an even address (Thumb bit clear)",
                        "0x08526d02", "", "0xfffffff9", "", 1}});
}

TEST_F(ChipFaults, AProgramThatKeepsRunningHasNoFault) {
  const Folder folder;
  const std::string image =
      folder.write("alive.elf", elf_file(boot_image({0xe7fe}), {{"live", 0, 2}}));
  const Finished alive = run({"chip", image, "--until", "30ms", "--json"});
  EXPECT_EQ(alive.status, 0) << alive.err;
  EXPECT_EQ(nlohmann::json::parse(alive.out)["faults"], nlohmann::json::array());
  EXPECT_THAT(alive.err, Not(HasSubstr("fault")));
}

TEST_F(ChipFaults, AFaultIsReportedAsTheReasonForAFailedScript) {
  const Folder folder;
  const std::string image = folder.write("dead.elf", start_calls({0xde00, 0xe7fe}));
  const std::string late = folder.write("late.script", "at 20ms\nexpect gpio9 high\n");
  EXPECT_THAT(run({"chip", image, "--script", late}).err, HasSubstr("dead.elf: HardFault on core"));
  const std::string early = folder.write("early.script", "at 1ms\nexpect gpio9 high\n");
  EXPECT_THAT(run({"chip", image, "--script", early}).err,
              HasSubstr("early.script:2: expected gpio9 high"));
  const std::string wrong = folder.write("wrong.script", "allow everything\n");
  const Finished refused = run({"chip", image, "--script", wrong});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("wrong.script:1: 'everything' is not a fault; give hardfault, "
                                     "lockup, bootblock or watchdog"));
}

}  // namespace
}  // namespace lamplock::cli::test::chip_faults
