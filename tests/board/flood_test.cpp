// Stops work however much a host has sent before them, whether or not it reads the answers.

#include <string>

#include "tests/board/program_host.hpp"

namespace lamplock::test::flood_test {
namespace {

/// Period in which the board polls its bytes and writes the laser's state to the pad.
constexpr Picoseconds dark_within = ps_per_ms;
/// Braking from 50 mm/s at 2 m/s2, ticks handed out ahead, and a round of the main loop.
constexpr Picoseconds at_rest_within = (25 + 30) * ps_per_ms;

struct Flood {
  std::size_t bytes;
  bool reads;
};

class Flooded : public testing::TestWithParam<Flood> {
 protected:
  static job::Profile profile() {
    job::Profile profile = program_profile();
    profile.settings.set_milli(Id::laser_mode, 1000);
    return profile;
  }
  /// Reaches 50 mm/s on the first line, which lasts 0.8 s; slow lines of `kind` wait after it.
  void run_into(std::string_view first, std::string_view kind) {
    host_.send(first);
    std::string flood;
    while (flood.size() < GetParam().bytes) flood += kind;
    write(flood);
    pass(300 * ps_per_ms);
    ASSERT_TRUE(rig_.monitor.stepped(now() - 10 * ps_per_ms, now()));
  }
  void write(std::string_view bytes) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    ASSERT_EQ(rig_.board.write({data, bytes.size()}), bytes.size());
  }
  void pass(Picoseconds time) {
    if (GetParam().reads)
      host_.run(time);
    else
      rig_.run(time);
  }
  Picoseconds now() const { return rig_.now(); }
  /// Sends the byte; the machine must come to rest and stay there.
  void stop_by(char byte) {
    stopped_ = now();
    write(std::string(1, byte));
    pass(2 * ps_per_s);
    EXPECT_FALSE(rig_.monitor.stepped(stopped_ + at_rest_within, now()));
    EXPECT_EQ(rig_.monitor.violation(profile().settings), "");
  }
  bool shone_since(Picoseconds from) { return rig_.board.world().beam().shone(from, now()); }

  Rig rig_{profile()};
  ProgramHost host_{rig_};
  Picoseconds stopped_ = 0;
};

constexpr std::string_view program = "M3 S500\nG1 X40 F3000\n";
constexpr std::string_view slow_lines = "G1 X0.1 F60\nG1 X0 F60\n";

TEST_P(Flooded, AResetDarkensStopsAndDiscards) {
  ASSERT_NO_FATAL_FAILURE(run_into(program, slow_lines));
  stop_by(0x18);
  EXPECT_FALSE(shone_since(stopped_ + dark_within));
  EXPECT_EQ(rig_.state(), MachineState::alarm);  // it moved
  host_.run_ms(100);
  EXPECT_TRUE(host_.has_said("Grbl 1.1h ['$' for help]"));
  host_.ask("$X\n");
  const StepPosition at = host_.position();
  EXPECT_THAT(host_.ask("G91 G1 X1 F600\n"), ElementsAre("ok"));
  EXPECT_TRUE(host_.wait_for_rest(1));
  EXPECT_EQ(host_.position()[0] - at[0], 200);
}

TEST_P(Flooded, AHoldHoldsAndResumes) {
  ASSERT_NO_FATAL_FAILURE(run_into(program, slow_lines));
  stop_by('!');
  EXPECT_EQ(rig_.state(), MachineState::hold);
  write("~");
  const Picoseconds resumed = now();
  pass(10 * ps_per_ms);
  EXPECT_TRUE(rig_.monitor.stepped(resumed, now()));
}

TEST_P(Flooded, ADoorByteOpensTheDoor) {
  ASSERT_NO_FATAL_FAILURE(run_into(program, slow_lines));
  stop_by('\x84');
  EXPECT_EQ(rig_.state(), MachineState::door);
}

TEST_P(Flooded, JogsEndAndWaitingJogsAreDropped) {
  ASSERT_NO_FATAL_FAILURE(run_into("$J=X40 F3000\n", "$J=G91 X0.1 F60\n"));
  stop_by('\x85');
  EXPECT_EQ(rig_.state(), MachineState::idle);
  // Each jog is answered, and a jog that is sent now runs.
  const auto jogs = 1 + (GetParam().bytes + 15) / 16;
  for (int i = 0; i < 100'000 && host_.answers().size() < jogs; ++i) host_.run_ms(1);
  EXPECT_EQ(host_.answers().size(), jogs);
  const StepPosition at = host_.position();
  EXPECT_THAT(host_.ask("$J=G91 X1 F600\n"), ElementsAre("ok"));
  EXPECT_TRUE(host_.wait_for_rest(1));
  EXPECT_EQ(host_.position()[0] - at[0], 200);
}

TEST_P(Flooded, AStatusIsAnswered) {
  ASSERT_NO_FATAL_FAILURE(run_into(program, slow_lines));
  write("?");
  pass(5 * ps_per_ms);
  host_.run_ms(0);
  const auto& said = host_.said();
  EXPECT_TRUE(std::any_of(said.begin(), said.end(),
                          [](const std::string& line) { return line.starts_with("<Run"); }));
}

INSTANTIATE_TEST_SUITE_P(Bytes, Flooded,
                         testing::Values(Flood{0, true}, Flood{1000, true}, Flood{9000, true},
                                         Flood{1'000'000, true}, Flood{0, false},
                                         Flood{9000, false}, Flood{1'000'000, false}),
                         [](const auto& flood) {
                           return std::to_string(flood.param.bytes) +
                                  (flood.param.reads ? "Read" : "Unread");
                         });

}  // namespace
}  // namespace lamplock::test::flood_test
