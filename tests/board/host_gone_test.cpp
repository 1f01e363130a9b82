// When the host is gone, it cannot stop its machine: motion is held, dark, within braking time and
// 30 ms. A host that was silent for longer than its setting counts as gone.

#include <string>

#include "tests/board/program_host.hpp"

namespace lamplock::test::host_gone_test {
namespace {

/// Braking from 50 mm/s at 2 m/s2, ticks handed out ahead, and a round of the main loop.
constexpr Picoseconds at_rest_within = (25 + 30) * ps_per_ms;

class HostGone : public testing::Test {
 protected:
  HostGone() {
    profile_.settings.set_milli(Id::laser_mode, 1000);
    set_up();
  }
  void set_up() {
    host_.reset();
    rig_ = std::make_unique<Rig>(profile_);
    host_ = std::make_unique<ProgramHost>(*rig_);
  }
  void set(Id id, double value) { job::state_setting(profile_, id, value, "test"); }
  void leave() {
    left_ = now();
    rig_->board.set_host_present(false);
  }
  Picoseconds now() const { return rig_->now(); }
  bool moves() const { return rig_->monitor.stepped(now() - 10 * ps_per_ms, now()); }
  void expect_rest() {
    rig_->run(ps_per_s);
    EXPECT_FALSE(rig_->monitor.stepped(left_ + at_rest_within, now()));
    EXPECT_FALSE(rig_->board.world().beam().shone(left_ + at_rest_within, now()));
    EXPECT_EQ(rig_->monitor.violation(profile_.settings), "");
  }

  job::Profile profile_ = program_profile();
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<ProgramHost> host_;
  Picoseconds left_ = 0;
};

constexpr std::string_view long_program = "M3 S500\nG1 X40 F3000\nX0\n";

TEST_F(HostGone, AProgramIsHeldUntilTheUserResumesIt) {
  host_->send(long_program);
  host_->run_ms(300);
  ASSERT_TRUE(moves());
  leave();
  expect_rest();
  EXPECT_EQ(rig_->state(), MachineState::hold);
  rig_->board.set_host_present(true);
  host_->run_ms(10);
  EXPECT_TRUE(host_->has_said("[MSG:Host lost: program held]"));
  EXPECT_EQ(rig_->state(), MachineState::hold);
  host_->send("~");
  EXPECT_TRUE(host_->wait_for_rest(5));
  EXPECT_EQ(host_->position()[0], 0);
}

TEST_F(HostGone, ACompletelyReceivedProgramMayContinue) {
  set(Id::run_on, 1);
  const std::pair<std::string, bool> ends[] = {
      {"", false},           {"M5\n", false},  {"G4 P0 (M2)\n", false},
      {"; M30\n", false},    {"M20\n", false}, {"M2\n", true},
      {"g0 x1 m30\n", true}, {"M02\n", true},  {"(x)M 30\n", true}};
  for (const auto& [end, whole] : ends) {
    SCOPED_TRACE(end);
    set_up();
    host_->send(std::string(long_program) + end);
    host_->run_ms(300);
    ASSERT_TRUE(moves());
    leave();
    rig_->run(3 * ps_per_s);
    EXPECT_EQ(rig_->state(), whole ? MachineState::idle : MachineState::hold);
    EXPECT_EQ(moves(), false);
  }
}

TEST_F(HostGone, AJogEnds) {
  host_->send("$J=X40 F3000\n$J=X0 F3000\n");
  host_->run_ms(300);
  ASSERT_TRUE(moves());
  leave();
  expect_rest();
  EXPECT_EQ(rig_->state(), MachineState::idle);
}

TEST_F(HostGone, AMachineAtRestStaysAsItIs) {
  host_->send("G1 X1 F3000\n");
  ASSERT_TRUE(host_->wait_for_rest());
  leave();
  rig_->run(ps_per_s);
  EXPECT_EQ(rig_->state(), MachineState::idle);
  rig_->board.set_host_present(true);
  host_->ask("G1 X0\n");
  EXPECT_TRUE(host_->wait_for_rest(1));
  EXPECT_EQ(host_->position()[0], 0);
}

TEST_F(HostGone, PointsAreNotFiredAnyMore) {
  host_->send("M3 S500\nM130 P0\nG1 F600\n");
  for (int i = 1; i <= 60; ++i) host_->send(i % 2 == 0 ? "X0.1\n" : "X0\n");
  host_->run_ms(300);
  const std::size_t fired = rig_->shots().size();
  ASSERT_GT(fired, 0u);
  leave();
  rig_->run(2 * ps_per_s);
  EXPECT_EQ(rig_->state(), MachineState::hold);
  EXPECT_EQ(rig_->monitor.fired(left_ + 2 * ps_per_ms, now()), 0u);
  rig_->board.set_host_present(true);
  host_->send("~");
  EXPECT_TRUE(host_->wait_for_rest(5));
  EXPECT_EQ(rig_->shots().size(), 60u);
}

TEST_F(HostGone, ASilentSendersProgramIsHeldIfSet) {
  set(Id::program_dead_man, 500);
  set_up();
  host_->send("M3 S500\nG1 X40 F600\n");
  for (int i = 0; i < 8; ++i) {
    host_->run_ms(200);
    EXPECT_THAT(host_->status(), StartsWith("<Run")) << "the host polls";
  }
  left_ = now() + 500 * ps_per_ms;
  rig_->run(400 * ps_per_ms);
  EXPECT_TRUE(moves());
  expect_rest();
  EXPECT_EQ(rig_->state(), MachineState::hold);
}

TEST_F(HostGone, AJogEndsWithItsLease) {
  set(Id::jog_lease, 250);
  set_up();
  host_->send("$J=X20 F600\n");
  host_->run_ms(200);
  EXPECT_TRUE(moves());
  left_ = now() + 60 * ps_per_ms;
  expect_rest();
  EXPECT_EQ(rig_->state(), MachineState::idle);
  // A renewed jog continues.
  for (int i = 0; i < 20; ++i) {
    host_->send("$J=G91 X-0.5 F600\n");
    host_->run_ms(45);
  }
  EXPECT_TRUE(moves());
}

}  // namespace
}  // namespace lamplock::test::host_gone_test
