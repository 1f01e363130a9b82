// The same job gives the same steps and shots: repeated, over any link, beside other boards.
#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

constexpr sim::LampConfig lamp{
    .jitter_us = 20, .wander = 0.01, .dropout = 0.01, .runt = 0.05, .doubled = 0.02, .seed = 5};

job::Job some_job(const job::Profile& profile, std::uint64_t seed, JoinMode mode) {
  return job_for(histogram_walk(500, seed), profile, mode);
}

/// All output pins had the same edges.
bool same_pins(const PinMonitor& a, const PinMonitor& b) {
  for (int axis = 0; axis < max_axes; ++axis)
    if (a.steps(axis) != b.steps(axis)) return false;
  return a.fires() == b.fires();
}

TEST(Determinism, TwoRunsAreTheSameToThePicosecond) {
  for (const JoinMode mode : both_modes) {
    const job::Profile profile = lamp_profile();
    const job::Job job = some_job(profile, 1, mode);
    Rig one(profile, lamp), two(profile, lamp);
    const link::JobResult first = run_job(one, job), second = run_job(two, job);
    ASSERT_EQ(first.end, JobEnd::done);
    EXPECT_EQ(first.status, second.status);
    EXPECT_EQ(one.shots(), two.shots());
    EXPECT_TRUE(same_pins(one.monitor, two.monitor));
    EXPECT_EQ(one.board.now(), two.board.now());
  }
}

/// Beats of the shots, counted from the first.
std::vector<std::int64_t> beats_from_first(const Rig& rig) {
  std::vector<std::int64_t> beats;
  for (const PinMonitor::Fire& fire : rig.monitor.fires())
    beats.push_back(fire.period - rig.monitor.fires().front().period);
  return beats;
}

TEST(Determinism, ThePlanDoesNotDependOnHowTheHostTalks) {
  for (const JoinMode mode : both_modes) {
    const job::Profile profile = lamp_profile(50);  // slow enough for a host that retransmits
    const job::Job job = some_job(profile, 2, mode);
    Rig plain(profile);
    ASSERT_EQ(run_job(plain, job).end, JobEnd::done);
    for (int variant = 0; variant < scaled(8); ++variant) {
      link::SenderOptions options = session(static_cast<std::uint32_t>(variant) + 100);
      options.window_frames = 1 + static_cast<std::size_t>(variant % 5);
      options.status_interval = std::chrono::milliseconds(20 + 30 * (variant % 7));
      Rig rig(profile);
      // Bytes are lost but not flipped: a flipped byte could be a hold.
      BoardCable cable(rig, {.drop = 2e-4, .delay = std::chrono::milliseconds(variant % 11)},
                       static_cast<std::uint64_t>(variant));
      const link::JobResult result = link::JobSender(cable, job, options).run();
      ASSERT_EQ(result.end, JobEnd::done);
      ASSERT_EQ(result.status.starvations, 0u);
      EXPECT_EQ(beats_from_first(rig), beats_from_first(plain)) << "variant " << variant;
    }
  }
}

TEST(Determinism, BoardsInOneProcessDoNotDisturbEachOther) {
  const job::Profile slow = lamp_profile(50), fast = lamp_profile(200, LampMode::master);
  const job::Job slow_job = some_job(slow, 3, JoinMode::free);
  const job::Job fast_job = some_job(fast, 4, JoinMode::start_stop);
  Rig slow_alone(slow, lamp), fast_alone(fast);
  run_job(slow_alone, slow_job);
  run_job(fast_alone, fast_job);

  Rig slow_beside(slow, lamp), fast_beside(fast);
  link::SimulatedTransport slow_link(slow_beside.board), fast_link(fast_beside.board);
  link::SenderOptions options = session(0x5EED);
  link::JobSender slow_sender(slow_link, slow_job, options),
      fast_sender(fast_link, fast_job, options);
  bool slow_runs = true, fast_runs = true;
  while (slow_runs || fast_runs) {
    slow_runs = slow_runs && slow_sender.step();
    fast_runs = fast_runs && fast_sender.step();
  }
  EXPECT_EQ(slow_sender.result().end, JobEnd::done);
  EXPECT_EQ(fast_sender.result().end, JobEnd::done);
  EXPECT_TRUE(same_pins(slow_alone.monitor, slow_beside.monitor));
  EXPECT_TRUE(same_pins(fast_alone.monitor, fast_beside.monitor));
}

}  // namespace
}  // namespace lamplock::test
