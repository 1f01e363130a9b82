// Constants and units that firmware, simulator and host agree on.
//
// Everything that moves is counted in steps (integers) and ticks (the smallest slice of time at
// which a step may start). A beat is one lamp period and lasts a whole number of ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lamplock {

/// Maximum number of axes of a machine: X Y Z A.
inline constexpr int max_axes = 4;
inline constexpr std::string_view axis_letters = "XYZA";

/// Nominal length of a tick.
inline constexpr std::uint32_t tick_ns = 1000;
inline constexpr std::uint32_t ticks_per_second = 1'000'000'000u / tick_ns;
/// No tick is shorter than this, however the lamp's beat stretches the lattice: its period may be
/// 10 % off nominal ($905, $910), a tick 5 % off that ($906).
inline constexpr std::uint32_t min_tick_ns = tick_ns * 3 / 4;

inline constexpr std::int64_t um_per_inch = 25'400;

/// System clock of the board in MHz. An image for another clock is built with another value
/// (toolchain/arm/CMakeLists.txt); everything else is derived from it, and a tick stays a tick.
#ifndef LAMPLOCK_CLOCK_MHZ
#define LAMPLOCK_CLOCK_MHZ 125
#endif
/// The same in Hz: the unit of times that cross the board interface.
inline constexpr std::uint32_t clock_hz = LAMPLOCK_CLOCK_MHZ * 1'000'000;
inline constexpr std::uint32_t clocks_per_tick = clock_hz / ticks_per_second;
inline constexpr std::uint32_t clocks_per_us = clock_hz / 1'000'000;

/// One value per axis.
template <class T>
using PerAxis = std::array<T, max_axes>;
/// Index of an axis in it.
constexpr std::size_t index(int axis) { return static_cast<std::size_t>(axis); }

/// Position of the machine in steps from machine zero.
using StepPosition = PerAxis<std::int32_t>;

}  // namespace lamplock
