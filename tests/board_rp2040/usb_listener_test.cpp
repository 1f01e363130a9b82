// Which of two USB functions is active: by its rules, and by the accepted bytes when two programs
// send at once.
#include "firmware/boards/rp2040/usb/listener.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <string>
#include <string_view>

#include "tests/board_rp2040/fake_usb.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using rp2040::usb::Function;
using rp2040::usb::Listener;
using rp2040::usb::Verdict;

constexpr Function serial = Function::serial;
constexpr Function stream = Function::stream;

/// A listener and its clock.
struct Ear {
  explicit Ear(std::uint32_t start_us = 0) : now_us(start_us) { listener.reset(now_us); }
  /// Receives a packet that ends a line.
  Verdict hear(Function from, bool tied = false) { return send(from, "?\n", tied); }
  Verdict send(Function from, std::string_view text, bool tied = false) {
    std::array<std::uint32_t, 16> words{};
    std::memcpy(words.data(), text.data(), text.size());
    return listener.packet(
        from, rp2040::usb::tail_of(words.data(), static_cast<std::uint32_t>(text.size())), now_us,
        tied);
  }
  void pass(std::uint32_t us) { now_us += us; }

  Listener listener;
  std::uint32_t now_us;
};

TEST(UsbListener, TheFirstSenderIsActive) {
  Ear ear;
  EXPECT_EQ(ear.listener.heard(), serial);
  EXPECT_EQ(ear.hear(stream), Verdict::take_over);
  EXPECT_EQ(ear.hear(stream), Verdict::take);
  EXPECT_EQ(ear.listener.heard(), stream);
  Ear other;
  EXPECT_EQ(other.hear(serial), Verdict::take);
}

TEST(UsbListener, TheSerialPortWaitsForASecondOfSilence) {
  // Also over the wrap of the clock.
  for (const std::uint32_t start : {0u, 0xffff'ff00u}) {
    Ear ear(start);
    ear.hear(stream);
    ear.pass(999'999);
    EXPECT_EQ(ear.hear(serial), Verdict::drop);
    EXPECT_EQ(ear.hear(stream), Verdict::take);
    ear.pass(1'000'000);
    EXPECT_EQ(ear.hear(serial), Verdict::take_over);
    EXPECT_EQ(ear.hear(stream), Verdict::take_over) << "the stream must never wait";
  }
}

TEST(UsbListener, AJobsHostIsActiveUntilItHasBeenSilentForTenSeconds) {
  for (const Function host : {serial, stream}) {
    Ear ear;
    ear.hear(host);
    for (int i = 0; i < 100; ++i) {
      ear.pass(500'000);
      EXPECT_EQ(ear.hear(other(host), true), Verdict::drop);
      EXPECT_EQ(ear.hear(host, true), Verdict::take);
    }
    ear.pass(9'999'999);
    EXPECT_EQ(ear.hear(other(host), true), Verdict::drop);
    ear.pass(1);
    EXPECT_EQ(ear.hear(other(host), true), Verdict::take_over);
    EXPECT_EQ(ear.hear(host, true), Verdict::take_over) << "the job belongs to this host";
    EXPECT_EQ(ear.hear(other(host), true), Verdict::drop);
  }
}

TEST(UsbListener, ACableReconnectedInAJobBelongsToItsHost) {
  for (const Function host : {serial, stream}) {
    Ear ear;
    ear.hear(host);
    ear.hear(host, true);
    ear.listener.reset(ear.now_us);
    ear.pass(5'000'000);
    EXPECT_EQ(ear.hear(other(host), true), Verdict::drop);
    EXPECT_NE(ear.hear(host, true), Verdict::drop);
    EXPECT_EQ(ear.listener.heard(), host);
  }
}

TEST(UsbListener, LinesThatBeganInDroppedBytesAreMarked) {
  struct Case {
    std::string_view dropped;
    Verdict then;
  };
  for (const Case& one :
       {Case{"G1X", Verdict::take_over_broken}, Case{"$I\n", Verdict::take_over},
        Case{"\r", Verdict::take_over}, Case{"?", Verdict::take_over},
        Case{"G1X?", Verdict::take_over_broken}, Case{"\x02\x45\x03", Verdict::take_over},
        // A real-time byte or flow control after a line or frame belongs to neither.
        Case{"$I\n?", Verdict::take_over}, Case{"$I\r~\x18\x80", Verdict::take_over},
        Case{"\x02\x45\x03?", Verdict::take_over}, Case{"$I\n\x11", Verdict::take_over},
        Case{"\x13", Verdict::take_over}, Case{"?!~?", Verdict::take_over},
        Case{"$I\nG1X?", Verdict::take_over_broken},
        Case{"$I\n\x02\x45", Verdict::take_over_broken},
        Case{"\x02\x45\x03$I", Verdict::take_over_broken}}) {
    Ear ear;
    ear.hear(stream);
    ASSERT_EQ(ear.send(serial, one.dropped), Verdict::drop);
    ear.send(serial, "?");  // does not affect the line around it
    ear.pass(1'000'000);
    EXPECT_EQ(ear.hear(serial), one.then) << one.dropped;
    EXPECT_EQ(ear.hear(serial), Verdict::take);
  }
  // A line begun while a function was active is never completed later.
  Ear turns;
  ASSERT_EQ(turns.send(serial, "$110=6"), Verdict::take);
  ASSERT_EQ(turns.hear(stream), Verdict::take_over);
  turns.pass(1'000'000);
  EXPECT_EQ(turns.send(serial, "0\n"), Verdict::take_over_broken);
  // The port that gets the answers is marked as well, if it was not active.
  Ear ear;
  ear.hear(stream);
  ear.listener.reset(ear.now_us);
  EXPECT_EQ(ear.send(serial, "G1X", true), Verdict::drop);
  ear.pass(10'000'000);
  EXPECT_EQ(ear.hear(serial, true), Verdict::take_over_broken);
}

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// The text that the device has received over either function, with one-byte commands at its end.
std::string heard(UsbHost& host) {
  const Bytes bytes = read_all(host);
  std::string text(bytes.begin(), bytes.end());
  std::uint8_t command = 0;
  while (host.serial.read_realtime(command)) host.commands.push_back(command);
  text.append(host.commands.begin(), host.commands.end());
  host.commands.clear();
  return text;
}

Handshake send(UsbHost& host, std::uint8_t endpoint, std::string_view text) {
  host.endpoint = endpoint;
  return host.bulk_out(bytes_of(text));
}

/// The device's output on an endpoint.
std::string ask(UsbHost& host, std::uint8_t endpoint) {
  host.endpoint = endpoint;
  const Bytes bytes = host.bulk_in().data;
  return {bytes.begin(), bytes.end()};
}

TEST(UsbFunctionsTogether, AnswersGoToTheActiveFunction) {
  UsbHost host;
  ASSERT_TRUE(host.enumerate());
  const std::uint32_t start = host.serial.generation();
  ASSERT_EQ(send(host, 2, "$I\n"), Handshake::ack);
  EXPECT_EQ(host.serial.generation(), start);
  EXPECT_EQ(heard(host), "$I\n");
  host.serial.write(bytes_of("one"));
  host.serve();
  EXPECT_EQ(ask(host, 3), "");
  EXPECT_EQ(ask(host, 2), "one");
  ASSERT_EQ(send(host, 3, "$G\n"), Handshake::ack);
  EXPECT_NE(host.serial.generation(), start) << "a new connection";
  EXPECT_EQ(heard(host), "$G\n");
  host.serial.write(bytes_of("two"));
  host.serve();
  EXPECT_EQ(ask(host, 2), "");
  EXPECT_EQ(ask(host, 3), "two");
}

TEST(UsbFunctionsTogether, IncompleteLinesAndAnswersEndWithTheirConnection) {
  UsbHost host;
  ASSERT_TRUE(host.enumerate());
  send(host, 2, "$110=6");
  host.serial.write(bytes_of("answer to the serial port"));
  send(host, 3, "0\n");
  EXPECT_EQ(heard(host), "0\n") << "the generation shows that it is not the end of a line";
  host.serve();
  EXPECT_EQ(ask(host, 3), "");
}

// A sender polls in the packet of its line: when it is active again, its next line is whole.
TEST(UsbFunctionsTogether, TheFirstLineAfterASwitchIsWhole) {
  for (const std::string_view before : {"$I\n?", "?$I\n~?", "\x02\x45\x03?"}) {
    for (const bool was_heard : {false, true}) {
      UsbHost host;
      ASSERT_TRUE(host.enumerate());
      if (!was_heard) send(host, 3, "$G\n");
      send(host, 2, before);
      send(host, 3, "$G\n");
      heard(host);
      host.usb.now_us += Listener::idle_lease_us;
      send(host, 2, "$I\n?");
      EXPECT_EQ(heard(host), "$I\n?") << before;
    }
  }
}

// The core reads the generation, then the bytes; the interrupt may bring a new host in between.
TEST(UsbFunctionsTogether, TheFirstReadOfANewConnectionIsEmpty) {
  UsbHost host;
  ASSERT_TRUE(host.enumerate());
  send(host, 2, "$I\n");
  EXPECT_EQ(heard(host), "$I\n");
  const std::uint32_t generation = host.serial.generation();
  send(host, 3, "$110=60\n");
  std::array<std::uint8_t, 64> bytes{};
  EXPECT_EQ(host.serial.read(bytes), 0u);
  EXPECT_NE(host.serial.generation(), generation);
  EXPECT_EQ(host.serial.read(bytes), 8u);
}

TEST(UsbFunctionsTogether, TheInactiveFunctionNeverWaitsAndIsNeverReadLater) {
  UsbHost host;
  ASSERT_TRUE(host.enumerate());
  host.serial.set_tied(false);
  ASSERT_EQ(send(host, 3, "job"), Handshake::ack);
  host.serial.set_tied(true);
  EXPECT_EQ(heard(host), "job");
  const std::uint32_t generation = host.serial.generation();
  for (int i = 0; i < 500; ++i) ASSERT_EQ(send(host, 2, "!\x18~ G1 X1\n"), Handshake::ack);
  EXPECT_EQ(heard(host), "");
  EXPECT_EQ(host.serial.generation(), generation);
  EXPECT_EQ(host.serial.counters().packets_unheard, 500u);
  host.serial.set_tied(false);
  EXPECT_EQ(heard(host), "");
  ASSERT_EQ(send(host, 3, "more"), Handshake::ack);
  EXPECT_EQ(heard(host), "more");
}

/// Two programs send their own lines at random, with pauses, in any mixture of packets: the bytes
/// between two new connections are lines of one program, whole except for the first and last.
TEST(UsbFunctionsTogether, NoLineIsEverMadeOfTwo) {
  std::mt19937_64 random(18);
  UsbHost host;
  ASSERT_TRUE(host.enumerate());
  struct Sender {
    std::uint8_t endpoint;
    char letter;
    std::string rest{};
  };
  std::array<Sender, 2> senders{Sender{2, 'a'}, Sender{3, 'b'}};
  std::uint32_t generation = host.serial.generation();
  std::string line;
  int lines = 0, changes = 0;
  const auto take = [&] {
    const std::uint32_t now = host.serial.generation();
    if (now != generation) {
      generation = now;
      line.clear();
      ++changes;
    }
    for (const char c : heard(host)) {
      if (c != '\n') {
        line += c;
        continue;
      }
      ++lines;
      const bool spoilt = line.find('\x7f') != std::string::npos;
      const bool whole = line == std::string(20, 'a') || line == std::string(20, 'b');
      EXPECT_TRUE(spoilt || whole) << line;
      line.clear();
    }
  };
  for (int round = 0; round < scaled(20000); ++round) {
    Sender& sender = senders[random() % 2];
    if (sender.rest.empty()) sender.rest = std::string(20, sender.letter) + '\n';
    const std::size_t size = 1 + random() % sender.rest.size();
    if (send(host, sender.endpoint, sender.rest.substr(0, size)) == Handshake::ack)
      sender.rest.erase(0, size);
    take();
    if (random() % 8 == 0) host.usb.now_us += static_cast<std::uint32_t>(random() % 2'000'000);
    if (random() % 64 == 0) host.serial.set_tied(random() % 2 == 0);
    if (random() % 16 == 0) host.frame();
  }
  EXPECT_GT(lines, scaled(100));
  EXPECT_GT(changes, scaled(100));
}

}  // namespace
}  // namespace lamplock::test
