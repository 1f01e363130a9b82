#include "sim/chip/profile/function_table.hpp"

#include <algorithm>

namespace lamplock::sim::chip {

FunctionTable::FunctionTable(std::span<const ImageSymbol> symbols) {
  for (const ImageSymbol& symbol : symbols)
    if (symbol.function) symbols_.push_back(symbol);
  std::stable_sort(
      symbols_.begin(), symbols_.end(),
      [](const ImageSymbol& a, const ImageSymbol& b) { return a.address < b.address; });
}

std::size_t FunctionTable::find(std::uint32_t address) const {
  const auto next = std::upper_bound(
      symbols_.begin(), symbols_.end(), address,
      [](std::uint32_t value, const ImageSymbol& symbol) { return value < symbol.address; });
  if (next == symbols_.begin()) return size();
  const ImageSymbol& symbol = *(next - 1);
  if (symbol.size != 0 && address - symbol.address >= symbol.size) return size();
  return static_cast<std::size_t>(next - symbols_.begin()) - 1;
}

}  // namespace lamplock::sim::chip
