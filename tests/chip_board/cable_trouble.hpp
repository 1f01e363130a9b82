// Troubles that each USB function of the board must survive: garbage, and a cable that is pulled
// and plugged in again during jobs. Each test defines how it is pulled and which bytes are sent
// meanwhile.
#pragma once

#include <functional>
#include <random>
#include <span>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {

inline void fill_with_noise(std::span<std::uint8_t> bytes, std::mt19937_64& random) {
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
}

/// Garbage had no effect, and the board still answers.
inline void expect_garbage_did_nothing(ChipRig& rig) {
  EXPECT_TRUE(rig.monitor.nothing_happened());
  EXPECT_FALSE(rig.energy.any_high_within(0, rig.now()));
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
  const auto unsent = [&host = rig.board.usb_host()] {
    return host.unsent(sim::chip::UsbFunction::serial) +
           host.unsent(sim::chip::UsbFunction::vendor);
  };
  for (int i = 0; i < 500 && unsent() != 0; ++i) {
    rig.run(ps_per_ms);
    rig.listen();
  }
  rig.run(50 * ps_per_ms);
  rig.answer("$I");  // ends an incomplete line or frame of the garbage
  EXPECT_THAT(rig.answer("$I"), testing::HasSubstr("[VER:"));
}

/// How a cable is pulled in a job.
struct CableCuts {
  std::uint64_t seed = 0;
  std::size_t first_after_shots = 0;    ///< no cut before this many shots; 0: from the begin on
  std::function<void(int cut)> pull{};  ///< numbers of cuts count from 0 over all jobs
  std::function<void()> plug{};
  Picoseconds max_wait = 0;  ///< to the first cut
  /// Adds further actions after the cable is back, at `back`.
  std::function<void(ChipCable& cable, Picoseconds back)> beside{};
};

/// Runs jobs with three cuts each at random moments: each job ends, every point is fired once.
inline void run_jobs_with_cuts(ChipRig& rig, const job::Profile& profile, const CableCuts& cuts) {
  std::mt19937_64 random(cuts.seed);
  const Pick<Picoseconds> up_to(random);
  int cut = 0, pulled = 0;
  for (int round = 0; round < scaled(2); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const job::Job job = job::make_job(chip_points(80, random()), profile, {});
    const std::size_t fired = rig.shots().size();
    RunningJob running(rig, job, static_cast<std::uint32_t>(round + 1));
    ASSERT_TRUE(running.run_until_fired(cuts.first_after_shots));
    Picoseconds at = rig.now() + up_to(cuts.max_wait);
    for (int i = 0; i < 3; ++i, ++cut) {
      running.cable.at(at, [&rig, &cuts, &pulled, cut] {
        if (!rig.board.usb_host().enumerated()) return;
        ++pulled;
        cuts.pull(cut);
      });
      at += 5 * ps_per_ms + up_to(40 * ps_per_ms);
      running.cable.at(at, cuts.plug);
      if (cuts.beside) cuts.beside(running.cable, at);
      at += 30 * ps_per_ms + up_to(60 * ps_per_ms);
    }
    ASSERT_EQ(running.finish(), JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job, fired));
    EXPECT_EQ(rig.monitor.violation(profile.settings), "");
  }
  EXPECT_GT(pulled, scaled(2));
}

}  // namespace lamplock::test
