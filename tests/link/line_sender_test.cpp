// Programs of G-code sent to a model of grbl: each line once and in order, the receive buffer never
// overrun, no line after an error, and the machine never left running.
#include "host/link/line_sender.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <random>

#include "host/error.hpp"
#include "tests/link/grbl_model.hpp"
#include "tests/scale.hpp"

namespace lamplock::link {
namespace {

using namespace std::chrono_literals;
using test::Faults;
using test::GrblModel;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<ProgramLine> numbered(const std::vector<std::string>& texts) {
  std::vector<ProgramLine> lines;
  lines.reserve(texts.size());
  for (const std::string& text : texts) lines.push_back({lines.size() + 1, text});
  return lines;
}

std::vector<std::string> texts_of(const std::vector<ProgramLine>& lines) {
  std::vector<std::string> texts;
  texts.reserve(lines.size());
  for (const ProgramLine& line : lines) texts.push_back(line.text);
  return texts;
}

/// Random lines of various lengths, all different.
std::vector<ProgramLine> random_program(std::mt19937_64& random, std::size_t count,
                                        std::size_t longest = 60) {
  std::vector<ProgramLine> lines;
  for (std::size_t i = 0; i < count; ++i) {
    std::string text = (random() % 3 == 0 ? "G0 N" : "G1 X") + std::to_string(i);
    const std::size_t size = random() % longest;
    while (text.size() < size) text += " F1";
    lines.push_back({2 * i + 3, text});
  }
  return lines;
}

/// A sender with its port, and a time-out longer than any test of a thousand lines.
struct Sending {
  Sending(GrblModel& board_in, std::vector<ProgramLine> program, LineOptions options = {})
      : board(board_in), port(board), sender(port, std::move(program), std::move(options)) {}

  LineResult run() {
    while (sender.step()) {
    }
    return sender.result();
  }
  /// Steps until the board reports this state.
  bool run_until(const std::string& state) {
    while (board.state != state)
      if (!sender.step()) return false;
    return true;
  }
  void run_for(std::chrono::microseconds time) {
    const auto until = board.now() + time;
    while (board.now() < until && sender.step()) {
    }
  }

  GrblModel& board;
  LinePort port;
  LineSender sender;
};

Error failure_of(Sending& sending) {
  try {
    sending.run();
  } catch (const Error& error) {
    return error;
  }
  return {Exit::done, "", "no error", ""};
}

TEST(LineSender, sends_each_line_once_and_ends_when_the_machine_is_at_rest) {
  GrblModel board;
  const auto program = numbered({"G21", "G1 X1 F100", "G1 X2", "M30"});
  Sending sending(board, program);
  const LineResult result = sending.run();
  EXPECT_EQ(result.end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
  EXPECT_EQ(board.state, "Idle");
  EXPECT_FALSE(board.moving());
  EXPECT_EQ(result.answered, 4u);
  EXPECT_EQ(result.last_line, 4u);
  EXPECT_THAT(result.status.position, ElementsAre(1.5, -2, 0));
  EXPECT_THAT(result.status.work_offset, ElementsAre(1, 0, 0));
  EXPECT_TRUE(board.bytes_seen.empty());
}

TEST(LineSender, an_empty_program_is_over_at_once) {
  GrblModel board;
  Sending sending(board, {});
  EXPECT_EQ(sending.run().end, LineEnd::done);
}

TEST(LineSender, ends_only_after_the_last_move) {
  GrblModel board;
  board.max_move = 3s;
  Sending sending(board, numbered({"G1 X1"}));
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_GE(board.now(), 3s);
}

TEST(LineSender, asks_for_the_status_five_times_a_second) {
  GrblModel board;
  board.max_move = 10s;
  Sending sending(board, numbered({"G1 X1"}));
  sending.run();
  EXPECT_NEAR(board.polls, 52, 4);
}

TEST(LineSender, random_programs_arrive_complete_and_the_window_is_never_exceeded) {
  for (int seed = 0; seed < test::scaled(60); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    GrblModel board(static_cast<std::uint64_t>(seed));
    board.window = 64 + random() % 1000;
    board.planner_blocks = 1 + random() % 20;
    board.max_move = std::chrono::microseconds(1 + random() % 30'000);
    board.max_answer = std::chrono::microseconds(1 + random() % 30'000);
    const auto program = random_program(random, random() % 200);
    Sending sending(board, program);
    ASSERT_EQ(sending.run().end, LineEnd::done) << seed;
    ASSERT_FALSE(board.overrun) << seed;
    ASSERT_EQ(board.lines, texts_of(program)) << seed;
    ASSERT_EQ(board.state, "Idle");
  }
}

TEST(LineSender, fills_the_window_to_the_byte) {
  GrblModel board;
  board.window = 100;
  board.planner_blocks = 1;
  // Ten lines of 10 characters, line end included, fill the window.
  Sending sending(board, numbered(std::vector<std::string>(50, "G1 X12345")));
  sending.run();
  EXPECT_EQ(board.max_used, 100u);
  EXPECT_FALSE(board.overrun);
}

TEST(LineSender, uses_grbls_buffer_size_if_the_board_does_not_report_one) {
  GrblModel board;
  board.tells_options = false;
  board.window = 127;
  Sending sending(board, numbered(std::vector<std::string>(100, "G1 X12345")));
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_FALSE(board.overrun);
  EXPECT_GT(board.max_used, 110u);
}

TEST(LineSender, system_lines_are_sent_alone) {
  GrblModel board;
  board.max_answer = 50ms;
  Sending sending(board, numbered({"G1 X1", "$H", "G1 X2"}));
  while (sending.sender.step()) ASSERT_LE(board.waiting(), 6u);
  EXPECT_EQ(board.lines.size(), 3u);
}

TEST(LineSender, stops_at_the_first_error_and_sends_no_further_line) {
  for (int seed = 0; seed < test::scaled(40); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    GrblModel board(static_cast<std::uint64_t>(seed));
    auto program = random_program(random, 100);
    const std::size_t wrong = random() % program.size();
    board.refused[program[wrong].text] = 22;
    board.refused[program.back().text] = 24;
    Sending sending(board, program);
    // The step that reads the error must not write another line.
    std::size_t written = 0;
    while (sending.sender.step())
      if (sending.sender.result().errors.empty()) written = board.lines_written;
    const LineResult result = sending.sender.result();
    ASSERT_EQ(result.end, LineEnd::error);
    ASSERT_EQ(result.errors.size(), 1u);
    ASSERT_EQ(result.errors[0].line, program[wrong].number) << seed;
    ASSERT_EQ(result.errors[0].error, wrong + 1 == program.size() ? 24 : 22);
    ASSERT_EQ(board.lines_written, written) << seed;
    ASSERT_EQ(board.resets, 1);
    ASSERT_FALSE(board.reset_in_motion);
    ASSERT_FALSE(board.moving());
    ASSERT_FALSE(board.overrun);
  }
}

TEST(LineSender, continues_after_errors_on_request) {
  GrblModel board;
  const auto program = numbered({"G1 X1", "bad", "G1 X2", "worse", "G1 X3"});
  board.refused = {{"bad", 1}, {"worse", 20}};
  LineOptions options;
  options.ignore_errors = true;
  Sending sending(board, program, options);
  const LineResult result = sending.run();
  EXPECT_EQ(result.end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
  ASSERT_EQ(result.errors.size(), 2u);
  EXPECT_EQ(result.errors[0].line, 2u);
  EXPECT_EQ(result.errors[0].error, 1);
  EXPECT_EQ(result.errors[1].line, 4u);
  EXPECT_EQ(result.errors[1].error, 20);
}

TEST(LineSender, ends_at_an_alarm) {
  GrblModel board;
  board.alarm_line = "G1 X50";
  std::vector<std::string> texts(100, "G1 X1");
  texts[49] = board.alarm_line;
  Sending sending(board, numbered(texts));
  const LineResult result = sending.run();
  EXPECT_EQ(result.end, LineEnd::alarm);
  EXPECT_EQ(result.alarm, 1);
  EXPECT_EQ(result.last_line, 49u);
  EXPECT_EQ(board.state, "Alarm");
}

TEST(LineSender, a_stop_holds_then_resets_and_leaves_nothing_running) {
  for (int seed = 0; seed < test::scaled(40); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    GrblModel board(static_cast<std::uint64_t>(seed));
    Sending sending(board, random_program(random, 300));
    sending.run_for(std::chrono::microseconds(random() % 900'000));
    sending.sender.stop();
    const LineResult result = sending.run();
    ASSERT_EQ(result.end, LineEnd::stopped);
    if (board.lines.empty() && board.resets == 0) continue;  // before anything was sent
    ASSERT_THAT(board.bytes_seen, ElementsAre('!', 0x18)) << seed;
    ASSERT_FALSE(board.reset_in_motion) << seed;
    const std::size_t seen = board.lines.size();
    board.wait(2s);
    ASSERT_EQ(board.lines.size(), seen);
    ASSERT_FALSE(board.moving());
    ASSERT_EQ(result.answered, seen);
  }
}

TEST(LineSender, a_stop_discards_lines_that_the_cable_has_not_accepted) {
  GrblModel board;
  board.window = 2000;
  board.max_written = 3;
  Sending sending(board, numbered(std::vector<std::string>(300, "G1 X1")));
  ASSERT_TRUE(sending.run_until("Run"));
  const std::size_t written = board.lines_written;
  sending.sender.stop();
  EXPECT_EQ(sending.run().end, LineEnd::stopped);
  EXPECT_LE(board.lines_written, written + 1);
  EXPECT_FALSE(board.moving());
}

TEST(LineSender, a_board_that_does_not_hold_is_reported) {
  GrblModel board;
  board.obeys_hold = false;
  board.max_move = 60s;
  Sending sending(board, numbered({"G1 X1", "G1 X2"}));
  sending.run_until("Run");
  sending.sender.stop();
  const Error error = failure_of(sending);
  EXPECT_EQ(error.exit(), Exit::job_failed);
  EXPECT_THAT(error.what(), HasSubstr("could not be stopped"));
  EXPECT_EQ(board.resets, 0);
}

TEST(LineSender, a_host_error_is_reported_when_the_machine_is_at_rest) {
  GrblModel board;
  Sending sending(board, numbered(std::vector<std::string>(100, "G1 X1")));
  ASSERT_TRUE(sending.run_until("Run"));
  sending.sender.fail(std::make_exception_ptr(Error(Exit::bad_input, "terminal", "gone", "-")));
  EXPECT_THAT(failure_of(sending).what(), HasSubstr("gone"));
  EXPECT_EQ(board.state, "Idle");
  EXPECT_EQ(board.resets, 1);
}

class Pause : public testing::TestWithParam<bool> {};

TEST_P(Pause, waits_for_the_user) {
  GrblModel board;
  board.answers_pause_first = GetParam();
  const auto program = numbered({"G1 X1", "M0", "G1 X2"});
  Sending sending(board, program);
  while (!sending.sender.waits()) ASSERT_TRUE(sending.sender.step());
  EXPECT_TRUE(sending.sender.at_pause());
  sending.run_for(2s);
  EXPECT_EQ(board.state, "Hold:0");
  sending.sender.resume();
  EXPECT_FALSE(sending.sender.waits()) << "reports from before the resume are outdated";
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
  EXPECT_THAT(board.bytes_seen, ElementsAre('~'));
}

INSTANTIATE_TEST_SUITE_P(line, Pause, testing::Bool());

TEST(LineSender, a_pause_in_the_last_line_is_not_the_end) {
  GrblModel board;
  board.answers_pause_first = true;
  Sending sending(board, numbered({"G1 X1", "M0"}));
  sending.run_for(2s);
  EXPECT_TRUE(sending.sender.waits());
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
}

TEST(LineSender, holds_and_resumes_for_the_user) {
  GrblModel board;
  const auto program = numbered(std::vector<std::string>(200, "G1 X1"));
  Sending sending(board, program);
  ASSERT_TRUE(sending.run_until("Run"));
  sending.sender.hold();
  while (!sending.sender.waits()) ASSERT_TRUE(sending.sender.step());
  EXPECT_FALSE(sending.sender.at_pause());
  sending.sender.realtime(realtime::feed_plus_10);
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
  EXPECT_THAT(board.bytes_seen, ElementsAre('!', 0x91, '~'));
}

TEST(LineSender, a_hold_before_the_first_line_keeps_the_machine_at_rest) {
  GrblModel board;
  const auto program = numbered(std::vector<std::string>(20, "G1 X1"));
  Sending sending(board, program);
  sending.sender.hold();
  sending.run_for(2s);
  EXPECT_TRUE(sending.sender.waits());
  EXPECT_EQ(board.lines.size(), 0u);
  EXPECT_EQ(sending.sender.answered(), 0u);
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
  EXPECT_THAT(board.bytes_seen, ElementsAre('!', '~'));
}

TEST(LineSender, a_hold_of_a_locked_machine_follows_its_unlocking) {
  GrblModel board;
  board.state = "Alarm";
  Sending sending(board, numbered({"$X", "G1 X1"}));
  sending.sender.hold();
  sending.run_for(2s);
  EXPECT_TRUE(sending.sender.waits());
  EXPECT_THAT(board.lines, ElementsAre("$X"));
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
}

TEST(LineSender, a_resume_takes_back_a_hold_before_the_first_line) {
  GrblModel board;
  Sending sending(board, numbered({"G1 X1", "G1 X2"}));
  sending.sender.hold();
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_TRUE(board.bytes_seen.empty());
}

TEST(LineSender, a_cut_cable_ends_it) {
  GrblModel board;
  Sending sending(board, numbered(std::vector<std::string>(500, "G1 X1")));
  ASSERT_TRUE(sending.run_until("Run"));
  board.silent = true;  // no answers and no reports
  EXPECT_EQ(sending.run().end, LineEnd::lost);
  EXPECT_LT(board.now(), 7s);
}

TEST(LineSender, a_cable_known_to_be_cut_ends_it_at_once) {
  for (int seed = 0; seed < test::scaled(20); ++seed) {
    Faults faults;
    faults.cuts = 1;
    GrblModel board(static_cast<std::uint64_t>(seed), faults);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto program = random_program(random, 2000);
    Sending sending(board, program);
    LineResult result;
    try {
      result = sending.run();
    } catch (const Error& error) {
      ASSERT_EQ(error.exit(), Exit::no_device);  // during the greeting
      continue;
    }
    ASSERT_EQ(result.end, LineEnd::lost);
    ASSERT_LT(board.now(), 1100ms);
    ASSERT_LE(result.answered, board.lines.size()) << "more answers than lines";
  }
}

TEST(LineSender, a_lost_ok_ends_in_a_timeout) {
  GrblModel board;
  board.lost_ok_line = "G1 X7";
  Sending sending(board, numbered({"G1 X1", "G1 X7"}));
  EXPECT_EQ(sending.run().end, LineEnd::unanswered);
  EXPECT_EQ(board.resets, 1);
}

TEST(LineSender, a_long_dwell_is_waited_for) {
  GrblModel board;
  Sending sending(board, numbered({"G1 X1", "G4 P60", "G1 X2"}));
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_GE(board.now(), 60s);
}

TEST(LineSender, a_restart_of_the_board_ends_the_program) {
  GrblModel board;
  Sending sending(board, numbered(std::vector<std::string>(500, "G1 X1")));
  ASSERT_TRUE(sending.run_until("Run"));
  board.restart();
  EXPECT_EQ(sending.run().end, LineEnd::restarted);
}

TEST(LineSender, forwards_messages_of_the_board) {
  GrblModel board;
  std::vector<std::string> heard;
  LineOptions options;
  options.on_text = [&heard](const std::string& text) { heard.push_back(text); };
  Sending sending(board, numbered({"G1 X1"}), options);
  ASSERT_TRUE(sending.run_until("Run"));
  board.reply("[MSG:Pgm End]");
  sending.run();
  EXPECT_THAT(heard, ElementsAre("[MSG:Pgm End]"));
}

TEST(LineSender, the_number_of_a_line_replaces_its_n_word_wherever_it_is) {
  const std::vector<ProgramLine> lines = with_numbers({{3, "X5 N100"},
                                                       {4, "G1X5N10Y2"},
                                                       {5, "X[SIN[30]] n 7"},
                                                       {6, "#<_n9>=2"},
                                                       {7, "N8"},
                                                       {8, "G1 " + std::string(252, '0') + " N4"}});
  EXPECT_THAT(texts_of(lines), ElementsAre("N3X5", "N4G1X5Y2", "N5X[SIN[30]]", "#<_n9>=2", "N8",
                                           "G1 " + std::string(252, '0')));
}

/// The N words are those of the file.
TEST(LineSender, a_board_that_counts_lines_itself_reports_no_line_of_the_file) {
  GrblModel board;
  Sending sending(board, numbered({"N10 G1 X1", "N20 G1 X2", "G1 X3"}));
  ASSERT_TRUE(sending.run_until("Run"));
  board.reply("<Run|MPos:0.000,0.000,0.000|FS:0,0|Ln:2>");
  sending.run_for(50ms);
  EXPECT_EQ(sending.sender.result().at_line, 0u);
}

TEST(LineSender, a_pause_shows_that_the_lines_before_it_are_executed) {
  GrblModel board;
  board.max_move = 400ms;
  LineOptions options;
  options.status_interval = 50ms;
  Sending sending(board, numbered({"G1 X1", "G1 X2", "M0", "G1 X3"}), options);
  ASSERT_TRUE(sending.run_until("Run"));
  sending.sender.hold();
  ASSERT_TRUE(sending.run_until("Hold:0"));
  sending.run_for(500ms);
  EXPECT_GE(sending.sender.answered(), 1u);
  EXPECT_EQ(sending.sender.done(), 0u) << "a hold has interrupted the first line";
  sending.sender.resume();
  ASSERT_TRUE(sending.run_until("Run"));
  ASSERT_TRUE(sending.run_until("Hold:0"));
  sending.run_for(500ms);
  EXPECT_EQ(sending.sender.answered(), 2u);
  EXPECT_EQ(sending.sender.done(), 2u);
  sending.sender.resume();
  EXPECT_EQ(sending.run().end, LineEnd::done);
  EXPECT_EQ(sending.sender.done(), 4u);
}

/// Their queue is not that of the report.
TEST(LineSender, points_on_the_beat_are_not_executed_at_a_pause) {
  for (const char* lock : {"M130 P0", "M[130]"}) {
    GrblModel board;
    LineOptions options;
    options.status_interval = 50ms;
    Sending sending(board, numbered({lock, "G1 X2", "M0"}), options);
    ASSERT_TRUE(sending.run_until("Hold:0"));
    sending.run_for(500ms);
    EXPECT_EQ(sending.sender.answered(), 2u);
    EXPECT_LE(sending.sender.done(), 1u);
  }
}

TEST(LineSender, the_time_of_a_line_of_the_host_counts_while_it_runs) {
  struct SlowLine final : HostLines {
    bool has(std::size_t index) const override { return index == 1; }
    bool run(std::size_t /*index*/) override { return ++steps > 20; }
    void stop() override {}
    int steps = 0;
  } slow;
  GrblModel board;
  LineOptions options;
  options.host_lines = &slow;
  Sending sending(board, numbered({"G1 X1", "M101", "G1 X2"}), options);
  std::chrono::microseconds last{};
  while (sending.sender.step()) {
    if (!sending.sender.runs_host_line()) continue;
    EXPECT_GE(sending.sender.host_time(), last);
    last = sending.sender.host_time();
  }
  EXPECT_GT(last.count(), 0);
  EXPECT_GE(sending.sender.host_time(), last);
}

TEST(LineSender, a_banner_before_the_first_answer_is_no_restart) {
  GrblModel board;
  board.restart();
  Sending sending(board, numbered({"G1 X1"}));
  EXPECT_EQ(sending.run().end, LineEnd::done);
}

TEST(Greeting, without_a_version_names_the_remedy) {
  GrblModel board;
  board.tells_version = false;
  Sending sending(board, {});
  const Error error = failure_of(sending);
  EXPECT_EQ(error.exit(), Exit::no_device);
  EXPECT_THAT(error.what(), HasSubstr("[VER:]"));
  EXPECT_LT(board.now(), 5s);
}

TEST(Greeting, of_a_silent_board) {
  GrblModel board;
  board.deaf = true;
  Sending sending(board, {});
  EXPECT_THAT(failure_of(sending).what(), HasSubstr("does not answer within 4 s"));
}

TEST(Greeting, of_a_board_that_wakes_up_late) {
  GrblModel board;
  board.deaf = true;
  LinePort port(board);
  std::size_t asked = 0;
  struct Awaking : link::Transport {
    explicit Awaking(GrblModel& b) : board(b) {}
    std::size_t write(std::span<const std::uint8_t> bytes) override { return board.write(bytes); }
    std::size_t read(std::span<std::uint8_t> bytes) override { return board.read(bytes); }
    void wait(std::chrono::microseconds time) override {
      board.deaf = board.now() < 2500ms;
      board.wait(time);
    }
    std::chrono::microseconds now() const override { return board.now(); }
    bool reconnect() override { return false; }
    GrblModel& board;
  } awaking(board);
  LinePort late(awaking);
  const auto program = numbered({"G1 X1", "G1 X2"});
  LineSender sender(late, program);
  while (sender.step()) ++asked;
  EXPECT_EQ(sender.result().end, LineEnd::done);
  EXPECT_EQ(board.lines, texts_of(program));
}

TEST(Greeting, refuses_a_machine_that_is_busy_or_in_alarm) {
  GrblModel alarm;
  alarm.state = "Alarm";
  Sending first(alarm, numbered({"G1 X1"}));
  const Error error = failure_of(first);
  EXPECT_EQ(error.exit(), Exit::job_failed);
  EXPECT_THAT(error.what(), HasSubstr("$X"));
  GrblModel door;
  door.state = "Door:1";
  Sending second(door, numbered({"G1 X1"}));
  EXPECT_THAT(failure_of(second).what(), HasSubstr("its door is open"));
  EXPECT_TRUE(door.lines.empty());
}

TEST(Greeting, a_line_longer_than_the_buffer_is_refused_before_anything_is_sent) {
  GrblModel board;
  board.window = 20;
  Sending sending(board, numbered({"G1 X1", "G1 X1.000000000 Y2.0000000"}));
  EXPECT_THAT(failure_of(sending).what(), HasSubstr("line 2: has 27 characters"));
  EXPECT_TRUE(board.lines.empty());
}

}  // namespace
}  // namespace lamplock::link
