// One-byte commands on their way to the main loop: stops are never lost.
#include "shared/wire/realtime_inbox.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

#include "tests/scale.hpp"

namespace lamplock::wire {
namespace {

using test::scaled;

void push(RealtimeInbox& inbox, std::string_view bytes) {
  for (const char byte : bytes) inbox.push(static_cast<std::uint8_t>(byte));
}

std::string popped(RealtimeInbox& inbox) {
  std::string all;
  for (std::uint8_t byte = 0; inbox.pop(byte);) all += static_cast<char>(byte);
  return all;
}

TEST(RealtimeInbox, KeepsTheOrderAndDropsRepeats) {
  RealtimeInbox inbox;
  push(inbox, "!?!~~!??");
  EXPECT_EQ(popped(inbox), "!~!?");
  EXPECT_EQ(popped(inbox), "");
  // Every step of an override counts.
  push(inbox, "\x91\x91\x91");
  EXPECT_EQ(popped(inbox), "\x91\x91\x91");
}

TEST(RealtimeInbox, AFullInboxStillAcceptsAStop) {
  for (const char stop : {'!', '\x18', '\x84', '\x85'}) {
    RealtimeInbox inbox;
    push(inbox, std::string(1000, '\x91'));
    push(inbox, std::string(1, stop));
    push(inbox, std::string(1000, '\x92'));
    const std::string all = popped(inbox);
    EXPECT_EQ(all.size(), RealtimeInbox::capacity);
    EXPECT_EQ(all.back(), stop);
  }
}

/// For any input, the machine ends stopped if the last command other than overrides was a stop.
TEST(RealtimeInbox, TheLastStopIsNeverLost) {
  std::mt19937_64 random(2);
  constexpr std::string_view commands = "!~?\x18\x84\x85\x91\xa0";
  for (int round = 0; round < scaled(2000); ++round) {
    RealtimeInbox inbox;
    char last = 0;
    std::string all;
    for (auto count = random() % 200; count > 0; --count) {
      const char byte = commands[random() % commands.size()];
      push(inbox, std::string(1, byte));
      if (stop_rank(static_cast<std::uint8_t>(byte)) != 0) last = byte;
      if (byte == '~') last = 0;
      std::uint8_t taken = 0;
      if (random() % 8 == 0 && inbox.pop(taken)) all += static_cast<char>(taken);
    }
    all += popped(inbox);
    if (last == 0) continue;
    const std::size_t resumed = all.rfind('~');
    const std::string after = resumed == std::string::npos ? all : all.substr(resumed);
    EXPECT_NE(after.find_first_of("!\x18\x84\x85"), std::string::npos);
  }
}

}  // namespace
}  // namespace lamplock::wire
