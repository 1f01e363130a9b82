// The two links as one: which port's bytes are accepted, and where a new connection begins.
#include "firmware/boards/rp2040/ports.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lamplock::test {
namespace {

/// A port with given properties.
struct FakePort {
  FakePort() = default;
  explicit FakePort(unsigned /*gpio*/) {}

  std::size_t read(std::span<std::uint8_t> out) {
    const std::size_t n = std::min(out.size(), waiting.size());
    std::copy_n(waiting.begin(), n, out.begin());
    waiting.erase(0, n);
    if (breaks_in_read) ++now;
    breaks_in_read = false;
    return n;
  }
  bool read_realtime(std::uint8_t& byte) {
    if (commands.empty()) return false;
    byte = static_cast<std::uint8_t>(commands.front());
    commands.erase(0, 1);
    return true;
  }
  bool realtime_waits() const { return !commands.empty(); }
  bool before_jog_cancel() const { return false; }
  bool take_loss() {
    const bool was = lost;
    lost = false;
    return was;
  }
  std::size_t room() const { return 64; }
  void write(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) sent.push_back(static_cast<char>(byte));
  }
  void poll() {}
  std::uint32_t generation() const { return now; }
  bool present() const { return here; }
  void set_tied(bool value) { tied = value; }

  std::string waiting, commands, sent;
  std::uint32_t now = 0;
  bool lost = false;
  bool here = true;
  bool breaks_in_read = false;
  bool tied = false;
};

struct Desk {
  rp2040::BasicPorts<FakePort, FakePort> ports{0};
  bool is_new = false;

  /// Bytes accepted in one pass of the main loop.
  std::string hear(bool tied = false) {
    std::array<std::uint8_t, 64> bytes;
    const std::size_t n = ports.read(bytes, tied);
    is_new = ports.take_new_connection();
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)};
  }
  std::string hear_usb(std::string_view text, bool tied = false) {
    ports.usb().waiting += text;
    return hear(tied);
  }
  std::string hear_uart(std::string_view text, bool tied = false) {
    ports.uart().waiting += text;
    return hear(tied);
  }
};

TEST(Ports, TheFirstBytesOfTheOtherPortAreANewConnection) {
  Desk desk;
  EXPECT_EQ(desk.hear_usb("$110=6"), "$110=6");
  EXPECT_FALSE(desk.is_new);
  EXPECT_EQ(desk.hear_uart("0\n"), "0\n");
  EXPECT_TRUE(desk.is_new);
  EXPECT_EQ(desk.hear_uart("$I\n"), "$I\n");
  EXPECT_FALSE(desk.is_new);
  EXPECT_EQ(desk.hear_usb("?"), "?");
  EXPECT_TRUE(desk.is_new);
}

TEST(Ports, OneByteCommandsAreAcceptedAsLinesAre) {
  Desk desk;
  std::uint8_t byte = 0;
  desk.hear_usb("G1X1\n");
  desk.ports.usb().commands = "!";
  ASSERT_TRUE(desk.ports.read_realtime(byte, true));
  EXPECT_EQ(byte, '!');
  EXPECT_FALSE(desk.ports.take_new_connection());
  // During a job the other port is ignored, and its bytes are not delivered later.
  desk.ports.uart().commands = "\x18";
  EXPECT_FALSE(desk.ports.read_realtime(byte, true));
  EXPECT_FALSE(desk.ports.read_realtime(byte, false));
  desk.ports.uart().commands = "?";
  ASSERT_TRUE(desk.ports.read_realtime(byte, false));
  EXPECT_TRUE(desk.ports.take_new_connection());
}

TEST(Ports, LossesCountWhileTheirPortIsActive) {
  Desk desk;
  desk.hear_usb("G1X1\n");
  desk.ports.uart().lost = true;  // noise on an open line
  EXPECT_FALSE(desk.ports.take_loss());
  desk.hear_uart("G1X1\n");
  EXPECT_FALSE(desk.ports.take_loss());
  desk.ports.uart().lost = true;
  EXPECT_TRUE(desk.ports.take_loss());
  EXPECT_FALSE(desk.ports.take_loss());
}

TEST(Ports, OnlyTheActiveHostCountsAsPresent) {
  Desk desk;
  EXPECT_TRUE(desk.ports.host_present());
  desk.ports.usb().here = false;
  EXPECT_FALSE(desk.ports.host_present());
  // The presence of a host at the UART is unknown.
  desk.hear_uart("G1X1\n");
  EXPECT_TRUE(desk.ports.host_present());
}

TEST(Ports, ABreakOfUsbIsANewConnectionEvenBeforeItsFirstBytes) {
  Desk desk;
  desk.hear_usb("$110=6");
  ++desk.ports.usb().now;
  EXPECT_EQ(desk.hear(), "");
  EXPECT_TRUE(desk.is_new);
  EXPECT_EQ(desk.hear_usb("0\n"), "0\n");
  EXPECT_FALSE(desk.is_new);
  ++desk.ports.usb().now;
  EXPECT_EQ(desk.hear_usb("0\n"), "0\n");
  EXPECT_TRUE(desk.is_new);
}

TEST(Ports, ABreakOfUsbDoesNotAffectTheHostAtTheUart) {
  Desk desk;
  desk.hear_uart("$11");
  ++desk.ports.usb().now;
  EXPECT_EQ(desk.hear_uart("0\n"), "0\n");
  EXPECT_FALSE(desk.is_new);
}

TEST(Ports, LastBytesOfAnEndedConnectionAreDropped) {
  Desk desk;
  desk.ports.usb().breaks_in_read = true;
  EXPECT_EQ(desk.hear_usb("$110=6"), "");
  EXPECT_EQ(desk.hear_usb("0\n"), "0\n");
  EXPECT_TRUE(desk.is_new);
}

TEST(Ports, WhenTiedTheOtherPortIsIgnored) {
  Desk desk;
  desk.hear_usb("?");
  EXPECT_EQ(desk.hear_uart("!", true), "");
  EXPECT_FALSE(desk.is_new);
  desk.ports.write(std::array<std::uint8_t, 1>{'x'});
  EXPECT_EQ(desk.ports.usb().sent, "x");
  EXPECT_EQ(desk.ports.uart().sent, "");
  EXPECT_EQ(desk.hear_usb("~", true), "~");
  // Bytes sent meanwhile are not delivered later.
  EXPECT_EQ(desk.hear(), "");
}

TEST(Ports, UsbIsInformedOfAnUnfinishedJob) {
  Desk desk;
  desk.hear(true);
  EXPECT_TRUE(desk.ports.usb().tied);
  desk.hear(false);
  EXPECT_FALSE(desk.ports.usb().tied);
}

}  // namespace
}  // namespace lamplock::test
