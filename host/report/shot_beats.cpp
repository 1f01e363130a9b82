#include "host/report/shot_beats.hpp"

#include <algorithm>

#include "shared/beat.hpp"

namespace lamplock::report {

std::vector<std::uint32_t> beats_from_first(const sim::Shots& shots,
                                            const settings::Values& settings) {
  const bool free =
      settings.whole(settings::Id::lamp_mode) == static_cast<int>(settings::LampMode::free_beat);
  const sim::Picoseconds beat = beat_ticks(settings) * sim::ps_per_us;
  std::vector<std::uint32_t> beats(shots.size());
  std::transform(shots.begin(), shots.end(), beats.begin(), [&](const sim::Shot& shot) {
    return static_cast<std::uint32_t>(free ? (shot.at - shots.front().at + beat / 2) / beat
                                           : shot.beat - shots.front().beat);
  });
  return beats;
}

}  // namespace lamplock::report
