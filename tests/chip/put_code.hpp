// Writes code and data directly to the memory of a simulated chip, in no simulated time.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>

#include "sim/chip/chip.hpp"
#include "sim/chip/fabric/bus.hpp"

namespace lamplock::test {

inline void put(sim::chip::Bus& bus, std::uint32_t address,
                std::initializer_list<unsigned> halfwords) {
  for (const unsigned value : halfwords) {
    const auto half = static_cast<std::uint16_t>(value);
    std::memcpy(bus.memory_at(address).data(), &half, sizeof half);
    address += 2;
  }
}
inline void put_word(sim::chip::Bus& bus, std::uint32_t address, std::uint32_t value) {
  std::memcpy(bus.memory_at(address).data(), &value, sizeof value);
}

inline void put(sim::chip::Chip& chip, std::uint32_t address,
                std::initializer_list<unsigned> halfwords) {
  put(chip.bus(), address, halfwords);
}
inline void put_word(sim::chip::Chip& chip, std::uint32_t address, std::uint32_t value) {
  put_word(chip.bus(), address, value);
}

}  // namespace lamplock::test
