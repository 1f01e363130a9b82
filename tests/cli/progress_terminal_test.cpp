// The progress of a real job in terminals of several widths, resized in between: one line at any
// time, and keys that do not stick to it.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/screen.hpp"

namespace lamplock::cli::test::progress_terminal {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr std::chrono::milliseconds redraw_interval{200};

bool is_progress(const std::string& line) {
  return line.starts_with("engraving") && line.find('%') != std::string::npos;
}

std::size_t progress_lines(const Screen& screen) {
  const auto lines = screen.lines();
  return static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), is_progress));
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class JobInTerminal {
 public:
  JobInTerminal() : engrave({"engrave", list(), "--pause-every", "1", "--pause-beats", "15000"}) {}

  std::string list() { return folder.write("p.xyz", xyz(walk(3000, 4, 0.05))); }
  /// Shows what comes in this time.
  void watch(std::chrono::milliseconds time) {
    const std::string bytes = engrave.watch(time);
    redraws += count_of(bytes, "engraving ");
    screen.write(bytes);
  }
  void resize(std::size_t columns) {
    watch(0ms);
    engrave.resize(static_cast<unsigned short>(columns));
    screen.resize(columns);
  }

  Folder folder;
  Screen screen{80, 30, Screen::Resizing::wraps};
  InTerminal engrave;
  std::size_t redraws = 0;
};

TEST(ProgressInTerminal, is_one_line_at_any_width) {
  JobInTerminal job;
  ASSERT_TRUE(job.engrave.wait_for("engraving "));
  const auto start = std::chrono::steady_clock::now();
  for (const std::size_t columns : {120u, 40u, 80u, 60u}) {
    job.resize(columns);
    job.engrave.type("+\n7");  // an echo of Enter would leave a copy of the line
    job.watch(redraw_interval + 100ms);
    EXPECT_EQ(progress_lines(job.screen), 1u) << columns;
    const auto lines = job.screen.lines();
    EXPECT_TRUE(is_progress(lines.back())) << lines.back();
    EXPECT_LT(lines.back().size(), columns);
    EXPECT_THAT(lines.back(), HasSubstr(" > 7"));
    job.engrave.type("\x7f");
  }
  const auto taken = std::chrono::steady_clock::now() - start;
  EXPECT_LE(job.redraws, static_cast<std::size_t>(taken / redraw_interval) + 2);
  job.engrave.type("\x03");
  job.watch(redraw_interval + 200ms);
  EXPECT_THAT(job.screen.lines().back(), HasSubstr("held"));
  EXPECT_EQ(progress_lines(job.screen), 1u);
  job.engrave.type("\x03");
  job.watch(500ms);
  EXPECT_EQ(progress_lines(job.screen), 0u) << "the line is removed at the end";
  EXPECT_EQ(job.screen.unknown(), "");
  EXPECT_EQ(job.engrave.finish().status, 130);
}

}  // namespace
}  // namespace lamplock::cli::test::progress_terminal
