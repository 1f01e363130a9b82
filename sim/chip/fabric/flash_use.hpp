// How the masters use the flash: visits and misses of each line of eight bytes.
//
// In:  reads through the XIP window. Out: counts, and a text with a line for each line that was
// read. Who: XipMemory, if a FlashUse is connected to it; `lamplock chip --flash-use`.
//
// A visit is a read of a line by a master whose last read of the flash was of another line: a line
// cannot miss the cache more often than it is visited, so visits are what an order of the code can
// save (toolchain/order_code).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/chip/fabric/bus.hpp"

namespace lamplock::sim::chip {

class FlashUse {
 public:
  /// `flash_size` in bytes.
  explicit FlashUse(std::size_t flash_size);

  /// A read at an offset in the flash, less than its size; `hit`: the cache had the line.
  void read(std::uint32_t offset, Master master, bool hit);
  /// A comment, then `ADDRESS VISITS MISSES` for each line that was read, by address: the address
  /// of the line in hexadecimal, with which the image is linked.
  std::string text() const;

 private:
  struct Line {
    std::uint64_t visits = 0, misses = 0;
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<Line> lines_;
  std::array<std::uint32_t, 3> last_{none, none, none};  ///< line that each master read last
};

}  // namespace lamplock::sim::chip
