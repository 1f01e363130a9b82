// Canned cycles: every move of them.
#include "firmware/program/cycles.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::cycles_test {
namespace {

using lamplock::test::scaled;
using test::mm;
using test::Rig;
using test::Row;

/// F60 is active and the machine is at Z 5.
template <std::size_t size>
void expect_rows(const Row (&rows)[size]) {
  for (const Row& row : rows) {
    Rig rig;
    rig.run("F60 Z5");
    EXPECT_EQ(rig.run_all(row.lines), row.wanted) << row.lines;
  }
}

TEST(Cycles, Drill) {
  expect_rows({
      {"G81 X1 Y2 R1 Z-2", "rapid to 1 2 5; rapid to 1 2 1; feed 60 to 1 2 -2; rapid to 1 2 5"},
      {"G99 G81 X1 Y2 R1 Z-2", "rapid to 1 2 5; rapid to 1 2 1; feed 60 to 1 2 -2; rapid to 1 2 1"},
      {"G81 X1 R1 Z-2|X2", "rapid to 2 0 5; rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 5"},
      {"G99 G81 X1 R1 Z-2|X2", "rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 1"},
      {"G81 X1 R1 Z-2|Z-3 X2", "rapid to 2 0 5; rapid to 2 0 1; feed 60 to 2 0 -3; rapid to 2 0 5"},
      {"G81 X1 R1 Z-2|X2 R2", "rapid to 2 0 5; rapid to 2 0 2; feed 60 to 2 0 -2; rapid to 2 0 5"},
      {"G81 Z-2 R1", "rapid to 0 0 1; feed 60 to 0 0 -2; rapid to 0 0 5"},
      {"G81 Z1 R1", "rapid to 0 0 1; feed 60 to 0 0 1; rapid to 0 0 5"},
      {"G81 X1 A3 Z0 R1",
       "rapid to 1 0 5 3; rapid to 1 0 1 3; feed 60 to 1 0 0 3; rapid to 1 0 5 3"},
      // Below the retract level: first up, and G98 ends at the retract level.
      {"G81 X1 R7 Z2", "rapid to 0 0 7; rapid to 1 0 7; feed 60 to 1 0 2; rapid to 1 0 7"},
      // G98 returns to the level where the series began, not where the last hole ended.
      {"G99 G81 X1 R1 Z-2|G98 X2", "rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 5"},
      {"G99 G81 X1 R1 Z-2|G98 G82 X2 R1 Z-2 P0",
       "rapid to 2 0 1; feed 60 to 2 0 -2; dwell 0us; rapid to 2 0 5"},
      {"G99 G81 X1 R1 Z-2|G0 X3|G98 G81 X2 R1 Z-2",
       "rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 1"},
      {"G81 X1 R1 Z-2|G80|G0 X0", "rapid to 0 0 5"},
      // G80 ends the series.
      {"G99 G81 X1 R1 Z-2|G80|G98 G81 X2 R0 Z-2",
       "rapid to 2 0 1; rapid to 2 0 0; feed 60 to 2 0 -2; rapid to 2 0 1"},
  });
}

TEST(Cycles, Repeated) {
  expect_rows({
      {"G91 G81 X1 Y2 R-4 Z-3 L2",
       "rapid to 1 2 5; rapid to 1 2 1; feed 60 to 1 2 -2; rapid to 1 2 5; "
       "rapid to 2 4 5; rapid to 2 4 1; feed 60 to 2 4 -2; rapid to 2 4 5"},
      {"G91 G99 G81 X1 R-4 Z-3 L2",
       "rapid to 1 0 5; rapid to 1 0 1; feed 60 to 1 0 -2; rapid to 1 0 1; "
       "rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 1"},
      {"G99 G81 X1 R1 Z0 L2",
       "rapid to 1 0 5; rapid to 1 0 1; feed 60 to 1 0 0; rapid to 1 0 1; "
       "feed 60 to 1 0 0; rapid to 1 0 1"},
      // R counts from where the series began.
      {"G91 G99 G81 X1 R-4 Z-3|X1", "rapid to 2 0 1; feed 60 to 2 0 -2; rapid to 2 0 1"},
      {"G91 G81 X1 R-4 Z-3 L2|X1",
       "rapid to 3 0 5; rapid to 3 0 1; feed 60 to 3 0 -2; rapid to 3 0 5"},
  });
}

TEST(Cycles, DwellAndPecks) {
  expect_rows({
      {"G82 R1 Z0 P0.5", "rapid to 0 0 1; feed 60 to 0 0 0; dwell 500000us; rapid to 0 0 5"},
      {"G82 R1 Z0 P0.5|X1",
       "rapid to 1 0 5; rapid to 1 0 1; feed 60 to 1 0 0; dwell 500000us; rapid to 1 0 5"},
      {"G83 R1 Z-2 Q2",
       "rapid to 0 0 1; feed 60 to 0 0 -1 on the way; rapid to 0 0 1; rapid to 0 0 -0.746; "
       "feed 60 to 0 0 -2; rapid to 0 0 5"},
      {"G73 R1 Z-2 Q2",
       "rapid to 0 0 1; feed 60 to 0 0 -1 on the way; rapid to 0 0 -0.746; "
       "feed 60 to 0 0 -2; rapid to 0 0 5"},
      {"G83 R1 Z-1 Q2", "rapid to 0 0 1; feed 60 to 0 0 -1; rapid to 0 0 5"},
      {"G83 R1 Z-1 Q9", "rapid to 0 0 1; feed 60 to 0 0 -1; rapid to 0 0 5"},
      // The clearance does not exceed the retract level.
      {"G83 R1 Z0.8 Q0.1",
       "rapid to 0 0 1; feed 60 to 0 0 0.9 on the way; rapid to 0 0 1; feed 60 to 0 0 0.8; "
       "rapid to 0 0 5"},
      {"G73 R1 Z-2 Q2|X1",
       "rapid to 1 0 5; rapid to 1 0 1; feed 60 to 1 0 -1 on the way; rapid to 1 0 -0.746; "
       "feed 60 to 1 0 -2; rapid to 1 0 5"},
      {"G20 G83 R1 Z0.9 Q0.05",
       "rapid to 0 0 25.4; feed 60 to 0 0 24.13 on the way; rapid to 0 0 25.4; "
       "rapid to 0 0 24.384; feed 60 to 0 0 22.86; rapid to 0 0 25.4"},
  });
}

/// G85 and G89 leave at the feed, as in LinuxCNC; G86 with the spindle at rest.
TEST(Cycles, Bores) {
  expect_rows({
      {"G85 X1 R1 Z-2",
       "rapid to 1 0 5; rapid to 1 0 1; feed 60 to 1 0 -2; feed 60 to 1 0 1 on the way; "
       "rapid to 1 0 5"},
      {"G99 G85 R1 Z-2|X2", "rapid to 2 0 1; feed 60 to 2 0 -2; feed 60 to 2 0 1 on the way"},
      {"G89 P.5 R1 Z-2",
       "rapid to 0 0 1; feed 60 to 0 0 -2; dwell 500000us; feed 60 to 0 0 5 on the way"},
      {"M3 S9|G86 P.5 R1 Z-2 L2",
       "rapid to 0 0 1 M3 S9; feed 60 to 0 0 -2 M3 S9; dwell 500000us; spindle M5; "
       "rapid to 0 0 5 M3 S9; spindle M3 S9; rapid to 0 0 1 M3 S9; feed 60 to 0 0 -2 M3 S9; "
       "dwell 500000us; spindle M5; rapid to 0 0 5 M3 S9; spindle M3 S9"},
      {"G86 R1 Z-2", "28@1"},
  });
}

TEST(Cycles, InOtherPlanes) {
  expect_rows({
      {"Y5|G18 G81 X1 Z2 R1 Y-2",
       "rapid to 1 5 2; rapid to 1 1 2; feed 60 to 1 -2 2; rapid to 1 5 2"},
      {"X5|G19 G81 Y1 Z2 R1 X-2",
       "rapid to 5 1 2; rapid to 1 1 2; feed 60 to -2 1 2; rapid to 5 1 2"},
  });
}

TEST(Cycles, WithOffsets) {
  expect_rows({
      {"G10 L2 P1 X10 Z1|G81 X1 R1 Z-2",
       "rapid to 11 0 5; rapid to 11 0 2; feed 60 to 11 0 -1; rapid to 11 0 5"},
      {"G68 X0 Y0 R90|G81 X1 R1 Z-2",
       "rapid to 0 1 5; rapid to 0 1 1; feed 60 to 0 1 -2; rapid to 0 1 5"},
      {"G95 S100 F0.1|G81 R1 Z0", "rapid to 0 0 1; feed 10 to 0 0 0; rapid to 0 0 5"},
      {"M130 P1|G81 R1 Z0", "rapid to 0 0 1 free; feed 60 to 0 0 0 free; rapid to 0 0 5 free"},
  });
}

/// Random holes: every one is cut to its depth from its retract level, in pecks no longer than Q,
/// and rapids never go below what has been cut.
TEST(Cycles, CutToTheDepthAndRapidsStayAboveTheCut) {
  std::mt19937_64 random(6);
  for (int run = 0; run < scaled(2000); ++run) {
    const Motion kinds[] = {Motion::drill, Motion::drill_dwell, Motion::drill_peck,
                            Motion::drill_chip_break};
    CycleRequest request{};
    request.kind = kinds[random() % 4];
    request.normal = static_cast<std::uint8_t>(random() % 3);
    request.retract_e7 = mm(static_cast<double>(random() % 100));
    request.depth_e7 = request.retract_e7 - static_cast<std::int64_t>(random() % 100'000'000);
    request.end_e7 = request.retract_e7 + static_cast<std::int64_t>(random() % 100'000'000);
    request.peck_e7 = 1'000'000 + static_cast<std::int64_t>(random() % 100'000'000);
    request.clearance_e7 = static_cast<std::int64_t>(random() % 5'000'000);
    request.holes = static_cast<std::uint32_t>(1 + random() % 3);
    request.start[request.normal] = mm(static_cast<double>(random() % 200)) - mm(50);
    request.step[(request.normal + 1u) % 3] = mm(1);
    DrillCycle cycle;
    cycle.begin(request);
    std::int64_t bottom = request.retract_e7, level = request.start[request.normal];
    std::uint32_t holes = 0;
    CycleMove move{};
    while (cycle.next(move)) {
      const std::int64_t to = move.to[request.normal];
      if (move.kind == CycleMove::Kind::cut) {
        ASSERT_GE(level, bottom);
        const bool pecks =
            request.kind == Motion::drill_peck || request.kind == Motion::drill_chip_break;
        ASSERT_TRUE(!pecks || bottom - to <= request.peck_e7);
        bottom = to;
        if (move.bottom) {
          ASSERT_EQ(to, request.depth_e7);
          ++holes;
        }
      } else if (move.kind == CycleMove::Kind::rapid) {
        ASSERT_TRUE(to >= bottom);
        ASSERT_LE(to, std::max({request.end_e7, request.start[request.normal]}));
        if (to == request.end_e7 && bottom == request.depth_e7) bottom = request.retract_e7;
      }
      level = to;
    }
    ASSERT_EQ(holes, request.holes);
    ASSERT_EQ(level, request.end_e7);
  }
}

}  // namespace
}  // namespace lamplock::program::cycles_test
