// The model of the TMC2209 against figures of its datasheet (rev. 1.09).
#include "sim/world/tmc2209.hpp"

#include <gmock/gmock.h>

#include <random>

namespace lamplock::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Picoseconds bit = ps_per_s / 115'200;

/// Sends bytes one after the other; returns the reply.
struct Master {
  Bytes send(const Bytes& bytes, Picoseconds pause = 0) {
    Bytes reply;
    for (const std::uint8_t byte : bytes) {
      now += 10 * bit + pause;
      const Bytes more = wire.receive(byte, now, bit);
      reply.insert(reply.end(), more.begin(), more.end());
    }
    now += 100 * bit;
    return reply;
  }
  static Bytes with_crc(Bytes bytes) {
    bytes.push_back(tmc_crc(bytes));
    return bytes;
  }
  static Bytes writing(std::uint8_t address, std::uint8_t reg, std::uint32_t value) {
    return with_crc({0x05, address, static_cast<std::uint8_t>(reg | 0x80),
                     static_cast<std::uint8_t>(value >> 24), static_cast<std::uint8_t>(value >> 16),
                     static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)});
  }
  TmcWire wire{std::array<std::uint8_t, 4>{0, 2, 1, 3}};
  Picoseconds now = 0;
};

/// The algorithm of 4.2, bit by bit as the datasheet's source text has it.
std::uint8_t crc_of_the_datasheet(const Bytes& bytes) {
  unsigned char crc = 0;
  for (std::uint8_t current : bytes)
    for (int j = 0; j < 8; ++j) {
      if (((crc >> 7) ^ (current & 0x01)) != 0)
        crc = static_cast<unsigned char>((crc << 1) ^ 0x07);
      else
        crc = static_cast<unsigned char>(crc << 1);
      current = static_cast<std::uint8_t>(current >> 1);
    }
  return crc;
}

TEST(Tmc2209, HasTheCrcOfTheDatasheet) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    Bytes bytes(3 + random() % 5);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(tmc_crc(bytes), crc_of_the_datasheet(bytes));
  }
  // Requests of IFCNT and IOIN from drive 0.
  EXPECT_EQ(tmc_crc(Bytes{0x05, 0x00, 0x02}), 0x8f);
  EXPECT_EQ(tmc_crc(Bytes{0x05, 0x00, 0x06}), 0x6f);
}

TEST(Tmc2209, AnswersWithItsVersion) {
  Master master;
  const Bytes early = master.send(Master::with_crc({0x05, 3, 0x06}));
  ASSERT_EQ(early.size(), 8u);
  EXPECT_NE(early.back(), tmc_crc(Bytes(early.begin(), early.end() - 1)))
      << "8 bits after the request, on a wire with others";
  master.send(Master::writing(3, 0x03, 2u << 8));
  const Bytes reply = master.send(Master::with_crc({0x05, 3, 0x06}));
  ASSERT_EQ(reply.size(), 8u);
  EXPECT_THAT(Bytes(reply.begin(), reply.end() - 1), ElementsAre(0x05, 0xff, 0x06, 0x21, 0, 0, 0));
  EXPECT_EQ(reply.back(), tmc_crc(Bytes(reply.begin(), reply.end() - 1)));
}

TEST(Tmc2209, CountsOnlyAcceptedWritesToItself) {
  Master master;
  const Tmc2209& drive = master.wire.drives[1];
  EXPECT_THAT(master.send(Master::writing(2, 0x10, 0x00081f10)), IsEmpty());
  EXPECT_EQ(drive.read(0x02), 1u);
  Bytes damaged = Master::writing(2, 0x10, 0);
  damaged[5] ^= 4;
  master.send(damaged);
  master.send(Master::writing(1, 0x10, 0));
  EXPECT_EQ(drive.read(0x02), 1u);
  EXPECT_EQ(drive.written(0x10), 0x00081f10u);
  EXPECT_EQ(drive.read(0x10), 0u) << "IHOLD_IRUN is write only";
  for (int i = 0; i < 255; ++i) master.send(Master::writing(2, 0x13, 0));
  EXPECT_EQ(drive.read(0x02), 0u) << "counts to 255";
}

TEST(Tmc2209, ForgetsADatagramAfterAPause) {
  Master master;
  const Bytes request = Master::with_crc({0x05, 0, 0x02});
  master.send({request[0], request[1]});  // a long pause follows
  EXPECT_EQ(master.send(request).size(), 8u);
  EXPECT_EQ(master.send(request, 50 * bit).size(), 8u);
  EXPECT_THAT(master.send(request, 60 * bit), IsEmpty());
}

TEST(Tmc2209, HasTheResetValuesAndTellsOfAReset) {
  Tmc2209 drive(0);
  EXPECT_EQ(drive.read(0x00), 0x101u);
  EXPECT_EQ(drive.read(0x6c), 0x10000053u);
  EXPECT_EQ(drive.read(0x01), 1u);
  drive.write(0x01, 1);
  EXPECT_EQ(drive.read(0x01), 0u);
  drive.set_status(Tmc2209::short_a);
  EXPECT_EQ(drive.read(0x01), 2u);
  drive.set_powered(false);
  drive.set_powered(true);
  EXPECT_EQ(drive.read(0x01), 1u);
  EXPECT_EQ(drive.read(0x6f), 0u);
}

/// Full scale of both ranges (rev. 1.03: table of section 8, sense levels of 325 and 180 mV in the
/// table of detector levels).
TEST(Tmc2209, HasTheCurrentsAndMicrostepsOfTheDatasheet) {
  Tmc2209 drive(2);
  EXPECT_EQ(drive.microsteps(), 64u) << "by MS1 and MS2";
  drive.write(0x00, 1u << 7);
  EXPECT_EQ(drive.microsteps(), 256u);
  drive.write(0x6c, 0x14000053);
  EXPECT_EQ(drive.microsteps(), 16u);
  drive.write(0x10, 31u << 8);
  EXPECT_NEAR(drive.current_ma(110), 1768, 1);
  for (const auto& [sense_mohm, current_a] :
       {std::pair{100, 1.92}, {150, 1.35}, {220, 0.96}, {500, 0.44}, {1000, 0.23}})
    EXPECT_NEAR(drive.current_ma(static_cast<std::uint32_t>(sense_mohm)) / 1000, current_a, 0.0051);
  drive.write(0x6c, 0x14020053);
  EXPECT_NEAR(drive.current_ma(110), 979, 1);
  drive.write(0x10, 15u << 8);
  EXPECT_NEAR(drive.current_ma(110), 490, 1);
}

TEST(Tmc2209, IsSilentWithoutPower) {
  Master master;
  master.wire.drives[0].set_powered(false);
  EXPECT_THAT(master.send(Master::with_crc({0x05, 0, 0x02})), IsEmpty());
  EXPECT_EQ(master.send(Master::with_crc({0x05, 1, 0x02})).size(), 8u);
}

}  // namespace
}  // namespace lamplock::sim
