// I2C0 as the master and I2C1 as a slave on one bus: GPIO 4 joined to 6 (SDA), 5 to 7 (SCL)
// (RP2040 datasheet, 4.3.6, 4.3.10, 4.3.17).
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "sim/chip/serial/i2c.hpp"
#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::i2c_slave_test {
namespace {

constexpr std::uint32_t con = 0x00, tar = 0x04, sar = 0x08, data_cmd = 0x10, fs_hcnt = 0x1c,
                        fs_lcnt = 0x20, intr_mask = 0x30, raw_intr = 0x34, clr_rd_req = 0x50,
                        clr_tx_abrt = 0x54, clr_rx_done = 0x58, clr_stop = 0x60, enable = 0x6c,
                        status = 0x70, txflr = 0x74, rxflr = 0x78, sda_hold = 0x7c,
                        abort_source = 0x80, nack_only = 0x84, sda_setup = 0x94, ack_general = 0x98,
                        enable_status = 0x9c, spklen = 0xa0;
constexpr std::uint32_t do_read = 1u << 8, do_stop = 1u << 9, do_restart = 1u << 10,
                        first_byte = 1u << 11;
constexpr std::uint32_t rx_over = 2, rd_req = 32, tx_abort = 64, rx_done = 128, stop_seen = 512,
                        start_seen = 1024, gen_call = 2048, restart_seen = 4096;
constexpr std::uint32_t as_master = 0x65, as_slave = 0x24;
constexpr std::uint32_t slave_ten_bits = 8, master_ten_bits = 16, stop_if_addressed = 128,
                        rx_hold = 512;
constexpr std::uint32_t slave_activity = 64;
constexpr std::uint32_t mine = 0x42;

class I2cSlaveTest : public ::testing::Test {
 protected:
  I2cSlaveTest() {
    for (const unsigned gpio : {4u, 5u, 6u, 7u}) {
      rig_.gpio.pads_bank().write(4 + 4 * gpio, 0x5a);  // pull-up
      rig_.connect(gpio, PinFunction::i2c);
    }
    rig_.gpio.join(4, 6, rig_.wheel.now());
    rig_.gpio.join(5, 7, rig_.wheel.now());
    set_up(master_, as_master);
    set_up(slave_, as_slave);
  }
  void set_up(I2c& i2c, std::uint32_t control, std::uint32_t address = mine) {
    i2c.write(enable, 0);
    i2c.write(con, control);
    i2c.write(tar, address);
    i2c.write(sar, address);
    i2c.write(fs_hcnt, 86);
    i2c.write(fs_lcnt, 149);
    i2c.write(spklen, 7);
    i2c.write(sda_hold, 40);
    i2c.write(intr_mask, 0);
    i2c.write(enable, 1);
  }
  bool pad(unsigned gpio) const { return rig_.pad(gpio); }
  std::uint32_t raw() { return slave_.read(raw_intr); }
  bool raw(std::uint32_t bits) { return (raw() & bits) != 0; }
  void command(std::uint32_t word) { master_.write(data_cmd, word); }
  void pass_bits(Cycle bits) { rig_.pass(bits * bit); }
  /// All bytes that the slave has received.
  std::vector<std::uint32_t> received() {
    std::vector<std::uint32_t> words;
    while (slave_.read(rxflr) != 0) words.push_back(slave_.read(data_cmd));
    return words;
  }
  std::vector<std::uint32_t> master_received() {
    std::vector<std::uint32_t> bytes;
    while (master_.read(rxflr) != 0) bytes.push_back(master_.read(data_cmd) & 0xffu);
    return bytes;
  }
  std::uint32_t master_aborted() { return master_.read(abort_source) & 0x1ffffu; }
  std::uint32_t slave_aborted() { return slave_.read(abort_source) & 0x1ffffu; }

  static constexpr Cycle high = 86 + 7 + 7, low = 149 + 1, bit = high + low;  // 4.3.14.1
  rigs::DmaSystemRig rig_;
  I2c& master_ = rig_.system.i2c0;
  I2c& slave_ = rig_.system.i2c1;
};

// FIRST_DATA_BYTE marks the byte after the address.
TEST_F(I2cSlaveTest, ReceivesTheMastersBytes) {
  command(0x35);
  command(0xca);
  command(0x01 | do_stop);
  pass_bits(5);
  EXPECT_EQ(slave_.read(status) & (slave_activity | 1u), slave_activity | 1u);
  pass_bits(60);
  EXPECT_EQ(received(), (std::vector<std::uint32_t>{0x35 | first_byte, 0xca, 0x01}));
  EXPECT_EQ(master_aborted(), 0u);
  EXPECT_TRUE(raw(start_seen));
  EXPECT_TRUE(raw(stop_seen));
  EXPECT_FALSE(raw(rd_req | rx_done | tx_abort | gen_call | restart_seen));
  EXPECT_EQ(slave_.read(status) & (slave_activity | 1u), 0u);
  EXPECT_TRUE(pad(4) && pad(5) && pad(6) && pad(7));
  EXPECT_TRUE(rig_.reports.empty());
}

// The byte arrives with the fall of SCL after its ninth clock: START's hold and two bytes.
TEST_F(I2cSlaveTest, AByteArrivesAfterItsNinthClock) {
  command(0x35 | do_stop);
  rig_.pass(high + 18 * bit - 1);
  EXPECT_EQ(slave_.read(rxflr), 0u);
  rig_.pass(1);
  EXPECT_EQ(slave_.read(rxflr), 1u);
}

// Another address is not acknowledged; STOP_DET_IFADDRESSED.
TEST_F(I2cSlaveTest, StopOfOthersCanBeIgnored) {
  for (const std::uint32_t option : {0u, stop_if_addressed}) {
    set_up(slave_, as_slave | option, mine + 1);
    command(0x35 | do_stop);
    pass_bits(60);
    EXPECT_EQ(master_aborted(), 1u) << "ABRT_7B_ADDR_NOACK";
    EXPECT_TRUE(received().empty());
    EXPECT_EQ(raw(stop_seen), option == 0);
    slave_.read(clr_stop);
    master_.read(clr_tx_abrt);
  }
  set_up(slave_, as_slave | stop_if_addressed);
  command(0x35 | do_stop);
  pass_bits(60);
  EXPECT_TRUE(raw(stop_seen));
}

// 4.3.10.1.2: SCL is held low until a byte is available; the byte is on SDA for IC_SDA_SETUP - 1
// before SCL is released.
TEST_F(I2cSlaveTest, StretchesTheClockUntilTheByteIsAvailable) {
  slave_.write(enable, 0);
  slave_.write(sda_setup, 21);
  slave_.write(enable, 1);
  command(do_read | do_stop);
  rig_.pass(high + 9 * bit - 1);
  EXPECT_FALSE(raw(rd_req));
  rig_.pass(1);
  EXPECT_TRUE(raw(rd_req));
  pass_bits(100);
  EXPECT_FALSE(pad(5));
  EXPECT_EQ(slave_.read(clr_rd_req), 1u);
  EXPECT_FALSE(raw(rd_req));
  EXPECT_FALSE(pad(5)) << "cleared, but there is no byte";
  slave_.write(data_cmd, 0x6e);
  rig_.pass(0);
  EXPECT_FALSE(pad(4)) << "the highest bit";
  rig_.pass(19);
  EXPECT_FALSE(pad(5));
  rig_.pass(1);
  EXPECT_TRUE(pad(5));
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0x6e}));
  EXPECT_TRUE(raw(rx_done));
  EXPECT_EQ(slave_.read(clr_rx_done), 1u);
  EXPECT_FALSE(raw(rx_done | rd_req | tx_abort));
  EXPECT_TRUE(raw(stop_seen));
  EXPECT_TRUE(pad(4) && pad(5));
}

// 4.3.10.1.4: bytes in the FIFO are sent without RD_REQ.
TEST_F(I2cSlaveTest, AvailableBytesFollowWithoutAPause) {
  command(do_read);
  command(do_read);
  command(do_read | do_stop);
  pass_bits(20);
  slave_.read(clr_rd_req);
  for (const std::uint32_t byte : {0x11u, 0x80u, 0xffu}) slave_.write(data_cmd, byte);
  pass_bits(28);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0x11, 0x80, 0xff}));
  EXPECT_FALSE(raw(rd_req)) << "requested for the first byte only";
  EXPECT_TRUE(raw(rx_done));
  EXPECT_EQ(slave_aborted(), 0u);
}

TEST_F(I2cSlaveTest, RequestsEachMissingByte) {
  for (int n = 0; n < 3; ++n) command(do_read | (n == 2 ? do_stop : 0u));
  for (std::uint32_t n = 0; n < 3; ++n) {
    pass_bits(20);
    EXPECT_EQ(slave_.read(clr_rd_req), 1u) << n;
    slave_.write(data_cmd, 0xa0 + n);
  }
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0xa0, 0xa1, 0xa2}));
}

// ABRT_SLVFLUSH_TXFIFO: old data are flushed when the master begins to read, and no byte is
// accepted until IC_CLR_TX_ABRT is read.
TEST_F(I2cSlaveTest, OldBytesAreFlushed) {
  slave_.write(data_cmd, 0x77);
  slave_.write(data_cmd, 0x78);
  command(do_read | do_stop);
  pass_bits(20);
  EXPECT_TRUE(raw(tx_abort));
  EXPECT_TRUE(raw(rd_req));
  EXPECT_EQ(slave_.read(abort_source), 2u << 23 | 1u << 13) << "TX_FLUSH_CNT";
  slave_.write(data_cmd, 0x79);
  EXPECT_EQ(slave_.read(txflr), 0u);
  slave_.read(clr_tx_abrt);
  slave_.write(data_cmd, 0x12);
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0x12}));
}

TEST_F(I2cSlaveTest, BytesThatTheMasterDoesNotReadAreFlushed) {
  command(do_read | do_stop);
  pass_bits(20);
  for (const std::uint32_t byte : {1u, 2u, 3u}) slave_.write(data_cmd, byte);
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{1}));
  EXPECT_TRUE(raw(rx_done));
  EXPECT_TRUE(raw(tx_abort));
  EXPECT_EQ(slave_.read(txflr), 0u);
}

// ABRT_SLVRD_INTX: a read command is not an answer.
TEST_F(I2cSlaveTest, AReadCommandIsNotAnAnswer) {
  command(do_read | do_stop);
  pass_bits(20);
  slave_.write(data_cmd, do_read);
  EXPECT_EQ(slave_aborted(), 1u << 15);
  EXPECT_FALSE(pad(5));
  slave_.read(clr_tx_abrt);
  slave_.write(data_cmd, 0x55);
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0x55}));
}

// A register address is written, then read after a RESTART: RESTART_DET.
TEST_F(I2cSlaveTest, WriteThenReadWithRestart) {
  command(0x0c);
  command(do_read | do_restart);
  command(do_read | do_stop);
  pass_bits(60);
  EXPECT_EQ(received(), (std::vector<std::uint32_t>{0x0c | first_byte}));
  EXPECT_TRUE(raw(restart_seen));
  EXPECT_TRUE(raw(rd_req));
  EXPECT_FALSE(raw(stop_seen));
  slave_.write(data_cmd, 0xde);
  slave_.write(data_cmd, 0xad);
  pass_bits(30);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0xde, 0xad}));
  EXPECT_TRUE(raw(stop_seen));
}

// 4.3.6.2; IC_ACK_GENERAL_CALL.
TEST_F(I2cSlaveTest, GeneralCall) {
  master_.write(enable, 0);
  master_.write(tar, 1u << 11);  // SPECIAL, GC_OR_START 0
  master_.write(enable, 1);
  command(0x06 | do_stop);
  pass_bits(40);
  EXPECT_TRUE(raw(gen_call));
  EXPECT_EQ(received(), (std::vector<std::uint32_t>{0x06 | first_byte}));
  EXPECT_EQ(master_aborted(), 0u);

  // The slave's own address does not count as a general call.
  slave_.read(clr_stop);
  set_up(slave_, as_slave | stop_if_addressed);
  EXPECT_FALSE(raw(gen_call)) << "disabling clears it";
  command(0x07 | do_stop);
  pass_bits(40);
  EXPECT_EQ(received(), (std::vector<std::uint32_t>{0x07 | first_byte}));
  EXPECT_FALSE(raw(stop_seen));

  set_up(slave_, as_slave);
  slave_.write(ack_general, 0);
  command(0x06 | do_stop);
  pass_bits(40);
  EXPECT_FALSE(raw(gen_call));
  EXPECT_TRUE(received().empty());
  EXPECT_EQ(master_aborted(), 1u << 4) << "ABRT_GCALL_NOACK";
}

// IC_SLV_DATA_NACK_ONLY: the address is acknowledged; data are neither acknowledged nor stored.
TEST_F(I2cSlaveTest, RefusesData) {
  slave_.write(enable, 0);
  slave_.write(nack_only, 1);
  slave_.write(enable, 1);
  command(0x35);
  command(0x36 | do_stop);
  pass_bits(60);
  EXPECT_EQ(master_aborted(), 1u << 3) << "ABRT_TXDATA_NOACK";
  EXPECT_TRUE(received().empty());
  EXPECT_TRUE(raw(stop_seen));
}

// 4.3.10.1.3: without room bytes are acknowledged and lost; RX_FIFO_FULL_HLD_CTRL: the slave holds
// the bus instead.
TEST_F(I2cSlaveTest, WithoutRoomBytesAreLostOrTheBusIsHeld) {
  for (const std::uint32_t option : {0u, rx_hold}) {
    set_up(slave_, as_slave | option);
    for (std::uint32_t n = 0; n < 15; ++n) command(n);
    pass_bits(40);
    for (std::uint32_t n = 15; n < 18; ++n) command(n | (n == 17 ? do_stop : 0u));
    pass_bits(400);
    EXPECT_EQ(pad(5), option == 0);
    EXPECT_EQ(raw(rx_over), option == 0);
    EXPECT_EQ(raw(stop_seen), option == 0);
    for (std::uint32_t n = 0; n < (option == 0 ? 16u : 18u); ++n) {
      ASSERT_NE(slave_.read(rxflr), 0u) << n;
      EXPECT_EQ(slave_.read(data_cmd) & 0xffu, n);
      pass_bits(20);
    }
    EXPECT_EQ(slave_.read(rxflr), 0u);
    EXPECT_TRUE(raw(stop_seen));
    slave_.read(clr_stop);
    EXPECT_EQ(master_aborted(), 0u);
  }
}

TEST_F(I2cSlaveTest, TenBits) {
  set_up(master_, as_master | master_ten_bits, 0x2a5);
  set_up(slave_, as_slave | slave_ten_bits, 0x2a5);
  command(0x99 | do_stop);
  pass_bits(50);
  EXPECT_EQ(received(), (std::vector<std::uint32_t>{0x99 | first_byte}));
  command(do_read | do_stop);
  pass_bits(60);
  EXPECT_TRUE(raw(rd_req));
  slave_.write(data_cmd, 0x3c);
  pass_bits(20);
  EXPECT_EQ(master_received(), (std::vector<std::uint32_t>{0x3c}));
  EXPECT_EQ(master_aborted(), 0u);

  set_up(slave_, as_slave | slave_ten_bits, 0x2a4);
  command(0x99 | do_stop);
  pass_bits(50);
  EXPECT_EQ(master_aborted(), 1u << 2) << "ABRT_10ADDR2_NOACK";
  set_up(slave_, as_slave, 0x2a5);
  master_.read(clr_tx_abrt);
  command(0x99 | do_stop);
  pass_bits(50);
  EXPECT_EQ(master_aborted(), 1u << 1) << "ABRT_10ADDR1_NOACK: seven bits only";
}

// "What is on the data bus is not what is supposed to be transmitted": ABRT_SLV_ARBLOST.
TEST_F(I2cSlaveTest, LosesTheBusToALowSda) {
  command(do_read | do_stop);
  pass_bits(20);
  slave_.write(data_cmd, 0xff);
  rig_.gpio.set_external(4, External::low, rig_.wheel.now());
  pass_bits(3);
  rig_.gpio.set_external(4, External::floating, rig_.wheel.now());
  EXPECT_TRUE(raw(tx_abort));
  EXPECT_EQ(slave_aborted(), 1u << 14 | 1u << 12);
  pass_bits(20);
  EXPECT_TRUE(pad(4) && pad(5)) << "the master ends it";
}

// IC_ENABLE_STATUS: SLV_DISABLED_WHILE_BUSY, SLV_RX_DATA_LOST.
TEST_F(I2cSlaveTest, DisabledWhileBusy) {
  command(0x35);
  command(0x36 | do_stop);
  pass_bits(14);
  slave_.write(enable, 0);
  EXPECT_EQ(slave_.read(enable_status), 6u);
  pass_bits(50);
  EXPECT_EQ(master_aborted(), 1u << 3);
  slave_.write(enable, 1);
  EXPECT_EQ(slave_.read(enable_status), 1u);
  slave_.write(enable, 0);
  EXPECT_EQ(slave_.read(enable_status), 0u);
}

// IC_SDA_HOLD: SDA falls this time after SCL, for a slave at least seven cycles.
TEST_F(I2cSlaveTest, AcknowledgeFollowsAfterTheHoldTime) {
  for (const auto& [hold, expected] : {std::pair{60u, 60u}, std::pair{1u, 7u}}) {
    slave_.write(enable, 0);
    slave_.write(sda_hold, hold);
    slave_.write(enable, 1);
    master_.write(enable, 0);
    master_.write(tar, mine);
    master_.write(sda_hold, 1);  // releases SDA at once
    master_.write(enable, 1);
    command(do_read | do_stop);  // the eighth bit is 1
    rig_.pass(high + 8 * bit + expected - 1);
    EXPECT_TRUE(pad(4)) << hold;
    rig_.pass(1);
    EXPECT_FALSE(pad(4)) << hold;
    pass_bits(10);
    slave_.write(data_cmd, 0);
    pass_bits(30);
  }
}

TEST_F(I2cSlaveTest, InterruptsAndNothingDueOnAFreeBus) {
  slave_.write(intr_mask, rd_req);
  EXPECT_FALSE(rig_.line(Irq::i2c1));
  command(do_read | do_stop);
  pass_bits(20);
  EXPECT_TRUE(rig_.line(Irq::i2c1));
  slave_.read(clr_rd_req);
  EXPECT_FALSE(rig_.line(Irq::i2c1));
  slave_.write(data_cmd, 1);
  pass_bits(100);
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000'000);
}

// Both directions by DMA: requests 34 and 35 (2.5.3.1).
TEST_F(I2cSlaveTest, ReceivesByDma) {
  constexpr std::uint32_t i2c1_base = 0x4004'8000;
  slave_.write(0x88, 1);
  rig_.start_dma(0, i2c1_base + data_cmd, rigs::DmaSystemRig::ram, 20, 0, false, true,
                 Dreq::i2c1_rx);
  for (std::uint32_t n = 0; n < 20; ++n) {
    command(n * 3 | (n == 19 ? do_stop : 0u));
    pass_bits(9);
  }
  pass_bits(30);
  EXPECT_FALSE(rig_.dma_busy(0));
  for (std::uint32_t n = 0; n < 20; ++n)
    EXPECT_EQ(rig_.load(rigs::DmaSystemRig::ram + n / 4 * 4) >> n % 4 * 8 & 0xffu, n * 3);
}

/// A master that drives only the two pins: it can send sequences that I2C0 cannot.
class PinMaster {
 public:
  explicit PinMaster(rigs::DmaSystemRig& rig) : rig_(rig) {}
  void start() {
    put(sda, true);
    put(scl, true);
    put(sda, false);
    put(scl, false);
  }
  void stop() {
    put(sda, false);
    put(scl, true);
    put(sda, true);
  }
  /// Sends a byte; returns whether it is acknowledged.
  bool write(std::uint32_t byte) {
    for (unsigned bit = 8; bit-- > 0;) clock((byte >> bit & 1u) != 0);
    return !clock(true);
  }
  /// Reads the last byte, without acknowledging it.
  std::uint32_t read() {
    std::uint32_t byte = 0;
    for (int bit = 0; bit < 8; ++bit) byte = byte << 1 | (clock(true) ? 1u : 0u);
    clock(true);
    return byte;
  }

 private:
  static constexpr unsigned sda = 6, scl = 7;
  bool clock(bool level) {
    put(sda, level);
    put(scl, true);
    const bool seen = (rig_.gpio.pad_levels() >> sda & 1u) != 0;
    put(scl, false);
    return seen;
  }
  void put(unsigned gpio, bool level) {
    rig_.gpio.set_external(gpio, level ? External::floating : External::low, rig_.wheel.now());
    rig_.pass(200);
  }
  rigs::DmaSystemRig& rig_;
};

// 4.3.6.2: a RESTART for reading repeats the first byte of ten bits. It selects the slave that all
// ten bits have addressed before, and no slave after another address.
TEST_F(I2cSlaveTest, TenBitsStaySelectedUntilAnotherAddress) {
  PinMaster pins(rig_);
  set_up(slave_, as_slave | slave_ten_bits, 0x2a5);
  pins.start();
  EXPECT_FALSE(pins.write(0xf5));
  pins.start();
  EXPECT_TRUE(pins.write(0xf4));
  EXPECT_TRUE(pins.write(0xa5));
  for (const std::uint32_t byte : {0x81u, 0x7eu}) {
    pins.start();
    ASSERT_TRUE(pins.write(0xf5));
    slave_.write(data_cmd, byte);
    rig_.pass(200);
    EXPECT_EQ(pins.read(), byte);
  }
  pins.start();
  EXPECT_FALSE(pins.write(0xf2)) << "bits 9 and 8 of another address";
  pins.start();
  EXPECT_FALSE(pins.write(0xf5));
  pins.start();
  EXPECT_TRUE(pins.write(0xf4));
  EXPECT_TRUE(pins.write(0xa5));
  pins.stop();
  pins.start();
  EXPECT_FALSE(pins.write(0xf5)) << "the STOP has ended it";
  pins.stop();
}

TEST_F(I2cSlaveTest, MasterAndSlaveAtOnceIsReported) {
  set_up(slave_, as_slave | 1u);
  ASSERT_EQ(rig_.reports.size(), 1u);
  EXPECT_NE(rig_.reports[0].find("I2C1 IC_CON"), std::string::npos);
}

}  // namespace
}  // namespace lamplock::sim::chip::i2c_slave_test
