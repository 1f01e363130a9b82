// The image of each board on its own wiring does what that of a Pico does. New rows are found by
// themselves.
#include <algorithm>
#include <map>

#include "host/flash/image_board.hpp"
#include "shared/boards/pico_flash.hpp"
#include "tests/chip_board/board_bench.hpp"
#include "tests/chip_board/program_trace.hpp"
#include "tests/error_of.hpp"

namespace lamplock::test {
namespace {

flash::FlashImage flash_contents(const sim::chip::Image& image) {
  std::vector<flash::Part> parts;
  for (const sim::chip::ImagePart& part : image.parts) parts.push_back({part.address, part.bytes});
  return flash::make_flash_image(std::move(parts), "test");
}

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

TEST_P(EachBoard, NamesItselfAndRefusesWhatBelongsToAnother) {
  Bench bench(row(), row());
  ChipRig& rig = bench.rig;
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[BOARD:" + std::string(row().name) + "]"));
  EXPECT_EQ(flash::board_of_image(flash_contents(image_of(row()))), row().name);
  for (const BoardRow* other : boards::all_boards) {
    const std::string map = std::to_string(static_cast<int>(other->first_map));
    const std::string answer = rig.answer("$990=" + map);
    EXPECT_THAT(answer, HasSubstr(other == &row() ? "ok" : "another board")) << map;
  }
  EXPECT_THAT(rig.answer("$RST=$"), HasSubstr("ok"));
  const std::string own = "$990=" + std::to_string(static_cast<int>(row().first_map));
  EXPECT_THAT(rig.answer("$$"), HasSubstr(own));
}

/// The flash has the settings of another board: the image says that it replaces them.
TEST_P(EachBoard, NamesTheFirstSettingOfAnotherBoardThatItReplaces) {
  const BoardRow& other = &row() == boards::all_boards[0] ? *boards::all_boards[1] : boards::pico;
  Bench bench(profile_of(other, false), row(), row(), ChipRig::Power::on);
  EXPECT_THAT(bench.rig.heard,
              HasSubstr("[MSG:Settings of another board replaced: $990; check $$]"));
  Bench own(row(), row());
  EXPECT_THAT(own.rig.heard, testing::Not(HasSubstr("replaced")));
  // A board with erased flash reports no replaced settings.
  Bench blank(row(), row(), ChipRig::Power::off);
  const auto flash = blank.rig.board.chip().flash().storage();
  std::ranges::fill(
      flash.subspan(boards::settings_offset, boards::settings_sectors * boards::sector_bytes),
      0xFF);
  blank.rig.boot();
  EXPECT_THAT(blank.rig.heard, HasSubstr("Grbl"));
  EXPECT_THAT(blank.rig.heard, testing::Not(HasSubstr("replaced")));
}

/// More axes than pins, no beam channel, a beat that is too fast for its processor.
TEST_P(EachBoard, RefusesAxesChannelsAndBeatsThatItLacks) {
  Bench bench(row(), row());
  ChipRig& rig = bench.rig;
  const boards::Pins map = row().maps[0].pins;
  EXPECT_THAT(rig.answer("$960=4"), HasSubstr(boards::axes(map) == 4 ? "ok" : "another board"));
  EXPECT_THAT(rig.answer("$924=8"),
              HasSubstr((boards::channels(map) & 8) != 0 ? "ok" : "another board"));
  EXPECT_THAT(rig.answer("$901=5000"), HasSubstr("ok"));
  EXPECT_THAT(rig.answer("$901=5000.001"), HasSubstr("$901 at most 5000 Hz on a board "));
  EXPECT_THAT(rig.answer("$RST=$"), HasSubstr("ok"));
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

/// Shots follow edges of the lamp, or of the trigger output, which this board does not have.
TEST(SkrPico, RefusesAJobOfPointsWithoutALamp) {
  Bench bench(boards::skr_pico, boards::skr_pico, ChipRig::Power::on, true);
  const auto run = [&] {
    run_to_the_end(bench.rig, job::make_job(chip_points(5, 5), bench.profile, {}));
  };
  EXPECT_THAT(error_of(run), HasSubstr("lamp_mode"));
  EXPECT_EQ(bench.rig.monitor.last_step(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, EachBoard, testing::ValuesIn(boards::all_boards), board_test_name);

}  // namespace
}  // namespace lamplock::test
