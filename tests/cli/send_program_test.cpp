// `lamplock send` with G-code programs, to a model of grbl at a TCP port.
#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "sim/endpoint/tcp_endpoint.hpp"
#include "tests/cli/program.hpp"
#include "tests/link/grbl_model.hpp"

namespace lamplock::cli::test {
namespace {

using namespace std::chrono_literals;
using lamplock::test::GrblModel;
using testing::HasSubstr;

/// The model at the pace of the wall clock. Its state may be read after stop() only.
class Served {
 public:
  explicit Served(std::unique_ptr<GrblModel> model = std::make_unique<GrblModel>())
      : model_(std::move(model)), thread_([this] { serve(); }) {}
  ~Served() { stop(); }
  std::string address() const { return port_->address(); }
  GrblModel& stop() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
    return *model_;
  }
  /// Pulls the cable.
  void cut() {
    stop();
    port_.reset();
  }

 private:
  void serve() {
    std::array<std::uint8_t, 512> bytes{};
    while (!end_) {
      const std::size_t count = port_->read(bytes);
      model_->write(std::span(bytes).first(count));
      model_->wait(1ms);
      const std::size_t said = model_->read(bytes);
      port_->write(std::span(bytes).first(said));
      std::this_thread::sleep_for(1ms);
    }
  }

  std::optional<sim::TcpEndpoint> port_{std::in_place, "127.0.0.1:0"};
  std::unique_ptr<GrblModel> model_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

std::string many_moves(int count) {
  std::string text = "G21 (units)\n";
  for (int i = 1; i < count; ++i) text += "G1 X" + std::to_string(i) + "\n";
  return text;
}

TEST(SendProgram, sends_it_and_reports) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "%\n(a?)\nG21\nG1 X1 ; one!\n\nM30\n%\n");
  Served board;
  const Finished done = run({"send", file, "--board", board.address(), "--yes", "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto document = nlohmann::json::parse(done.out);
  EXPECT_EQ(document["end"], "done");
  EXPECT_EQ(document["lines"], 3);
  EXPECT_EQ(document["answered"], 3);
  EXPECT_EQ(document["last_line"], 6);
  EXPECT_EQ(document["errors"], nlohmann::json::array());
  EXPECT_EQ(document["position"], (nlohmann::json{1.5, -2, 0}));
  EXPECT_GT(document["seconds"].get<double>(), 0);
  EXPECT_EQ(board.stop().lines, (std::vector<std::string>{"G21", "G1 X1", "M30"}));
}

TEST(SendProgram, the_time_is_planned_from_what_is_sent) {
  const Folder folder;
  const std::string long_comment = "(" + std::string(300, 'x') + "?)";
  const std::string file =
      folder.write("a.ngc", "\xEF\xBB\xBF$X\n" + long_comment + "\nG1 X10 F600\n");
  const Finished done = run({"send", file, "--board", "virtual", "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto document = nlohmann::json::parse(done.out);
  ASSERT_TRUE(document["planned_seconds"].is_number());
  EXPECT_NEAR(document["planned_seconds"].get<double>(), 1, 0.01);
}

TEST(SendProgram, a_dry_program_moves_without_laser_words) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G21 M4 S500\nG1 X1 F100 S3\nM3\nX2\nM30\n");
  Served board;
  const Finished done = run({"send", file, "--board", board.address(), "--dry", "--yes"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(board.stop().lines, (std::vector<std::string>{"M5", "G21", "G1 X1 F100", "X2", "M30"}));
}

TEST(SendProgram, begins_at_a_line_after_a_dark_approach) {
  const Folder folder;
  const std::string file =
      folder.write("a.ngc", "G20 G90 G0 X1 Y0 Z2\nM4 S500 F10\n(middle)\nG1 X2\nX3\nM30\n");
  Served board;
  const Finished done = run({"send", file, "--board", board.address(), "--yes", "--from", "5"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(board.stop().lines,
            (std::vector<std::string>{"M5", "G21 G90 G94 G80 G17 G54", "G0 X50.8000000 Y0.0000000",
                                      "G0 Z50.8000000", "F254.000", "G20", "G1 S500.000 M4", "X3",
                                      "M30"}));
}

TEST(SendProgram, jobs_are_refused_by_the_name_of_a_grbl_board) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", "0 0 0\n1 0 0\n");
  Served board;
  const Finished refused = run({"engrave", points, "--board", board.address(), "--yes"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("the board runs grbl"));
  EXPECT_THAT(refused.err, HasSubstr("send a G-code program: lamplock send FILE.ngc"));
}

TEST(SendProgram, a_misspelt_board_gets_the_nearest_name) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G21\n");
  const Finished refused = run({"send", file, "--board", "virtal"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("error: --board: there is no board 'virtal'; "
                                     "did you mean 'virtual'?"));
  EXPECT_THAT(refused.err, HasSubstr("serial port"));
}

TEST(SendProgram, reports_the_line_of_an_error) {
  const Folder folder;
  const std::string file = folder.write("a.nc", "G21\n\nG1 X2\n" + many_moves(100));
  auto model = std::make_unique<GrblModel>();
  model->refused["G1 X2"] = 22;
  Served board(std::move(model));
  const Finished wrong = run({"send", file, "--board", board.address(), "--yes"});
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err,
              HasSubstr("error: " + file + ":3: error:22 the feed is zero or has not been set; "));
  EXPECT_EQ(lines(wrong.err).size(), 1u) << wrong.err;
  EXPECT_EQ(board.stop().resets, 1);
}

TEST(SendProgram, continues_after_errors_if_requested) {
  const Folder folder;
  const std::string file = folder.write("a.nc", "G21\nbad\nG1 X1\nbad\nM30\n");
  auto model = std::make_unique<GrblModel>();
  model->refused["bad"] = 1;
  Served board(std::move(model));
  const Finished wrong =
      run({"send", file, "--board", board.address(), "--yes", "--ignore-errors"});
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr(file + ":2: error:1 "));
  EXPECT_THAT(wrong.err, HasSubstr(file + ":4: error:1 "));
  EXPECT_THAT(wrong.err, HasSubstr("2 of 5 lines were refused"));
  EXPECT_EQ(board.stop().lines.size(), 5u);
}

TEST(SendProgram, an_alarm_is_reported) {
  const Folder folder;
  const std::string file = folder.write("a.nc", "G21\nG1 X2\n");
  auto model = std::make_unique<GrblModel>();
  model->alarm_line = "G1 X2";
  Served board(std::move(model));
  const Finished ended = run({"send", file, "--board", board.address(), "--yes"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("ALARM:1 a limit switch engaged"));
}

TEST(SendProgram, ctrl_c_holds_and_resets) {
  const Folder folder;
  const std::string file = folder.write("a.gcode", many_moves(400));
  Served board;
  Running sending({"send", file, "--board", board.address(), "--yes"});
  ASSERT_TRUE(sending.wait_for("sending: "));
  sending.interrupt();
  const Finished stopped = sending.finish();
  EXPECT_EQ(stopped.status, 130);
  EXPECT_THAT(stopped.err, HasSubstr("stopped: line "));
  GrblModel& model = board.stop();
  EXPECT_THAT(model.bytes_seen, testing::ElementsAre('!', 0x18));
  EXPECT_FALSE(model.reset_in_motion);
  EXPECT_FALSE(model.moving());
  EXPECT_FALSE(model.overrun);
}

TEST(SendProgram, a_pause_waits_for_its_user) {
  const Folder folder;
  const std::string file = folder.write("a.tap", "G1 X1\nM0\nG1 X2\n");
  Served board;
  InTerminal sending({"send", file, "--board", board.address(), "--yes"});
  ASSERT_TRUE(sending.wait_for("the program pauses (M0), before line 2; Enter resumes"));
  sending.type("%\n");  // the mark of a tape in a pasted text is not a blank line
  ASSERT_TRUE(sending.wait_for("Enter alone resumes"));
  sending.type("~\n");
  ASSERT_TRUE(sending.wait_for("resuming"));
  const Finished done = sending.finish();
  EXPECT_EQ(done.status, 0) << done.out;
  EXPECT_THAT(done.out, HasSubstr("3 of 3 lines"));
}

TEST(SendProgram, a_pulled_cable_is_one_error) {
  const Folder folder;
  const std::string file = folder.write("a.cnc", many_moves(400));
  Served board;
  Running sending({"send", file, "--board", board.address(), "--yes"});
  ASSERT_TRUE(sending.wait_for("sending: "));
  board.cut();
  const Finished lost = sending.finish();
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("connection lost, so that the machine could not be stopped"));
}

TEST(SendProgram, nothing_is_sent_without_permission) {
  const Folder folder;
  Served board;
  const Finished refused = run({"send", folder.write("a.gc", "G21\n"), "--board", board.address()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(board.stop().lines.empty());
}

TEST(SendProgram, what_cannot_be_sent) {
  const Folder folder;
  const auto refused = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"send"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Finished ended = run(all);
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(lines(ended.err).size(), 1u) << ended.err;
    return ended.err;
  };
  const std::string good = folder.write("good.ngc", "G21\n");
  EXPECT_THAT(refused({folder / "none.ngc"}), HasSubstr("no such file"));
  EXPECT_THAT(refused({folder.write("e.ngc", "(nothing)\n")}), HasSubstr("no line to send"));
  EXPECT_THAT(refused({folder.write("x.ngc", "G21\nG1 !\n")}), HasSubstr("x.ngc:2: "));
  EXPECT_THAT(refused({good, "--from", "3"}), HasSubstr("--from 3: "));
  EXPECT_THAT(refused({good, "--from", "1", "--fired", "3"}), HasSubstr("--fired: is for jobs"));
  EXPECT_THAT(refused({folder.write("b.ngc", "G1 X1\nM130 P0\n"), "--dry"}),
              HasSubstr("b.ngc:2: --dry cannot leave 'M130' out"));
  EXPECT_THAT(refused({folder.write("a.llj", "x"), "--ignore-errors"}),
              HasSubstr("--ignore-errors: is for prog"));
}

/// The firmware on a simulated board at a port; the board keeps its state between programs.
class SendToBoard : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(board_.wait_for("Ctrl-C")); }
  Finished send(const std::string& text, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{
        "send", folder_.write("q.ngc", text), "--board", folder_ / "port", "--yes", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  void do_first(const std::string& text) {
    const Finished done = send(text);
    ASSERT_EQ(done.status, 0) << done.err;
  }
  void expect_refused(const Finished& ended, const std::string& what) {
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("q.ngc:" + what));
    EXPECT_THAT(ended.err, HasSubstr("nothing was sent"));
  }
  double x() {
    const Finished done = send("G4 P0.01\n");
    return done.status == 0 ? nlohmann::json::parse(done.out)["position"][0].get<double>() : -1e9;
  }

  Folder folder_;
  Running board_{{"sim", "--pty", folder_ / "port"}};
};

TEST_F(SendToBoard, NothingIsBegunThatLeavesTheWorkSpace) {
  expect_refused(send("G21 G90\nG1 X1 F1000\nG1 X60\n"), "3: X 60.000 mm is outside");
  EXPECT_EQ(x(), 0);
  do_first("G10 L2 P1 X20\n");
  expect_refused(send("G21 G90\nG0 X35\n"), "2: X 55.000 mm is outside");
  expect_refused(send("G21 G90\nG0 X1\nG0 X2\nX35\n", {"--from", "3"}), "4: X 55.000");
  do_first("G21 G90\nG0 X-60\n");
  EXPECT_NEAR(x(), -40, 0.01);
  expect_refused(send("G91\nG0 X-11\n"), "2: X -51.000 mm is outside");
  do_first("G92 X0\n");
  expect_refused(send("G90 G0 X91\n"), "1: X 51.000 mm is outside");
}

TEST_F(SendToBoard, TheCheckBeginsWithTheStateOfTheBoard) {
  do_first("G21 G90\nG1 X10 F3000\n");
  do_first("G2 X20 Y0 R5\n");
  do_first("X15 Y5 R5\nG91 G1 X1\n");
  EXPECT_NEAR(x(), 16, 0.01);
  do_first("X1\nG20\n");
  EXPECT_NEAR(x(), 17, 0.01);
  expect_refused(send("G90 G0 X2\n"), "1: X 50.800 mm is outside");
  do_first("G93\n");
  expect_refused(send("G1 X0\n"), "1:1: error:22 the feed is zero");
}

/// The tool of the last T is not the one in the spindle before an M6.
TEST_F(SendToBoard, ValuesAreThoseOfTheToolInTheSpindle) {
  do_first("G10 L1 P1 Z5 R1\nG10 L1 P2 Z20 R1\nM61 Q1\nG0 Z0\n");
  do_first("T2\nG0 X0\nM2\n");
  const std::string print = "G43\n(PRINT, tool %d#5400 length %d#5403)\n";
  EXPECT_THAT(send(print + "G49\nM2\n").err, HasSubstr("tool 1 length 5"));
  EXPECT_THAT(send("o1 if [#5400 EQ 1]\n" + print + "o1 endif\nG49\nM2\n").err,
              HasSubstr("tool 1 length 5"));
}

TEST_F(SendToBoard, TheMiddleHasTheToolOfTheLinesBefore) {
  do_first("G10 L1 P1 Z5 R1\nG10 L1 P2 Z20 R1\nM61 Q1\n");
  const std::string text =
      "G21 G90\nM61 Q2\nG0 X0 Y0 Z1\nG1 X10 F600\n(PRINT, tool %d#5400)\nG43\nG0 Z1\nM2\n";
  const Finished part = send(text, {"--from", "4"});
  EXPECT_EQ(part.status, 0) << part.err;
  EXPECT_THAT(part.err, HasSubstr("tool 2"));
  EXPECT_NEAR(nlohmann::json::parse(part.out)["position"][2].get<double>(), 21, 0.01);
}

/// A program without M2 leaves its parameters on the board.
TEST_F(SendToBoard, ParametersOfAnEarlierProgramAreCleared) {
  do_first("G21 G90\n#1=40 #<wide>=3\nG1 X1 F600\n");
  do_first("G21 G90\nG1 X[#1 + 2] F600\n");
  EXPECT_NEAR(x(), 2, 0.01);
  do_first("#1=40\nM70\n");
  do_first("G0 X[1 + EXISTS[#<wide>]]\n");
  EXPECT_NEAR(x(), 1, 0.01);
  EXPECT_EQ(send("G0 X#1\nM72\n").status, 2);
}

TEST(SendProgram, lines_after_its_end_are_checked) {
  const Folder folder;
  const std::string file = folder.write("a.ngc", "G21\nM30\nG1 X1 X2 F100\n");
  const Finished refused = run({"send", file, "--board", "virtual"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("a.ngc:3:7: error:25 the word occurs twice"));
}

TEST(SendProgram, lines_for_the_board_are_refused_beforehand) {
  const Folder folder;
  for (const char* line : {"$bogus", "$20=0", "$J=G91 X1 F100", "$HXY"}) {
    const std::string file = folder.write("a.ngc", std::string("G21\n") + line + "\nG4 P0.01\n");
    const Finished refused = run({"send", file, "--board", "virtual"});
    EXPECT_EQ(refused.status, 2) << line;
    EXPECT_THAT(refused.err, HasSubstr("a.ngc:2: '" + std::string(line) + "' must not be"));
  }
  const std::string asks = folder.write("b.ngc", "$X\nG21\n$G\nG4 P0.01\n");
  EXPECT_EQ(run({"send", asks, "--board", "virtual"}).status, 0);
  const std::string alone = folder.write("c.ngc", "$20=0\n$130=90\n");
  EXPECT_EQ(run({"send", alone, "--board", "virtual"}).status, 0);
  const std::string wrong = folder.write("d.ngc", "G21\n$bogus\n");
  const Finished sent = run({"send", wrong, "--board", "virtual", "--ignore-errors"});
  EXPECT_EQ(sent.status, 1);
  EXPECT_THAT(sent.err, HasSubstr("d.ngc:2: error:3 "));
}

TEST(SendProgram, a_board_without_a_state_report_checks_its_work_area) {
  const Folder folder;
  std::string text;
  for (int i = 0; i < 1500; ++i) text += "G0 X60\n";
  const std::string far = folder.write("far.ngc", "G0 X60\nG0 X61\n");
  const std::string wrong = folder.write("wrong.ngc", text + "G0 X1 X2\n");
  auto model = std::make_unique<GrblModel>();
  model->settings[20] = "1";
  Served board(std::move(model));
  const Finished refused = run({"send", wrong, "--board", board.address(), "--yes"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("wrong.ngc:1501:7: "));
  const Finished done = run({"send", far, "--board", board.address(), "--yes"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(board.stop().lines,
            (std::vector<std::string>{"$#", "$G", "$#", "$G", "G0 X60", "G0 X61"}));
}

}  // namespace
}  // namespace lamplock::cli::test
