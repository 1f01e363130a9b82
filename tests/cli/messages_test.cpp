// For any file or value, the program's error message is one printable line with a remedy, and the
// program ends by itself.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "host/printable.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test {
namespace {

using lamplock::test::scaled;
using Arguments = std::vector<std::string>;

/// A command that reads a file "@" of these kinds and writes a file "=".
struct Reader {
  Arguments words;
  std::vector<std::string> extensions;
};

const std::vector<std::string> models{"stl", "obj", "ply", "glb", "3mf", "svg",
                                      "dxf", "xyz", "bmp", "png", "toml"};

std::vector<Reader> readers() {
  return {{{"engrave", "@"}, models},
          {{"points", "@", "-o", "="}, models},
          {{"estimate", "@"}, models},
          {{"job", "@", "-o", "="}, models},
          {{"frame", "@"}, models},
          {{"order", "@", "-o", "="}, {"xyz", "ply", "dxf"}},
          {{"raster", "@", "--feed", "1000", "--gcode", "="}, {"bmp", "png", "jpg"}},
          {{"send", "@"}, {"llj", "ngc"}},
          {{"check", "@"}, {"ngc"}},
          {{"diagnose", "@"}, {"ngc"}},
          {{"compare", "@", "@"}, {"html"}},
          {{"flash", "@"}, {"uf2", "elf"}},
          {{"chip", "@", "--until", "1ms"}, {"uf2", "elf"}},
          {{"engrave", "ball.stl", "--machine", "@"}, {"toml"}},
          {{"raster", "disc.bmp", "--feed", "900", "-o", "=", "--machine", "@"}, {"toml"}},
          {{"settings", "restore", "@"}, {"toml", "txt"}},
          {{"lines", "show", "--lines", "@"}, {"toml"}},
          {{"jog", "--machine", "@"}, {"toml"}}};
}

/// Random bytes that are not a file of any kind; every reader must refuse them.
std::string random_bytes(std::mt19937_64& random) {
  std::string bytes(60 + random() % 300, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes + "\n\xff\x01\n";  // not a text, even if the rest is one
}
std::string utf_16(std::string_view text) {
  std::string bytes = "\xff\xfe";
  for (const char c : text) (bytes += c) += '\0';
  return bytes;
}
std::string broken_text(std::mt19937_64& random) {
  static constexpr std::array<std::string_view, 5> texts{
      "G1 X1 F", "0 0 0\n1 1 ", "[machine]\nbeam = ", "solid x\nfacet normal ", "<svg width="};
  static constexpr std::array<std::string_view, 5> trouble{"\x1b[2J\x1b[31mred", "\x07\x9b\x31m",
                                                           "\xe2\x80\xae gnp", "\r\x1b]0;title\x07",
                                                           "\x7f\xff\xc0"};
  const std::string text(texts[random() % texts.size()]);
  switch (random() % 4) {
    case 0:
      return utf_16(text + "1 nonsense\n");
    case 1:
      return text + std::string(1, '\0') + "nul\n";
    default:
      return text + std::string(trouble[random() % trouble.size()]) + "\n";
  }
}
/// The beginning of a valid file, of kinds that are invalid without their end.
std::string truncated(std::mt19937_64& random, const std::string& extension) {
  const std::string whole = extension == "bmp"   ? disc_bmp(20)
                            : extension == "stl" ? octahedron_stl()
                            : extension == "png" ? "\x89PNG\r\n\x1a\n" + std::string(40, '\1')
                            : extension == "llj" ? "LLJ1" + std::string(90, '\2')
                                                 : std::string();
  if (whole.empty()) return random_bytes(random);
  return whole.substr(0, random() % (whole.size() / 2 + 1));
}
std::string content(std::mt19937_64& random, const std::string& extension) {
  switch (random() % 3) {
    case 0:
      return random_bytes(random);
    case 1:
      return truncated(random, extension);
    default:
      return broken_text(random);
  }
}

/// A value that a shell can pass, that is, without NUL.
std::string wrong_value(std::mt19937_64& random) {
  static constexpr std::array<std::string_view, 9> values{
      "nan",  "-1e308",      "", "\x1b[31m7", "12mm", "\xff\xfe", "99999999999999999999",
      "a\nb", "\xe2\x80\xae"};
  return std::string(values[random() % values.size()]);
}

std::string shown(const Arguments& words) {
  std::string text;
  for (const std::string& word : words) text += " " + printable(word);
  return text;
}

/// All lines must be printable.
void expect_printable(const std::string& text) {
  for (const std::string& line : lines(text)) {
    std::string tabs = line;
    std::replace(tabs.begin(), tabs.end(), '\t', ' ');
    EXPECT_EQ(printable(tabs), tabs);
  }
}

void expect_refusal(const Arguments& words) {
  SCOPED_TRACE(shown(words));
  const Finished refused = run(words);
  EXPECT_GT(refused.status, 0);
  EXPECT_LT(refused.status, 128) << "ended by a signal";
  EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
  expect_printable(refused.err);
  expect_printable(refused.out);
}

/// A folder with two valid inputs.
class Messages : public testing::Test {
 protected:
  Messages() {
    folder_.write("ball.stl", octahedron_stl());
    folder_.write("disc.bmp", disc_bmp(8));
  }
  Arguments filled(const Arguments& words, const std::string& file) const {
    Arguments result;
    for (const std::string& word : words)
      result.push_back(word == "@"                                        ? file
                       : word == "="                                      ? folder_ / "out.xyz"
                       : word.ends_with(".stl") || word.ends_with(".bmp") ? folder_ / word
                                                                          : word);
    return result;
  }
  const Folder folder_;
  std::mt19937_64 random_{30};
};

TEST_F(Messages, OfBrokenFilesAreOnePrintableLineWithARemedy) {
  const std::vector<Reader> all = readers();
  for (int i = 0; i < scaled(240, static_cast<int>(all.size())); ++i) {
    const Reader& reader = all[static_cast<std::size_t>(i) % all.size()];
    const std::string& extension = reader.extensions[random_() % reader.extensions.size()];
    // File names are foreign text too.
    const std::string name = random_() % 4 == 0 ? "a\x1b[7mb." : "input.";
    const std::string file = folder_.write(name + extension, content(random_, extension));
    expect_refusal(filled(reader.words, file));
  }
}

TEST_F(Messages, OfWrongValuesAreOnePrintableLineWithARemedy) {
  const std::vector<Arguments> commands{
      {"engrave", "ball.stl", "--size"},
      {"engrave", "ball.stl", "--spacing"},
      {"engrave", "ball.stl", "--board"},
      {"points", "ball.stl", "-o", "=", "--seed"},
      {"engrave", "ball.stl", "--order"},
      {"engrave", "ball.stl", "--job-speed"},
      {"raster", "disc.bmp", "-o", "=", "--feed"},
      {"raster", "disc.bmp", "--feed", "900", "-o", "=", "--origin"},
      {"settings", "get"},
      {"settings", "set", "--board", "virtual"},
      {"send", "ball.stl", "--board"},
      {"frame", "ball.stl", "--origin"},
      {"sim", "--board"},
      {"jog", "--board"},
      {"chip"},
      {"bench"},
      {"job"},
      {}};
  for (int i = 0; i < scaled(160, static_cast<int>(commands.size())); ++i) {
    Arguments words = filled(commands[static_cast<std::size_t>(i) % commands.size()], "");
    words.push_back(wrong_value(random_));
    expect_refusal(words);
  }
}

/// Runs the program in a shell; `{}` in the line is its name. Returns its status.
int status_in_shell(const std::string& line, const std::string& arguments) {
  const std::string command = program_path() + (" " + arguments);
  const std::size_t at = line.find("{}");
  const int status = std::system(
      (line.substr(0, at) + command + line.substr(at + 2)).c_str());  // NOLINT(cert-env33-c)
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

TEST_F(Messages, OutputThatCannotBeWrittenIsAnError) {
  const std::string ball = folder_ / "ball.stl", err = folder_ / "err";
  EXPECT_EQ(status_in_shell("{} >/dev/full 2>" + err, "settings list --board virtual"), 1);
  EXPECT_THAT(read(err), testing::MatchesRegex("error: standard output: [^\n]+; [^\n]+\n"));
  EXPECT_EQ(status_in_shell("{} >/dev/full 2>" + err, "--help"), 1);
  // A reader that has closed the pipe, also for messages.
  const std::string status = folder_ / "status";
  status_in_shell("{ {}; echo $? >" + status + "; } 2>&1 | true",
                  "engrave " + ball + " --spacing 0.4 --dry");
  EXPECT_THAT(read(status), testing::AnyOf("0\n", "1\n"));
}

TEST(Printable, KeepsTextAndShowsTheRest) {
  EXPECT_EQ(printable("Größe 3 µm, 玻璃"), "Größe 3 µm, 玻璃");
  EXPECT_EQ(printable("a\nb\tc"), "a b c");
  EXPECT_EQ(printable("\x1b[31m"), "\\x1b[31m");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xff\xfe"
                      "G"),
            "\\xff\\xfeG");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\u{009b}31m");
  EXPECT_EQ(printable("\xe2\x80\xae"), "\\u{202e}");
  // An overlong form, a surrogate, a truncated sequence.
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xe2\x80"), "\\xe2\\x80");
}

}  // namespace
}  // namespace lamplock::cli::test
