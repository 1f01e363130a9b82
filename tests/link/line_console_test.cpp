// Conversations with a model of grbl, typed interactively and from a script.
#include "host/link/line_console.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <span>
#include <string>

#include "host/error.hpp"
#include "tests/error_of.hpp"
#include "tests/link/grbl_model.hpp"

namespace lamplock::link {
namespace {

using namespace std::chrono_literals;
using test::error_of;
using test::GrblModel;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A console and the text that it has shown.
struct Talk {
  Talk(GrblModel& board_in, bool in_order)
      : board(board_in),
        port(board),
        console(port, in_order, [this](const std::string& line) { shown.push_back(line); }) {}
  void until_done() {
    while (!console.done() && !console.failure()) console.step();
  }
  void run_for(std::chrono::microseconds time) {
    const auto until = board.now() + time;
    while (board.now() < until) console.step();
  }

  GrblModel& board;
  LinePort port;
  std::vector<std::string> shown;
  LineConsole console;
};

TEST(LineConsole, lines_are_answered_one_by_one) {
  GrblModel board;
  board.settings = {{100, "200.000"}};
  Talk talk(board, true);
  for (const char* line : {"$$", "G1 X1\r", "G4 P30", "?"}) talk.console.type(line);
  talk.until_done();
  EXPECT_THAT(talk.shown, ElementsAre("$100=200.000", "ok", "ok", "ok", StartsWith("<Idle|")));
  EXPECT_THAT(board.lines, ElementsAre("G1 X1", "G4 P30"));
  EXPECT_GT(board.polls, 20) << "the console must poll the board";
  EXPECT_FALSE(talk.console.failure());
}

TEST(LineConsole, the_end_of_the_input_ends_it_when_the_machine_is_at_rest) {
  GrblModel board;
  Talk talk(board, true);
  talk.console.type("G1 X1");
  talk.console.end_input();
  talk.until_done();
  EXPECT_FALSE(talk.console.at_rest()) << "an ok does not mean that the machine is at rest";
  talk.run_for(500ms);
  EXPECT_TRUE(talk.console.at_rest());
  EXPECT_THAT(talk.shown, ElementsAre("ok"));
}

TEST(LineConsole, realtime_bytes_are_not_sent_within_a_line) {
  GrblModel board;
  Talk talk(board, true);
  talk.console.type("G1 X1 (stop! \xC3\x84)");
  talk.console.type("$100=2(b)");
  for (const char* line : {"G1 X2 !", "$100=\xC3\x84", "G1 X3 ~ (on)"})
    EXPECT_THAT(error_of([&] { talk.console.type(line); }), HasSubstr("is a real-time command"));
  talk.until_done();
  EXPECT_THAT(board.bytes_seen, testing::IsEmpty());
  EXPECT_THAT(board.lines, ElementsAre("G1 X1", "$100=2(b)"));
}

/// The answer to a pause arrives after the word that ends it.
TEST(LineConsole, in_order_a_word_ends_a_pause) {
  GrblModel board;
  Talk talk(board, true);
  for (const char* line : {"G1 X1", "M0", "?", "~", "G1 X2"}) talk.console.type(line);
  const auto limit = board.now() + 20s;
  while (!talk.console.done() && !talk.console.failure() && board.now() < limit)
    talk.console.step();
  EXPECT_TRUE(talk.console.done());
  EXPECT_FALSE(talk.console.failure());
  EXPECT_THAT(talk.shown, ElementsAre("ok", StartsWith("<Hold:0|"), "ok", "ok"));
  EXPECT_THAT(board.lines, ElementsAre("G1 X1", "M0", "G1 X2"));
}

/// A fault or a door holds the machine before the end of a script: the script has failed, but not
/// if it asked for the hold, or has only read settings of a machine that was held before.
TEST(LineConsole, in_order_a_hold_at_the_end_is_a_failure) {
  const auto failed = [](const std::vector<const char*>& lines, bool holds) {
    GrblModel board;
    Talk talk(board, true);
    for (const char* line : lines) talk.console.type(line);
    talk.console.end_input();
    const auto limit = board.now() + 20s;
    while (!talk.console.done() && board.now() < limit) talk.console.step();
    if (holds) board.state = "Hold:0";
    while (!talk.console.at_rest() && board.now() < limit) talk.console.step();
    EXPECT_TRUE(talk.console.at_rest());
    return talk.console.failure().has_value();
  };
  EXPECT_FALSE(failed({"G1 X1"}, false));
  EXPECT_TRUE(failed({"G1 X1"}, true));
  EXPECT_TRUE(failed({"$$", "M0", "~", "G1 X1"}, true));
  EXPECT_FALSE(failed({"$$"}, true));
  EXPECT_FALSE(failed({"G1 X1", "!"}, true));
  EXPECT_FALSE(failed({"G1 X1", "$$", "!", "?"}, true));
}

/// Without a pause every line waits for its turn.
TEST(LineConsole, in_order_a_hold_waits_for_the_answer) {
  GrblModel board;
  Talk talk(board, true);
  for (const char* line : {"G4 P3", "!", "~"}) talk.console.type(line);
  talk.run_for(2s);
  EXPECT_THAT(board.bytes_seen, testing::IsEmpty());
  talk.until_done();
  talk.run_for(100ms);
  EXPECT_THAT(board.bytes_seen, ElementsAre('!', '~'));
}

TEST(LineConsole, in_order_nothing_follows_an_error) {
  GrblModel board;
  board.refused["bad"] = 1;
  Talk talk(board, true);
  for (const char* line : {"G1 X1", "bad", "G1 X2"}) talk.console.type(line);
  talk.until_done();
  talk.run_for(1s);
  ASSERT_TRUE(talk.console.failure());
  EXPECT_EQ(talk.console.failure()->line, 2u);
  EXPECT_THAT(talk.console.failure()->text, HasSubstr("error:1 a word must begin"));
  EXPECT_THAT(board.lines, ElementsAre("G1 X1", "bad"));
}

TEST(LineConsole, an_alarm_is_a_failure) {
  GrblModel board;
  board.alarm_line = "G1 X9";
  Talk talk(board, true);
  talk.console.type("G1 X9");
  talk.until_done();
  ASSERT_TRUE(talk.console.failure());
  EXPECT_THAT(talk.console.failure()->text, StartsWith("ALARM:1 "));
}

TEST(LineConsole, by_hand_it_continues_after_errors_and_a_hold_is_sent_at_once) {
  GrblModel board;
  board.max_move = 5s;
  board.planner_blocks = 1;
  board.refused["bad"] = 1;
  Talk talk(board, false);
  for (const char* line : {"bad", "G1 X1", "G1 X2", "G1 X3"}) talk.console.type(line);
  talk.run_for(500ms);
  EXPECT_EQ(board.state, "Run");
  talk.console.type(" :hold ");
  talk.run_for(500ms);
  EXPECT_EQ(board.state, "Hold:0");
  talk.console.type("~");
  talk.console.type(":feed  +10");
  talk.run_for(30s);
  EXPECT_TRUE(talk.console.done());
  EXPECT_THAT(board.bytes_seen, ElementsAre('!', '~', 0x91));
  EXPECT_EQ(board.lines.size(), 4u);
}

/// A board that records what the host has written.
struct RecordingBoard : GrblModel {
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t count = GrblModel::write(bytes);
    written.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  std::string written{};
};

TEST(LineConsole, by_hand_a_hold_overtakes_the_lines_before_it) {
  RecordingBoard board;
  Talk talk(board, false);
  for (int i = 0; i < 1000; ++i) talk.console.type("G1 X40");
  talk.console.type(":hold");
  EXPECT_EQ(talk.console.queued(), 1000u);
  talk.run_for(500ms);
  EXPECT_EQ(board.written, "!") << "a board at rest may ignore the hold";
  EXPECT_THAT(talk.shown, ElementsAre(HasSubstr(": 1000; :reset discards them")));
  talk.console.type("~");
  talk.console.step();
  EXPECT_EQ(board.written, "!~G1 X40\n");
  EXPECT_EQ(talk.console.queued(), 999u);
}

/// Whatever is typed before or after it; only comments may have the character.
TEST(LineConsole, by_hand_a_line_with_a_hold_holds_and_is_not_sent) {
  for (const char* line : {"G0 X!", "G0 X5 !", "G0 ! X5", "G0 X :hold", "G0 (a) X!", "G0 (slow!",
                           "$J=G91 X5 F100 !", "G0 X1 (b) ! ; c"}) {
    SCOPED_TRACE(line);
    RecordingBoard board;
    Talk talk(board, false);
    talk.console.type(line);
    talk.run_for(100ms);
    EXPECT_EQ(board.written, "!");
    ASSERT_EQ(talk.shown.size(), 1u);
    EXPECT_THAT(talk.shown[0], testing::AllOf(StartsWith("hold; '"), HasSubstr("was not sent")));
  }
  for (const char* line : {"G0 X5 (wow!)", "G0 X5 ; done!", "G0 X5 ; then :hold"}) {
    SCOPED_TRACE(line);
    RecordingBoard board;
    Talk talk(board, false);
    talk.console.type(line);
    talk.run_for(100ms);
    EXPECT_EQ(board.written, "G0 X5\n");
  }
}

TEST(LineConsole, suggests_the_word_without_its_colon) {
  GrblModel board;
  Talk talk(board, false);
  const auto error = [&](const char* line) { return error_of([&] { talk.console.type(line); }); };
  EXPECT_THAT(error("hold"), HasSubstr("did you mean ':hold'?"));
  EXPECT_THAT(error("Rseet"), HasSubstr("did you mean ':reset'?"));
  EXPECT_THAT(error("feed +10"), HasSubstr("did you mean ':feed +10'?"));
  EXPECT_THAT(error("hlep"), HasSubstr("did you mean 'help'?"));
  EXPECT_THAT(error("G1 ~ X1"), testing::Not(HasSubstr("G-code program")));
  EXPECT_EQ(talk.console.queued(), 0u);
}

TEST(LineConsole, by_hand_a_jog_cancel_discards_the_jogs_before_it) {
  RecordingBoard board;
  Talk talk(board, false);
  for (const char* line : {"$J=G91 X1 F100", "G1 X1", "$J=G91 X2 F100", ":jogcancel"})
    talk.console.type(line);
  talk.until_done();
  EXPECT_EQ(board.written, "\x85G1 X1\n");
}

TEST(LineConsole, by_hand_a_hold_overtakes_the_lines_that_wait) {
  RecordingBoard board;
  board.max_move = 5s;
  Talk talk(board, false);
  for (int i = 0; i < 1000; ++i) talk.console.type("G1 X40");
  talk.run_for(500ms);
  ASSERT_EQ(board.state, "Run");
  const std::size_t before = board.written.size();
  talk.console.type("!");
  talk.console.step();
  EXPECT_EQ(board.written[before], '!');
  talk.run_for(100ms);
  EXPECT_EQ(board.state, "Hold:0");
  EXPECT_GT(talk.console.queued(), 900u);
}

TEST(LineConsole, by_hand_a_reset_discards_the_lines_before_it) {
  GrblModel board;
  board.max_move = 5s;
  Talk talk(board, false);
  for (int i = 0; i < 1000; ++i) talk.console.type("G1 X40");
  talk.run_for(500ms);
  talk.console.type(":reset");
  EXPECT_EQ(talk.console.queued(), 0u);
  talk.console.type("G1 X7");
  talk.until_done();
  EXPECT_EQ(board.resets, 1);
  EXPECT_EQ(board.lines.back(), "G1 X7");
  EXPECT_LT(board.lines.size(), 100u);
}

TEST(LineConsole, a_reset_answers_all_waiting_lines) {
  GrblModel board;
  Talk talk(board, true);
  talk.console.type(":reset");
  talk.console.type("G1 X1");
  talk.until_done();
  EXPECT_THAT(talk.shown, ElementsAre(StartsWith("Grbl"), "ok"));
}

TEST(LineConsole, a_silent_board_is_an_error) {
  GrblModel board;
  board.deaf = true;
  Talk talk(board, true);
  talk.console.type("$$");
  EXPECT_THROW(talk.until_done(), Error);
  EXPECT_LT(board.now(), 6s);
}

TEST(LineConsole, words) {
  EXPECT_EQ(realtime_word(" ! "), '!');
  EXPECT_EQ(realtime_word(":reset"), 0x18);
  EXPECT_EQ(realtime_word(":power -10"), 0x9B);
  EXPECT_FALSE(realtime_word("G1 X1"));
  EXPECT_FALSE(realtime_word(""));
  EXPECT_THAT(error_of([] { realtime_word(":holdd"); }), HasSubstr("':hold'"));
}

}  // namespace
}  // namespace lamplock::link
