// The loop that holds a temperature on the flash image of a board with SENSOR: ADC, controller,
// LASER PWM, and the spot of the simulated world that the light heats.
#include "tests/board/heat_profile.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/figure.hpp"
#include "tests/paths.hpp"

namespace lamplock::test::temperature_loop_test {
namespace {

using settings::LoopMode;
using sim::HeatConfig;
using sim::Pin;

const sim::chip::Image& image_with_sensor() {
  static const sim::chip::Image image =
      sim::chip::load_image(in_build(std::string(boards::grblhal_pico.image) + ".elf"));
  return image;
}

struct HeatedChip {
  explicit HeatedChip(const job::Profile& profile, const HeatConfig& heat = heat_config())
      : rig(profile.settings, heated_world(profile, heat), ChipRig::Power::on,
            image_with_sensor()) {}
  const sim::HeatSensor& spot() const { return *rig.board.world().heat(); }
  bool has_light() { return rig.board.world().beam().at(rig.now()).shines(); }
  void run_to(Picoseconds at) {
    while (rig.now() < at) rig.user.step(100 * ps_per_us);
  }

  ChipRig rig;
};

/// Boot takes 0.2 s.
constexpr Picoseconds step_at = 500 * ps_per_ms;

TEST(TemperatureLoopOnTheChip, HoldsTheTemperatureAfterAStepInAbsorption) {
  HeatConfig heat = heat_config();
  heat.changes = {{.at = step_at, .absorption = 1.1}};
  HeatedChip chip(loop_profile(LoopMode::power), heat);
  chip.rig.user.give("G21 G91 M3 S600\nG1 X20 F3000\nG1 X-20\nM5\n");
  const Picoseconds end = step_at + 150 * ps_per_ms;
  while (chip.rig.now() < end) chip.rig.user.step(ps_per_ms);
  const HeatResponse held = response_of(chip.spot(), step_at, end);
  std::printf("chip: first %.2f K, settled %.4f s, overshoot %.2f %%, at the end %.2f K\n",
              held.first_k, held.settled_s, held.overshoot * 100, held.final_k);
  EXPECT_NEAR(held.final_k, hot_k, 0.5);
  EXPECT_LE(held.settled_s, 0.1);
  EXPECT_LE(held.overshoot, 0.2);
}

TEST(TemperatureLoopOnTheChip, IsDarkWithin5MsOfACutWireAndContinuesWhenTheUserSaysSo) {
  const Picoseconds repaired = step_at + 150 * ps_per_ms;
  HeatConfig heat = heat_config();
  heat.changes = {{.at = step_at, .broken_volts = 0}, {.at = repaired}};
  HeatedChip chip(loop_profile(LoopMode::power), heat);
  chip.rig.user.give("G21 G91 M3 S600\nG1 X20 F3000\nG1 X-20\nM5\n");
  chip.run_to(step_at);
  ASSERT_TRUE(chip.has_light());
  while (chip.has_light() && chip.rig.now() < step_at + 20 * ps_per_ms)
    chip.rig.run(20 * ps_per_us);
  expect_figure("chip: dark after a cut of the wire of the sensor", chip.rig.now() - step_at, 0.7,
                5);
  const Picoseconds dark = chip.rig.now();
  chip.run_to(step_at + 120 * ps_per_ms);
  EXPECT_THAT(chip.rig.status(), HasSubstr("Hold"));
  EXPECT_THAT(chip.rig.heard, HasSubstr("[MSG:SENSOR out of range, laser off"));
  const StepPosition held = chip.rig.board.world().drives().position();
  chip.rig.user.send("~");
  chip.run_to(repaired + 20 * ps_per_ms);
  EXPECT_EQ(chip.rig.board.world().drives().position(), held);
  EXPECT_FALSE(chip.rig.board.world().beam().shone(dark, chip.rig.now()));
  chip.rig.user.send("~");
  EXPECT_TRUE(chip.rig.user.run_until_idle(chip.rig.now() + 10 * ps_per_s));
  EXPECT_EQ(chip.rig.user.errors(), 0u);
  EXPECT_TRUE(chip.rig.board.world().beam().shone(repaired, chip.rig.now()));
  EXPECT_EQ(chip.rig.board.world().drives().position(), StepPosition{});
}

/// The image of the Pico lacks the settings, which would use SRAM for nothing.
TEST(TemperatureLoopOnTheChip, ImagesOfBoardsWithoutASensorSayThatTheyLackIt) {
  ChipRig rig(job::Profile{});
  rig.user.step(300 * ps_per_ms);
  for (const std::string line : {"$1061=1", "$1064=5", "$1069=0"}) {
    const std::string said = rig.user.answer(line);
    EXPECT_THAT(said, HasSubstr(line.substr(0, 5) + " needs SENSOR"));
    EXPECT_THAT(said, HasSubstr("error:52"));
  }
  EXPECT_THAT(rig.user.answer("$1060=1"), HasSubstr("error:3"));
}

}  // namespace
}  // namespace lamplock::test::temperature_loop_test
