// The cache of execution in place: 16 KiB, two ways, lines of eight bytes (RP2040 datasheet,
// 2.6.3.1), with its contents, so that code which forgets to flush it reads old data.
//
// In:  offsets in flash (24 bits), lines read from it.
// Out: lines present; counts of accesses and hits. Who: XipMemory.
// Not documented and assumed: the way that was used longer ago is replaced; the lines of way 0 are
// the first half of the cache used as SRAM.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace lamplock::sim::chip {

class XipCache {
 public:
  static constexpr std::uint32_t set_count = 1024;
  static constexpr std::uint32_t line_size = 8;
  static constexpr std::uint32_t size = 2 * set_count * line_size;

  /// The line of an offset, which then counts as used last; null: not present.
  std::uint8_t* find(std::uint32_t offset) {
    const Place place(offset);
    Set& set = sets_[place.set];
    for (unsigned way = 0; way < 2; ++way) {
      if (set.tags[way] != place.tag) continue;
      set.oldest = way ^ 1u;
      return line(place.set, way);
    }
    return nullptr;
  }
  /// The place for a line that was not found.
  std::uint8_t* replace(std::uint32_t offset) {
    const Place place(offset);
    Set& set = sets_[place.set];
    const unsigned way = set.oldest;
    set.tags[way] = place.tag;
    set.oldest = way ^ 1u;
    return line(place.set, way);
  }
  /// A write to the caching window drops the line.
  void invalidate(std::uint32_t offset) {
    const Place place(offset);
    for (std::uint32_t& tag : sets_[place.set].tags)
      if (tag == place.tag) tag = 0;
  }
  /// Drops all lines; what is in the memory stays (2.6.3.2).
  void flush() { sets_ = {}; }

  /// CTR_ACC and CTR_HIT: both saturate.
  void count(bool hit) {
    if (accesses_ != most) ++accesses_;
    if (hit && hits_ != most) ++hits_;
  }
  void clear_hits() { hits_ = 0; }
  void clear_accesses() { accesses_ = 0; }
  std::uint32_t hits() const { return hits_; }
  std::uint32_t accesses() const { return accesses_; }

  std::span<std::uint8_t> memory() { return memory_; }

 private:
  static constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  struct Set {
    std::array<std::uint32_t, 2> tags{};  ///< 0: empty
    unsigned oldest = 0;
  };
  struct Place {
    explicit Place(std::uint32_t offset)
        : set((offset & 0xff'ffffu) / line_size % set_count),
          tag((offset & 0xff'ffffu) / line_size / set_count + 1) {}
    std::uint32_t set, tag;
  };
  std::uint8_t* line(std::uint32_t set, unsigned way) {
    return &memory_[(way * set_count + set) * line_size];
  }

  std::array<Set, set_count> sets_{};
  std::array<std::uint8_t, size> memory_{};
  std::uint32_t hits_ = 0;
  std::uint32_t accesses_ = 0;
};

}  // namespace lamplock::sim::chip
