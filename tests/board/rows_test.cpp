// Jobs of rows on the virtual board: the light of each cell, once, whatever the cable and the user
// do; dark at once where it has to be.
#include <algorithm>
#include <cmath>

#include "tests/board/board_cable.hpp"
#include "tests/board/pixel_rows.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

using wire::HoldReason;

wire::JobHeader row_header(const job::Profile& machine) {
  wire::JobHeader header;
  header.axes = static_cast<std::uint8_t>(machine.settings.whole(Id::axes));
  return header;
}

/// How a raster is sent.
struct Sending {
  Faults faults = {};
  std::uint64_t seed = 1;
  std::size_t most_runs = wire::most_runs_a_line;
  std::size_t most_bytes = wire::max_payload;
};

/// A machine, a cable and a sender of a raster.
struct RowRig {
  explicit RowRig(const Raster& picture, const Sending& sending = {})
      : raster(picture),
        lines(PixelLines(picture, sending.most_runs).lines()),
        rig(machine),
        cable(rig, sending.faults, sending.seed),
        host(cable, lines, row_header(machine), 77, sending.most_bytes) {}

  /// Every cell got its light, nothing else did, and no shot was fired.
  void expect_burnt() {
    rig.run(5 * ps_per_ms);
    const CellLight light = cell_light(raster, rig.monitor, rig.board.world().beam());
    EXPECT_EQ(light.dark, 0);
    EXPECT_EQ(light.twice, 0);
    EXPECT_EQ(light.right, raster.pixels());
    EXPECT_LT(std::abs(light.elsewhere), 1e-3);
    EXPECT_TRUE(rig.monitor.fires().empty());
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::laser_gate));
  }

  job::Profile machine = raster_machine();
  Raster raster;
  std::vector<PixelLine> lines;
  Rig rig;
  BoardCable cable;
  RowHost host;
};

/// Power in proportion to the speed is right to a count of LASER PWM.
constexpr int flicker = 40;

/// What the laser does, change by change.
std::vector<std::uint16_t> powers_of(const sim::Beam& beam) {
  std::vector<std::uint16_t> powers;
  for (const sim::BeamChange& change : beam.changes())
    if (powers.empty() || std::abs(powers.back() - change.light()) > flicker)
      powers.push_back(change.light());
  return powers;
}

/// The same picture as lists of powers in G-code.
TEST(Rows, ShineAsListsOfPowersDo) {
  for (int i = 0; i < scaled(4); ++i) {
    const Raster raster(static_cast<std::uint64_t>(i + 1), 3, 150 + 50 * i, i % 2 == 0 ? 1 : 6);
    std::string text = raster.program(true);
    text.replace(text.find("M3"), 2, "M4");
    Rig by_text(raster_machine());
    ProgramHost host(by_text);
    ASSERT_TRUE(host.stream(text));
    RowRig rows(raster);
    ASSERT_TRUE(rows.host.run(30));
    rows.expect_burnt();
    const sim::Beam& beam = rows.rig.board.world().beam();
    const Raster::Judgement judgement = raster.judge(rows.rig.monitor, beam, 0, flicker);
    EXPECT_EQ(judgement.lit_as_wanted, raster.pixels());
    EXPECT_LE(judgement.largest_shift, 1);
    const auto text_powers = powers_of(by_text.board.world().beam()), powers = powers_of(beam);
    ASSERT_EQ(powers.size(), text_powers.size());
    for (std::size_t k = 0; k < powers.size(); ++k)
      ASSERT_NEAR(powers[k], text_powers[k], flicker) << "change " << k;
  }
}

/// 3000 runs a second, in lines of any length that the board can take.
TEST(Rows, OfGreyPixelsKeepTheirSpeed) {
  for (int i = 0; i < scaled(3); ++i) {
    const std::size_t most_runs[] = {wire::most_runs_a_line, 300, 100};
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 10), 3, 700, 1),
                {.most_runs = most_runs[i % 3]});
    ASSERT_TRUE(rows.host.run(30));
    rows.expect_burnt();
    const Raster::Judgement judgement =
        rows.raster.judge(rows.rig.monitor, rows.rig.board.world().beam(), 0, flicker);
    EXPECT_EQ(judgement.lit_as_wanted, rows.raster.pixels());
    EXPECT_LE(judgement.largest_shift, 1);
    EXPECT_GT(judgement.slowest_mm_s, 0.98 * Raster::speed_mm_s);
    EXPECT_EQ(rows.host.status().starvations, 0u);
  }
}

}  // namespace
}  // namespace lamplock::test
