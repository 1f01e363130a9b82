// The functions of an image by their addresses.
//
// In:  the symbols of the image, if it has some. Out: the function at an address.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/chip/image/image.hpp"

namespace lamplock::sim::chip {

/// Sorted by address.
class FunctionTable {
 public:
  explicit FunctionTable(std::span<const ImageSymbol> symbols);
  std::size_t size() const { return symbols_.size(); }
  const ImageSymbol& operator[](std::size_t index) const { return symbols_[index]; }
  /// The index of the function that an address belongs to; size(): none. A function without a size,
  /// as in assembler, reaches to the next.
  std::size_t find(std::uint32_t address) const;

 private:
  std::vector<ImageSymbol> symbols_;
};

}  // namespace lamplock::sim::chip
