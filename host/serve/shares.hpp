// Numbers in the binary messages for pages: 16 bits, little endian.
//
// Who: clouds and paths.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

namespace lamplock::serve {

inline void put_16(std::string& bytes, unsigned value) {
  bytes += static_cast<char>(value & 0xff);
  bytes += static_cast<char>(value >> 8);
}

/// 0 to 65535 for 0 to 1.
inline void put_share(std::string& bytes, double share) {
  constexpr double full = 65535;
  put_16(bytes, static_cast<unsigned>(std::lround(std::clamp(share, 0.0, 1.0) * full)));
}

/// Where a value lies from `low` to `high`: 0 to 1; 0.5 if the range is empty.
inline double share_of(double value, double low, double high) {
  return high > low ? (value - low) / (high - low) : 0.5;
}

}  // namespace lamplock::serve
