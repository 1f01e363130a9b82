// The boot ROM executed by a core: tables, functions, flash operations, the start of the chip; and
// the profile of such a core.
#include "sim/chip/rom/boot_rom.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <deque>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "shared/boards/boot2_crc32.hpp"
#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/xip.hpp"
#include "sim/chip/profile/profile.hpp"
#include "sim/chip/profile/shadow_stack.hpp"
#include "sim/chip/rom/rom_on_core.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::rom_test {
namespace {

/// Registers that store what is written; RESETS answers that everything is done.
struct PlainBlock final : Peripheral {
  explicit PlainBlock(bool is_done = false) : done(is_done) {}
  std::string_view name() const override { return "PLAIN"; }
  std::uint32_t read(std::uint32_t offset) override { return peek(offset); }
  std::uint32_t peek(std::uint32_t offset) const override {
    if (done && offset == 8) return ~words.at(0);
    const auto found = words.find(offset);
    return found == words.end() ? 0 : found->second;
  }
  void write(std::uint32_t offset, std::uint32_t value) override { words[offset] = value; }
  std::uint32_t write_clear_bits(std::uint32_t) const override { return 0; }
  void reset() override { words.clear(); }
  bool done;
  std::map<std::uint32_t, std::uint32_t> words{{0, 0}};
};

/// The FIFOs between the cores as core 1 sees them.
struct Mailbox final : Peripheral {
  std::string_view name() const override { return "SIO"; }
  std::uint32_t read(std::uint32_t offset) override {
    if (offset == 0x50) return (in.empty() ? 0u : 1u) | (out.size() < 8 ? 2u : 0u);
    if (offset != 0x58 || in.empty()) return 0;
    const std::uint32_t word = in.front();
    in.pop_front();
    return word;
  }
  std::uint32_t peek(std::uint32_t) const override { return 0; }
  void write(std::uint32_t offset, std::uint32_t value) override {
    if (offset == 0x54) out.push_back(value);
  }
  std::uint32_t write_clear_bits(std::uint32_t) const override { return 0; }
  void reset() override {}
  std::deque<std::uint32_t> in, out;
};

/// The parts of a chip that the ROM uses.
struct Chip {
  explicit Chip(int id = 0, std::uint64_t seed = 1)
      : bus(wheel, timing, note),
        flash(FlashChip::default_size, {}, note, seed),
        xip(wheel, bus, flash, note),
        rom(bus.rom(), xip.pins(), note),
        core(id, bus, wheel, irqs, timing, note) {
    bus.map(0x4000'4000, syscfg);
    bus.map(0x4000'8000, clocks);
    bus.map(0x4000'c000, resets);
    bus.map(0x4001'0000, psm);
    bus.map(0x4001'8000, xip.pins().io());
    bus.map(0x4002'0000, xip.pins().pads());
    bus.map(0x4005'8000, watchdog);
    bus.map(0x4006'4000, chip_reset);
    bus.map_sio(mailbox, mailbox);
    attach_rom(rom, core, bus);
  }
  void put(std::uint32_t address, const std::vector<std::uint16_t>& code) {
    std::memcpy(bus.memory_at(address).data(), code.data(), code.size() * 2);
  }
  void start() {
    rom.reset();
    core.reset(0);
  }
  /// Runs until the program counter gets to `stop`; false after `limit` cycles.
  bool run_to(std::uint32_t stop, Cycle limit = 100'000'000) {
    const Cycle end = core.cycle() + limit;
    while (core.cycle() < end) {
      if (core.reg(15) == stop) return true;
      if (core.step() == 0) return false;
    }
    return false;
  }
  /// The core is about to call a function from code in SRAM.
  void prepare_call(std::uint32_t function, const std::vector<std::uint32_t>& arguments) {
    core.reset(0);
    put(0x2000'0000, {0x47b8, 0xe7fe});  // BLX r7; B .
    for (unsigned i = 0; i < arguments.size(); ++i) core.set_reg(i, arguments[i]);
    core.set_reg(7, function);
    core.set_reg(15, 0x2000'0000);
  }
  /// Calls a function from code in SRAM; returns its result and its cycles without the BLX.
  std::uint32_t call(std::uint32_t function, const std::vector<std::uint32_t>& arguments,
                     Cycle limit = 100'000'000) {
    prepare_call(function, arguments);
    for (unsigned i = 4; i < 7; ++i) core.set_reg(i, 0x1111'1111u * i);
    const Cycle begin = core.cycle();
    EXPECT_TRUE(run_to(0x2000'0002, limit));
    cycles = core.cycle() - begin - 2;
    EXPECT_EQ(core.reg(13), BootRom::boot2_address) << "stack";
    for (unsigned i = 4; i < 7; ++i) EXPECT_EQ(core.reg(i), 0x1111'1111u * i);
    return core.reg(0);
  }
  std::uint32_t call(const char* code, const std::vector<std::uint32_t>& arguments,
                     Cycle limit = 100'000'000) {
    return call(rom.function(code[0], code[1]), arguments, limit);
  }
  /// Prepares writes to the flash, as in RP2040 datasheet 2.8.3.1.3.
  void command_mode() {
    call("IF", {});
    call("EX", {});
  }
  void back_to_xip() {
    call("FC", {});
    call("CX", {});
  }
  void give_boot2(const std::vector<std::uint16_t>& code) {
    std::memset(flash.storage().data(), 0, 256);
    std::memcpy(flash.storage().data(), code.data(), code.size() * 2);
    const std::uint32_t crc = boards::boot2_crc32(flash.storage().first(252));
    std::memcpy(flash.storage().data() + 252, &crc, 4);
  }

  std::set<std::string> reports;
  NotModelled note = [this](const std::string& what) { reports.insert(what); };
  TimeWheel wheel;
  Timing timing;
  IrqLines irqs;
  Bus bus;
  FlashChip flash;
  Xip xip;
  BootRom rom;
  Core core;
  PlainBlock syscfg, clocks, resets{true}, psm, watchdog, chip_reset;
  Mailbox mailbox;
  Cycle cycles = 0;
};

TEST(BootRom, HasItsMagicAndTablesAtTheDatasheetsPlaces) {
  Chip chip;
  const std::span<const std::uint8_t> rom = chip.bus.rom();
  EXPECT_EQ(rom[0x10], 'M');
  EXPECT_EQ(rom[0x11], 'u');
  EXPECT_EQ(rom[0x12], 1);
  EXPECT_EQ(rom[0x13], 3);
  std::set<std::uint32_t> seen;
  for (const char* code : {"P3", "R3", "L3", "T3", "MS", "S4", "MC", "C4", "IF", "EX", "RE", "RP",
                           "FC", "CX", "UB", "WV", "DT", "DE"}) {
    const std::uint32_t at = chip.rom.function(code[0], code[1]);
    EXPECT_EQ(at & 1u, 1u) << code;
    EXPECT_LT(at, Bus::rom_size);
    EXPECT_TRUE(seen.insert(at).second);
  }
  EXPECT_EQ(chip.rom.function('X', 'X'), 0u);
  EXPECT_NE(chip.rom.datum('C', 'R'), 0u);
  EXPECT_NE(chip.rom.datum('G', 'R'), 0u);
}

TEST(BootRom, LooksFunctionsUpForThumbCode) {
  Chip chip;
  // MOVS r3, #0x14; LDRH r0, [r3]; LDRH r2, [r3, #4]; BLX r2; B .
  chip.put(0x2000'0000, {0x2314, 0x8818, 0x889a, 0x4790, 0xe7fe});
  const auto lookup = [&](std::string_view code) {
    chip.core.reset(0);
    chip.core.set_reg(15, 0x2000'0000);
    chip.core.set_reg(1, static_cast<std::uint32_t>(code[0] | code[1] << 8));
    EXPECT_TRUE(chip.run_to(0x2000'0008));
    return chip.core.reg(0);
  };
  for (const char* code : {"P3", "WV", "RP", "IF"})
    EXPECT_EQ(lookup(code), chip.rom.function(code[0], code[1]));
  EXPECT_TRUE(chip.reports.empty());
  EXPECT_EQ(lookup("FS"), 0u)
      << "the begin of the floating-point code, which is not Thumb code here";
  EXPECT_TRUE(chip.reports.contains("ROM function or data 'FS'"));
}

TEST(BootRom, CountsBits) {
  Chip chip;
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(200); ++i) {
    auto value = static_cast<std::uint32_t>(random());
    if (i % 3 == 0) value >>= random() % 32;
    if (i == 0) value = 0;
    EXPECT_EQ(chip.call("P3", {value}), static_cast<std::uint32_t>(std::popcount(value)));
    EXPECT_EQ(chip.cycles, 20u);
    EXPECT_EQ(chip.call("L3", {value}), static_cast<std::uint32_t>(std::countl_zero(value)));
    EXPECT_EQ(chip.call("T3", {value}), static_cast<std::uint32_t>(std::countr_zero(value)));
    std::uint32_t back = 0;
    for (int bit = 0; bit < 32; ++bit) back = back << 1 | (value >> bit & 1u);
    EXPECT_EQ(chip.call("R3", {value}), back);
  }
}

TEST(BootRom, FillsAndCopies) {
  Chip chip;
  std::mt19937_64 random(6);
  const std::span<std::uint8_t> memory = chip.bus.memory_at(0x2000'1000);
  for (int i = 0; i < test::scaled(200); ++i) {
    for (std::size_t k = 0; k < 1024; ++k) memory[k] = static_cast<std::uint8_t>(random());
    std::vector<std::uint8_t> model(memory.begin(), memory.begin() + 1024);
    const bool words = random() % 2 == 0, copy = random() % 2 == 0;
    const std::size_t grain = words ? 4 : 1;
    const std::size_t to = random() % 200 / grain * grain;
    const std::size_t from = 512 + random() % 200 / grain * grain;
    const std::size_t size = random() % 100;
    const auto base = [](std::size_t offset) {
      return 0x2000'1000u + static_cast<std::uint32_t>(offset);
    };
    const auto count = static_cast<std::uint32_t>(size);
    if (copy) {
      EXPECT_EQ(chip.call(words ? "C4" : "MC", {base(to), base(from), count}), base(to));
      for (std::size_t k = 0; k < size; ++k) model[to + k] = model[from + k];
    } else {
      EXPECT_EQ(chip.call(words ? "S4" : "MS", {base(to), 0x1a5, count}), base(to));
      for (std::size_t k = 0; k < size; ++k) model[to + k] = 0xa5;
    }
    ASSERT_TRUE(std::equal(model.begin(), model.end(), memory.begin()));
  }
  // A bad pointer causes a HardFault in the simulated core, not a crash of the simulator.
  chip.prepare_call(chip.rom.function('M', 'S'), {0x3000'0000, 0, 4});
  for (int i = 0; i < 50 && chip.core.exception() == 0; ++i) chip.core.step();
  EXPECT_EQ(chip.core.exception(), 3u);
}

TEST(BootRom, ErasesAndProgramsFlashInItsRealTime) {
  Chip chip;
  chip.wheel.set_frequency(125'000'000);
  std::mt19937_64 random(8);
  for (std::uint8_t& byte : chip.flash.storage()) byte = static_cast<std::uint8_t>(random());
  std::vector<std::uint8_t> model(chip.flash.storage().begin(), chip.flash.storage().end());
  const std::span<std::uint8_t> data = chip.bus.memory_at(0x2000'2000);
  for (std::size_t k = 0; k < 512; ++k) data[k] = static_cast<std::uint8_t>(random());

  chip.command_mode();
  EXPECT_GT(chip.cycles, 12'000u) << "two delays of about 6000 cycles for the pulls";
  chip.call("RE", {0x8000, 0x1000, 0x1'0000, 0xd8});
  EXPECT_GE(chip.cycles, 45 * 125'000u);
  EXPECT_LE(chip.cycles, 45 * 125'000u + 2000);
  std::fill_n(model.begin() + 0x8000, 0x1000, std::uint8_t{0xff});
  chip.call("RP", {0x8100, 0x2000'2000, 512});
  std::copy_n(data.begin(), 512, model.begin() + 0x8100);
  // Two pages: 260 bytes at 48 cycles and 400 us each.
  EXPECT_GE(chip.cycles, 2 * (260 * 48 + 50'000u));
  EXPECT_LE(chip.cycles, 2 * (260 * 48 + 50'000u) + 4000);
  // A block of 64 KiB among sectors.
  chip.call("RE", {0xf000, 0x1'2000, 0x1'0000, 0xd8});
  EXPECT_LE(chip.cycles, (2 * 45 + 150) * 125'000u + 6000);
  std::fill_n(model.begin() + 0xf000, 0x1'2000, std::uint8_t{0xff});
  EXPECT_TRUE(chip.bus.read(0x1000'8100, Width::word, Master::core0, chip.core.cycle()).fault)
      << "command mode";
  chip.back_to_xip();
  EXPECT_TRUE(std::equal(model.begin(), model.end(), chip.flash.storage().begin()));
  const Access access = chip.bus.read(0x1000'8100, Width::byte, Master::core0, chip.core.cycle());
  EXPECT_FALSE(access.fault);
  EXPECT_EQ(access.value, data[0]);
  chip.reports.erase("XIP read while no flash is mapped");
  EXPECT_TRUE(chip.reports.empty()) << *chip.reports.begin();
}

TEST(BootRom, ProgramsFromAddressZeroToo) {
  Chip chip;
  chip.command_mode();
  chip.call("RP", {0x8000, 0, 256});
  EXPECT_TRUE(std::equal(chip.bus.rom().begin(), chip.bus.rom().begin() + 256,
                         chip.flash.storage().begin() + 0x8000));
  EXPECT_EQ(chip.flash.counts().sectors_erased, 0u);
}

TEST(BootRom, LeavesContinuousReadMode) {
  Chip chip;
  chip.flash.select(0);
  chip.flash.transfer(0xeb, 0);
  for (int i = 0; i < 6; ++i) chip.flash.clock(0, 0);
  chip.flash.clock(0xa, 0);
  chip.flash.clock(0, 0);
  chip.flash.deselect(0);
  ASSERT_TRUE(chip.flash.continuous_read());
  chip.command_mode();
  EXPECT_FALSE(chip.flash.continuous_read());
}

TEST(BootRom, InterruptsRunDuringAnErase) {
  Chip chip;
  chip.wheel.set_frequency(125'000'000);
  chip.command_mode();
  chip.core.reset(0);
  // Vectors at 0x20000100; the handler returns at once.
  const std::uint32_t handler = 0x2000'0201;
  std::memcpy(chip.bus.memory_at(0x2000'0140).data(), &handler, 4);
  chip.put(0x2000'0200, {0x4770});
  chip.core.set_vtor(0x2000'0100);
  // STR r1, [r0] to NVIC_ISER; then BLX r7.
  chip.put(0x2000'0000, {0x6001, 0x2000, 0x2101, 0x0309, 0x47b8, 0xe7fe});
  chip.core.set_reg(0, 0xe000'e100);
  chip.core.set_reg(1, 1);
  chip.core.set_reg(2, 0x1'0000);
  chip.core.set_reg(7, chip.rom.function('R', 'E'));
  chip.core.set_reg(15, 0x2000'0000);
  std::mt19937_64 random(9);
  Cycle raised = 0, longest = 0;
  Cycle next = chip.core.cycle() + 5000;
  int taken = 0;
  while (chip.core.reg(15) != 0x2000'000a) {
    ASSERT_NE(chip.core.step(), 0u);
    if (raised == 0 && chip.core.cycle() >= next) {
      chip.irqs.set(Irq::timer_0, true);
      raised = chip.core.cycle();
    }
    if (raised != 0 && chip.core.exception() == 16) {
      longest = std::max(longest, chip.core.cycle() - raised);
      chip.irqs.set(Irq::timer_0, false);
      raised = 0;
      next = chip.core.cycle() + 1000 + random() % 9000;
      ++taken;
    }
  }
  EXPECT_GT(taken, 500);
  EXPECT_LE(longest, 120u);
  EXPECT_EQ(chip.flash.counts().sectors_erased, 1u);
}

TEST(Boot, CopiesBoot2AndJumpsToIt) {
  Chip chip;
  chip.give_boot2({0xe7fe, 0x1234});
  chip.start();
  ASSERT_TRUE(chip.run_to(BootRom::boot2_address));
  EXPECT_EQ(chip.rom.state(), RomState::running);
  EXPECT_EQ(chip.core.reg(14), 0u);
  EXPECT_EQ(chip.core.reg(13), BootRom::boot2_address);
  EXPECT_TRUE(std::equal(chip.flash.storage().begin(), chip.flash.storage().begin() + 256,
                         chip.bus.memory_at(BootRom::boot2_address).begin()));
  // An attempt takes about 4 ms at 6.5 MHz.
  const double milliseconds = static_cast<double>(chip.wheel.time_of(chip.core.cycle())) / 1e9;
  EXPECT_GT(milliseconds, 3.0);
  EXPECT_LT(milliseconds, 8.0);
  EXPECT_TRUE(chip.reports.empty()) << *chip.reports.begin();
}

TEST(Boot, ABadChecksumEndsInTheUsbLoaderAfterHalfASecond) {
  std::mt19937_64 random(10);
  for (int i = 0; i < test::scaled(3); ++i) {
    Chip chip;
    chip.give_boot2({0xe7fe});
    const std::uint64_t bit = random() % (256 * 8);
    chip.flash.storage()[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    chip.start();
    while (chip.rom.state() != RomState::bootsel) ASSERT_NE(chip.core.step(), 0u);
    const double seconds = static_cast<double>(chip.wheel.time_of(chip.core.cycle())) / 1e12;
    EXPECT_GT(seconds, 0.4);
    EXPECT_LT(seconds, 0.7);
    EXPECT_TRUE(chip.reports.contains(
        "ROM USB boot loader: mass storage (UF2) is not modelled, PICOBOOT only"));
  }
}

TEST(Boot, FindsBoot2OnceTheFlashIsNoLongerBusy) {
  // A watchdog reset during an erase: the flash completes the erase.
  Chip chip;
  chip.give_boot2({0xe7fe});
  chip.flash.select(0);
  chip.flash.transfer(0x06, 0);
  chip.flash.deselect(0);
  chip.flash.select(0);
  for (const std::uint8_t byte : std::array<std::uint8_t, 4>{0x20, 0x01, 0x00, 0x00})
    chip.flash.transfer(byte, 0);
  chip.flash.deselect(0);
  chip.start();
  ASSERT_TRUE(chip.run_to(BootRom::boot2_address));
  EXPECT_GT(chip.wheel.time_of(chip.core.cycle()), 45 * ps_per_ms);
}

TEST(Boot, TheButtonHoldsTheUsbLoader) {
  Chip chip;
  chip.give_boot2({0xe7fe});
  chip.xip.pins().press_bootsel(true);
  chip.start();
  while (chip.rom.state() != RomState::bootsel) ASSERT_NE(chip.core.step(), 0u);
  chip.xip.pins().press_bootsel(false);
  chip.start();
  EXPECT_TRUE(chip.run_to(BootRom::boot2_address));
}

TEST(Boot, UsesTheWatchdogsVectorOnceAndOnlyIfItMatches) {
  const auto start = [](std::uint32_t magic, std::uint32_t check, Chip& chip) {
    chip.give_boot2({0xe7fe});
    chip.put(0x2000'0400, {0x4770});  // BX LR: back to the ordinary start
    chip.watchdog.words[0x1c] = magic;
    chip.watchdog.words[0x20] = check;
    chip.watchdog.words[0x24] = 0x2000'8000;
    chip.watchdog.words[0x28] = 0x2000'0401;
    chip.start();
    bool taken = false;
    for (int i = 0; i < 100; ++i) {
      chip.core.step();
      if (chip.core.reg(15) != 0x2000'0400) continue;
      taken = chip.core.reg(13) == 0x2000'8000 && chip.rom.state() == RomState::running;
    }
    EXPECT_TRUE(chip.run_to(BootRom::boot2_address));
    return taken;
  };
  constexpr std::uint32_t good = 0x2000'0401u ^ 0x4ff8'3f2du;
  Chip a, b, c;
  EXPECT_TRUE(start(0xb007'c0d3, good, a));
  EXPECT_EQ(a.watchdog.words[0x1c], 0u);
  EXPECT_FALSE(start(0xb007'c0d2, good, b));
  EXPECT_EQ(b.watchdog.words[0x1c], 0xb007'c0d2u);
  EXPECT_FALSE(start(0xb007'c0d3, good ^ 4, c));
}

TEST(Boot, ClearsTheNmiMasksUnlessSyscfgIsInReset) {
  for (const bool held : {false, true}) {
    Chip chip;
    chip.resets.words[0] = held ? 1u << 18 : 0;
    chip.syscfg.words = {{0, 5}, {4, 6}};
    chip.give_boot2({0xe7fe});
    chip.start();
    ASSERT_TRUE(chip.run_to(BootRom::boot2_address));
    EXPECT_EQ(chip.syscfg.words[0], held ? 5u : 0u);
    EXPECT_EQ(chip.syscfg.words[4], held ? 6u : 0u);
  }
}

TEST(Boot, TheRescueFlagHalts) {
  Chip chip;
  chip.give_boot2({0xe7fe});
  chip.chip_reset.words[8] = 1u << 24;
  chip.start();
  for (int i = 0; i < 100; ++i) chip.core.step();
  EXPECT_EQ(chip.rom.state(), RomState::rescue);
  EXPECT_TRUE(chip.core.sleeping());
}

TEST(Boot, ResetToUsbBootUsesTheWatchdog) {
  Chip chip;
  chip.prepare_call(chip.rom.function('U', 'B'), {1u << 25, 2});
  for (int i = 0; i < 20; ++i) chip.core.step();
  EXPECT_TRUE(chip.core.sleeping());
  EXPECT_EQ(chip.watchdog.words[0x0c], 1u << 25);
  EXPECT_EQ(chip.watchdog.words[0x10], 2u);
  EXPECT_EQ(chip.watchdog.words[0] >> 30 & 1u, 1u) << "enabled";
  EXPECT_EQ(chip.watchdog.words[4], 10'000u);
  EXPECT_EQ(chip.psm.words[8], 0x1'fffcu);
  // The restart by the watchdog.
  chip.start();
  for (int i = 0; i < 20; ++i) chip.core.step();
  EXPECT_EQ(chip.rom.state(), RomState::bootsel);
}

TEST(Boot, CoreOneWaitsForItsLaunch) {
  Chip chip(1);
  const auto run = [&] {
    for (int i = 0; i < 200; ++i) {
      if (chip.core.idle()) chip.core.send_event();
      chip.core.step();
    }
  };
  chip.start();
  run();
  ASSERT_EQ(chip.mailbox.out, (std::deque<std::uint32_t>{0}));
  chip.put(0x2000'0600, {0xe7fe});
  chip.mailbox.out.clear();
  // As the usual launch code does; a wrong word restarts the sequence.
  const auto exchange = [&](std::uint32_t word) {
    chip.mailbox.in.push_back(word);
    run();
    EXPECT_EQ(chip.mailbox.out.size(), 1u);
    const std::uint32_t answer = chip.mailbox.out.front();
    chip.mailbox.out.clear();
    return answer;
  };
  EXPECT_EQ(exchange(7), 0u);
  for (const std::uint32_t word : {0u, 0u, 1u, 0x2000'0100u, 0x2000'9000u, 0x2000'0601u})
    EXPECT_EQ(exchange(word), word);
  EXPECT_EQ(chip.core.reg(15), 0x2000'0600u);
  EXPECT_EQ(chip.core.reg(13), 0x2000'9000u);
  EXPECT_EQ(chip.core.vtor(), 0x2000'0100u);
}

TEST(Boot, PowerCutsWhileTheRomWritesLeaveOldNewOrTheAllowedMix) {
  std::mt19937_64 random(12);
  int torn = 0;
  for (int i = 0; i < test::scaled(1000); ++i) {
    Chip chip(0, random());
    chip.wheel.set_frequency(125'000'000);
    const std::span<std::uint8_t> data = chip.bus.memory_at(0x2000'2000);
    for (std::size_t k = 0; k < 256; ++k) data[k] = static_cast<std::uint8_t>(random());
    std::vector<std::uint8_t> old(chip.flash.storage().begin(),
                                  chip.flash.storage().begin() + 8192);
    chip.command_mode();
    chip.prepare_call(chip.rom.function('R', 'P'), {0x1000, 0x2000'2000, 256});
    chip.core.run_until(chip.core.cycle() + random() % 66'000);
    chip.wheel.advance_to(chip.core.cycle());
    chip.xip.power_cut();
    bool all_old = true, all_new = true;
    for (std::size_t k = 0; k < 8192; ++k) {
      const bool page = k >= 0x1000 && k < 0x1100;
      const std::uint8_t now = chip.flash.storage()[k];
      const std::uint8_t wanted = page ? data[k - 0x1000] : old[k];
      ASSERT_EQ((now ^ old[k]) & ~(old[k] ^ wanted), 0);
      all_old = all_old && now == old[k];
      all_new = all_new && now == wanted;
    }
    if (!all_old && !all_new) ++torn;
  }
  EXPECT_GT(torn, test::scaled(1000) / 4);
}

TEST(Profile, CountsFunctionsInterruptsAndStack) {
  Chip chip;
  // main at 0: MOVS r0, #3; loop: BL work; SUBS r0, #1; BNE loop; B .
  // work at 0x20: PUSH {r4, lr}; MOVS r4, #10; SUBS r4, #1; BNE; POP {r4, pc}
  chip.put(0x2000'0000, {0x2003, 0xf000, 0xf80d, 0x3801, 0xd1fb, 0xe7fe});
  chip.put(0x2000'0020, {0xb510, 0x240a, 0x3c01, 0xd1fd, 0xbd10});
  const std::uint32_t handler = 0x2000'0201;
  std::memcpy(chip.bus.memory_at(0x2000'0140).data(), &handler, 4);
  chip.put(0x2000'0200, {0x46c0, 0x4770});
  const std::vector<ImageSymbol> symbols = {{"main", 0x2000'0000, 12, true},
                                            {"data", 0x2000'0010, 4, false},
                                            {"work", 0x2000'0020, 10, true},
                                            {"handler", 0x2000'0200, 4, true}};
  chip.core.reset(0);
  chip.core.set_reg(15, 0x2000'0000);
  chip.core.set_reg(13, 0x2000'9000);
  StackGauge stack("main", chip.bus, 0x2000'8000, 0x2000'9000);
  stack.fill();
  {
    ShadowStack calls(chip.core, symbols);
    const Profile profile(calls);
    ASSERT_TRUE(chip.run_to(0x2000'000a, 10'000));
    std::map<std::string, ProfileEntry> found;
    for (const ProfileEntry& entry : profile.functions()) found[entry.name] = entry;
    EXPECT_EQ(found["work"].count, 3u);
    // PUSH 3, MOVS 1, ten SUBS, nine BNE taken 2 and one 1, POP with PC 4+1.
    const Cycle once = 3 + 1 + 10 + 9 * 2 + 1 + 5;
    EXPECT_EQ(found["work"].total, 3 * once);
    EXPECT_EQ(found["work"].longest, once);
    EXPECT_EQ(found["main"].total + found["work"].total, profile.cycles());
    EXPECT_EQ(stack.used(), 8u);
    // An interrupt at the closing loop.
    chip.core.set_vtor(0x2000'0100);
    chip.put(0x2000'0300, {0x6001, 0xe7fe});
    chip.core.set_reg(0, 0xe000'e100);
    chip.core.set_reg(1, 1);
    chip.core.set_reg(15, 0x2000'0300);
    chip.core.step();
    chip.irqs.set(Irq::timer_0, true);
    for (int i = 0; i < 10 && chip.core.exception() == 0; ++i) chip.core.step();
    chip.irqs.set(Irq::timer_0, false);
    for (int i = 0; i < 10 && chip.core.exception() != 0; ++i) chip.core.step();
    const std::vector<ProfileEntry> exceptions = profile.exceptions();
    ASSERT_EQ(exceptions.size(), 1u);
    EXPECT_EQ(exceptions[0].name, "TIMER_0");
    EXPECT_EQ(exceptions[0].count, 1u);
    EXPECT_GE(exceptions[0].total, 13u + 1 + 2) << "entry, NOP, BX";
    EXPECT_LE(exceptions[0].total, 15u + 1 + 2);
    EXPECT_GE(stack.used(), 32u);
    const std::string text = profile.text();
    EXPECT_NE(text.find("work"), std::string::npos);
    EXPECT_NE(text.find("TIMER_0"), std::string::npos);
  }
  chip.core.step();  // without a listener
  EXPECT_THROW(StackGauge("x", chip.bus, 0x3000'0000, 0x3000'0100), std::invalid_argument);
}

}  // namespace
}  // namespace lamplock::sim::chip::rom_test
