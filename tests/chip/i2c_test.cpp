// I2C by the RP2040 datasheet, 4.3: ic_clk is clk_sys.
#include "sim/chip/serial/i2c.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::i2c_test {
namespace {

constexpr std::uint32_t con = 0x00, tar = 0x04, data_cmd = 0x10, ss_hcnt = 0x14, ss_lcnt = 0x18,
                        fs_hcnt = 0x1c, fs_lcnt = 0x20, intr_stat = 0x2c, intr_mask = 0x30,
                        raw_intr = 0x34, rx_tl = 0x38, tx_tl = 0x3c, clr_intr = 0x40,
                        clr_tx_abrt = 0x54, clr_activity = 0x5c, clr_stop = 0x60, enable = 0x6c,
                        status = 0x70, txflr = 0x74, rxflr = 0x78, abort_source = 0x80,
                        dma_cr = 0x88, dma_tdlr = 0x8c, enable_status = 0x9c, spklen = 0xa0;
constexpr std::uint32_t do_read = 1u << 8, do_stop = 1u << 9, do_restart = 1u << 10,
                        first_byte = 1u << 11;
constexpr std::uint32_t rx_under = 1, rx_over = 2, rx_full = 4, tx_over = 8, tx_empty = 16,
                        tx_abort = 64, activity = 256, stop_seen = 512, start_seen = 1024;
constexpr std::uint32_t con_base = 0x65, ten_bits = 16, restart_on = 32, tx_empty_late = 256,
                        rx_hold = 512;
constexpr std::uint32_t base = 0x4004'4000;

/// Records its events with times; acknowledges a given number of bytes.
class Recorder : public I2cDevice {
 public:
  bool addressed(bool for_reading, Cycle at) override {
    note(for_reading ? "read" : "write", at);
    return acknowledges;
  }
  bool byte_written(std::uint8_t byte, Cycle at) override {
    note(std::to_string(byte), at);
    return taken-- > 0;
  }
  std::uint8_t byte_read(Cycle at) override {
    note("?", at);
    return next++;
  }
  void stopped(Cycle at) override { note("stop", at); }

  void note(const std::string& what, Cycle at) {
    log.append(log.empty() ? "" : " ").append(what);
    times.push_back(at);
  }
  std::string log;
  std::vector<Cycle> times;
  bool acknowledges = true;
  int taken = 1000;
  std::uint8_t next = 100;
};

class I2cTest : public ::testing::Test {
 protected:
  I2cTest() {
    i2c_.connect(device_, 0x42);
    i2c_.write(intr_mask, 0);
    // 100 kHz with the counts of drivers: 3/5 and 2/5 of 1250 cycles.
    i2c_.write(fs_hcnt, 750);
    i2c_.write(fs_lcnt, 500);
    i2c_.write(spklen, 31);
    open(0x42);
  }
  void open(std::uint32_t address, std::uint32_t control = con_base) {
    i2c_.write(enable, 0);
    i2c_.write(con, control);
    i2c_.write(tar, address);
    i2c_.write(enable, 1);
  }
  bool line() const { return rig_.line(Irq::i2c0); }
  void command(std::uint32_t word) { i2c_.write(data_cmd, word); }
  bool raw(std::uint32_t bit) { return (i2c_.read(raw_intr) & bit) != 0; }
  /// Cycles from `from` to each recorded event.
  std::vector<Cycle> since(Cycle from) const {
    std::vector<Cycle> result;
    for (const Cycle at : device_.times) result.push_back(at - from);
    return result;
  }

  // 4.3.14.1: high HCNT + SPKLEN + 7, low LCNT + 1.
  static constexpr Cycle high = 750 + 31 + 7, low = 500 + 1, byte = 9 * (high + low);
  rigs::DmaSystemRig rig_;
  I2c& i2c_ = rig_.system.i2c0;
  Recorder device_;
};

TEST_F(I2cTest, AWriteTakesItsConditionsAndNinePeriodsAByte) {
  const Cycle from = rig_.wheel.now();
  EXPECT_EQ(i2c_.high_cycles(), high);
  EXPECT_EQ(i2c_.low_cycles(), low);
  EXPECT_EQ(i2c_.read(status), 6u);
  command(7);
  command(9 | do_stop);
  EXPECT_EQ(i2c_.read(status), 0x23u) << "active, two commands";
  EXPECT_TRUE(raw(start_seen));
  EXPECT_TRUE(raw(activity));
  rig_.pass(high + byte);
  EXPECT_EQ(i2c_.read(txflr), 1u);
  rig_.pass(10 * byte);
  EXPECT_EQ(device_.log, "write 7 9 stop");
  EXPECT_EQ(since(from), (std::vector<Cycle>{high + byte, high + 2 * byte, high + 3 * byte,
                                             high + 3 * byte + low + high}));
  EXPECT_EQ(i2c_.read(status), 6u);
  EXPECT_TRUE(raw(stop_seen));
  EXPECT_EQ(i2c_.read(clr_stop), 1u);
  EXPECT_FALSE(raw(stop_seen));
  EXPECT_EQ(i2c_.read(clr_activity), 1u);
  EXPECT_FALSE(raw(activity));
}

TEST_F(I2cTest, TheBusStaysFreeBetweenTransfers) {
  const Cycle from = rig_.wheel.now();
  command(1 | do_stop);
  command(2 | do_stop);
  rig_.pass(10 * byte);
  const Cycle second = high + 2 * byte + low + high + low;  // t_BUF is LCNT (4.3.14)
  EXPECT_EQ(device_.log, "write 1 stop write 2 stop");
  EXPECT_EQ(since(from)[3], second + high + byte);
}

TEST_F(I2cTest, StandardSpeedHasItsOwnCountsAndMinima) {
  i2c_.write(ss_hcnt, 600);
  EXPECT_EQ(i2c_.read(ss_hcnt), 0x28u) << "only while disabled";
  i2c_.write(enable, 0);
  i2c_.write(ss_hcnt, 600);
  i2c_.write(ss_lcnt, 1);
  i2c_.write(spklen, 0);
  i2c_.write(con, 0x63);
  EXPECT_EQ(i2c_.read(ss_lcnt), 8u);
  EXPECT_EQ(i2c_.high_cycles(), 600u + 1 + 7);
  EXPECT_EQ(i2c_.low_cycles(), 9u);
  i2c_.write(con, 0x67);
  EXPECT_EQ(i2c_.read(con), 0x65u) << "no high-speed mode: fast mode";
}

TEST_F(I2cTest, ReadsMarkTheFirstByte) {
  i2c_.write(rx_tl, 1);
  i2c_.write(intr_mask, rx_full);
  for (int n = 0; n < 3; ++n) command(do_read | (n == 2 ? do_stop : 0u));
  rig_.pass(high + 3 * byte - 1);
  EXPECT_FALSE(line());
  rig_.pass(1);
  EXPECT_TRUE(line());
  EXPECT_EQ(i2c_.read(intr_stat), rx_full);
  rig_.pass(3 * byte);
  EXPECT_EQ(device_.log, "read ? ? ? stop");
  EXPECT_EQ(i2c_.read(rxflr), 3u);
  EXPECT_EQ(i2c_.read(data_cmd), 100u | first_byte);
  EXPECT_EQ(i2c_.read(data_cmd), 101u);
  EXPECT_FALSE(line());
  EXPECT_EQ(i2c_.read(data_cmd), 102u);
  EXPECT_FALSE(raw(rx_under));
  i2c_.read(data_cmd);
  EXPECT_TRUE(raw(rx_under));
}

TEST_F(I2cTest, ADirectionChangeIsARestartAndARestartCanBeRequested) {
  const Cycle from = rig_.wheel.now();
  command(5);
  command(do_read);
  command(do_read | do_restart | do_stop);
  rig_.pass(20 * byte);
  EXPECT_EQ(device_.log, "write 5 read ? read ? stop");
  const Cycle restart = low + low + high;
  EXPECT_EQ(since(from)[2], high + 2 * byte + restart + byte);
  EXPECT_EQ(since(from)[4], high + 4 * byte + 2 * restart + byte);
  // With RESTART disabled, a STOP and a START replace it.
  open(0x42, con_base & ~restart_on);
  device_.log.clear();
  command(5);
  command(do_read | do_stop);
  rig_.pass(20 * byte);
  EXPECT_EQ(device_.log, "write 5 stop read ? stop");
}

TEST_F(I2cTest, AnEmptyFifoHoldsTheBus) {
  command(1);
  rig_.pass(20 * byte);
  EXPECT_EQ(device_.log, "write 1");
  EXPECT_EQ(i2c_.read(status), 0x27u);
  EXPECT_EQ(rig_.wheel.next(), never_cycle);
  const Cycle from = rig_.wheel.now();
  command(2 | do_stop);
  rig_.pass(5 * byte);
  EXPECT_EQ(device_.log, "write 1 2 stop");
  EXPECT_EQ(since(from)[2], byte);
  // The bus is held over a change of IC_TAR: the next transfer begins with a RESTART.
  device_.log.clear();
  command(3);
  rig_.pass(5 * byte);
  open(0x42);
  command(do_read | do_restart | do_stop);
  rig_.pass(9 * byte);
  EXPECT_EQ(device_.log, "write 3 read ? stop");
}

TEST_F(I2cTest, AMissingDeviceAborts) {
  open(0x43);
  i2c_.write(intr_mask, tx_abort);
  for (std::uint32_t n = 0; n < 3; ++n) command(n);
  rig_.pass(high + byte - 1);
  EXPECT_FALSE(line());
  rig_.pass(1);
  EXPECT_TRUE(line());
  EXPECT_EQ(i2c_.read(abort_source), 3u << 23 | 1u);  // ABRT_7B_ADDR_NOACK, three flushed
  command(1);
  EXPECT_EQ(i2c_.read(txflr), 0u) << "held empty until the abort is cleared";
  EXPECT_FALSE(raw(stop_seen));
  rig_.pass(low + high);
  EXPECT_TRUE(raw(stop_seen));
  EXPECT_EQ(i2c_.read(clr_tx_abrt), 1u);
  EXPECT_EQ(i2c_.read(abort_source), 0u);
  EXPECT_FALSE(line());
  command(1);
  EXPECT_EQ(i2c_.read(txflr), 1u);
}

TEST_F(I2cTest, ADeviceMayRefuseItsAddressOrAByte) {
  device_.taken = 1;
  for (std::uint32_t n = 0; n < 4; ++n) command(n);
  rig_.pass(20 * byte);
  EXPECT_EQ(device_.log, "write 0 1 stop");
  EXPECT_EQ(i2c_.read(abort_source), 2u << 23 | 1u << 3);  // ABRT_TXDATA_NOACK
  i2c_.read(clr_intr);
  EXPECT_EQ(i2c_.read(raw_intr), tx_empty);
  device_.acknowledges = false;
  command(1);
  rig_.pass(20 * byte);
  EXPECT_EQ(i2c_.read(abort_source) & 0xffffu, 1u);
}

TEST_F(I2cTest, AbortsWithoutAStart) {
  open(0x42, con_base & ~1u);
  command(1);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 11);  // ABRT_MASTER_DIS
  i2c_.read(clr_tx_abrt);
  open(1u << 11);  // general call
  command(do_read);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 5);  // ABRT_GCALL_READ
  i2c_.read(clr_tx_abrt);
  open(0x242, (con_base | ten_bits) & ~restart_on);
  command(do_read);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 10);  // ABRT_10B_RD_NORSTRT
  i2c_.read(clr_tx_abrt);
  EXPECT_FALSE(raw(start_seen));
  open(0x42);
  i2c_.write(enable, 3);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 16);  // ABRT_USER_ABRT
  EXPECT_EQ(i2c_.read(enable), 1u);
}

TEST_F(I2cTest, AGeneralCallNeedsAListener) {
  open(1u << 11);
  command(6 | do_stop);
  rig_.pass(9 * byte);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 4);  // ABRT_GCALL_NOACK
  i2c_.read(clr_tx_abrt);
  Recorder listener;
  i2c_.connect(listener, I2c::general_call);
  command(6 | do_stop);
  rig_.pass(9 * byte);
  EXPECT_EQ(listener.log, "write 6 stop");
}

TEST_F(I2cTest, TenBitAddresses) {
  Recorder far;
  i2c_.connect(far, 0x242, true);
  open(0x242, con_base | ten_bits);
  const Cycle from = rig_.wheel.now();
  command(1);
  command(do_read | do_stop);
  rig_.pass(20 * byte);
  EXPECT_EQ(far.log, "write 1 read ? stop");
  EXPECT_EQ(far.times[0] - from, high + 2 * byte);
  const Cycle restart = low + low + high;
  EXPECT_EQ(far.times[2] - from, high + 3 * byte + restart + byte) << "first byte only";
  far.log.clear();
  far.times.clear();
  const Cycle again = rig_.wheel.now();
  command(do_read | do_stop);
  rig_.pass(20 * byte);
  EXPECT_EQ(far.log, "read ? stop");
  EXPECT_EQ(far.times[0] - again, high + 2 * byte + restart + byte);
  // The same high bits, then different ones; no device has this address.
  open(0x243, con_base | ten_bits);
  command(1);
  rig_.pass(20 * byte);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 2);  // ABRT_10ADDR2_NOACK
  i2c_.read(clr_tx_abrt);
  open(0x142, con_base | ten_bits);
  command(1);
  rig_.pass(20 * byte);
  EXPECT_EQ(i2c_.read(abort_source) & 0x1ffffu, 1u << 1);  // ABRT_10ADDR1_NOACK
  EXPECT_EQ(device_.log, "") << "the device with the 7-bit address is not addressed";
}

TEST_F(I2cTest, FullFifosOverflowOrHoldTheBus) {
  i2c_.write(enable, 5);  // TX_CMD_BLOCK
  for (int n = 0; n < 16; ++n) command(do_read);
  EXPECT_EQ(i2c_.read(status), 0u);
  EXPECT_FALSE(raw(tx_over));
  command(do_read);
  EXPECT_TRUE(raw(tx_over));
  i2c_.write(enable, 1);
  rig_.pass(17 * byte + high);
  EXPECT_NE(i2c_.read(status) & 16u, 0u);
  command(do_read | do_stop);
  rig_.pass(3 * byte);
  EXPECT_TRUE(raw(rx_over));
  EXPECT_EQ(i2c_.read(rxflr), 16u);
  EXPECT_TRUE(raw(stop_seen));
  // The same with RX_FIFO_FULL_HLD_CTRL.
  open(0x42, con_base | rx_hold);
  device_.next = 0;
  i2c_.read(clr_intr);
  for (int n = 0; n < 16; ++n) command(do_read);
  rig_.pass(5 * byte);
  command(do_read | do_stop);
  rig_.pass(40 * byte);
  EXPECT_FALSE(raw(rx_over));
  EXPECT_FALSE(raw(stop_seen));
  for (std::uint32_t n = 0; n < 17; ++n) EXPECT_EQ(i2c_.read(data_cmd) & 0xffu, n);
  rig_.pass(low + high);
  EXPECT_TRUE(raw(stop_seen));
}

TEST_F(I2cTest, TxEmptyByLevelOrByTheShifter) {
  i2c_.write(tx_tl, 1);
  EXPECT_TRUE(raw(tx_empty));
  for (std::uint32_t n = 0; n < 3; ++n) command(n | (n == 2 ? do_stop : 0u));
  EXPECT_FALSE(raw(tx_empty));
  rig_.pass(high + 2 * byte);  // the second is in the shifter
  EXPECT_TRUE(raw(tx_empty));
  rig_.pass(9 * byte);
  open(0x42, con_base | tx_empty_late);
  i2c_.write(tx_tl, 0);
  command(1);
  const Cycle from = rig_.wheel.now();
  while (!raw(tx_empty)) rig_.pass(1);
  EXPECT_EQ(rig_.wheel.now() - from, high + 2 * byte) << "the address and the byte are out";
}

TEST_F(I2cTest, DisablingEndsTheTransferWithItsByte) {
  for (std::uint32_t n = 0; n < 4; ++n) command(n);
  rig_.pass(high + byte + byte / 2);
  i2c_.write(enable, 0);
  EXPECT_EQ(i2c_.read(txflr), 0u);
  EXPECT_EQ(i2c_.read(enable_status), 1u) << "not yet";
  rig_.pass(byte);
  EXPECT_EQ(device_.log, "write 0 stop");
  EXPECT_EQ(i2c_.read(enable_status), 0u);
  EXPECT_EQ(i2c_.read(raw_intr) & (tx_empty | activity), 0u);
  // An abort requested during a transfer ends it with its byte, too.
  open(0x42);
  rig_.pass(byte);
  for (std::uint32_t n = 0; n < 4; ++n) command(n);
  rig_.pass(high + byte + byte / 2);
  i2c_.write(enable, 3);
  EXPECT_EQ(i2c_.read(enable), 3u);
  rig_.pass(byte);
  EXPECT_EQ(i2c_.read(enable), 1u);
  EXPECT_EQ(i2c_.read(abort_source), 3u << 23 | 1u << 16);
}

TEST_F(I2cTest, TheDmaFeedsCommands) {
  for (std::uint32_t n = 0; n < 40; ++n) rig_.store(rig_.ram + 4 * n, n | (n == 39 ? do_stop : 0u));
  i2c_.write(dma_tdlr, 7);
  i2c_.write(dma_cr, 2);
  rig_.start_dma(3, rig_.ram, base + data_cmd, 40, 2, true, false, Dreq::i2c0_tx);
  rig_.pass(100);
  EXPECT_EQ(i2c_.read(txflr), 8u) << "requests while the level is at most TDL";
  rig_.pass(50 * byte);
  EXPECT_FALSE(rig_.dma_busy(3));
  EXPECT_EQ(device_.times.size(), 42u);
  EXPECT_EQ(device_.times[40] - device_.times[0], 40 * byte) << "never held";
  // It also transfers the received bytes.
  open(0x42);
  i2c_.write(dma_cr, 1);
  device_.next = 1;
  rig_.start_dma(4, base + data_cmd, rig_.ram + 0x200, 12, 0, false, true, Dreq::i2c0_rx);
  for (int n = 0; n < 12; ++n) command(do_read | (n == 11 ? do_stop : 0u));
  rig_.pass(20 * byte);
  EXPECT_FALSE(rig_.dma_busy(4));
  for (std::uint32_t n = 0; n < 12; ++n) EXPECT_EQ(rig_.bus.sram()[0x200 + n], n + 1);
}

TEST_F(I2cTest, GapsBetweenRegistersAreReported) {
  constexpr std::uint32_t end = 0x100, comp_parameters = 0xf4;
  const std::set<std::uint32_t> gaps{0x0c, 0x24, 0x28, 0xa4, 0xac, 0xb0, 0xb4, 0xb8,
                                     0xbc, 0xc0, 0xc4, 0xc8, 0xcc, 0xd0, 0xd4, 0xd8,
                                     0xdc, 0xe0, 0xe4, 0xe8, 0xec, 0xf0, end};
  for (std::uint32_t offset = 0; offset <= end; offset += 4) {
    const std::size_t wanted = gaps.count(offset);
    rig_.reports.clear();
    i2c_.read(offset);
    EXPECT_EQ(rig_.reports.size(), wanted) << std::hex << offset;
    rig_.reports.clear();
    i2c_.write(offset, 0);
    EXPECT_EQ(rig_.reports.size(), wanted) << std::hex << offset;
  }
  EXPECT_EQ(i2c_.read(comp_parameters), 0u);
}

TEST_F(I2cTest, ResetAndUnmodelledFeatures) {
  rig_.reports.clear();
  open(0x42, 0x25);
  EXPECT_EQ(rig_.reports.size(), 1u) << "master and slave at once";
  i2c_.reset();
  EXPECT_EQ(i2c_.read(con), 0x65u);
  EXPECT_EQ(i2c_.read(tar), 0x55u);
  EXPECT_EQ(i2c_.read(intr_mask), 0x8ffu);
  EXPECT_EQ(i2c_.read(0xfc), 0x44570140u);
  EXPECT_FALSE(line());
}

}  // namespace
}  // namespace lamplock::sim::chip::i2c_test
