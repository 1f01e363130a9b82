// The compiler's own 128-bit integer: an independent reference for ours.
#pragma once

#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock::test {

__extension__ using Native = __int128;
__extension__ using UnsignedNative = unsigned __int128;

inline Native native(Int128 x) {
  return static_cast<Native>(
      (static_cast<UnsignedNative>(static_cast<std::uint64_t>(x.hi())) << 64) | x.lo());
}

inline Int128 to_int128(Native x) {
  const auto u = static_cast<UnsignedNative>(x);
  return {static_cast<std::uint64_t>(u >> 64), static_cast<std::uint64_t>(u)};
}

}  // namespace lamplock::test
