// Bytes of a terminal to whole keys of the line editor.
#include "host/cli/editor_keys.hpp"

#include <gmock/gmock.h>

#include <random>
#include <string>
#include <vector>

#include "tests/scale.hpp"

namespace lamplock::cli::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(EditorKeys, real_time_keys_are_never_part_of_a_sequence) {
  EditorKeys keys;
  EXPECT_THAT(keys.take("a!\x1b[5~~"), ElementsAre("a", "!", "\x1b[5~", "~"));
  EXPECT_THAT(keys.take("\x1b!\x1b\x1b\x18"), ElementsAre("!", "\x18"));
  EXPECT_THAT(keys.take("\x1b["), IsEmpty());
  EXPECT_TRUE(keys.inside());
  keys.pause();
  EXPECT_THAT(keys.take("!"), ElementsAre("!"));
  EXPECT_EQ(realtime_word_of("!"), "!");
  EXPECT_EQ(realtime_word_of("\x18"), ":reset");
  for (const char* other : {"a", "\x1b[5~", "\x1b!", ":", ""})
    EXPECT_EQ(realtime_word_of(other), "");
}

/// libedit would take the rest of a sequence that it does not know for text.
TEST(EditorKeys, sequences_are_editing_characters_or_nothing) {
  EXPECT_EQ(editing_key_of("\x1b[D"), "\x02");
  EXPECT_EQ(editing_key_of("\x1b[3~"), "\x1f");
  for (const char* unknown : {"\x1b[5~", "\x1b[15~", "\x1b[1;5C", "\x1bOP", "\x1b[[A"})
    EXPECT_EQ(editing_key_of(unknown), "");
  for (const char* key : {"a", "~", "\n",
                          "\x1b"
                          "b",
                          "\xC3\xA4"})
    EXPECT_EQ(editing_key_of(key), key);
}

/// In pieces of any size.
TEST(EditorKeys, are_the_same_in_any_pieces) {
  const std::vector<std::string> all{"a",
                                     "!",
                                     "~",
                                     "\x1b[A",
                                     "\x1bOH",
                                     "\x1b[3~",
                                     "\x1b[[A",
                                     "\x1b[1;5C",
                                     "\x1b"
                                     "f",
                                     "\xC3\xA4",
                                     "\xE2\x82\xAC",
                                     "\n"};
  std::mt19937 random(11);
  for (int round = 0; round < lamplock::test::scaled(500); ++round) {
    std::vector<std::string> typed, found;
    std::string bytes;
    for (int i = 0; i < 20; ++i) bytes += typed.emplace_back(all[random() % all.size()]);
    EditorKeys keys;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t size = 1 + random() % 5;
      for (std::string& key : keys.take(std::string_view(bytes).substr(at, size)))
        found.push_back(std::move(key));
      at += size;
    }
    ASSERT_EQ(found, typed);
  }
}

}  // namespace
}  // namespace lamplock::cli::test
