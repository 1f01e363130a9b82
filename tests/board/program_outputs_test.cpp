// Outputs and inputs of programs on the virtual board: each output changes at the tick where its
// line begins, programs wait for inputs, and outputs go off when a program ends.
#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <random>

#include "shared/boards/all_boards.hpp"
#include "tests/board/program_host.hpp"
#include "tests/paths.hpp"

namespace lamplock::test::program_outputs_test {
namespace {

using sim::Pin;

constexpr std::int32_t steps_per_mm = 200;
constexpr std::uint8_t reset_byte = 0x18, flood_byte = 0xa0, mist_byte = 0xa1;
constexpr std::uint16_t full = 65535;

/// The tick at which Y begins to move.
class BeginOfY final : public sim::TickListener {
 public:
  void ticks_played(const sim::PlayedTicks& ticks) override {
    const bool moves = ticks.block.moving && !ticks.block.axis[1].is_at_rest();
    if (moves && !moved_) begins.push_back(ticks.start);
    moved_ = moves;
  }
  void beat_begins(std::uint64_t /*tick*/, Picoseconds /*at*/) override {}
  std::vector<Picoseconds> begins;

 private:
  bool moved_ = false;
};

job::Profile profile_with(boards::PinMap map) {
  job::Profile profile = program_profile();
  profile.settings.set_milli(Id::laser_mode, 1000);
  profile.settings.set_milli(Id::pin_map, static_cast<int>(map) * 1000);
  return profile;
}

/// A board with outputs, its host and its wires.
struct Machine {
  explicit Machine(const job::Profile& profile, const sim::WorldConfig& world)
      : rig(profile.settings, world) {
    rig.board.listen(begin_of_y);
    host.run_ms(5);
  }
  explicit Machine(boards::PinMap map = boards::PinMap::cut_io)
      : Machine(profile_with(map), world_for(profile_with(map))) {}

  /// Position of the load of X at an edge.
  std::int32_t x_at(const EdgeLog::Edge& edge) const { return rig.monitor.position_at(0, edge.at); }
  bool is_high(Pin pin) { return rig.board.bus().level(pin); }
  bool aux() { return is_high(Pin::aux_out); }
  bool air() { return is_high(Pin::air); }
  void set(Pin pin, bool level) {
    rig.set(pin, level);
    host.run_ms(2);
  }
  void ask_ok(std::string_view lines, double seconds = 30) {
    const std::size_t before = host.answers().size();
    host.ask(lines, seconds);
    const std::vector<std::string> answers(
        host.answers().begin() + static_cast<std::ptrdiff_t>(before), host.answers().end());
    EXPECT_THAT(answers, Each("ok")) << lines;
    EXPECT_EQ(answers.size(),
              static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n')));
  }

  Rig rig;
  ProgramHost host{rig};
  EdgeLog aux_edges{rig.board.bus(), Pin::aux_out}, air_edges{rig.board.bus(), Pin::air};
  BeginOfY begin_of_y;
};

// --- coolant ----------------------------------------------------------------------------------

TEST(Coolant, ChangesAtItsLineAndNotWhenItIsRead) {
  Machine m;
  ASSERT_TRUE(m.host.stream("G1 X5 F600\nM8\nG1 X10\nM9\nG1 X15\nM7\nG1 X20\nM2\n"));
  std::vector<std::int32_t> places;
  std::vector<bool> levels;
  for (const EdgeLog::Edge& edge : m.air_edges.edges()) {
    places.push_back(m.x_at(edge));
    levels.push_back(edge.level);
  }
  EXPECT_THAT(places, ElementsAre(5 * steps_per_mm, 10 * steps_per_mm, 15 * steps_per_mm,
                                  20 * steps_per_mm));
  EXPECT_THAT(levels, ElementsAre(true, false, true, false));
  EXPECT_THAT(m.host.ask("$G\n"), Contains(HasSubstr(" M9 ")));
}

TEST(Coolant, IsSwitchedByHandAtOnce) {
  Machine m;
  m.host.send(flood_byte);
  m.host.run_ms(1);
  EXPECT_TRUE(m.air());
  m.host.send(mist_byte);
  m.host.send(flood_byte);
  m.host.run_ms(1);
  EXPECT_TRUE(m.air());
  m.host.send(mist_byte);
  m.host.run_ms(1);
  EXPECT_FALSE(m.air());
}

TEST(Coolant, IsOffWhileTheDoorIsOpenAndOnAgainWithTheProgram) {
  Machine m;
  m.host.send("M8\nG1 X40 F600\n");
  m.host.run_ms(300);
  EXPECT_TRUE(m.air());
  m.set(Pin::door, true);
  EXPECT_FALSE(m.air());
  m.host.run_ms(200);
  m.set(Pin::door, false);
  EXPECT_FALSE(m.air());
  m.host.send("~");
  m.host.run_ms(5);
  EXPECT_TRUE(m.air());
  m.host.send("!");
  m.host.run_ms(100);
  EXPECT_TRUE(m.air());
}

// --- outputs ----------------------------------------------------------------------------------

TEST(ProgramOutputs, ChangeAtTheTickThatTheirLineBeginsWith) {
  Machine m;
  ASSERT_TRUE(m.host.stream("G1 X5 F3000\nM62 P0\nG1 Y5\nG1 X10\nM63 P0\nG1 Y10\nG0 X0\n"));
  std::vector<Picoseconds> edges;
  for (const EdgeLog::Edge& edge : m.aux_edges.edges()) edges.push_back(edge.at);
  EXPECT_EQ(edges, m.begin_of_y.begins);
  EXPECT_EQ(edges.size(), 2u);
}

TEST(ProgramOutputs, ChangeWithTheMotionHoweverItIsPlanned) {
  std::mt19937_64 random(8);
  const Pick<int> pick(random);
  for (int i = 0; i < scaled(20); ++i) {
    Machine m;
    std::string text = fmt::format("G91 M3 S{}\n", pick(0, 1) * 500);
    std::vector<std::int32_t> wanted;
    std::int32_t x = 0;
    bool on = false;
    for (int line = 0; line < 60; ++line) {
      if (pick(0, 2) == 0) {
        on = !on;
        text += fmt::format("M6{} P0\n", on ? 2 : 3);
        wanted.push_back(x);
        if (pick(0, 3) == 0) text += "G4 P0.01\n";
        if (pick(0, 3) == 0) text += "G1 X0 F1000\n";  // no motion
      }
      const int steps = pick(1, 150);
      x += steps;
      text += fmt::format("G1 X{} F{}\n", steps / 200.0, pick(1, 60) * 100);
    }
    ASSERT_TRUE(m.host.stream(text)) << m.host.status();
    ASSERT_EQ(m.aux_edges.edges().size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      EXPECT_EQ(m.aux_edges.edges()[k].level, k % 2 == 0);
      EXPECT_LE(std::abs(m.x_at(m.aux_edges.edges()[k]) - wanted[k]), 1) << "change " << k;
    }
    EXPECT_THAT(m.host.answers(), Each("ok"));
  }
}

TEST(ProgramOutputs, WaitForMotionAndTheLastOneCounts) {
  Machine m;
  m.ask_ok("M62 P0\nM63 P0\nM62 P0\nG4 P0.1\n");
  EXPECT_FALSE(m.aux());
  ASSERT_TRUE(m.host.wait_for_rest());
  m.ask_ok("$J=G91 X1 F3000\n");
  ASSERT_TRUE(m.host.wait_for_rest());
  EXPECT_FALSE(m.aux());  // a jog is not part of the program
  m.ask_ok("G0 X2\n");
  ASSERT_TRUE(m.host.wait_for_rest());
  EXPECT_TRUE(m.aux());
  EXPECT_EQ(m.aux_edges.edges().size(), 1u);
}

TEST(ProgramOutputs, ChangeAtOnceWhenReadBeforeTheMotion) {
  Machine m;
  m.host.send("G1 X20 F600\nM64 P0\nG1 X0\n");
  m.host.run_ms(50);
  EXPECT_TRUE(m.aux());
  EXPECT_LT(m.host.position()[0], 100);
  m.host.send("M65 P0\n");
  m.host.run_ms(2);
  EXPECT_FALSE(m.aux());
}

TEST(ProgramOutputs, AreAnalogueOrDigitalAsTheyWereUsedLast) {
  Machine m;
  const auto level = [&m] { return m.rig.board.bus().aux(); };
  m.ask_ok("M68 E0 Q25\n");
  EXPECT_EQ(level(), (full + 2) / 4);
  m.ask_ok("M67 E0 Q50.5\n");
  EXPECT_EQ(level(), (full + 2) / 4);
  m.ask_ok("G0 X1\n");
  ASSERT_TRUE(m.host.wait_for_rest());
  EXPECT_EQ(level(), std::lround(full * 0.505));
  m.ask_ok("M64 P0\n");
  EXPECT_EQ(level(), full);
  m.ask_ok("M68 E0 Q100\nM68 E0 Q0\n");
  EXPECT_EQ(level(), 0);
}

TEST(ProgramOutputs, ChangeNoSoonerAfterAHold) {
  Machine m;
  m.host.send("G1 X10 F1200\nM62 P0\nG1 X20\n");
  m.host.run_ms(200);
  m.host.send("!");
  m.host.run_ms(2000);
  EXPECT_FALSE(m.aux());
  m.host.send("~");
  ASSERT_TRUE(m.host.wait_for_rest());
  ASSERT_EQ(m.aux_edges.edges().size(), 1u);
  EXPECT_LE(std::abs(m.x_at(m.aux_edges.edges()[0]) - 10 * steps_per_mm), 1);
}

TEST(ProgramOutputs, StayInAHoldInAPauseAndWhileTheDoorIsOpen) {
  Machine m;
  m.ask_ok("M64 P0\n");
  m.host.send("G1 X10 F1200\nM0\nG1 X20\n");
  m.host.run_ms(100);
  m.host.send("!");
  m.host.run_ms(100);
  EXPECT_TRUE(m.aux());
  m.host.send("~");
  m.host.run_ms(1000);
  EXPECT_THAT(m.host.status(), StartsWith("<Hold"));
  EXPECT_TRUE(m.aux());
  m.set(Pin::door, true);
  EXPECT_TRUE(m.aux());
}

/// After anything that ends a program.
TEST(ProgramOutputs, AreAllOffAfterTheEnd) {
  const std::vector<std::pair<std::string, std::function<void(Machine&)>>> ends{
      {"M2", [](Machine& m) { m.ask_ok("M2\n"); }},
      {"M30", [](Machine& m) { m.ask_ok("M30\n"); }},
      {"reset", [](Machine& m) { m.host.send(reset_byte); }},
      {"sleep", [](Machine& m) { m.ask_ok("$SLP\n"); }},
      {"limit", [](Machine& m) { m.set(Pin::limit_x, true); }},
      {"estop", [](Machine& m) { m.set(Pin::estop, true); }},
      {"soft limit", [](Machine& m) { m.host.send("G0 X1000\n"); }},
  };
  for (const auto& [name, end] : ends) {
    SCOPED_TRACE(name);
    Machine m;
    m.ask_ok("M8\nM64 P0\nG1 X1 F600\nM62 P0\n");
    m.host.run_ms(300);
    ASSERT_TRUE(m.aux() && m.air());
    end(m);
    m.host.run_ms(5);
    EXPECT_FALSE(m.aux());
    EXPECT_FALSE(m.air());
    if (name == "M2" || name == "M30") {
      m.ask_ok("G0 X2\n");
      ASSERT_TRUE(m.host.wait_for_rest());
      EXPECT_FALSE(m.aux()) << "the waiting change must be dropped";
    }
  }
}

TEST(ProgramOutputs, AreKnownInTheMapThatHasThem) {
  Machine cut(boards::PinMap::cut);
  EXPECT_THAT(cut.host.ask("M62 P0\nM68 E0 Q5\nM66 P0 L0\nM66 P1 L0\n"),
              ElementsAre("error:20", "error:20", "error:20", "[MSG:Input 1 off]", "ok"));
  Machine m;
  EXPECT_THAT(
      m.host.ask("M62\nM62 P1\nM62 P0.5\nM62 P0 M63\nM67 E0\nM67 E0 Q101\nM67 E0 Q-1\n"
                 "M66 P0 L5\nM66 P0 L3\nM66 P0 L3 Q0\nM66 P2 L0\nM62 G4 P0\nM62 E0\n"),
      ElementsAre("error:28", "error:39", "error:23", "error:21", "error:28", "error:39", "error:4",
                  "error:39", "error:28", "error:19", "error:39", "error:24", "error:28"));
}

// --- inputs -----------------------------------------------------------------------------------

TEST(ProgramInputs, AreWaitedForAtRest) {
  struct Case {
    std::string words;
    bool before, then;  ///< the pin: low = on
    std::string said;
  };
  const Case cases[] = {{"L1", true, false, "[MSG:Input 0 on]"},
                        {"L2", false, true, "[MSG:Input 0 off]"},
                        {"L3", true, false, "[MSG:Input 0 on]"},
                        {"L4", false, true, "[MSG:Input 0 off]"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.words);
    Machine m;
    m.set(Pin::aux_in, c.before);
    m.host.send(fmt::format("G1 X5 F1200\nM66 P0 {} Q5\nG1 X10\n", c.words));
    m.host.run_ms(1000);
    EXPECT_EQ(m.host.position()[0], 5 * steps_per_mm);
    EXPECT_EQ(m.host.answers().size(), 1u);
    m.set(Pin::aux_in, c.then);
    ASSERT_TRUE(m.host.wait_for_rest());
    EXPECT_TRUE(m.host.has_said(c.said));
    EXPECT_EQ(m.host.position()[0], 10 * steps_per_mm);
    EXPECT_THAT(m.host.answers(), ElementsAre("ok", "ok", "ok"));
  }
}

TEST(ProgramInputs, AreTakenAsTheyAreAtOnce) {
  Machine m;
  EXPECT_THAT(m.host.ask("M66 P0 L0\nM66 P0 L4 Q1\n"),
              ElementsAre("[MSG:Input 0 off]", "ok", "[MSG:Input 0 off]", "ok"));
  m.set(Pin::aux_in, false);
  EXPECT_THAT(m.host.ask("M66 P0\nM66 P0 L3 Q1\n"),
              ElementsAre("[MSG:Input 0 on]", "ok", "[MSG:Input 0 on]", "ok"));
  m.set(Pin::probe, false);
  EXPECT_THAT(m.host.ask("M66 P1\n"), ElementsAre("[MSG:Input 1 on]", "ok"));
}

TEST(ProgramInputs, StopTheProgramWhenTimeIsOver) {
  Machine m;
  m.host.send("M3 S1000\nG1 X5 F1200\nM66 P0 L3 Q0.5\nG1 X10\n");
  m.host.run_ms(2000);
  EXPECT_TRUE(m.host.has_said("[MSG:Input 0 not met: off]"));
  EXPECT_THAT(m.host.status(), StartsWith("<Hold"));
  EXPECT_EQ(m.host.position()[0], 5 * steps_per_mm);
  EXPECT_FALSE(m.rig.board.world().beam().at(m.rig.now()).shines());
  m.host.send("~");
  ASSERT_TRUE(m.host.wait_for_rest());
  EXPECT_EQ(m.host.position()[0], 10 * steps_per_mm);
}

TEST(ProgramInputs, AreForgottenByAReset) {
  Machine m;
  m.host.send("M66 P0 L3 Q50\nG1 X10 F600\n");
  m.host.run_ms(100);
  m.host.send(reset_byte);
  m.host.run_ms(10);
  EXPECT_EQ(m.rig.state(), MachineState::idle);
  m.set(Pin::aux_in, false);
  m.host.run_ms(100);
  EXPECT_EQ(m.host.position()[0], 0);
  m.ask_ok("M66 P0 L0\n");
}

// --- a feeder ---------------------------------------------------------------------------------

std::string material_feed() {
  std::ifstream file(test::in_repository("examples/material-feed.ngc"));
  return {std::istreambuf_iterator<char>(file), {}};
}

sim::WorldConfig world_with(const sim::FeederConfig& feeder) {
  sim::WorldConfig world = world_for(profile_with(boards::PinMap::cut_io));
  world.feeder = feeder;
  return world;
}

TEST(MaterialFeed, CutsOneSheetAfterTheOther) {
  Machine m(profile_with(boards::PinMap::cut_io), world_with({}));
  const sim::World& world = m.rig.board.world();
  for (int sheet = 1; sheet <= 3; ++sheet) {
    ASSERT_TRUE(m.host.stream(material_feed()));
    EXPECT_EQ(world.feeder()->sheets(), sheet);
    EXPECT_FALSE(world.feeder()->runs());
    EXPECT_FALSE(m.air());
  }
  EXPECT_THAT(m.host.answers(), Each("ok"));
  EXPECT_EQ(m.aux_edges.edges().size(), 12u);
  EXPECT_EQ(world.drives().position()[0], -5 * steps_per_mm);
  // The feeder removes the sheet on the machine's way home, from the beginning of that way.
  for (std::size_t i = 2; i < 12; i += 4) EXPECT_EQ(m.x_at(m.aux_edges.edges()[i]), 0);
}

TEST(MaterialFeed, StopsDarkWhenTheSensorsWireBreaks) {
  Machine m(profile_with(boards::PinMap::cut_io), world_with({.broken_from = 0}));
  m.host.send(material_feed());
  m.host.run_ms(7000);
  EXPECT_THAT(m.host.status(), StartsWith("<Hold"));
  EXPECT_TRUE(m.host.has_said("[MSG:Input 0 not met: off]"));
  EXPECT_EQ(m.host.position()[0], 0);
  EXPECT_FALSE(m.rig.board.world().beam().shone(0, m.rig.now()));
  EXPECT_TRUE(m.aux()) << "the feeder has not been switched off";
  m.host.send(reset_byte);
  m.host.run_ms(5);
  EXPECT_FALSE(m.aux());
}

// --- drives at rest ---------------------------------------------------------------------------

job::Profile with_rest(int delay_ms, int axes, boards::PinMap map) {
  job::Profile profile = profile_with(map);
  profile.settings.set_milli(Id::axes, 4000);
  profile.settings.set_milli(Id::idle_delay, delay_ms * 1000);
  profile.settings.set_milli(Id::idle_release, axes * 1000);
  return profile;
}

TEST(DrivesAtRest, AreReleasedAfterTheirTimeIfAllOfTheirWireMayBe) {
  struct Case {
    int axes;
    boards::PinMap map;
    bool on, z_on;  ///< at rest
  };
  using boards::PinMap;
  const Case cases[] = {{15, PinMap::cut, false, false},  {11, PinMap::cut, true, false},
                        {3, PinMap::cut_io, false, true}, {12, PinMap::cut_io, true, false},
                        {7, PinMap::cut_io, false, true}, {15, PinMap::cut_io, false, false}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.axes);
    const job::Profile profile = with_rest(200, c.axes, c.map);
    Machine m(profile, world_for(profile));
    m.ask_ok("G0 X1 Z1\n");
    ASSERT_TRUE(m.host.wait_for_rest());
    m.host.run_ms(180);
    EXPECT_TRUE(m.is_high(Pin::enable));
    m.host.run_ms(40);
    EXPECT_EQ(m.is_high(Pin::enable), c.on);
    if (c.map == PinMap::cut_io) {
      EXPECT_EQ(m.is_high(Pin::enable_z), c.z_on);
    }
    m.ask_ok("G0 X0\n");
    EXPECT_TRUE(m.is_high(Pin::enable));
    ASSERT_TRUE(m.host.wait_for_rest());
    EXPECT_EQ(m.rig.board.world().drives().total_faults(), 0u);
    EXPECT_EQ(m.rig.board.world().drives().position()[0], 0);
  }
}

TEST(DrivesAtRest, AreNeverReleasedByDefaultNorInAHold) {
  for (const int delay : {255, 0}) {
    const job::Profile profile = with_rest(delay, 15, boards::PinMap::cut);
    Machine m(profile, world_for(profile));
    m.host.run_ms(2000);
    EXPECT_EQ(m.is_high(Pin::enable), delay == 255);
    m.host.send("G1 X10 F600\n");
    m.host.run_ms(400);
    m.host.send("!");
    m.host.run_ms(2000);
    EXPECT_TRUE(m.is_high(Pin::enable));
  }
}

TEST(DrivesAtRest, HoldBeforeAJobOfPoints) {
  job::Profile profile = lamp_profile(500);
  profile.settings.set_milli(Id::idle_delay, 50'000);
  const job::Job job = job::make_job(wild_points(20, 3), profile, {});
  Rig rig(profile);
  rig.run(500 * ps_per_ms);
  EXPECT_FALSE(rig.board.bus().level(Pin::enable));
  EXPECT_EQ(run_job(rig, job).end, JobEnd::done);
  expect_each_once(rig, job, false);
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  rig.run(500 * ps_per_ms);
  EXPECT_FALSE(rig.board.bus().level(Pin::enable));
}

/// Whatever the commands, no step occurs while its drive is released or has just been enabled.
TEST(DrivesAtRest, TakeNoStepAtRandomMoments) {
  std::mt19937_64 random(5);
  const Pick<int> pick(random);
  for (int i = 0; i < scaled(10); ++i) {
    const job::Profile profile = with_rest(pick(0, 60), pick(0, 15), boards::PinMap::cut_io);
    Machine m(profile, world_for(profile));
    for (int k = 0; k < 60; ++k) {
      switch (pick(0, 9)) {
        case 0:
          m.host.send(fmt::format("$J=G91 X{} F{}\n", pick(-3, 3), pick(1, 60) * 100));
          break;
        case 1:
          m.host.send("!");
          break;
        case 2:
        case 3:
          m.host.send("~");
          break;
        case 4:
          m.host.send(pick(0, 3) == 0 ? reset_byte : std::uint8_t{0x85});
          break;
        case 5:
          m.host.send("$X\n");
          break;
        default:
          m.host.send(fmt::format("G0 X{} Z{}\n", pick(-9, 9), pick(-9, 9)));
          break;
      }
      m.host.run_ms(pick(0, 4) == 0 ? pick(0, 600) : pick(0, 60));
      ASSERT_EQ(m.rig.board.world().drives().total_faults(), 0u) << i << " " << k;
      const bool off = !m.is_high(Pin::enable) || !m.is_high(Pin::enable_z);
      if (off) {
        EXPECT_FALSE(m.rig.board.controller().outputs().laser_enable);
      }
    }
  }
}

}  // namespace
}  // namespace lamplock::test::program_outputs_test
