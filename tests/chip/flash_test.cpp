// The flash chip against the rules of its datasheet, power cuts, and the serial interface that
// drives it.
#include "sim/chip/flash/flash_chip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/flash/ssi.hpp"
#include "sim/chip/flash/xip.hpp"
#include "tests/chip/random_bytes.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::flash_test {
namespace {

using test::random_bytes;

/// A flash chip and a host that drives each wire.
struct Bench {
  explicit Bench(std::uint64_t seed = 1)
      : flash(
            FlashChip::default_size, {}, [this](const std::string& what) { reports.insert(what); },
            seed) {}

  std::vector<std::uint8_t> command(const std::vector<std::uint8_t>& out, std::size_t in = 0) {
    flash.select(now);
    for (const std::uint8_t byte : out) flash.transfer(byte, now);
    std::vector<std::uint8_t> result;
    for (std::size_t i = 0; i < in; ++i) result.push_back(flash.transfer(0, now));
    flash.deselect(now);
    now += 100 * ps_per_ns;
    return result;
  }
  static std::vector<std::uint8_t> with_address(std::uint8_t code, std::uint32_t address,
                                                const std::vector<std::uint8_t>& data = {}) {
    std::vector<std::uint8_t> out = {code, static_cast<std::uint8_t>(address >> 16),
                                     static_cast<std::uint8_t>(address >> 8),
                                     static_cast<std::uint8_t>(address)};
    for (const std::uint8_t byte : data) out.push_back(byte);
    return out;
  }
  void enable() { command({0x06}); }
  void wait() { now = std::max(now, flash.busy_until()); }
  std::uint8_t status() { return command({0x05}, 1)[0]; }
  void program(std::uint32_t address, const std::vector<std::uint8_t>& data) {
    enable();
    command(with_address(0x02, address, data));
  }
  std::uint8_t at(std::uint32_t address) { return command(with_address(0x03, address), 1)[0]; }
  /// Clocks out a number on `lanes` lines, with the others high.
  void put(std::uint32_t value, unsigned bits, unsigned lanes) {
    const unsigned mask = (1u << lanes) - 1u;
    for (unsigned done = 0; done < bits; done += lanes)
      flash.clock(((value >> (bits - done - lanes)) & mask) | (0xfu & ~mask), now);
  }
  std::uint8_t get(unsigned lanes) {
    unsigned value = 0;
    for (unsigned done = 0; done < 8; done += lanes) {
      const unsigned lines = flash.clock(0xf, now);
      value = value << lanes | (lanes == 1 ? (lines >> 1) & 1u : lines & ((1u << lanes) - 1u));
    }
    return static_cast<std::uint8_t>(value);
  }

  std::set<std::string> reports;
  FlashChip flash;
  Picoseconds now = ps_per_ms;
};

TEST(FlashChip, ReportsItsIdentity) {
  Bench b;
  EXPECT_EQ(b.command({0x9f}, 3), (std::vector<std::uint8_t>{0xef, 0x40, 0x15}));
  EXPECT_EQ(b.command({0x90, 0, 0, 0}, 2), (std::vector<std::uint8_t>{0xef, 0x14}));
  EXPECT_EQ(b.command({0xab, 0, 0, 0}, 1)[0], 0x14);
  b.flash.set_unique_id({1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(b.command({0x4b, 0, 0, 0, 0}, 8), (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_TRUE(b.reports.empty());
  b.command({0x5a, 0, 0, 0, 0}, 4);
  EXPECT_TRUE(b.reports.contains("FLASH command 5Ah"));
}

TEST(FlashChip, SizesAreChecked) {
  EXPECT_THROW(FlashChip(3'000'000), std::invalid_argument);
  EXPECT_THROW(FlashChip(1024), std::invalid_argument);
  EXPECT_NO_THROW(FlashChip(16 * 1024 * 1024));
}

TEST(FlashChip, ProgrammingOnlyClearsBitsAndWrapsInItsPage) {
  Bench b;
  std::mt19937_64 random(7);
  std::vector<std::uint8_t> model(2048, 0xff);
  for (int i = 0; i < test::scaled(300); ++i) {
    const auto address = static_cast<std::uint32_t>(random() % model.size());
    const auto data = random_bytes(random, 1 + random() % 300);
    b.program(address, data);
    // Of more than a page only the last 256 bytes count: each byte replaces the one 256 before.
    std::vector<int> page(256, -1);
    for (std::size_t k = 0; k < data.size(); ++k) page[(address + k) % 256] = data[k];
    for (std::size_t k = 0; k < 256; ++k)
      if (page[k] >= 0) model[(address & ~255u) + k] &= static_cast<std::uint8_t>(page[k]);
    b.wait();
    if (random() % 8 == 0) {
      const auto sector = static_cast<std::uint32_t>(random() % 4096);
      b.enable();
      b.command(Bench::with_address(0x20, sector));
      b.wait();
      std::fill(model.begin(), model.end(), std::uint8_t{0xff});
    }
    ASSERT_TRUE(std::equal(model.begin(), model.end(), b.flash.storage().begin()));
  }
}

TEST(FlashChip, NeedsAWriteEnableEachTime) {
  Bench b;
  b.command(Bench::with_address(0x02, 0, {0}));
  b.wait();
  EXPECT_EQ(b.at(0), 0xff);
  b.enable();
  EXPECT_EQ(b.status(), 2);
  b.command({0x04});
  EXPECT_EQ(b.status(), 0);
  b.command(Bench::with_address(0x20, 0));
  EXPECT_EQ(b.status(), 0);
  b.program(0, {0x12});
  EXPECT_EQ(b.status(), 1) << "busy, and no longer enabled";
  b.wait();
  EXPECT_EQ(b.status(), 0);
  b.command(Bench::with_address(0x02, 1, {0}));
  b.wait();
  EXPECT_EQ(b.at(1), 0xff);
  EXPECT_EQ(b.flash.counts().pages_programmed, 1u);
}

TEST(FlashChip, IsBusyForTheTimeOfItsDatasheet) {
  Bench b;
  struct Case {
    std::uint8_t code;
    Picoseconds time;
    std::size_t size;
  };
  for (const Case& c : {Case{0x20, 45 * ps_per_ms, 0x1000}, Case{0x52, 120 * ps_per_ms, 0x8000},
                        Case{0xd8, 150 * ps_per_ms, 0x1'0000}}) {
    std::fill(b.flash.storage().begin(), b.flash.storage().end(), std::uint8_t{0});
    b.enable();
    const Picoseconds start = b.now;
    b.command(Bench::with_address(c.code, 0x1'8123));
    EXPECT_EQ(b.flash.busy_until(), start + c.time);
    b.now = start + c.time - 1;
    EXPECT_EQ(b.status() & 1, 1);
    EXPECT_EQ(b.at(0x1'8123), 0xff) << "not read while busy: the line floats";
    b.now = start + c.time;
    EXPECT_EQ(b.status() & 1, 0);
    const auto first = static_cast<std::uint32_t>(0x1'8123 & ~(c.size - 1));
    EXPECT_EQ(b.at(first), 0xff);
    EXPECT_EQ(b.at(first - 1), 0);
    EXPECT_EQ(b.at(static_cast<std::uint32_t>(first + c.size - 1)), 0xff);
    EXPECT_EQ(b.at(static_cast<std::uint32_t>(first + c.size)), 0);
  }
  b.enable();
  b.command({0xc7});
  b.wait();
  EXPECT_TRUE(std::all_of(b.flash.storage().begin(), b.flash.storage().end(),
                          [](std::uint8_t byte) { return byte == 0xff; }));
}

TEST(FlashChip, IgnoresCommandsThatDoNotEndAtAByte) {
  Bench b;
  b.flash.select(b.now);
  b.put(0x06, 8, 1);
  b.put(0, 1, 1);
  b.flash.deselect(b.now);
  EXPECT_EQ(b.status(), 0);
  b.enable();
  b.flash.select(b.now);
  b.put(0x02000000, 32, 1);
  b.put(0, 7, 1);
  b.flash.deselect(b.now);
  EXPECT_EQ(b.status(), 2) << "still enabled, nothing done";
  b.flash.select(b.now);
  b.put(0x20000000, 32, 1);
  b.put(0, 8, 1);
  b.flash.deselect(b.now);
  EXPECT_EQ(b.status(), 2);
}

TEST(FlashChip, ReadsOnOneTwoAndFourLines) {
  Bench b;
  std::mt19937_64 random(3);
  for (std::uint8_t& byte : b.flash.storage()) byte = static_cast<std::uint8_t>(random());
  const auto read = [&](std::uint32_t code, unsigned address_lanes, bool mode, unsigned dummies,
                        unsigned lanes, std::uint32_t address) {
    b.flash.select(b.now);
    if (code != 0) b.put(code, 8, 1);
    b.put(address, 24, address_lanes);
    if (mode) b.put(0xa0, 8, address_lanes);
    for (unsigned i = 0; i < dummies; ++i) b.flash.clock(0xf, b.now);
    std::vector<std::uint8_t> result(8);
    for (std::uint8_t& byte : result) byte = b.get(lanes);
    b.flash.deselect(b.now);
    return result;
  };
  for (int i = 0; i < 200; ++i) {
    const auto address = static_cast<std::uint32_t>(random() % (FlashChip::default_size - 8));
    const std::vector<std::uint8_t> want(b.flash.storage().begin() + address,
                                         b.flash.storage().begin() + address + 8);
    EXPECT_EQ(read(0x03, 1, false, 0, 1, address), want);
    EXPECT_EQ(read(0x0b, 1, false, 8, 1, address), want);
    EXPECT_EQ(read(0x3b, 1, false, 8, 2, address), want);
    EXPECT_EQ(read(0x6b, 1, false, 8, 4, address), want);
    EXPECT_EQ(read(0xbb, 2, true, 0, 2, address), want);
    EXPECT_TRUE(b.flash.continuous_read());
    EXPECT_EQ(read(0, 2, true, 0, 2, address), want);
    // Ones on IO0, with the other lines pulled up, end the continuous mode.
    b.command({0xff, 0xff});
    EXPECT_FALSE(b.flash.continuous_read());
    EXPECT_EQ(read(0xeb, 4, true, 4, 4, address), want);
    EXPECT_EQ(read(0, 4, true, 4, 4, address), want);
    b.command({0xff, 0xff});
  }
  b.flash.set_quad_enable(false);
  EXPECT_NE(read(0xeb, 4, true, 4, 4, 0),
            std::vector<std::uint8_t>(b.flash.storage().begin(), b.flash.storage().begin() + 8));
}

TEST(FlashChip, StatusPowerDownAndReset) {
  Bench b;
  EXPECT_EQ(b.command({0x35}, 1)[0], 2) << "quad enable as delivered";
  b.enable();
  b.command({0x01, 0x00, 0x00});
  EXPECT_EQ(b.status() & 1, 1);
  b.wait();
  EXPECT_EQ(b.command({0x35}, 1)[0], 0);
  b.enable();
  b.command({0x31, 0x02});
  b.wait();
  EXPECT_EQ(b.command({0x35}, 1)[0], 2);
  b.command({0xb9});
  b.enable();
  EXPECT_EQ(b.command({0x9f}, 3), (std::vector<std::uint8_t>{0xff, 0xff, 0xff}));
  b.command({0xab});
  b.wait();
  EXPECT_EQ(b.status(), 0) << "the write enable was ignored";
  b.enable();
  b.command({0x66});
  b.command({0x99});
  b.wait();
  EXPECT_EQ(b.status(), 0);
  // A protected chip does not change, and the approximation is reported.
  b.enable();
  b.command({0x01, 0x1c});
  b.wait();
  b.program(0, {0});
  b.wait();
  EXPECT_EQ(b.at(0), 0xff);
  EXPECT_EQ(b.reports.size(), 1u);
}

TEST(FlashChip, AResetWhileBusyIsReported) {
  Bench b;
  b.program(0, {0});
  b.command({0x99});
  EXPECT_TRUE(b.reports.empty()) << "not enabled: ignored";
  b.command({0x66});
  b.command({0x99});
  EXPECT_EQ(b.status(), 1);
  EXPECT_EQ(b.reports.size(), 1u);
}

TEST(FlashChip, PowerCutAtAThousandMoments) {
  std::mt19937_64 random(11);
  int untouched = 0, torn = 0, finished = 0;
  for (int i = 0; i < test::scaled(1500); ++i) {
    Bench b(random());
    const auto old = random_bytes(random, 3 * 4096);
    std::copy(old.begin(), old.end(), b.flash.storage().begin());
    const bool erase = random() % 2 == 0;
    const auto data = random_bytes(random, 256);
    b.enable();
    const Picoseconds start = b.now;
    b.command(erase ? Bench::with_address(0x20, 4096) : Bench::with_address(0x02, 4096, data));
    const Picoseconds length = b.flash.busy_until() - start;
    const auto cut =
        static_cast<Picoseconds>(random() % static_cast<std::uint64_t>(length * 11 / 10));
    b.flash.power_cut(start + cut);
    b.now = start + cut + ps_per_us;
    ASSERT_EQ(b.status(), 0);
    const std::size_t size = erase ? 4096 : 256;
    bool same = true, done = true;
    for (std::size_t k = 0; k < old.size(); ++k) {
      const std::uint8_t now = b.flash.storage()[k];
      if (k < 4096 || k >= 4096 + size) {
        ASSERT_EQ(now, old[k]) << "outside the changed range";
        continue;
      }
      const std::uint8_t wanted =
          erase ? std::uint8_t{0xff} : static_cast<std::uint8_t>(old[k] & data[k - 4096]);
      same = same && now == old[k];
      done = done && now == wanted;
      // A page: each bit old or new. A sector: anything.
      if (!erase) {
        ASSERT_EQ((now ^ old[k]) & ~(old[k] ^ wanted), 0);
      }
    }
    if (cut >= length) {
      ASSERT_TRUE(done);
    }
    ++(done ? finished : same ? untouched : torn);
    // The chip still works.
    b.enable();
    b.command(Bench::with_address(0x20, 4096));
    b.wait();
    ASSERT_EQ(b.at(4096), 0xff);
  }
  EXPECT_GT(torn, test::scaled(1500) / 2);
  EXPECT_GT(finished, 0);
}

TEST(FlashChip, APowerCutIsRepeatableBySeed) {
  const auto run = [](std::uint64_t seed) {
    Bench b(seed);
    std::fill(b.flash.storage().begin(), b.flash.storage().end(), std::uint8_t{0x5a});
    b.enable();
    b.command(Bench::with_address(0x20, 0));
    b.flash.power_cut(b.now + 20 * ps_per_ms);
    return std::vector<std::uint8_t>(b.flash.storage().begin(), b.flash.storage().begin() + 4096);
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
}

/// The interface with named registers.
struct Wired {
  Wired()
      : bus(wheel, timing, note),
        flash(FlashChip::default_size, {}, note),
        xip(wheel, bus, flash, note) {
    bus.map(0x4001'8000, xip.pins().io());
    bus.map(0x4002'0000, xip.pins().pads());
    wheel.set_frequency(125'000'000);
  }
  void write(std::uint32_t address, std::uint32_t value) {
    ASSERT_FALSE(bus.write(address, value, Width::word, Master::core0, now).fault);
    now += 4;
  }
  std::uint32_t read(std::uint32_t address) {
    const Access access = bus.read(address, Width::word, Master::core0, now);
    EXPECT_FALSE(access.fault);
    now += 4;
    return access.value;
  }
  void serial(std::uint32_t divider) {
    write(ssi + 0x08, 0);
    write(ssi + 0x14, divider);
    write(ssi, 7u << 16);
    write(ssi + 0x10, 1);
    write(ssi + 0x08, 1);
  }
  /// Transfers bytes in both directions, as direct users of the SSI do.
  std::vector<std::uint8_t> transfer(const std::vector<std::uint8_t>& out) {
    for (const std::uint8_t byte : out) write(ssi + 0x60, byte);
    while ((read(ssi + 0x28) & 5) != 4) {
    }
    std::vector<std::uint8_t> in;
    while (read(ssi + 0x24) != 0) in.push_back(static_cast<std::uint8_t>(read(ssi + 0x60)));
    return in;
  }
  /// Reads past the cache, which answers instead of the flash in command mode.
  bool readable(std::uint32_t address) {
    if ((address >> 24) == 0x10) address |= 0x0300'0000;
    return !bus.read(address, Width::word, Master::core0, now).fault;
  }

  static constexpr std::uint32_t ssi = 0x1800'0000;
  std::set<std::string> reports;
  NotModelled note = [this](const std::string& what) { reports.insert(what); };
  TimeWheel wheel;
  Timing timing;
  Bus bus;
  FlashChip flash;
  Xip xip;
  Cycle now = 10;
};

TEST(Ssi, BytesTakeTheTimeOfTheirClocks) {
  Wired w;
  w.serial(6);
  const Cycle start = w.now;
  for (int i = 0; i < 10; ++i) w.write(Wired::ssi + 0x60, i == 0 ? 0x9f : 0);
  EXPECT_EQ(w.read(Wired::ssi + 0x24), 0u) << "48 cycles a byte";
  w.now = start + 48;
  EXPECT_EQ(w.read(Wired::ssi + 0x24), 1u);
  w.now = start + 10 * 48 - 1;
  EXPECT_EQ(w.read(Wired::ssi + 0x28) & 1u, 1u) << "BUSY";
  w.now = start + 10 * 48;
  EXPECT_EQ(w.read(Wired::ssi + 0x28) & 1u, 0u);
  EXPECT_EQ(w.read(Wired::ssi + 0x24), 10u);
  std::vector<std::uint32_t> got(4);
  for (std::uint32_t& word : got) word = w.read(Wired::ssi + 0x60);
  EXPECT_EQ(got, (std::vector<std::uint32_t>{0xff, 0xef, 0x40, 0x15}));
}

TEST(Ssi, FifosOverflowAsTheRealOnesDo) {
  Wired w;
  w.serial(6);
  for (int i = 0; i < 12; ++i) w.write(Wired::ssi + 0x60, 0);
  w.now += 12 * 48;
  for (int i = 0; i < 12; ++i) w.write(Wired::ssi + 0x60, 0);
  w.now += 12 * 48;
  EXPECT_EQ(w.read(Wired::ssi + 0x24), 16u);
  EXPECT_EQ(w.read(Wired::ssi + 0x34) & 8u, 8u) << "RXOI";
  w.read(Wired::ssi + 0x48);
  EXPECT_EQ(w.read(Wired::ssi + 0x34) & 8u, 0u);
  EXPECT_EQ(w.read(Wired::ssi + 0x28) & 0x18u, 0x18u);
}

TEST(Ssi, ChipSelectRisesWhenTheFifoRunsEmptyAndIsHeldByTheOverride) {
  Wired w;
  w.serial(2);
  EXPECT_EQ(w.transfer({0x9f}).size(), 1u);
  EXPECT_EQ(w.transfer({0, 0, 0}), (std::vector<std::uint8_t>{0xff, 0xff, 0xff}))
      << "a new command begins";
  w.write(0x4001'800c, 2u << 8);
  EXPECT_EQ(w.transfer({0x9f}).size(), 1u);
  EXPECT_EQ(w.transfer({0, 0, 0}), (std::vector<std::uint8_t>{0xef, 0x40, 0x15}));
  w.write(0x4001'800c, 3u << 8);
  w.write(0x4001'800c, 0);
}

TEST(Xip, SerialReadsMapTheFlashAndCommandModeUnmapsIt) {
  Wired w;
  EXPECT_FALSE(w.readable(0x1000'0000));
  EXPECT_TRUE(w.reports.contains("XIP read while no flash is mapped"));
  w.flash.storage()[5] = 0x77;
  w.serial(4);
  EXPECT_FALSE(w.readable(0x1000'0000));
  const auto serial_xip = [&] {
    w.write(Wired::ssi + 8, 0);
    w.write(Wired::ssi, 31u << 16 | 3u << 8);
    w.write(Wired::ssi + 0xf4, 0x03u << 24 | 2u << 8 | 6u << 2);
    w.write(Wired::ssi + 4, 0);
    w.write(Wired::ssi + 8, 1);
  };
  serial_xip();
  ASSERT_TRUE(w.readable(0x1000'0000));
  EXPECT_EQ(w.read(0x1000'0004), 0xffff'77ffu);
  EXPECT_EQ(w.read(0x1320'0004), 0xffff'77ffu) << "aliases and repeats";
  EXPECT_EQ(w.xip.ssi().line_fill_cycles(), (8u + 24 + 64) * 4);
  // Reads fail during an erase and work again after it.
  w.serial(2);
  w.transfer({0x06});
  w.transfer({0x20, 0, 0, 0});
  serial_xip();
  EXPECT_FALSE(w.readable(0x1000'0000));
  w.now += 46 * 125'000;
  w.wheel.advance_to(w.now);
  ASSERT_TRUE(w.readable(0x1000'0000));
  EXPECT_EQ(w.read(0x1000'0004), 0xffff'77ffu) << "the cache was not flushed";
  w.write(0x1400'0004, 1);
  EXPECT_EQ(w.read(0x1000'0004), 0xffff'ffffu);
  w.xip.power_cut();
  EXPECT_FALSE(w.readable(0x1000'0000));
}

TEST(Xip, MissingRegistersAreReported) {
  Wired w;
  for (const std::uint32_t address :
       {Wired::ssi + 0x2c, Wired::ssi + 0xfc, 0x1400'0020u, 0x4002'001cu}) {
    w.reports.clear();
    EXPECT_EQ(w.read(address), 0u);
    EXPECT_EQ(w.reports.size(), 1u) << std::hex << address;
  }
  w.reports.clear();
  for (const std::uint32_t address : {Wired::ssi + 0x28, Wired::ssi + 0xf8, 0x4002'0018u})
    w.read(address);
  EXPECT_TRUE(w.reports.empty());
}

}  // namespace
}  // namespace lamplock::sim::chip::flash_test
