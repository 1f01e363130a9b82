// The line that is redrawn on a terminal: on random screens, with random notes and changes of the
// width, there is exactly one.
#include "host/cli/live_line.hpp"

#include <gmock/gmock.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <random>

#include "host/cli/jog_screen.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/progress.hpp"
#include "tests/cli/screen.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test::live_line {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

/// A pseudo-terminal whose output arrives on a screen.
class Terminal {
 public:
  Terminal(std::size_t columns, Screen::Resizing resizing) : screen(columns, height, resizing) {
    EXPECT_EQ(::openpty(&master_, &slave_, nullptr, nullptr, nullptr), 0);
    out = ::fdopen(slave_, "w");
    resize(columns);
  }
  ~Terminal() {
    std::fclose(out);
    ::close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// The screen changes before the program reads the new width, or between that and its output.
  void resize(std::size_t columns) {
    const winsize size{height, static_cast<unsigned short>(columns), 0, 0};
    ::ioctl(master_, TIOCSWINSZ, &size);
    screen.resize(columns);
  }
  /// Shows what was written.
  std::string take() {
    std::string bytes;
    pollfd watched{master_, POLLIN, 0};
    std::array<char, 4096> text{};
    while (::poll(&watched, 1, 0) > 0) {
      const ssize_t count = ::read(master_, text.data(), text.size());
      if (count <= 0) break;
      bytes.append(text.data(), static_cast<std::size_t>(count));
    }
    screen.write(bytes);
    return bytes;
  }

  static constexpr unsigned short height = 30;
  std::FILE* out = nullptr;
  Screen screen;

 private:
  int master_ = -1, slave_ = -1;
};

std::size_t shown_copies(const Screen& screen) {
  const auto lines = screen.lines();
  return static_cast<std::size_t>(std::count_if(
      lines.begin(), lines.end(), [](const std::string& line) { return line.starts_with("job"); }));
}

/// Widths at which a line of a hundred characters wraps into one to ten rows.
std::size_t random_width(std::mt19937_64& random) {
  return std::uniform_int_distribution<std::size_t>(12, 130)(random);
}

void random_walk(std::mt19937_64& random, Screen::Resizing resizing) {
  Terminal terminal(random_width(random), resizing);
  LiveLine::Clock::time_point now{};
  int redraws = 0, change = 0;
  const auto text = [&](std::size_t columns) {
    ++redraws;
    return ("job " + std::to_string(change) + std::string(100, '.')).substr(0, columns);
  };
  std::vector<std::string> notes;
  {
    LiveLine line(terminal.out, text, [&now] { return now; });
    now += LiveLine::redraw_interval;
    line.refresh();
    terminal.take();
    for (int step = 0; step < 40; ++step) {
      now += std::chrono::milliseconds(random() % 150);
      ++change;
      const bool races = random() % 4 == 0;
      if (random() % 4 == 0 && !races) terminal.resize(random_width(random));
      if (random() % 4 == 0)
        line.note(notes.emplace_back("n" + std::to_string(step)));
      else
        line.refresh();
      if (races) terminal.resize(random_width(random));
      terminal.take();
      ASSERT_EQ(shown_copies(terminal.screen), 1u) << "step " << step;
      ASSERT_EQ(terminal.screen.cursor_column(), 0u);
    }
    EXPECT_LE(redraws, now.time_since_epoch() / LiveLine::redraw_interval);
    EXPECT_GE(redraws, 5);
  }
  terminal.take();
  // Nothing of the line is left, and every note is there once, in order.
  EXPECT_EQ(terminal.screen.lines(), notes);
  EXPECT_EQ(terminal.screen.unknown(), "");
}

TEST(LiveLines, exactly_one_line_on_any_terminal) {
  std::mt19937_64 random(33);
  for (int i = 0; i < lamplock::test::scaled(60); ++i) {
    random_walk(random, Screen::Resizing::wraps);
    random_walk(random, Screen::Resizing::cuts);
  }
}

TEST(LiveLines, prints_of_others_go_above) {
  Terminal terminal(40, Screen::Resizing::wraps);
  LiveLine::Clock::time_point now{};
  const auto at = [&now] { return now; };
  LiveLine outer(
      terminal.out, [](std::size_t) { return "outer"; }, at);
  const auto pass = [&now](LiveLine& line) {
    now += LiveLine::redraw_interval;
    line.refresh();
  };
  pass(outer);
  LiveLine::print(terminal.out, "printed\n");
  pass(outer);
  terminal.take();
  EXPECT_THAT(terminal.screen.lines(), ElementsAre("printed", "outer"));
  {
    LiveLine inner(
        terminal.out, [](std::size_t) { return "inner"; }, at);
    pass(outer);
    pass(inner);
    terminal.take();
    EXPECT_THAT(terminal.screen.lines(), ElementsAre("printed", "inner"));
    inner.keep();
  }
  pass(outer);
  terminal.take();
  EXPECT_THAT(terminal.screen.lines(), ElementsAre("printed", "inner", "outer"));
}

TEST(ProgressLine, leaves_out_fields_where_columns_are_few) {
  ProgressFields fields{"engraving",       2123,         6773, "held", "speed 150 %",
                        "3 min 12 s left", "ends 15:42", "20"};
  EXPECT_EQ(progress_line(fields, 119),
            "engraving [#########---------------------]  31 %, 2 123 of 6 773, held, speed 150 %, "
            "3 min 12 s left, ends 15:42 > 20");
  EXPECT_EQ(progress_line(fields, 79),
            "engraving  31 %, 2 123 of 6 773, held, speed 150 %, 3 min 12 s left > 20");
  EXPECT_EQ(progress_line(fields, 59), "engraving  31 %, held, speed 150 %, 3 min 12 s left > 20");
  EXPECT_EQ(progress_line(fields, 39), "engraving  31 %, held, speed 150 % > 20");
  EXPECT_EQ(progress_line(fields, 5), "  31 ");
  fields.state = fields.typed = "";
  EXPECT_EQ(progress_line(fields, 49), "engraving  31 %, speed 150 %, 3 min 12 s left");
  EXPECT_EQ(progress_line(fields, 39), "engraving  31 %, 3 min 12 s left");
  std::size_t before = 0;
  for (std::size_t columns = 0; columns < 150; ++columns) {
    const std::size_t length = progress_line(fields, columns).size();
    EXPECT_LE(length, columns);
    EXPECT_GE(length + 25, before) << columns;  // no field is lost where there are more columns
    before = length;
  }
}

TEST(JogLine, leaves_out_fields_where_columns_are_few) {
  pendant::Display display;
  display.work_mm = {-100.5, 0, 12.25};
  display.mode = pendant::Mode::step;
  display.step_mm = 0.1;
  link::BoardStatus status;
  status.state = "Idle";
  status.position = {0, 0, 0};
  EXPECT_EQ(jog_line(display, status, 119),
            "X -100.500  Y 0.000  Z 12.250  | Idle | step 0.1 mm | no axis | feed 100 %");
  EXPECT_EQ(jog_line(display, status, 59), "X -100.500  Y 0.000  Z 12.250  | Idle | step 0.1 mm");
  EXPECT_EQ(jog_line(display, status, 39), "X -100.500  Y 0.000  Z 12.250  | Idle");
  EXPECT_EQ(jog_line(display, status, 31), "X -100.5  Y 0.0  Z 12.2  | Idle");
  EXPECT_EQ(jog_line(display, status, 25), "X -100.50  Y 0.00  | Idle");
  EXPECT_EQ(jog_line(display, status, 19), "X -100.500  | Idle");
  EXPECT_EQ(jog_line(display, status, 15), "X -100.500");
  EXPECT_EQ(jog_line(display, status, 8), "X -100.5");
  EXPECT_EQ(jog_line(display, status, 4), "Idle");
  for (std::size_t columns = 0; columns < 100; ++columns)
    EXPECT_LE(jog_line(display, status, columns).size(), columns);
}

std::vector<std::string> typed(KeyLine& line, const std::string& keys) {
  std::vector<std::string> lines;
  for (const char key : keys) EXPECT_TRUE(line.take(key, lines));
  return lines;
}

TEST(KeyLines, are_edited_as_a_terminal_does) {
  KeyLine line;
  EXPECT_THAT(typed(line, "15"), ElementsAre());
  EXPECT_EQ(line.text(), "15");
  EXPECT_THAT(typed(line,
                    "\x7f"
                    "0\n+\n"),
              ElementsAre("10", "+"));
  EXPECT_THAT(typed(line,
                    "abc\x15"
                    "70\x1b[A\x1bOB\x1b[1;5C\r"),
              ElementsAre("70"));
  EXPECT_THAT(typed(line, "\x7f\x7f\xc3\xa4 \xf0\x9f\x98\x80\n"), ElementsAre("? ?"));
  EXPECT_THAT(typed(line, "7\x04\n"), ElementsAre("7"));
  std::vector<std::string> none;
  EXPECT_FALSE(line.take('\x04', none)) << "Ctrl-D at the begin of a line ends the input";
}

/// Enter alone resumes: the one after `!`, which users type out of habit, must not.
TEST(KeyLines, hold_without_enter) {
  using namespace std::chrono_literals;
  const auto start = KeyLine::Clock::now();
  KeyLine line;
  std::vector<std::string> lines;
  const auto type = [&](const std::string& keys, std::chrono::milliseconds at) {
    lines.clear();
    for (const char key : keys) line.take(key, lines, start + at);
  };
  type("8!", 0ms);
  EXPECT_THAT(lines, ElementsAre("!"));
  EXPECT_EQ(line.text(), "");
  type("\n", 900ms);
  EXPECT_THAT(lines, ElementsAre("!")) << "the use case repeats what resumes";
  type("\n", 950ms);
  EXPECT_THAT(lines, ElementsAre(""));
  type("!", 2000ms);
  type("\n", 3100ms);
  EXPECT_THAT(lines, ElementsAre(""));
  type("!1\n", 4200ms);
  EXPECT_THAT(lines, ElementsAre("!", "1"));
  type("\x1b!\x1b[!~", 4300ms);
  EXPECT_THAT(lines, ElementsAre("!")) << "'!' is an intermediate byte of a sequence";
  type("\x1b[", 4400ms);
  type("!", 4700ms);
  EXPECT_THAT(lines, ElementsAre("!"));
}

}  // namespace
}  // namespace lamplock::cli::test::live_line
