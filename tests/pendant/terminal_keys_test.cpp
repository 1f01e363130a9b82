// Bytes of terminals decoded to keys, and repeated keys.
#include "host/pendant/terminal_keys.hpp"

#include <gmock/gmock.h>

#include <random>

#include "host/pendant/key_repeat.hpp"
#include "tests/scale.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(TerminalKeys, of_xterm_and_the_console) {
  TerminalKeys keys;
  EXPECT_THAT(keys.take("\x1b[A\x1b[B\x1b[C\x1b[D"), ElementsAre("up", "down", "right", "left"));
  EXPECT_THAT(keys.take("\x1bOA\x1bOP\x1b[5~\x1b[6~\x1b[24~"),
              ElementsAre("up", "f1", "page-up", "page-down", "f12"));
  EXPECT_THAT(keys.take("\x1b[[A\x1b[H\x1b[1~"), ElementsAre("f1", "home", "home"));
  EXPECT_THAT(keys.take("a \r\x18\x7f\t"),
              ElementsAre("a", "space", "enter", "ctrl-x", "backspace", "tab"));
  EXPECT_THAT(keys.take("\x1b[1;5A\x1b[200~"), IsEmpty()) << "a key with Ctrl is not the plain key";
}

TEST(TerminalKeys, an_escape_alone_is_a_key) {
  TerminalKeys keys;
  EXPECT_THAT(keys.take("\x1b"), IsEmpty());
  EXPECT_TRUE(keys.inside());
  EXPECT_THAT(keys.pause(), ElementsAre("escape"));
  EXPECT_THAT(keys.take("\x1b\x1b[A"), ElementsAre("escape", "up"));
  EXPECT_THAT(keys.take("\x1b "), ElementsAre("escape", "space"))
      << "both keys stop the machine; Alt-space would not";
  EXPECT_THAT(keys.take("\x1b["), IsEmpty());
  EXPECT_THAT(keys.pause(), IsEmpty());
  EXPECT_FALSE(keys.inside());
}

/// The division of the bytes does not change the keys; noise gives only existing names.
TEST(TerminalKeys, are_the_same_in_pieces) {
  std::mt19937_64 random(2);
  for (int round = 0; round < test::scaled(300); ++round) {
    std::string bytes;
    for (int i = 0; i < 60; ++i)
      bytes +=
          random() % 3 == 0 ? std::string("\x1b[") : std::string(1, static_cast<char>(random()));
    TerminalKeys whole, pieces;
    const auto wanted = whole.take(bytes);
    std::vector<std::string> got;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t size = 1 + random() % 5;
      for (auto& key : pieces.take(std::string_view(bytes).substr(at, size)))
        got.push_back(std::move(key));
      at += size;
    }
    EXPECT_EQ(got, wanted);
    for (const std::string& key : wanted) EXPECT_TRUE(is_keyboard_name(key)) << key;
  }
}

TEST(KeyRepeat, distinguishes_a_held_key_from_repeated_presses) {
  KeyRepeat repeat;
  EXPECT_FALSE(repeat.press("a", 10s).held);
  EXPECT_FALSE(repeat.press("a", 10s + 160ms).held) << "a finger";
  EXPECT_FALSE(repeat.press("b", 10s + 190ms).held);
  EXPECT_TRUE(repeat.press("b", 10s + 280ms).held);
  EXPECT_FALSE(repeat.press("", 20s).held);
  EXPECT_FALSE(repeat.press("", 20s + 30ms).held) << "keys of a pendant never repeat";
}

TEST(KeyRepeat, uses_the_measured_interval) {
  KeyRepeat repeat;
  repeat.press("a", 0s);
  EXPECT_EQ(repeat.press("a", 92ms).until, 92ms + 230ms);
  EXPECT_EQ(repeat.press("a", 184ms).until, 184ms + 230ms);
  KeyRepeat fast;
  fast.press("a", 0s);
  EXPECT_EQ(fast.press("a", 33ms).until, 33ms + 100ms);
  // Two at once, as from a remote terminal.
  EXPECT_EQ(fast.press("a", 33ms).until, 33ms + 100ms);
}

}  // namespace
}  // namespace lamplock::pendant
