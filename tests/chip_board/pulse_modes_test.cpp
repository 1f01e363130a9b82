// The flash image with drives of every kind: no pulse that a drive would lose, the same steps at
// the same ticks as on the virtual board, and an e-stop that keeps the position.
#include <fmt/format.h>

#include <random>

#include "sim/virtual_board/virtual_board.hpp"
#include "tests/board/step_log.hpp"
#include "tests/board/turning_job.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_sender.hpp"
#include "tests/chip_board/program_trace.hpp"

namespace lamplock::test::pulse_modes_test {
namespace {

using settings::PulseMode;
using testing::HasSubstr;

struct Pulses {
  const char* name;
  PerAxis<PulseMode> modes;
  int step_invert, direction_invert;
  std::int32_t setup_ns, hold_ns;
};
constexpr PulseMode step_dir = PulseMode::step_dir, cw_ccw = PulseMode::cw_ccw,
                    quadrature = PulseMode::quadrature;
constexpr Pulses kinds[] = {
    {"step_dir", {step_dir, step_dir, step_dir, step_dir}, 0b0010, 0b0100, 5'000, 20'000},
    {"cw_ccw", {cw_ccw, cw_ccw, cw_ccw, cw_ccw}, 0b0011, 0b0101, 200, 200},
    {"quadrature", {quadrature, quadrature, quadrature, quadrature}, 0b0001, 0b0010, 2'000, 1'000},
    {"mixed", {quadrature, step_dir, cw_ccw, step_dir}, 0, 0, 20'000, 5'000},
};

class PulseModes : public testing::TestWithParam<Pulses> {
 protected:
  static job::Profile profile(const Pulses& pulses) {
    job::Profile profile = chip_profile(1000);
    let_speed_jump(profile);
    set_pulses(profile.settings, pulses.modes, pulses.step_invert, pulses.direction_invert,
               pulses.setup_ns, pulses.hold_ns);
    return profile;
  }
};

/// A long move first, as in program_ticks_test.cpp; then back and forth.
std::string zigzag(unsigned seed, int lines) {
  std::mt19937_64 random(seed);
  const auto pick = [&random](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  std::string text = "G21 G91 G1 F6000\nX6 Y-4 Z1\n";
  int way = -1;
  for (int i = 0; i < lines; ++i, way = -way)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", way * pick(0, 0.3), -way * pick(-0.05, 0.3),
                        pick(-0.05, 0.05));
  return text;
}

struct ProgramRun {
  ProgramTrace trace;
  bool ended = false;
};

ProgramRun run(sim::Board& board, const StepLog& log, const std::string& text) {
  ProgramSender sender(board);
  sender.give(text);
  const Picoseconds end = board.now() + 20 * ps_per_s;
  ProgramRun result;
  result.ended = sender.run_until_answered(end) && sender.run_until_idle(end);
  board.run_until(board.now() + 5 * ps_per_ms);  // until the ticks handed out are over
  EXPECT_EQ(sender.errors(), 0u) << sender.heard();
  result.trace.steps = log.steps();
  result.trace.end = board.now();
  return result;
}

TEST_P(PulseModes, StepAsOnTheVirtualBoardAndKeepTheDrivesTimes) {
  job::Profile machine = profile(GetParam());
  // Without a lamp, whose lock would adjust the ticks of each board differently.
  job::state_setting(machine, Id::lamp_mode, 0, "test");
  const std::string text = zigzag(1, scaled(60));
  sim::VirtualBoard board(machine.settings, chip_world(machine));
  const StepLog our_log(machine.settings, board.bus());
  const ProgramRun ours = run(board, our_log, text);
  ChipRig rig(machine);
  const StepLog their_log(machine.settings, rig.board.bus());
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  EXPECT_EQ(their_log.total(), 0u) << "the start must not make a step";
  const ProgramRun theirs = run(rig.board, their_log, text);
  ASSERT_TRUE(ours.ended && theirs.ended);
  const TraceComparison steps(ours.trace, theirs.trace, true);
  EXPECT_EQ(steps.difference(), "");
  EXPECT_EQ(steps.steps(), ours.trace.total());
  EXPECT_EQ(steps.largest_step_error(), 0);
  EXPECT_EQ(steps.stretches().size(), 1u);
  EXPECT_GT(our_log.reversals(0).size(), 10u);
  EXPECT_EQ(board.world().drives().total_faults(), 0u);
  EXPECT_EQ(rig.board.world().drives().position(), board.world().drives().position());
  expect_no_violations(rig);
}

TEST_P(PulseModes, JobsHitTheirPointsAndAnEmergencyStopKeepsThePlace) {
  const job::Profile machine = profile(GetParam());
  ChipRig rig(machine);
  const StepLog log(machine.settings, rig.board.bus());
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  std::mt19937_64 random(5);
  const int rounds = scaled(3);
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    RunningJob running(rig, turning_job(machine, random()), static_cast<std::uint32_t>(round + 1));
    const std::size_t before = rig.shots().size();
    ASSERT_TRUE(running.run_until_fired(30 + random() % 30));
    for (std::size_t i = before; i < rig.shots().size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(rig.shots()[i].steps[axis], running.job.targets[i - before].steps[axis]) << i;
    // Motion reverses at the beats: the e-stop comes soon after one.
    const Picoseconds pressed = rig.shots().at(rig.shots().size() - 1).at + 3 * ps_per_ms +
                                static_cast<Picoseconds>(random() % 60) * ps_per_us;
    ASSERT_GT(pressed, rig.now());
    rig.board.world().schedule(sim::Pin::estop, true, pressed);
    rig.board.world().schedule(sim::Pin::estop, false, pressed + 5 * ps_per_ms);
    rig.board.run_until(pressed + 10 * ps_per_us);
    const StepPosition stopped = rig.board.world().drives().position();
    EXPECT_EQ(running.finish(), link::JobEnd::alarm);
    rig.run(60 * ps_per_ms);
    EXPECT_EQ(rig.board.world().drives().position(), stopped);
    EXPECT_EQ(rig.reported_position(machine.settings), stopped);
    EXPECT_EQ(rig.answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  }
  EXPECT_GT(log.reversals(0).size(), 30u * static_cast<unsigned>(rounds));
  expect_no_violations(rig);
}

/// Low while the board does not drive the pad: with a pull-down that is off.
TEST(DrivesEnable, IsActiveHighIfTheSettingsSaySo) {
  constexpr unsigned pad = boards::gpio(boards::Role::drives_enable);
  for (const bool active_high : {false, true}) {
    job::Profile machine = chip_profile();
    machine.settings.set_milli(Id::enable_invert, active_high ? 1000 : 0);
    ChipRig rig(machine);
    ASSERT_NO_FATAL_FAILURE(rig.boot());
    const auto level = [&rig] { return (rig.board.chip().gpio().pad_levels() >> pad & 1) != 0; };
    EXPECT_EQ(level(), active_high);
    EXPECT_TRUE(rig.board.bus().level(sim::Pin::enable));
    EXPECT_EQ(rig.answer(active_high ? "$4=0" : "$4=1"), "ok\r\n");
    rig.run(20 * ps_per_ms);
    EXPECT_EQ(level(), active_high) << "must apply from the next start on";
    rig.board.world().schedule(sim::Pin::estop, true, rig.now());
    rig.run(20 * ps_per_ms);
    EXPECT_EQ(level(), !active_high);
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::enable));
  }
}

void PrintTo(const Pulses& pulses, std::ostream* out) { *out << pulses.name; }

INSTANTIATE_TEST_SUITE_P(Drives, PulseModes, testing::ValuesIn(kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace lamplock::test::pulse_modes_test
