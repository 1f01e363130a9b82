// The stamp reader: finds the time of the edge that the fire stage has judged.
//
// In:  the ring that DMA fills with the words of STAMP (even places: rises, odd places: falls),
//      their number, the present clock (within 1 us).
// Out: the clock of an accepted edge on the core's 64-bit clock, within one system clock.
// Who: FireUnit (beat interrupt, priority 1); no registers, tested on a PC.
//
// FIRE reports that an edge was accepted, STAMP the times of all edges, runts included. FIRE
// reports a known time after the edge and the CPU reads it a little later, so the edge is the
// newest one that is old enough and lasted long enough.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/pio/programs.hpp"

namespace lamplock::rp2040 {

inline constexpr std::uint32_t stamp_ring_words = 64;
inline constexpr unsigned stamp_ring_bits = 8;
static_assert(stamp_ring_words * 4 == 1u << stamp_ring_bits);

struct alignas(1u << stamp_ring_bits) StampRing {
  std::array<std::uint32_t, stamp_ring_words> words{};
};

class StampReader {
 public:
  explicit StampReader(StampRing& ring) : ring_(ring) {}

  /// STAMP started at `clock` with X all ones.
  void begin(std::uint64_t clock) {
    start_ = last_edge_ = clock;
    ring_.words.fill(~0u);
  }

  /// Clock of the newest accepted rise not after `latest`; `count`: words written so far
  /// (modulo any multiple of the ring), `now`: the present clock. False: none.
  bool find(std::uint32_t count, std::uint64_t latest, std::uint64_t now,
            std::uint64_t& edge) const;
  /// The edge has been judged: this one and all before it are used up.
  void used(std::uint64_t edge) { last_edge_ = edge; }

 private:
  StampRing& ring_;
  std::uint64_t start_ = 0;
  std::uint64_t last_edge_ = 0;
};

}  // namespace lamplock::rp2040
