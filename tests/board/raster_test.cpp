// Raster engraving on the virtual board: 0.1 mm pixels in both directions at 300 mm/s and 2 m/s2.
#include "tests/board/raster.hpp"

#include <set>

#include "host/file.hpp"
#include "tests/board/program_host.hpp"
#include "tests/paths.hpp"

namespace lamplock::test {
namespace {

void engrave(const Raster& raster, double lead_us, bool lists = false) {
  const job::Profile machine = raster_machine(lead_us);
  Rig rig(machine);
  ProgramHost host(rig);
  ASSERT_TRUE(host.stream(raster.program(lists)));
  for (const std::string& answer : host.answers()) ASSERT_EQ(answer, "ok");
  host.run_ms(20);
  expect_engraved(raster, rig.monitor, rig.board, lead_us);
  EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
}

TEST(Raster, LightChangesAtTheEdgesOfPixels) {
  for (int i = 0; i < scaled(4); ++i)
    engrave(Raster(static_cast<std::uint64_t>(i + 1), 4, 200, 4), 0);
}

TEST(Raster, OfListsOfPowersIsTheSame) {
  for (int i = 0; i < scaled(4); ++i)
    engrave(Raster(static_cast<std::uint64_t>(i + 20), 4, 200, 4), 0, true);
}

/// Every pixel has another power: a row is one line of the planner, whatever its length.
TEST(Raster, OfGreyPixelsKeepsItsSpeed) {
  for (int i = 0; i < scaled(4); ++i)
    engrave(Raster(static_cast<std::uint64_t>(i + 40), 3, 700, 1), 0, true);
}

TEST(Raster, OfGreyPixelsIsTheSameWithALeadOfTheLaser) {
  for (int i = 0; i < scaled(4); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i + 7));
    const auto lead_us = static_cast<double>(random() % 2001) - 1000;
    engrave(Raster(static_cast<std::uint64_t>(i + 60), 2, 500, 1), lead_us, true);
  }
}

/// Held at random moments and resumed at another feed rate: no pixel is lost or shifted.
TEST(Raster, ResumesInThePixelWhereItWasHeld) {
  for (int i = 0; i < scaled(6); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const double lead_us = i % 2 == 0 ? 0 : static_cast<double>(random() % 2001) - 1000;
    const Raster raster(static_cast<std::uint64_t>(i + 70), 3, 300, i % 3 == 0 ? 4 : 1);
    Rig rig(raster_machine(lead_us));
    rig.run(ps_per_ms);
    ProgramSender sender(rig.board);
    sender.give(raster.program(true));
    const int holds = send_with_holds(rig, sender, random);
    const Raster::Judgement judgement = raster.judge(rig.monitor, rig.board.world().beam(),
                                                     static_cast<Picoseconds>(lead_us * ps_per_us));
    EXPECT_EQ(judgement.lit_as_wanted, raster.pixels()) << i;
    EXPECT_LE(judgement.max_shift, 1) << i;
    EXPECT_GT(judgement.changes, raster.pixels() / 10);
    EXPECT_LT(judgement.slowest_mm_s, Raster::speed_mm_s / 2);
    EXPECT_GT(holds, 5);
  }
}

/// The pattern that measures the lead: eight bars per row.
TEST(Raster, TheExampleForTheLeadDrawsItsBars) {
  Rig rig(raster_machine());
  ProgramHost host(rig);
  const std::string text = read_file(test::in_repository("examples/laser-lead.ngc"));
  ASSERT_TRUE(host.stream(text));
  for (const std::string& answer : host.answers()) ASSERT_EQ(answer, "ok");
  std::size_t rows = 0;
  for (std::size_t at = 0; (at = text.find(":300", at)) != std::string::npos; ++rows)
    at = text.find('\n', at);
  EXPECT_EQ(rows, 24u);
  EXPECT_EQ(rig.board.world().beam().openings(), 8 * rows);
  // Rows to the left have light where rows to the right have it.
  std::set<long> begins, ends;
  const auto& x = rig.monitor.steps(0);
  bool shone = false;
  for (const sim::BeamChange& change : rig.board.world().beam().changes()) {
    if (change.shines() == shone) continue;
    shone = change.shines();
    const auto next =
        std::upper_bound(x.begin(), x.end(), change.at,
                         [](Picoseconds at, const PinMonitor::Step& step) { return at < step.at; });
    const bool left = (next - 1)->position < (next - 2)->position;
    (shone == left ? ends : begins).insert((next - 1)->position);
  }
  for (const long place : begins) EXPECT_EQ(place % 1000, 0) << place;
  for (const long place : ends) EXPECT_EQ(place % 1000, 40) << place;
}

/// A laser that answers late, or too early for its drives. Runs are slightly longer here: each is a
/// line, and the 128 lines known ahead must cover the braking distance.
TEST(Raster, LightChangesAtTheEdgesOfPixelsWithALeadOfTheLaser) {
  for (int i = 0; i < scaled(4); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const auto lead_us = static_cast<double>(random() % 2001) - 1000;
    engrave(Raster(static_cast<std::uint64_t>(i + 50), 2, 200, 6), lead_us);
  }
}

}  // namespace
}  // namespace lamplock::test
