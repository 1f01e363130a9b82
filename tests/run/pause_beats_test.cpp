// The beats of pauses in the counts of a board.
#include "host/run/pause_beats.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "shared/beat_reason.hpp"
#include "tests/scale.hpp"

namespace lamplock::run::pause_beats_test {
namespace {

using lamplock::test::scaled;

/// A beat as the board counts it, and as the report must count it.
struct Beat {
  BeatReason counted;
  bool is_pause = false;
};

job::Job random_job(std::mt19937_64& random) {
  job::Job job;
  job.header.dry = random() % 4 == 0;
  const auto count = 2 + random() % 30;
  for (std::uint64_t i = 0; i < count; ++i) {
    wire::Target point;
    point.steps[0] = static_cast<std::int32_t>(100 * i);
    // Some points are passed without a shot.
    point.shots = static_cast<std::uint8_t>(random() % 5 == 0 ? 0 : 1 + random() % 2);
    job.targets.push_back(point);
    if (random() % 3 != 0) continue;
    wire::Target pause = point;
    pause.shots = 0;
    pause.beats = static_cast<std::uint16_t>(1 + random() % 20);
    job.targets.push_back(pause);
  }
  return job;
}

/// The beats of the targets `from` up to `end`, one after the other, as the shot scheduler counts
/// them. `min_beats`: from one shot to the next.
std::vector<Beat> beats_of(const job::Job& job, std::size_t from, std::size_t end, int min_beats,
                           std::mt19937_64& random) {
  std::vector<Beat> beats;
  const BeatReason moving = job.header.dry ? BeatReason::dry : BeatReason::moving;
  for (std::size_t i = from; i < end; ++i) {
    const wire::Target& target = job.targets[i];
    const bool is_pause = job.is_pause(i);
    const int between = is_pause ? target.beats - 1 : static_cast<int>(random() % 4);
    for (int b = 0; b < between; ++b)
      beats.push_back(
          {is_pause && !job.header.dry && b < min_beats - 1 ? BeatReason::protection : moving,
           is_pause});
    const int last = is_pause ? 1 : std::max<int>(1, target.shots);
    for (int b = 0; b < last; ++b)
      beats.push_back({job.header.dry      ? BeatReason::dry
                       : target.shots != 0 ? BeatReason::fired
                                           : BeatReason::no_point_due,
                       is_pause});
  }
  return beats;
}

struct Counts {
  NamedBeats inside, outside;
};

/// The counts of beats from the first shot to the last, and of the others.
Counts counts_of(const job::Job& job, const std::vector<Beat>& beats, bool is_right) {
  std::size_t first = 0, last = beats.size();
  const auto fired = [&beats](std::size_t i) { return beats[i].counted == BeatReason::fired; };
  while (!job.header.dry && first < last && !fired(first)) ++first;
  while (!job.header.dry && last > first && !fired(last - 1)) --last;
  Counts counts;
  for (std::size_t i = 0; i < beats.size(); ++i) {
    NamedBeats& part = i >= first && i < last ? counts.inside : counts.outside;
    ++part[is_right && beats[i].is_pause ? pause_reason : std::string(name(beats[i].counted))];
  }
  return counts;
}

/// Reasons without beats do not matter.
NamedBeats without_zeros(NamedBeats beats) {
  std::erase_if(beats, [](const auto& entry) { return entry.second == 0; });
  return beats;
}

TEST(PauseBeats, HaveTheirOwnReasonWhereverTheJobBeginsAndEnds) {
  std::mt19937_64 random(5);
  for (int i = 0; i < scaled(300); ++i) {
    job::Job job = random_job(random);
    const int min_beats = 1 + static_cast<int>(random() % 4);
    job.settings.set_milli(settings::Id::lamp_frequency, 100'000);
    job.settings.set_milli(settings::Id::max_shot_rate, 100'000 / min_beats);
    const std::size_t from = random() % job.targets.size();
    const std::size_t end = from + random() % (job.targets.size() - from + 1);
    const std::vector<Beat> beats = beats_of(job, from, end, min_beats, random);
    Counts counted = counts_of(job, beats, false);
    const Counts right = counts_of(job, beats, true);
    count_pauses(job, from, end, counted.inside, counted.outside);
    EXPECT_EQ(without_zeros(counted.inside), without_zeros(right.inside)) << i;
    EXPECT_EQ(without_zeros(counted.outside), without_zeros(right.outside)) << i;
  }
}

/// A board that has reported fewer beats than the plan has, because the job was stopped.
TEST(PauseBeats, AreNeverMoreThanTheBoardHasCounted) {
  std::mt19937_64 random(6);
  const auto sum = [](const NamedBeats& beats) {
    std::uint64_t all = 0;
    for (const auto& entry : beats) all += entry.second;
    return all;
  };
  for (int i = 0; i < scaled(300); ++i) {
    const job::Job job = random_job(random);
    NamedBeats inside{{"moving", random() % 9}, {"fired", 7}}, outside{{"moving", random() % 3}};
    const std::uint64_t before = sum(inside), before_outside = sum(outside);
    count_pauses(job, 0, random() % 99, inside, outside);
    EXPECT_EQ(sum(inside), before);
    EXPECT_EQ(sum(outside), before_outside);
    EXPECT_EQ(inside["fired"], 7u);
  }
}

}  // namespace
}  // namespace lamplock::run::pause_beats_test
