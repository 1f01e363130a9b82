// Transcripts of senders with the virtual board: windows, polls, line ends, long lines, "$" between
// lines, pauses, resets, floods of text. Every line is answered once and in order, and every line
// that the board sends is in grbl's format.
#include <fmt/format.h>

#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

constexpr std::size_t queue_bytes = 1024;

class Protocol : public testing::Test {
 protected:
  Protocol() { host_.run_ms(5); }
  void TearDown() override {
    EXPECT_EQ(host_.fault(), "");
    EXPECT_FALSE(rig_.board.controller().runner().generator().underrun());
    EXPECT_EQ(rig_.shots().size(), 0u);
  }

  std::int32_t step_x() const { return host_.position()[0]; }

  job::Profile profile_ = program_profile();
  Rig rig_{profile_};
  ProgramHost host_{rig_, ProgramHost::Banner::kept};
};

/// Lines with and without motion, some of them wrong, and the expected answers.
struct Transcript {
  std::vector<std::string> lines, answers;
};

Transcript mixed_transcript(int count) {
  Transcript script;
  const auto add = [&script](const std::string& line, const char* answer) {
    script.lines.push_back(line);
    script.answers.emplace_back(answer);
  };
  add("G21 G90 G94", "ok");
  for (int i = 0; i < count; ++i) {
    const double x = (i * 37 % 100) / 10.0, y = (i * 53 % 100) / 10.0;
    switch (i % 11) {
      case 3:
        add("", "ok");
        break;
      case 5:
        add("(a comment)", "ok");
        break;
      case 7:
        add("G43 H1", "error:95");
        break;
      case 9:
        add("$G", "ok");
        break;
      case 10:
        add("XYZ", "error:2");
        break;
      default:
        add(fmt::format("N{} G1 X{:.3f} Y{:.3f} F6000", i + 1, x, y), "ok");
    }
  }
  add("G0 X0 Y0", "ok");
  return script;
}

/// Free bytes in the last report; -1 if the report has no such field.
long free_bytes(const std::string& report) {
  const std::size_t at = report.find("|Bf:");
  if (at == std::string::npos) return -1;
  return std::strtol(report.c_str() + report.find(',', at) + 1, nullptr, 10);
}

const char* const report_pattern =
    "<[a-zA-Z]+(:[0-9])?\\|MPos:-?[0-9]+\\.[0-9]{3},-?[0-9]+\\.[0-9]{3},-?[0-9]+\\.[0-9]{3}"
    "\\|Bf:[0-9]+,[0-9]+(\\|Ln:[0-9]+)?\\|FS:[0-9]+,[0-9]+(\\|Pn:[PXYZDHRS]+)?"
    "(\\|WCO:-?[0-9.]+,-?[0-9.]+,-?[0-9.]+)?(\\|Ov:[0-9]+,[0-9]+,[0-9]+(\\|A:[SCFM]+)?)?"
    "(\\|[A-Z][a-z]+:[0-9,]+)*>";

TEST_F(Protocol, EverySenderGetsEveryAnswerOnceAndInOrder) {
  const Transcript script = mixed_transcript(scaled(60));
  struct Way {
    std::size_t window;
    int poll_ms;
    const char* end;
  };
  const Way ways[] = {{queue_bytes, 100, "\n"}, {queue_bytes, 5, "\r\n"}, {128, 5, "\n"},
                      {128, 100, "\r"},         {0, 100, "\n"},           {0, 5, "\r\n"}};
  for (const Way& how : ways) {
    SCOPED_TRACE(testing::Message() << "window " << how.window << ", poll " << how.poll_ms);
    Rig rig(profile_);
    ProgramHost host(rig, ProgramHost::Banner::kept, how.window);
    host.run_ms(5);
    for (const std::string& line : script.lines) host.give(line + how.end);
    std::size_t polls = 0, seen = 0;
    const std::regex pattern(report_pattern);
    for (int i = 0; i < 120'000 && !host.answered(); ++i) {
      if (i % (2 * how.poll_ms) == 0) host.send("?");
      host.step(ps_per_ms / 2);
      if (host.reports() == seen) continue;
      seen = host.reports();
      ++polls;
      EXPECT_TRUE(std::regex_match(host.last_report(), pattern)) << host.last_report();
    }
    EXPECT_EQ(host.answers(), script.answers);
    ASSERT_TRUE(host.wait_for_rest());
    host.run_ms(20);
    EXPECT_EQ(host.answers().size(), script.answers.size());
    EXPECT_EQ(host.fault(), "");
    EXPECT_EQ(host.position(), (StepPosition{}));
    EXPECT_GE(polls, 1u);
  }
}

/// The board answers each of 200 queries per second; none is lost while it prints lists.
TEST_F(Protocol, EveryQuestionMarkIsAnswered) {
  host_.send("G1 X20 F3000\n");
  for (int i = 0; i < 200; ++i) {
    host_.send("?");
    if (i % 40 == 20) host_.send("$#\n");
    host_.run_ms(5);
  }
  host_.run_ms(20);
  EXPECT_EQ(host_.reports(), 200u);
  EXPECT_THAT(host_.answers(), AllOf(SizeIs(6), Each("ok")));
}

/// The reported room is real: whole lines that wait are subtracted, and that many bytes are
/// accepted at once.
TEST_F(Protocol, ReportsTheRoomThatThereIs) {
  EXPECT_EQ(free_bytes(host_.status()), static_cast<long>(queue_bytes));
  host_.send("G4 P0.2\n");
  host_.run_ms(5);
  std::size_t waiting = 0;
  for (int i = 0; i < 12; ++i) {
    const std::string line = "G1 X" + std::to_string(i % 7) + " F6000 (" +
                             std::string(static_cast<std::size_t>(i * 3), 'a') + ")\n";
    host_.send(line);
    waiting += line.size();
    EXPECT_EQ(free_bytes(host_.status()), static_cast<long>(queue_bytes - waiting));
  }
  const std::size_t left = queue_bytes - waiting - 1;
  std::size_t filled = 0;
  for (; filled + 2 <= left; filled += 2) host_.send(" \n");
  host_.run_ms(3);
  ASSERT_TRUE(host_.wait_for(1 + 12 + filled / 2, 5));
  EXPECT_THAT(host_.answers(), Each("ok"));
}

/// The reported free bytes plus the sender's unanswered bytes, without the line in progress, never
/// exceed the window. The cable is empty meanwhile.
TEST_F(Protocol, NeverPromisesMoreThanItsWindow) {
  std::string text;
  std::deque<std::size_t> sizes;
  for (int i = 0; text.size() < queue_bytes - 40; ++i) {
    const std::string line = fmt::format("G1 X{}.{:03} F{}\n", i % 20, i * 7 % 997, 600 + i * 7);
    text += line;
    sizes.push_back(line.size());
  }
  host_.send("M0\n" + text);
  host_.run_ms(20);
  host_.send("~");
  long free = 0;
  std::size_t answered = 1;  // the pause
  ASSERT_TRUE(host_.wait_for(answered));
  for (int i = 0; i < 2000 && !sizes.empty(); ++i) {
    free = free_bytes(host_.status());
    for (; answered < host_.answers().size(); ++answered) sizes.pop_front();
    std::size_t under_way = 0;
    for (std::size_t k = 1; k < sizes.size(); ++k) under_way += sizes[k];  // the first one is open
    ASSERT_LE(free + static_cast<long>(under_way), static_cast<long>(queue_bytes));
    host_.run_ms(5);
  }
  EXPECT_EQ(free_bytes(host_.status()), static_cast<long>(queue_bytes));
}

TEST_F(Protocol, EveryEndOfALineIsOne) {
  host_.send("G91\rG1X1F6000\r\nG1X1\nG1X1\n\rG1X1\r\n\r\n\n\n");
  ASSERT_TRUE(host_.wait_for(9));
  ASSERT_TRUE(host_.wait_for_rest());
  host_.run_ms(20);
  // LF CR is two ends, CR LF is one.
  EXPECT_THAT(host_.answers(), AllOf(SizeIs(9), Each("ok")));
  EXPECT_EQ(step_x(), 800);
}

TEST_F(Protocol, TakesLinesOf256CharactersAndNoLonger) {
  const auto padded = [](const std::string& code, std::size_t size) {
    return code + std::string(size - code.size(), ' ') + "\n";
  };
  host_.send(padded("G91G1X1F6000", 256) + padded("G1X2", 257) + "G1X4\n" + padded("G1X8", 400));
  host_.send(padded("G1X16", 3000));
  host_.send("G1X32\n");
  ASSERT_TRUE(host_.wait_for(6));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "error:11", "ok", "error:11", "error:11", "ok"));
  EXPECT_EQ(step_x(), 37 * 200);
}

/// UGS and other senders encode bytes above 127 in UTF-8, with 0xC2 in front.
TEST_F(Protocol, Utf8BeforeOverridesDoesNoHarm) {
  host_.send("G1 X10\xC2\x91\xC2\x91 Y2 F3000\n");
  host_.run_ms(5);
  EXPECT_THAT(host_.status(), HasSubstr("|Ov:120,100,100"));
  host_.send("\xC2\x96\xC2\x9A\xC2\x94");
  EXPECT_THAT(host_.status(), HasSubstr("|Ov:119,50,110"));
  host_.send("\xC2\x90\xC2\x95\xC2\x99");
  EXPECT_THAT(host_.status(), HasSubstr("|Ov:100,100,100"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_THAT(host_.answers(), ElementsAre("ok"));
  EXPECT_EQ(host_.position(), (StepPosition{2000, 400, 0, 0}));
}

TEST_F(Protocol, ReportsItsWindowBeforeItStreams) {
  EXPECT_THAT(host_.ask("$I\n"),
              ElementsAre(MatchesRegex("\\[VER:1\\.1h\\.[0-9]{8}:.*\\]"),
                          MatchesRegex("\\[OPT:[A-Z0]*,[0-9]+,1024\\]"), "[BOARD:virtual]", "ok"));
  EXPECT_THAT(host_.ask("$\n"), ElementsAre(StartsWith("[HLP:"), "ok"));
}

TEST_F(Protocol, SystemCommandsBetweenLinesOfAProgram) {
  host_.send("G1 X5 F600\n$$\n$#\n$110=5000\nG1 X6\n$I\n$X\n$C\n$N\n$SLP\n$RST=#\nG1 X0 F6000\n");
  ASSERT_TRUE(host_.wait_for(12, 3));
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "ok", "ok", "error:8", "ok", "ok", "ok", "error:8",
                                           "ok", "error:8", "error:8", "ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(step_x(), 0);
  EXPECT_EQ(rig_.board.controller().values().milli(Id::max_rate_x),
            profile_.settings.milli(Id::max_rate_x));
}

TEST_F(Protocol, PausesAreLeftByAStartByte) {
  host_.send("G1 X1 F6000\nM0\nG1 X2\nM0\nG1 X3\n");
  host_.run_ms(500);
  EXPECT_THAT(host_.answers(), SizeIs(1));
  EXPECT_THAT(host_.status(), StartsWith("<Hold:0|MPos:1.000,"));
  host_.send("~");
  host_.run_ms(500);
  EXPECT_THAT(host_.answers(), SizeIs(3));
  EXPECT_THAT(host_.status(), StartsWith("<Hold:0|MPos:2.000,"));
  host_.send(0x81);  // grblHAL's byte: ignored if unknown
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest(2));
  EXPECT_THAT(host_.answers(), AllOf(SizeIs(5), Each("ok")));
  EXPECT_EQ(step_x(), 600);
}

/// Real-time bytes work while a sender has filled the window to its last byte.
TEST_F(Protocol, HandlesRealTimeBytesWithAFullWindow) {
  host_.send("M0\n");
  host_.run_ms(20);
  for (std::size_t i = 0; i < queue_bytes / 8; ++i) host_.send("G1X1F60\n");
  host_.run_ms(50);
  EXPECT_THAT(host_.status(), StartsWith("<Hold:0|"));
  host_.send("~");
  EXPECT_TRUE(host_.wait_for(1, 1));
  host_.send(0x18);
  host_.run_ms(500);
  EXPECT_TRUE(host_.has_said("Grbl 1.1h ['$' for help]"));
}

TEST_F(Protocol, CheckModeAnswersAsARunWould) {
  EXPECT_THAT(host_.ask("$C\n"), ElementsAre("[MSG:Enabled]", "ok"));
  host_.send("G1 X10 F600\nG38\nG4 P5\nM0\nG1 X9999\nG1 X5\n");
  ASSERT_TRUE(host_.wait_for(7, 0.5));
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "ok", "error:20", "ok", "ok", "error:33", "ok"));
  EXPECT_THAT(host_.status(), StartsWith("<Check|MPos:0.000,"));
  EXPECT_EQ(host_.count(Said::banner), 1u);
  EXPECT_THAT(host_.ask("$C\n"), Contains("[MSG:Disabled]"));
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  EXPECT_EQ(host_.count(Said::banner), 2u);
  // Modes are those after a reset, and the position is that of the machine.
  EXPECT_THAT(host_.ask("G91 G1 X1 F6000\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(step_x(), 200);
}

/// A jog wheel: many short jogs, then a cancel.
TEST_F(Protocol, JogsAreRepeatedAndCancelled) {
  for (int round = 0; round < 5; ++round) {
    const std::size_t before = host_.answers().size();
    for (int i = 0; i < 12; ++i) {
      host_.send(fmt::format("$J=G91 X{} F3000\n", round % 2 == 0 ? 1 : -1));
      host_.run_ms(7);
    }
    EXPECT_THAT(host_.status(), StartsWith("<Jog|"));
    host_.send(0x85);
    ASSERT_TRUE(host_.wait_for(before + 12));
    ASSERT_TRUE(host_.wait_for_rest(1));
    host_.run_ms(10);
    EXPECT_EQ(host_.answers().size(), before + 12);
    EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
    const std::int32_t stood = step_x();
    host_.run_ms(50);
    EXPECT_EQ(step_x(), stood);
  }
  EXPECT_THAT(host_.answers(), Each("ok"));
  // A program continues from where the jog ended, with its own modes.
  const std::int32_t stood = step_x();
  EXPECT_THAT(host_.ask("$G\nG91 G1 X1 F600\n"), Contains(HasSubstr("G21 G90")));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(step_x(), stood + 200);
}

TEST_F(Protocol, HoldAndResetKeepThePositionAndSendTheBannerOnce) {
  host_.send("G1 X40 F6000\nG1 X0\nG1 X40\n");
  host_.run_ms(150);
  host_.send("!");
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), StartsWith("<Hold:0|"));
  const std::size_t banners = host_.count(Said::banner);
  host_.send(0x18);
  host_.run_ms(30);
  EXPECT_EQ(host_.count(Said::banner), banners + 1);
  EXPECT_EQ(host_.count(Said::alarm), 0u);
  EXPECT_THAT(host_.status(), AllOf(StartsWith("<Idle|"), HasSubstr("|WCO:")));
  const std::size_t before = host_.answers().size();
  EXPECT_THAT(host_.ask("G1 X0 F6000\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(host_.answers().size(), before + 1);
  EXPECT_EQ(step_x(), 0);
}

/// An incomplete line before a reset is not the beginning of the next line.
TEST_F(Protocol, AResetDropsAnIncompleteLine) {
  host_.send("G1 X1");
  host_.send(0x18);
  host_.run_ms(10);
  host_.send("0 F600\n");
  ASSERT_TRUE(host_.wait_for(1));
  EXPECT_THAT(host_.answers()[0], StartsWith("error:"));
  EXPECT_EQ(step_x(), 0);
}

TEST_F(Protocol, StartUpLinesRunAfterAReset) {
  EXPECT_THAT(host_.ask("$N0=G21\n$N1=G91\n"), AllOf(SizeIs(2), Each("ok")));
  host_.run_ms(5);
  const std::size_t heard = host_.said().size(), answered = host_.answers().size();
  host_.send(0x18);
  host_.run_ms(20);
  EXPECT_THAT(host_.said_from(heard),
              ElementsAre("Grbl 1.1h ['$' for help]", ">G21:ok", ">G91:ok"));
  EXPECT_EQ(host_.answers().size(), answered);
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr("G91")));
}

/// Lists are longer than the ring that they pass through: no answer is lost, no line is torn.
TEST_F(Protocol, NothingIsLostInAFloodOfLists) {
  std::string text;
  for (int i = 0; i < 30; ++i) text += i % 2 == 0 ? "$$\n" : "$#\n";
  text += "G1 X2 F6000\n";
  const std::size_t settings_before = host_.count(Said::setting);
  for (const char c : text) {
    host_.send(std::string_view(&c, 1));
    host_.send("?");
    host_.run_ms(0.25);
  }
  ASSERT_TRUE(host_.wait_for(31, 10));
  host_.run_ms(50);
  EXPECT_THAT(host_.answers(), AllOf(SizeIs(31), Each("ok")));
  EXPECT_EQ(host_.count(Said::setting) - settings_before, 15 * settings::setting_count);
}

/// A line-by-line sender polls while it reads lists: messages lie between lines.
TEST_F(Protocol, MessagesLieBetweenLines) {
  for (int i = 0; i < 20; ++i) {
    host_.send("$$\n??M30\n?");
    host_.run_ms(1 + i % 3);
    host_.send("?$G\n?");
    ASSERT_TRUE(host_.wait_for(static_cast<std::size_t>(3 * i + 3)));
  }
  host_.run_ms(20);
  // Queries that arrive together get one answer.
  EXPECT_GE(host_.reports(), 40u);
  EXPECT_LE(host_.reports(), 100u);
  EXPECT_EQ(host_.answers().size(), 60u);
}

}  // namespace
}  // namespace lamplock::test
