// Lines for people, wrapped at words.
#include "host/cli/wrapped_text.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <random>
#include <sstream>
#include <string>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/screen.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test::wrapped {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(WrappedText, breaks_at_words_only) {
  EXPECT_EQ(wrapped_text("one two three", 8), "one two\n  three");
  EXPECT_EQ(wrapped_text("  one two three\nfour", 10), "  one two\n    three\nfour");
  EXPECT_EQ(wrapped_text("a    b", 6), "a    b");
  EXPECT_EQ(wrapped_text("a-long-word b", 4), "a-long-word\n  b");
  EXPECT_EQ(wrapped_text("type lamplock send f.llj", 8), "type lamplock send f.llj");
  EXPECT_EQ(wrapped_text("", 4), "");
}

/// The words are the same; a line is too long only if it is one word.
TEST(WrappedText, keeps_the_words_and_the_width) {
  std::mt19937 random(5);
  for (int round = 0; round < lamplock::test::scaled(1000); ++round) {
    std::string text;
    for (int i = 0; i < 30; ++i)
      text += std::string(1 + random() % 12, 'x') + (random() % 9 == 0 ? "\n" : " ");
    const std::size_t columns = 8 + random() % 60;
    const std::string result = wrapped_text(text, columns);
    std::istringstream before(text), after(result);
    for (std::string a, b; before >> a;) {
      ASSERT_TRUE(after >> b);
      ASSERT_EQ(a, b);
    }
    for (const std::string& line : lines(result)) {
      const std::string words = line.substr(std::min(line.find_first_not_of(' '), line.size()));
      ASSERT_TRUE(line.size() <= columns || words.find(' ') == std::string::npos) << line;
    }
  }
}

/// The rows of the screen, not the lines: a word that the terminal breaks is in two of them.
void expect_whole_words(const std::string& bytes, std::size_t columns, const std::string& words) {
  Screen screen(columns, 60, Screen::Resizing::cuts);
  screen.write(bytes);
  for (const std::string& line : screen.lines()) EXPECT_LT(line.size(), columns) << line;
  std::string all;
  for (const std::string& line : screen.lines())
    all += line.substr(std::min(line.find_first_not_of(' '), line.size())) + " ";
  EXPECT_THAT(all, HasSubstr(words));
}

TEST(WrappedText, is_what_terminals_show) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(3000, 4, 0.05)));
  for (const unsigned short columns : std::to_array<unsigned short>({40, 60})) {
    SCOPED_TRACE(columns);
    InTerminal console({"console"});
    console.resize(columns);
    ASSERT_TRUE(console.wait_for("> "));
    console.watch(0ms);
    console.type("help\n");
    ASSERT_TRUE(console.wait_for("leaves."));
    expect_whole_words(console.watch(100ms), columns,
                       "lines; Ctrl-R recalls the last line with the");
    InTerminal jog({"jog", "--pendant", "none"});
    jog.resize(columns);
    ASSERT_TRUE(jog.wait_for("| Idle"));
    jog.watch(0ms);
    jog.type("k");
    ASSERT_TRUE(jog.wait_for("no action"));
    expect_whole_words(jog.watch(300ms), columns,
                       "'k' has no action; keys: arrows PgUp/Dn move, m");
    InTerminal job({"engrave", list, "--pause-every", "1", "--pause-beats", "15000"});
    job.resize(columns);
    ASSERT_TRUE(job.wait_for("keys: "));
    expect_whole_words(job.watch(100ms), columns,
                       "! holds, Enter resumes, Ctrl-C twice stops; + -");
  }
}

}  // namespace
}  // namespace lamplock::cli::test::wrapped
