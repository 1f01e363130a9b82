#include "host/run/pause_beats.hpp"

#include <algorithm>
#include <initializer_list>

#include "shared/beat_reason.hpp"

namespace lamplock::run {
namespace {

/// Beats from one shot to the next at the maximum shot rate.
std::uint64_t min_beats(const settings::Values& values) {
  const std::int64_t rate = std::max(1, values.milli(settings::Id::max_shot_rate));
  const std::int64_t beats = (values.milli(settings::Id::lamp_frequency) + rate - 1) / rate;
  return static_cast<std::uint64_t>(std::max<std::int64_t>(1, beats));
}

/// Takes at most `beats` from the first of the reasons that have some; what it took is a pause.
void move_beats(std::uint64_t beats, std::initializer_list<BeatReason> reasons,
                NamedBeats& counts) {
  for (const BeatReason reason : reasons) {
    const auto found = counts.find(std::string(name(reason)));
    if (found == counts.end()) continue;
    const std::uint64_t moved = std::min(beats, found->second);
    found->second -= moved;
    counts[pause_reason] += moved;
    beats -= moved;
  }
}

}  // namespace

void count_pauses(const job::Job& job, std::size_t from, std::size_t end, NamedBeats& inside,
                  NamedBeats& outside) {
  end = std::min(end, job.targets.size());
  const auto fires = [&job](std::size_t i) { return !job.header.dry && job.targets[i].shots != 0; };
  // A dry run has no shot: all its beats are inside.
  std::size_t first = from, last = end;
  if (!job.header.dry) {
    while (first < end && !fires(first)) ++first;
    while (last > first && !fires(last - 1)) --last;
  }
  for (std::size_t i = from; i < end; ++i) {
    if (!job.is_pause(i)) continue;
    NamedBeats& counts = i >= first && i < last ? inside : outside;
    const std::uint64_t beats = job.targets[i].beats;
    if (job.header.dry) {
      move_beats(beats, {BeatReason::dry}, counts);
      continue;
    }
    const std::uint64_t kept_back = std::min(beats - 1, min_beats(job.settings) - 1);
    move_beats(1, {BeatReason::no_point_due, BeatReason::moving}, counts);
    move_beats(kept_back, {BeatReason::protection, BeatReason::moving}, counts);
    move_beats(beats - 1 - kept_back, {BeatReason::moving, BeatReason::protection}, counts);
  }
}

}  // namespace lamplock::run
