#include "firmware/boards/rp2040/fire/stamp_reader.hpp"

namespace lamplock::rp2040 {
namespace {
/// STAMP is two clocks coarse at both ends; FIRE says what is a runt, this only tells them apart.
constexpr std::uint64_t least_width_clocks = pio::longest_runt_clocks - 4;
}  // namespace

std::uint64_t StampReader::clock_of(std::uint32_t word, std::uint64_t now) const {
  // X counts down from all ones; the present time says how often it has wrapped (every 68 s).
  const std::uint32_t counted = ~word;
  const auto present = static_cast<std::uint32_t>((now - start_) / pio::clocks_per_stamp);
  const auto ago = static_cast<std::int32_t>(present - counted);
  const std::uint64_t since = (now - start_) - ((now - start_) % pio::clocks_per_stamp);
  return start_ + since - static_cast<std::uint64_t>(std::int64_t{ago} * pio::clocks_per_stamp) -
         pio::synchroniser_clocks;
}

bool StampReader::find(std::uint32_t count, std::uint64_t latest, std::uint64_t now,
                       std::uint64_t& edge) const {
  // An odd count: the newest stamp is a rise without a fall.
  bool open = count % 2 != 0;
  std::uint64_t fall = 0;
  std::uint32_t i = count - 1;
  for (std::uint32_t n = 0; n < stamp_ring_words; ++n, --i) {
    const std::uint32_t word = ring_.words[i % stamp_ring_words];
    if (i % 2 != 0) {
      fall = clock_of(word - 1, now);  // one count behind while the line was high
      continue;
    }
    const std::uint64_t rise = clock_of(word, now);
    if (static_cast<std::int64_t>(rise - last_edge_) <= 0) return false;
    const bool wide = open || fall - rise >= least_width_clocks;
    open = false;
    if (!wide || static_cast<std::int64_t>(latest - rise) < 0) continue;
    edge = rise;
    return true;
  }
  return false;
}

}  // namespace lamplock::rp2040
