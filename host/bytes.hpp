// Numbers in the bytes of files: integers and floating point, in either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace lamplock {

/// Reads the number at `bytes`.
template <class Value>
Value load(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(Value)> raw{};
  std::memcpy(raw.data(), bytes, raw.size());
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Value>(raw);
}

/// Appends a number, little endian.
template <class Value>
void append(std::string& bytes, Value value) {
  auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(value);
  if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

}  // namespace lamplock
