// Every board on every wiring: the image of a board does on its own wiring what that of a Pico
// does, and drives nothing on another. New rows are found by themselves.
#include <map>

#include "shared/boards/all_boards.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_trace.hpp"
#include "tests/error_of.hpp"

namespace lamplock::test {
namespace {

using boards::BoardRow;
using boards::Role;

const sim::chip::Image& image_of(const BoardRow& row) {
  static std::map<std::string_view, sim::chip::Image> images;
  auto found = images.find(row.name);
  if (found == images.end())
    found =
        images.emplace(row.name, sim::chip::load_image(in_build(std::string(row.image) + ".elf")))
            .first;
  return found->second;
}

job::Profile profile_of(const BoardRow& row, bool cuts) {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::pin_map, static_cast<int>(row.first_map) * 1000);
  if (!cuts) return profile;
  profile.settings.set_milli(Id::lamp_mode, 0);
  profile.settings.set_milli(Id::laser_mode, 1000);
  return profile;
}

sim::ChipBoardOptions wired_as(const BoardRow& row) {
  sim::ChipBoardOptions options = quick_host();
  options.wiring = row.first_map;
  return options;
}

/// An image of one board on the wiring of another, with the settings that the image begins with.
struct Bench {
  Bench(const BoardRow& of_image, const BoardRow& of_wiring,
        ChipRig::Power power = ChipRig::Power::on, bool cuts = false)
      : Bench(profile_of(of_image, cuts), of_image, of_wiring, power) {}
  Bench(const job::Profile& machine, const BoardRow& of_image, const BoardRow& of_wiring,
        ChipRig::Power power)
      : profile(machine),
        rig(machine.settings, world_for(machine), power, image_of(of_image), wired_as(of_wiring)) {
    rig.is_broken = &of_image != &of_wiring;
  }
  job::Profile profile;
  ChipRig rig;
};

/// Watches all pads that can release energy on a board.
class EnergyWatch final : public sim::chip::PadListener {
 public:
  EnergyWatch(sim::chip::Chip& chip, const BoardRow& row) : chip_(chip) {
    for (const boards::PinUse& use : row.maps[0].pins)
      if (use.energy) pins_ |= 1u << use.gpio;
    chip.gpio().listen(*this);
  }
  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle /*at*/) override {
    if (level && (pins_ >> gpio & 1) != 0) ++rises;
  }
  std::uint32_t levels() const { return chip_.gpio().pad_levels() & pins_; }

  std::size_t rises = 0;

 private:
  sim::chip::Chip& chip_;
  std::uint32_t pins_ = 0;
};

class EachBoard : public testing::TestWithParam<const BoardRow*> {
 protected:
  const BoardRow& row() const { return *GetParam(); }
};

struct Deeds {
  std::vector<Step> steps;
  std::vector<Picoseconds> shots;  ///< Q-SWITCH after the edge of the lamp
};

Deeds engrave(const BoardRow& row) {
  Bench bench(row, row);
  run_to_the_end(bench.rig, job::make_job(chip_points(30, 5), bench.profile, {}));
  Deeds deeds{steps_of(bench.rig.monitor, step_latency), {}};
  for (const auto& fire : bench.rig.monitor.fires()) deeds.shots.push_back(fire.rise - fire.edge);
  return deeds;
}

TEST_P(EachBoard, EngravesAsAPico) {
  static const Deeds of_the_pico = engrave(boards::pico);
  const Deeds deeds = engrave(row());
  ASSERT_GT(deeds.steps.size(), 400u);
  EXPECT_EQ(deeds.steps, of_the_pico.steps);
  EXPECT_EQ(deeds.shots, of_the_pico.shots);
}

ProgramTrace cut(const BoardRow& row) {
  Bench bench(row, row, ChipRig::Power::on, true);
  ChipRig& rig = bench.rig;
  rig.user.give(
      "G21 G91 M4\nG1 X2 Y1 S300 F6000\nG1 X1 S1000\nG2 X1 Y-1 I1 J0 S700\nG1 Z-0.5 S0\n"
      "G1 X-2 S500\nM5\n");
  EXPECT_TRUE(rig.user.run_until_answered(rig.now() + 5 * ps_per_s));
  EXPECT_TRUE(rig.user.run_until_idle(rig.now() + 5 * ps_per_s));
  EXPECT_EQ(rig.user.errors(), 0u);
  ProgramTrace trace;
  for (int axis = 0; axis < 3; ++axis) trace.steps[index(axis)] = rig.monitor.steps(axis);
  trace.light = rig.board.world().beam().changes();
  trace.end = rig.now();
  return trace;
}

TEST_P(EachBoard, CutsAsAPico) {
  static const ProgramTrace of_the_pico = cut(boards::pico);
  const ProgramTrace trace = cut(row());
  const TraceComparison comparison(of_the_pico, trace, true);
  EXPECT_EQ(comparison.difference(), "");
  EXPECT_GT(comparison.steps(), 1000u);
  EXPECT_GT(comparison.gate_edges(), 0u);
  // A step is in the same tick, whose edges the monitor sees two clocks later where pins are apart.
  EXPECT_LE(comparison.max_step_error(), 16 * ps_per_ns);
  EXPECT_LE(comparison.max_gate_error(), 16 * ps_per_ns);
}

TEST_P(EachBoard, NoEnergyWithoutAJob) {
  Bench bench(row(), row(), ChipRig::Power::off);
  ChipRig& rig = bench.rig;
  EnergyWatch energy(rig.board.chip(), row());
  rig.boot();
  rig.press(sim::Pin::estop, rig.now() + ps_per_ms, rig.now() + 60 * ps_per_ms);
  rig.run(120 * ps_per_ms);
  EXPECT_THAT(rig.status(), HasSubstr("Alarm"));
  rig.board.power_cut();
  rig.run(300 * ps_per_ms);
  EXPECT_EQ(energy.rises, 0u);
  EXPECT_EQ(energy.levels(), 0u);
}

TEST_P(EachBoard, NamesItselfAndRefusesWhatBelongsToAnother) {
  Bench bench(row(), row());
  ChipRig& rig = bench.rig;
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[BOARD:" + std::string(row().name) + "]"));
  for (const BoardRow* other : boards::all_boards) {
    const std::string map = std::to_string(static_cast<int>(other->first_map));
    const std::string answer = rig.answer("$990=" + map);
    EXPECT_THAT(answer, HasSubstr(other == &row() ? "ok" : "another board")) << map;
  }
  EXPECT_THAT(rig.answer("$RST=$"), HasSubstr("ok"));
  const std::string own = "$990=" + std::to_string(static_cast<int>(row().first_map));
  EXPECT_THAT(rig.answer("$$"), HasSubstr(own));
}

/// Pulses of several ticks, longer and shorter in turn without a restart.
TEST_P(EachBoard, ChangesItsPulsesAtRest) {
  Bench bench(row(), row());
  ChipRig& rig = bench.rig;
  const unsigned step = *boards::find_gpio(row().maps[0].pins, Role::step_x);
  struct Widths final : sim::chip::PadListener {
    explicit Widths(unsigned gpio) : pin(gpio) {}
    void pad_changed(unsigned gpio, bool level, sim::chip::Cycle at) override {
      if (gpio != pin) return;
      if (!level && rose != 0) widths.push_back(at - rose);
      rose = at;
    }
    unsigned pin;
    sim::chip::Cycle rose = 0;
    std::vector<sim::chip::Cycle> widths;
  } widths(step);
  rig.board.chip().gpio().listen(widths);
  for (const char* rate : {"$110=3000", "$111=3000", "$112=3000", "$113=3000"})
    ASSERT_THAT(rig.answer(rate), HasSubstr("ok"));
  for (const auto& [us, clocks] : std::map<double, unsigned>{{0.4, 63}, {2.4, 375}, {4, 625}}) {
    for (const bool again : {false, true}) {
      ASSERT_THAT(rig.answer(fmt::format("$0={}", again ? us : 0.5)), HasSubstr("ok"));
      widths.widths.clear();
      rig.user.give("G91\nG0 X0.05\nG0 X-0.05\n");
      ASSERT_TRUE(rig.user.run_until_idle(rig.now() + ps_per_s));
      ASSERT_EQ(widths.widths.size(), 20u);
      for (const sim::chip::Cycle width : widths.widths) EXPECT_EQ(width, again ? clocks : 63u);
    }
  }
}

/// Where the wiring contradicts the image no pad is driven, up to the next start.
TEST_P(EachBoard, DrivesNothingOnTheWiringOfAnother) {
  for (const BoardRow* other : boards::all_boards) {
    if (other == &row()) continue;
    Bench bench(row(), *other, ChipRig::Power::off);
    ChipRig& rig = bench.rig;
    EnergyWatch energy(rig.board.chip(), *other);
    rig.boot();
    EXPECT_EQ(energy.rises, 0u) << other->name;
    std::uint32_t outputs = 0;
    for (const boards::PinUse& use : row().maps[0].pins)
      if (use.direction == boards::Direction::output) outputs |= 1u << use.gpio;
    std::uint32_t inputs_there = other->driven;
    for (const boards::PinUse& use : other->maps[0].pins)
      if (use.direction == boards::Direction::input) inputs_there |= 1u << use.gpio;
    // Pins that the wiring drives do not show whether the chip does; a contention would.
    const bool is_silent = (rig.board.chip().gpio().driven() & ~inputs_there) == 0;
    // Boards whose outputs are the same may do without a refusal: the wrong pin of the e-stop keeps
    // the machine in its alarm.
    EXPECT_TRUE(is_silent || (outputs & inputs_there) == 0) << other->name;
    if (is_silent) {
      EXPECT_THAT(rig.heard, HasSubstr("Outputs off: GPIO ")) << other->name;
    }
    EXPECT_THAT(rig.status(), HasSubstr("Alarm")) << other->name;
    EXPECT_THAT(rig.board.chip().not_modelled(), IsEmpty()) << other->name;
  }
}

/// Drives on a board: set up before they are enabled.
struct DriveBench : Bench {
  explicit DriveBench(bool powered = true)
      : Bench(boards::skr_pico, boards::skr_pico, ChipRig::Power::off) {
    for (sim::Tmc2209& drive : drives()) drive.set_powered(powered);
    rig.boot();
    rig.run(150 * ps_per_ms);
  }
  std::vector<sim::Tmc2209>& drives() { return rig.board.drive_wire()->drives().drives; }
  std::uint32_t enables() const { return boards::enable_pins(boards::skr_pico); }
  std::uint32_t enables_high() { return rig.board.chip().gpio().pad_levels() & enables(); }
  void move() {
    rig.user.give("G91\nG0 X0.1\n");
    EXPECT_TRUE(rig.user.run_until_idle(rig.now() + ps_per_s));
  }
};

TEST(DrivesOnTheBoard, AreSetUpAndThenEnabledTogether) {
  DriveBench bench;
  for (const sim::Tmc2209& drive : bench.drives()) {
    EXPECT_EQ(drive.microsteps(), 16u);
    EXPECT_NEAR(drive.current_ma(boards::skr_pico.drives->sense_mohm), 490, 1);
  }
  bench.move();
  EXPECT_EQ(bench.enables_high(), 0u);
  ASSERT_THAT(bench.rig.answer("$1093=800"), HasSubstr("ok"));
  ASSERT_THAT(bench.rig.answer("$1096=64"), HasSubstr("ok"));
  bench.rig.run(200 * ps_per_ms);
  EXPECT_NEAR(bench.drives()[2].current_ma(boards::skr_pico.drives->sense_mohm), 796, 30);
  EXPECT_EQ(bench.drives()[1].microsteps(), 64u);
  bench.move();
  EXPECT_EQ(bench.enables_high(), 0u);
}

TEST(DrivesOnTheBoard, StayOffWithoutTheirSupply) {
  DriveBench bench(false);
  bench.rig.run(300 * ps_per_ms);
  EXPECT_EQ(bench.enables_high(), bench.enables());
  EXPECT_THAT(bench.rig.status(), HasSubstr("Alarm"));
  EXPECT_THAT(bench.rig.heard, HasSubstr("Drives off: X does not answer; switch the supply"));
  for (sim::Tmc2209& drive : bench.drives()) drive.set_powered(true);
  bench.rig.run(1000 * ps_per_ms);
  EXPECT_THAT(bench.rig.answer("$X"), HasSubstr("ok"));
  bench.move();
  EXPECT_EQ(bench.enables_high(), 0u);
}

TEST(DrivesOnTheBoard, AreDisabledWhenOneHasLostItsSetUp) {
  DriveBench bench;
  bench.move();
  bench.drives()[1].set_powered(false);
  bench.rig.run(600 * ps_per_ms);
  EXPECT_EQ(bench.enables_high(), bench.enables());
  EXPECT_THAT(bench.rig.status(), HasSubstr("Alarm"));
  EXPECT_THAT(bench.rig.heard, HasSubstr("Drives off: Y does not answer"));
}

TEST(DrivesOnTheBoard, RefuseSettingsOutOfTheirReach) {
  DriveBench bench;
  EXPECT_THAT(bench.rig.answer("$1091=1300"), HasSubstr("$1091 at most 1200 mA on a board"));
  EXPECT_THAT(bench.rig.answer("$1098=48"), HasSubstr("$1098 is 1, 2, 4"));
  EXPECT_THAT(bench.rig.answer("$900=2"), HasSubstr("$900 of another board"));
}

/// Shots follow edges of the lamp, or of the trigger output, which this board does not have.
TEST(SkrPico, RefusesAJobOfPointsWithoutALamp) {
  Bench bench(boards::skr_pico, boards::skr_pico, ChipRig::Power::on, true);
  const auto run = [&] {
    run_to_the_end(bench.rig, job::make_job(chip_points(5, 5), bench.profile, {}));
  };
  EXPECT_THAT(error_of(run), HasSubstr("lamp_mode"));
  EXPECT_EQ(bench.rig.monitor.last_step(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, EachBoard, testing::ValuesIn(boards::all_boards),
                         [](const auto& row) {
                           std::string name(row.param->name);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace lamplock::test
