// Actions between jobs: `lamplock operate` with a simulated machine at a port.
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/program.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::MatchesRegex;

using Place = std::vector<double>;

/// A machine that gets one command after the other.
class Operate : public testing::Test {
 protected:
  Operate() : sim_({"sim", "--pty", port_, "--shots", folder_ / "shots.csv"}) {}

  void SetUp() override { ASSERT_TRUE(sim_.wait_for("listening")); }

  Finished operate(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "operate");
    arguments.insert(arguments.end(), {"--board", port_, "--json"});
    return run(arguments);
  }
  /// The places that the command prints.
  json places(const std::vector<std::string>& arguments) const {
    const Finished done = operate(arguments);
    EXPECT_EQ(done.status, 0) << done.err;
    return json::parse(done.out);
  }
  void go(const std::string& line) const {
    const Finished done = run({"console", "--board", port_}, line + "\nG4 P0\n");
    EXPECT_EQ(done.status, 0) << done.out << done.err;
  }
  std::size_t shots() {
    sim_.interrupt();
    EXPECT_EQ(sim_.finish().status, 0);
    return read_shots(folder_ / "shots.csv").size();
  }

  Folder folder_;
  std::string port_ = folder_ / "port";
  Running sim_;
};

TEST_F(Operate, teaches_zero_and_goes_there) {
  go("G0 X5 Y6 Z-7");
  EXPECT_EQ(places({"zero", "--axes", "XY"})["zero_mm"], (Place{5, 6, 0}));
  go("G53 G0 X1 Y2 Z3");
  EXPECT_EQ(places({"init"})["machine_mm"], (Place{5, 6, 0}));
  go("G53 G0 X1 Y2 Z3");
  EXPECT_EQ(places({"zero"})["zero_mm"], (Place{1, 2, 3}));
  EXPECT_EQ(shots(), 0u);
}

/// Homing ignores holds: only a reset stops an axis whose switch does not engage.
TEST_F(Operate, stops_when_it_is_interrupted_homing_too) {
  go("$22=1\n$25=60");
  // On a busy computer the program has not begun after a second: it is interrupted later then.
  std::string why;
  for (int seconds = 1; seconds <= 16 && why.empty(); seconds *= 2) {
    Running homing({"operate", "home", "--board", port_, "--json"});
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
    homing.interrupt();
    const Finished ended = homing.finish();
    EXPECT_EQ(ended.status, 130);
    why = ended.err;
  }
  EXPECT_THAT(why, HasSubstr("reset during homing"));
  EXPECT_THAT(run({"console", "--board", port_}, "?\n").out, HasSubstr("<Alarm|"));
}

TEST_F(Operate, points_are_engraved_at_the_taught_zero) {
  go("G0 X5 Y-6 Z-7");
  (void)places({"zero"});
  const std::string list = folder_.write("p.xyz", "1 2 3\n1.5 2 3\n");
  const Finished done = run({"engrave", list, "--origin", "zero", "--board", port_, "--yes"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(run({"frame", list, "--origin", "zero", "--board", port_}).status, 0);
  EXPECT_EQ(places({"status"})["machine_mm"], (Place{6, -4, -4}));
  const std::string far = folder_.write("far.xyz", "46 2 3\n");
  const Finished outside = run({"engrave", far, "--origin", "zero", "--board", port_, "--yes"});
  EXPECT_EQ(outside.status, 2);
  EXPECT_THAT(outside.err, HasSubstr("x -55..45"));
  sim_.interrupt();
  EXPECT_EQ(sim_.finish().status, 0);
  const auto shots = read_shots(folder_ / "shots.csv");
  ASSERT_EQ(shots.size(), 2u);
  EXPECT_EQ(shots[0], (geometry::Point{6, -4, -4}));
  EXPECT_EQ(shots[1], (geometry::Point{6.5, -4, -4}));
}

TEST_F(Operate, changes_the_glass_and_returns_to_its_place) {
  go("G0 X20 Y12 Z-7");
  EXPECT_EQ(places({"sample", "--teach"})["sample_mm"], (Place{20, 12, -7}));
  go("G0 X6 Y8");
  EXPECT_EQ(places({"sample"})["machine_mm"], (Place{20, 12, -7}));
  // The same command again keeps the stored place.
  EXPECT_EQ(places({"sample"})["restore_mm"], (Place{6, 8, -7}));
  EXPECT_EQ(places({"restore"})["machine_mm"], (Place{6, 8, -7}));
  EXPECT_EQ(shots(), 0u);
}

/// Also from zero and from the sample position, never to a place that was stored long ago.
TEST_F(Operate, returns_to_the_place_before_the_last_move) {
  const Place there{20, 12, -7}, sample{5, 6, 7};
  go("G0 X5 Y6 Z7");
  (void)places({"sample", "--teach"});
  go("G0 X20 Y12 Z-7");
  (void)places({"zero"});
  EXPECT_EQ(places({"sample"})["machine_mm"], sample);
  EXPECT_EQ(places({"restore"})["machine_mm"], there);
  EXPECT_EQ(places({"sample"})["machine_mm"], sample);
  EXPECT_EQ(places({"init"})["machine_mm"], there);
  EXPECT_EQ(places({"restore"})["machine_mm"], sample);
}

TEST_F(Operate, fires_test_flashes_at_its_place_when_permitted) {
  go("G0 X6 Y8 Z-1");
  const Finished refused = operate({"pulse", "--flashes", "3"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--yes"));
  EXPECT_EQ(operate({"pulse", "--flashes", "2", "--dry"}).status, 0);
  EXPECT_EQ(operate({"pulse", "--flashes", "3", "--channel", "1", "--yes"}).status, 0);
  EXPECT_EQ(places({"status"})["machine_mm"], (Place{6, 8, -1}));
  sim_.interrupt();
  EXPECT_EQ(sim_.finish().status, 0);
  const std::string csv = read(folder_ / "shots.csv");
  const std::vector<std::string> rows = lines(csv);
  ASSERT_EQ(rows.size(), 4u) << csv;
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_THAT(rows[i], MatchesRegex("[0-9],1,[0-9]+,[0-9.]+,6,8,-1"));
}

/// Places in inches read as mm would move it; with G92, zero would be taught elsewhere.
TEST_F(Operate, does_not_move_to_misread_places) {
  go("G0 X9 Y2 Z-3");
  go("G92 X0");
  for (const char* what : {"zero", "init"}) {
    const Finished shifted = operate({what});
    EXPECT_EQ(shifted.status, 2) << what;
    EXPECT_THAT(shifted.err, HasSubstr("G92.1"));
  }
  go("G92.1");
  go("$13=1");
  for (const std::vector<std::string>& what :
       {std::vector<std::string>{"pulse", "--yes"}, {"init"}, {"status"}}) {
    const Finished inches = operate(what);
    EXPECT_EQ(inches.status, 2) << what[0];
    EXPECT_THAT(inches.err, HasSubstr("$13=0"));
  }
  go("$13=0");
  EXPECT_EQ(places({"status"})["machine_mm"], (Place{9, 2, -3}));
  EXPECT_EQ(shots(), 0u);
}

TEST_F(Operate, meshes_lie_around_the_taught_zero) {
  go("G0 X20 Y-10 Z5");
  (void)places({"zero"});
  const std::string model = folder_ / "m.stl";
  ASSERT_EQ(run({"example", model}).status, 0);
  const Finished done = run({"engrave", model, "--size", "8", "--spacing", "2", "--origin", "zero",
                             "--board", port_, "--yes"});
  EXPECT_EQ(done.status, 0) << done.err;
  sim_.interrupt();
  EXPECT_EQ(sim_.finish().status, 0);
  const auto shots = read_shots(folder_ / "shots.csv");
  ASSERT_GT(shots.size(), 10u);
  for (const auto& p : shots) {
    EXPECT_NEAR(p.x, 20, 4.01);
    EXPECT_NEAR(p.y, -10, 4.01);
    EXPECT_NEAR(p.z, 5, 4.01);
  }
}

TEST(OperateFourAxes, a_test_flash_moves_no_axis) {
  const Folder folder;
  const std::string port = folder / "port";
  const std::string machine = folder.write("m.toml", "axes = 4\ntravel = [100, 100, 100, 100]\n");
  Running sim({"sim", "--pty", port, "--machine", machine});
  ASSERT_TRUE(sim.wait_for("listening"));
  ASSERT_EQ(run({"console", "--board", port}, "G0 X10 A20\nG4 P0\n").status, 0);
  EXPECT_EQ(run({"operate", "pulse", "--yes", "--board", port}).status, 0);
  const Finished status = run({"operate", "status", "--json", "--board", port});
  EXPECT_EQ(json::parse(status.out)["machine_mm"], (Place{10, 0, 0, 20}));
}

TEST_F(Operate, a_job_that_cannot_end_does_not_begin) {
  std::string list;
  for (int i = 0; i < 600; ++i) list += std::to_string(i % 10 * 0.01) + " 0 0\n";
  list += "45 45 45\n";
  const Finished failed = run({"engrave", folder_.write("far.xyz", list), "--lamp", "1000",
                               "--speed", "0.004", "--board", port_, "--yes"});
  EXPECT_EQ(failed.status, 2);
  EXPECT_THAT(failed.err, HasSubstr("point 600: cannot be reached"));
  EXPECT_EQ(shots(), 0u);
}

TEST_F(Operate, refuses_what_it_cannot_do_in_one_line) {
  const auto expect = [](const Finished& failed, int status, const char* what) {
    EXPECT_EQ(failed.status, status);
    EXPECT_THAT(failed.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(failed.err, HasSubstr(what));
  };
  expect(operate({"zero", "--axes", "XQ"}), 2, "no axis 'Q'");
  expect(operate({"zero", "--axes", "XYX"}), 2, "twice");
  expect(operate({"home"}), 2, "lamplock settings set homing=1");
  expect(operate({"pulse", "--channel", "5"}), 2, "--channel");
  expect(run({"operate"}), 2, "a command is missing");
  expect(run({"operate", "init", "--board", folder_ / "none"}), 3, "there is no such port");
  go("G0 X1");
  ASSERT_EQ(run({"console", "--board", port_}, ":reset\n").status, 0);
  EXPECT_EQ(places({"status"})["machine_mm"], (Place{1, 0, 0}));
}

TEST_F(Operate, is_refused_in_an_alarm_and_while_something_runs) {
  Running program({"console", "--board", port_}, "G1 X40 F60\n!\n?\n");
  ASSERT_TRUE(program.wait_for("Hold"));
  (void)program.finish();
  const Finished busy = operate({"init"});
  EXPECT_EQ(busy.status, 2);
  EXPECT_THAT(busy.err, HasSubstr("is held"));
}

}  // namespace
}  // namespace lamplock::cli::test
