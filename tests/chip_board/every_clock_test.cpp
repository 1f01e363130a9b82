// An engraving is the same whether or not the simulator skips idle clocks of PIO and DMA: every
// edge of every pad, and the end.
#include <tuple>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// All edges of all pads: pad, level, cycle.
struct AllEdges final : sim::chip::PadListener {
  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle at) override {
    edges.emplace_back(at, gpio, level);
  }
  std::vector<std::tuple<sim::chip::Cycle, unsigned, bool>> edges;
};

struct Engraving {
  std::vector<std::tuple<sim::chip::Cycle, unsigned, bool>> edges;
  Picoseconds end = 0;
  std::array<sim::chip::Cycle, 2> cycles{};
  std::size_t shots = 0;
};

Engraving engrave(bool every_clock) {
  const job::Profile profile = chip_profile(250);
  ChipRig rig(profile);
  // From here on; the program's own tests compare the boot.
  rig.board.chip().pio_dma().set_step_every_clock(every_clock);
  AllEdges edges;
  rig.board.chip().gpio().listen(edges);
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(6)), 5), profile, {});
  RunningJob running(rig, job, 7);
  EXPECT_EQ(running.finish(), JobEnd::done);
  rig.board.chip().gpio().catch_up(rig.board.chip().now());
  // Edges of different pads may be reported out of order.
  std::stable_sort(edges.edges.begin(), edges.edges.end());
  return {edges.edges,
          rig.now(),
          {rig.board.chip().core(0).cycle(), rig.board.chip().core(1).cycle()},
          rig.shots().size()};
}

TEST(EveryClock, AnEngravingIsTheSame) {
  const Engraving skipping = engrave(false), stepping = engrave(true);
  EXPECT_EQ(skipping.shots, static_cast<std::size_t>(scaled(6)));
  EXPECT_EQ(skipping.shots, stepping.shots);
  EXPECT_GT(skipping.edges.size(), 1000u);
  EXPECT_TRUE(skipping.edges == stepping.edges)
      << skipping.edges.size() << " and " << stepping.edges.size() << " edges";
  EXPECT_EQ(skipping.end, stepping.end);
  EXPECT_EQ(skipping.cycles, stepping.cycles);
}

}  // namespace
}  // namespace lamplock::test
