// The words of refusals: groups of commands, numbers, boards that are files, long names, TOML.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::wording {
namespace {

using Arguments = std::vector<std::string>;
using testing::HasSubstr;

std::string refusal(const Arguments& words) {
  const Finished refused = run(words);
  EXPECT_THAT(refused.status, testing::AnyOf(2, 3)) << words.back();
  EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
  return refused.err;
}

TEST(Wording, OfGroupsNamesTheirCommands) {
  EXPECT_THAT(refusal({"settings", "--bord", "x"}), HasSubstr("did you mean '--board'?"));
  EXPECT_THAT(refusal({"operate", "--flashs", "3"}), HasSubstr("did you mean '--flashes'?"));
  EXPECT_THAT(refusal({"settings", "--board", "virtual", "get", "axes"}),
              HasSubstr("write it after a command: lamplock settings get --board"));
  EXPECT_THAT(refusal({"sttings", "list"}), HasSubstr("did you mean 'settings'?"));
  EXPECT_THAT(refusal({"settings", "lst"}), HasSubstr("did you mean 'list'?"));
  for (const Arguments& words : {Arguments{"settings"}, Arguments{"settings", "qqqqqq"}})
    EXPECT_THAT(refusal(words), HasSubstr("give list, get, set, backup, restore"));
  for (const char* const group : {"settings", "operate", "lines"})
    for (const char* const way : {"--help", "-h"})
      EXPECT_THAT(run({group, way}).out, HasSubstr("\nCommands:\n")) << group;
}

TEST(Wording, OfNumbersNamesTheRangeAndThePoint) {
  EXPECT_THAT(refusal({"engrave", "a.stl", "--spacing", "0,1"}),
              HasSubstr("'0,1' is not a number; write a decimal point: --spacing 0.1; give "));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--pause-every", "99999999999999999999999"}),
              HasSubstr("99999999999999999999999 is out of range; give "));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--from", "99999999999999999999999"}),
              HasSubstr("is out of range; give 0 to 18446744073709551615"));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--size", "1e999"}), HasSubstr("1e999 is out of range"));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--from", "1.5"}),
              HasSubstr("'1.5' is not a whole number"));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--size", "1.2.3"}), HasSubstr("is not a number"));
  EXPECT_THAT(refusal({"engrave", "a.stl", "--spacing", "0.3 mm"}),
              HasSubstr("'0.3 mm' is not a number; leave the unit out: --spacing 0.3; give "));
}

TEST(Wording, OfBoardsAndAddresses) {
  const Folder folder;
  const std::string file = folder.write("ball.stl", octahedron_stl());
  for (const Arguments& words :
       {Arguments{"settings", "list", "--board", file}, Arguments{"engrave", file, "--board", file},
        Arguments{"console", "--board", file}})
    EXPECT_THAT(refusal(words), HasSubstr("'" + file + "' is a file, not the port of a board"));
  EXPECT_THAT(refusal({"jog", "--board", folder.path()}), HasSubstr("is a folder, not the port"));
  EXPECT_THAT(refusal({"sim", "--tcp", "80"}), HasSubstr("--tcp 80: is not HOST:PORT; give "));
  EXPECT_THAT(refusal({"sim", "--tcp", "localhost:99999"}),
              HasSubstr("from 0 (any free one) to 65535"));
  EXPECT_THAT(refusal({"sim", "--tcp", "192.0.2.1:4000"}),
              HasSubstr("give an address of this computer"));
}

TEST(Wording, ShortensLongNames) {
  const std::string name(3000, 'x');
  for (const Arguments& words :
       {Arguments{name}, Arguments{"engrave", "--" + name}, Arguments{"engrave", name + ".stl"},
        Arguments{"engrave", "a.stl", "--size", name}, Arguments{"settings", "get", name},
        Arguments{"engrave", "a.stl", "--board", name}})
    EXPECT_LT(refusal(words).size(), 1500u) << words[0].substr(0, 9);
  // A multibyte character is not cut.
  std::string letters;
  for (int i = 0; i < 999; ++i) letters += "\xc3\xb6";
  EXPECT_THAT(refusal({"x" + letters}), testing::Not(HasSubstr("\\x")));
}

TEST(Wording, OfTomlIsPlain) {
  const Folder folder;
  const std::vector<std::pair<std::string, std::string>> texts{
      {"size = \n", "a value is missing"},
      {"size = 0,1\n", "a ',' follows the value"},
      {"size 5\n", "there is no '=' after the name"},
      {"a = \"abc\n", "a text has no quote at its end"},
      {"[glass\n", "the ']' of a section is missing"},
      {"a = 1\na = 2\n", "'a' is given twice"},
      {"[a]\n[a]\n", "'a' is given twice"},
      {"a = abc.stl\n", "the value is neither a number nor a text in quotes"},
      {"a = [1, 2\n", "the file ends in the middle of a value"},
      {"a = 99999999999999999999\n", "a number is too large"},
      {"a = \"\xff\"\n", ""},
      {"a = {b = 1\n", "a '}' is missing"},
      {"a = 01\n", "a number begins with 0"}};
  for (const auto& [text, plain] : texts) {
    const std::string file = folder.write("j.toml", text);
    for (const Arguments& words :
         {Arguments{"engrave", file}, Arguments{"lines", "--lines", file}}) {
      const std::string message = refusal(words);
      EXPECT_THAT(message, HasSubstr(plain)) << text;
      EXPECT_THAT(message, testing::Not(HasSubstr("parsing"))) << text;
    }
  }
}

}  // namespace
}  // namespace lamplock::cli::test::wording
