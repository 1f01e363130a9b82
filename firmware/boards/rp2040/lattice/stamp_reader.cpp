#include "firmware/boards/rp2040/lattice/stamp_reader.hpp"

namespace lamplock::rp2040 {
namespace {
/// STAMP has an error of two clocks at both ends; FIRE decides what is a runt, this only matches
/// edges.
constexpr std::int32_t min_width_counts = (pio::max_runt_clocks - 4) / pio::clocks_per_stamp;
static_assert((pio::max_runt_clocks - 4) % pio::clocks_per_stamp == 0);
}  // namespace

bool StampReader::find(std::uint32_t count, std::uint64_t latest, std::uint64_t now,
                       std::uint64_t& edge) const {
  // X counts down from all ones; the present time says how often it has wrapped (every 68 s).
  const std::uint64_t counts = (now - start_) / pio::clocks_per_stamp;
  const std::uint64_t present = start_ + counts * pio::clocks_per_stamp - pio::synchroniser_clocks;
  // Counts since a word: words and the newest count are close enough for 32 bits.
  const auto ago = [counts](std::uint32_t word) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) + word + 1);
  };
  // An odd count: the newest stamp is a rise without a fall.
  bool open = count % 2 != 0;
  std::int32_t fall = 0;
  std::uint32_t i = count - 1;
  for (std::uint32_t n = 0; n < stamp_ring_words; ++n, --i) {
    const std::uint32_t word = ring_.words[i % stamp_ring_words];
    if (i % 2 != 0) {
      fall = ago(word - 1);  // one count late while the line was high
      continue;
    }
    const std::int32_t rise = ago(word);
    const std::uint64_t at =
        present - static_cast<std::uint64_t>(std::int64_t{rise} * pio::clocks_per_stamp);
    if (static_cast<std::int64_t>(at - last_edge_) <= 0) return false;
    const bool wide = open || rise - fall >= min_width_counts;
    open = false;
    if (!wide || static_cast<std::int64_t>(latest - at) < 0) continue;
    edge = at;
    return true;
  }
  return false;
}

}  // namespace lamplock::rp2040
