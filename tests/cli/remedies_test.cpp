// Wrong inputs give one line each, and the remedy in that line works when it is followed.
//
// A message is followed as a user would: a suggested name replaces the wrong word, a number of the
// range or the greatest width replaces the wrong one, a command in the remedy is run.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test {
namespace {

using lamplock::test::scaled;
using CommandWords = std::vector<std::string>;

/// A command line and the word in it that is wrong, or the one to be misspelt.
struct Row {
  CommandWords words;
  std::size_t wrong = 0;
};

/// Valid commands; "@NAME" is a file of the folder.
const std::vector<CommandWords> valid{
    {"points", "@ball.stl", "-o", "@out.xyz", "--spacing", "0.4", "--method", "blue-noise"},
    {"points", "@ball.stl", "-o", "@out.ply", "--spacing", "0.5", "--material", "bk7", "--size",
     "2"},
    {"points", "@disc.bmp", "-o", "@out.xyz", "--threshold", "200", "--layers", "2"},
    {"engrave", "@ball.stl", "--spacing", "0.5", "--dry", "--board", "virtual"},
    {"estimate", "@ball.stl", "--spacing", "0.5", "--lamp-mode", "slave", "--job-speed", "90"},
    {"settings", "get", "lamp_frequency", "travel_x"},
    {"settings", "list", "--board", "virtual"},
    {"check", "@part.ngc", "--machine", "@machine.toml"},
    {"operate", "status", "--board", "virtual"},
    {"help", "engrave"}};

/// Numbers out of range.
const std::vector<Row> out_of_range{
    {{"engrave", "@ball.stl", "--spacing", "0.5", "--dry", "--flashes", "256"}, 6},
    {{"points", "@disc.bmp", "-o", "@out.xyz", "--tone", "--tone-lowest", "7"}, 6},
    {{"points", "@ball.stl", "-o", "@out.xyz", "--spacing", "0.5", "--size", "0"}, 7},
    {{"points", "@disc.bmp", "-o", "@out.xyz", "--layers", "0"}, 5},
    {{"points", "@ball.stl", "-o", "@out.xyz", "--spacing", "0.5", "--shells", "0"}, 7},
    {{"check", "@part.ngc", "--max-problems", "0"}, 3},
    {{"settings", "list", "--baud", "0"}, 3}};

/// Inputs whose remedy is a command.
const std::vector<Row> with_command{{{"engrave", "@ball.stl", "--colour"}},
                                    {{"engrave", "-x"}},
                                    {{"engrave"}},
                                    {{"engrave", "@ball.stl", "@ball.stl"}},
                                    {{"engrave", "@ball.stl", "--spacing"}},
                                    {{"engrave", "@ball.stl", "--spacing", "wide"}},
                                    {{"raster", "@disc.bmp"}},
                                    {{"settings"}},
                                    {{"qqqqqq"}},
                                    {{"operate", "qqqqqq"}},
                                    {{"help", "qqqqqq"}},
                                    {{"compare", "@ball.stl"}},
                                    {{"engrave", "@ball.stl", "--gcode"}},
                                    {{"points", "@ball.stl"}},
                                    {{"send", "@cloud.xyz"}},
                                    {{"send", "@ball.stl"}},
                                    {{"settings", "get", "qqqqqq"}}};

class Remedies : public testing::Test {
 protected:
  Remedies() {
    folder_.write("ball.stl", octahedron_stl());
    folder_.write("disc.bmp", disc_bmp(8));
    folder_.write("cloud.xyz", xyz(walk(9, 1)));
    folder_.write("part.ngc", "G1 X1 F600\nM2\n");
    folder_.write("machine.toml", "laser_mode = 1\n");
  }
  CommandWords filled(CommandWords words) const {
    for (std::string& word : words)
      if (word.starts_with('@')) word = folder_ / word.substr(1);
    return words;
  }
  /// Deletes, adds or swaps a letter of the last part of a word.
  std::string slip(std::string word) {
    const std::size_t begin =
        std::max(word.rfind('/') + 1, word.starts_with("--") ? std::size_t{2} : 0);
    const std::size_t at = begin + random_() % (word.size() - begin);
    const std::string before = word;
    switch (random_() % 3) {
      case 0:
        word.erase(at, 1);
        break;
      case 1:
        word.insert(at, 1, static_cast<char>('a' + random_() % 26));
        break;
      default:
        if (at + 1 < word.size()) std::swap(word[at], word[at + 1]);
    }
    return word == before ? word + "q" : word;
  }
  const Folder folder_;
  std::mt19937_64 random_{33};
};

std::string shown_words(const CommandWords& words) {
  std::string text;
  for (const std::string& word : words) text += word + " ";
  return text;
}

/// The message of a run that must fail.
std::string refusal_of(const CommandWords& words) {
  const Finished refused = run(words);
  EXPECT_GT(refused.status, 0) << shown_words(words);
  EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"))
      << shown_words(words);
  return refused.err;
}

/// The names in "did you mean 'A' or 'B'?".
CommandWords suggestions_in(const std::string& message) {
  CommandWords names;
  const std::string question =
      message.substr(std::min(message.find("did you mean"), message.size()));
  const std::regex quoted("'([^']*)'");
  for (std::sregex_iterator name(question.begin(), question.end(), quoted), end; name != end;
       ++name)
    names.push_back((*name)[1]);
  return names;
}

bool any_works(CommandWords words, std::size_t wrong, const CommandWords& replacements) {
  return std::any_of(replacements.begin(), replacements.end(), [&](const std::string& right) {
    words[wrong] = right;
    return run(words).status == 0;
  });
}

/// CommandWords that can be misspelt: no numbers, no outputs.
bool can_be_misspelt(const std::string& word) {
  return word.size() > 2 && !word.starts_with("@out") && word.find_first_of("0123456789") != 0;
}

TEST_F(Remedies, TheSuggestedNameWorks) {
  int tried = 0, works = 0;
  for (int i = 0; i < scaled(40, 20); ++i) {
    const CommandWords& row = valid[static_cast<std::size_t>(i) % valid.size()];
    CommandWords words = filled(row);
    std::size_t wrong = 0;
    do wrong = random_() % row.size();
    while (!can_be_misspelt(row[wrong]));
    words[wrong] = slip(words[wrong]);
    const Finished first = run(words);
    if (first.status == 0) continue;  // the slip is another valid word
    ++tried;
    EXPECT_THAT(first.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    if (any_works(words, wrong, suggestions_in(first.err)))
      ++works;
    else
      std::printf("not followed: %s: %s", shown_words(words).c_str(), first.err.c_str());
  }
  EXPECT_GT(tried, 10);
  EXPECT_GE(works, 0.95 * tried);
}

TEST_F(Remedies, ANumberOfTheRangeWorks) {
  for (const Row& row : out_of_range) {
    const CommandWords words = filled(row.words);
    const std::string message = refusal_of(words);
    std::smatch found;
    ASSERT_TRUE(std::regex_search(
        message, found, std::regex("out of range; give (at least |more than )?([-0-9.e]+)")))
        << message;
    const bool excluded = found[1] == "more than ";
    EXPECT_TRUE(any_works(words, row.wrong,
                          {excluded ? std::to_string(std::stod(found[2]) + 1) : found[2].str()}))
        << message;
  }
}

TEST_F(Remedies, TheCommandOfTheRemedyWorks) {
  for (const Row& row : with_command) {
    const std::string message = refusal_of(filled(row.words));
    std::smatch found;
    ASSERT_TRUE(std::regex_search(
        message, found,
        std::regex(
            "(see lamplock|lamplock)((?: [^ ;\n]+)* --help| job [^ ]+ -o [^ \n]+| settings list)")))
        << message;
    CommandWords words;
    std::istringstream text(found[2]);
    for (std::string word; text >> word;) words.push_back(word);
    const Finished followed = run(words);
    EXPECT_EQ(followed.status, 0) << message << followed.err;
  }
}

TEST_F(Remedies, TheGreatestWidthFits) {
  for (const CommandWords& more :
       {CommandWords{}, CommandWords{"--pitch-mm", "0.5"}, CommandWords{"--origin", "20,5"},
        CommandWords{"--overscan-mm", "3"}}) {
    CommandWords words = filled({"raster", "@disc.bmp", "--feed", "900", "-o", "@rows.llj",
                                 "--machine", "@machine.toml", "--width-mm", "500"});
    words.insert(words.end(), more.begin(), more.end());
    const std::string message = refusal_of(words);
    std::smatch found;
    ASSERT_TRUE(std::regex_search(message, found, std::regex("--width-mm ([0-9.]+)"))) << message;
    EXPECT_TRUE(any_works(words, 9, {found[1]})) << message;
    // It is the greatest one, in steps of 0.1 mm; pixels of 0.5 mm round the width.
    const double more_mm = more.size() == 2 && more[0] == "--pitch-mm" ? 0.5 : 0.1;
    EXPECT_FALSE(any_works(words, 9, {std::to_string(std::stod(found[1]) + more_mm)})) << message;
  }
}

TEST_F(Remedies, AMissingPortIsReportedBeforeItsPermission) {
  const Finished missing =
      run(filled({"engrave", "@ball.stl", "--spacing", "0.5", "--board", "@none"}));
  EXPECT_EQ(missing.status, 3);
  EXPECT_THAT(missing.err, testing::HasSubstr("there is no such port"));
}

TEST_F(Remedies, ArgumentsAreNamedInTheirOrder) {
  EXPECT_THAT(refusal_of({"engrave", "a.stl", "b.stl", "c.stl"}),
              testing::HasSubstr("unexpected arguments 'b.stl' 'c.stl'"));
  EXPECT_THAT(refusal_of({"engrave", "-x", "a.stl"}),
              testing::StartsWith("error: lamplock engrave: unknown option '-x'; "));
  EXPECT_THAT(refusal_of({"engrave", "-size", "3", "a.stl"}),
              testing::HasSubstr("did you mean '--size'?"));
  EXPECT_THAT(refusal_of({"engrave", "a.stl", "--size", "3", "--size", "4"}),
              testing::HasSubstr("--size: is given twice"));
}

}  // namespace
}  // namespace lamplock::cli::test
