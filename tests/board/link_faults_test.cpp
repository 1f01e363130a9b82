// Sender, bad cable, board, lamp, laser: shots = points, each once, whatever the cable does.
#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

struct Named {
  const char* name;
  Faults faults;
  friend void PrintTo(const Named& named, std::ostream* out) { *out << named.name; }
};

class BadCableToBoard : public testing::TestWithParam<Named> {};

TEST_P(BadCableToBoard, EveryPointIsFiredOnce) {
  int faults = 0;
  for (int seed = 0; seed < scaled(6); ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const job::Profile profile = lamp_profile(200, LampMode::slave, 10);
    const job::Job job = job_for(histogram_walk(600, number), profile, both_modes[seed % 2]);
    Rig rig(profile, {.jitter_us = 20, .wander = 0.01, .seed = number + 1});
    BoardCable cable(rig, GetParam().faults, number);
    link::SenderOptions sending = session(static_cast<std::uint32_t>(seed) * 7919 + 1);
    sending.auto_resume = true;  // noise may be a command of one byte
    const link::JobResult result = link::JobSender(cable, job, sending).run();
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, true));
    expect_sound(rig, profile.settings);
    expect_ledger(rig, result.status);
    EXPECT_EQ(cable.cuts_made(), GetParam().faults.cuts);
    if (GetParam().faults.cuts > 0) {
      EXPECT_GT(result.reconnects, 0u);
    }
    faults += cable.faults_made();
  }
  if (GetParam().faults.delay < std::chrono::milliseconds(10)) {
    EXPECT_GT(faults, 2 * scaled(6)) << "too few faults";
  }
}

constexpr std::chrono::milliseconds whole_job{3000};
INSTANTIATE_TEST_SUITE_P(
    Faults, BadCableToBoard,
    testing::Values(Named{"drops", {.drop = 1e-3}}, Named{"flips", {.flip = 1e-3}},
                    Named{"duplicates", {.duplicate = 1e-3}}, Named{"replays", {.replay = 0.2}},
                    Named{"strays", {.stray_realtime = 5e-3}},
                    Named{"cuts", {.cuts = 10, .cut_span = whole_job}},
                    Named{"slow", {.flip = 1e-4, .delay = std::chrono::milliseconds(40)}},
                    Named{"all",
                          {.drop = 4e-4,
                           .flip = 4e-4,
                           .duplicate = 4e-4,
                           .replay = 0.05,
                           .stray_realtime = 1e-3,
                           .cuts = 10,
                           .cut_span = whole_job}}),
    [](const auto& named) { return named.param.name; });

TEST(CutForGood, TheMachineHoldsAndTheJobContinuesWhereItWas) {
  // The host program ends with the cable; another one continues at the first point not fired.
  for (int seed = 0; seed < scaled(20); ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const job::Profile profile = lamp_profile(200, LampMode::slave, 10);
    const job::Job job = job::make_job(histogram_walk(400, number), profile, {});
    Rig rig(profile);
    std::mt19937_64 random(number);
    const auto cut_at = std::uniform_int_distribution<>(100, 1500)(random);
    {
      BoardCable cable(rig);
      link::JobSender sender(cable, job, session(1));
      while (cable.now() < std::chrono::milliseconds(cut_at)) ASSERT_TRUE(sender.step());
    }
    rig.run(5 * ps_per_s);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const wire::Status held = rig.status();
    ASSERT_NE(held.state, MachineState::run);
    ASSERT_EQ(rig.shots().size(), held.first_unfired);
    link::SenderOptions options;
    options.first_index = held.first_unfired;
    options.take_over = true;
    ASSERT_EQ(run_job(rig, job, options).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    expect_sound(rig, profile.settings);
  }
}

}  // namespace
}  // namespace lamplock::test
