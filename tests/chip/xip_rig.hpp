// Flash, SSI and cache on a bus, for tests of execution in place.
//
// In:  nothing; out: the SSI configured as by the usual second-stage boot: quad, continuous, so
//      that a line takes 8 clocks of address and mode, 4 of wait, 16 of data (W25Q16JV, fast read
//      quad I/O), each `divider` cycles of clk_sys (RP2040 datasheet, 4.10.4).
// Used by the tests of the cache and of streaming.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/xip.hpp"

namespace lamplock::test {

using namespace sim::chip;  // NOLINT: the tests use no other names

inline constexpr std::uint32_t ssi = 0x1800'0000, control = 0x1400'0000, cache_sram = 0x1500'0000;
inline constexpr std::uint32_t flush = control + 4, stat = control + 8, ctr_hit = control + 0xc,
                               ctr_acc = control + 0x10;
inline constexpr std::uint32_t cached = 0x1000'0000, no_allocate = 0x1100'0000,
                               no_cache = 0x1200'0000, bypass = 0x1300'0000;
inline constexpr std::uint32_t line_clocks = 8 + 4 + 16;

class XipTest : public testing::Test {
 protected:
  XipTest() {
    wheel_.set_frequency(125'000'000);
    for (std::size_t i = 0; i < flash_.storage().size(); ++i)
      flash_.storage()[i] = static_cast<std::uint8_t>(i * 7 + (i >> 8));
    at_ = 2000;  // after the flush that a reset begins
    set_divider(2);
  }
  void put(std::uint32_t address, std::uint32_t value) {
    ASSERT_FALSE(bus_.write(address, value, Width::word, Master::core0, at_).fault);
    at_ += 10;
  }
  std::uint32_t get(std::uint32_t address) {
    const Access access = bus_.read(address, Width::word, Master::core0, at_);
    EXPECT_FALSE(access.fault);
    at_ += 10 + access.wait;
    return access.value;
  }
  void setup(std::uint32_t divider, std::uint32_t spi_control) {
    put(ssi + 0x08, 0);
    put(ssi + 0x14, divider);
    put(ssi, 2u << 21 | 31u << 16 | 3u << 8);
    put(ssi + 0x04, 0);
    put(ssi + 0xf4, spi_control);
    put(ssi + 0x10, 1);
    put(ssi + 0x08, 1);
  }
  void set_divider(std::uint32_t divider) {
    constexpr std::uint32_t quad_address = 8u << 2 | 4u << 11;
    if (!flash_.continuous_read()) {
      flash_.select(0);
      flash_.transfer(0x06, 0);
      flash_.deselect(0);
      flash_.select(0);
      for (const unsigned byte : {0x01u, 0x00u, 0x02u})
        flash_.transfer(static_cast<std::uint8_t>(byte), 0);  // QE
      flash_.deselect(0);
      at_ += 20 * 125'000;
      setup(divider, quad_address | 2u << 8 | 1u);
      put(ssi + 0x60, 0xeb);
      put(ssi + 0x60, 0xa0);
      while ((get(ssi + 0x28) & 5) != 4) {
      }
      get(ssi + 0x60);
    }
    setup(divider, 0xa0u << 24 | quad_address | 2u);
  }
  /// Wait states of a read; the access ends before the next one begins.
  std::uint32_t wait(std::uint32_t address, Master master = Master::core0) {
    const Access access = bus_.read(address, Width::word, master, at_);
    EXPECT_FALSE(access.fault) << std::hex << address;
    EXPECT_EQ(access.value, flash_word(address));
    at_ += 10 + access.wait;
    return access.wait;
  }
  std::uint32_t flash_word(std::uint32_t address) {
    std::uint32_t word = 0;
    std::memcpy(&word, &flash_.storage()[address & (flash_.storage().size() - 1)], sizeof word);
    return word;
  }

  std::set<std::string> reports_;
  NotModelled note_ = [this](const std::string& what) { reports_.insert(what); };
  TimeWheel wheel_;
  Timing timing_;
  Bus bus_{wheel_, timing_, note_};
  FlashChip flash_{FlashChip::default_size, {}, note_};
  Xip xip_{wheel_, bus_, flash_, note_};
  Cycle at_ = 0;
};

}  // namespace lamplock::test
