// Offsets and places that outlive a program: the owner of the interpreter stores them.
//
// All in machine coordinates or differences of them, 10^-7 mm. They may be changed from outside
// while the interpreter is not busy; it reads them in every line.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/program/modal.hpp"
#include "firmware/program/tool_table.hpp"
#include "firmware/program/value.hpp"

namespace lamplock::program {

/// Bits of Parameters::changed: 0..8 are the coordinate systems, origin and rotation.
enum class ParameterRow : std::uint8_t { home_g28 = 9, home_g30, shift, tool_length, tools };

struct Parameters {
  std::array<Place, coordinate_systems> systems_e7{};  ///< origins of G54 .. G59.3
  /// Their rotations round the origin, from X towards Y, 10^-7 degrees.
  std::array<std::int64_t, coordinate_systems> rotations_e7{};
  Place home_g28_e7{}, home_g30_e7{};
  Place shift_e7{};                 ///< G92; active if Modal::shifted
  std::int64_t tool_length_e7 = 0;  ///< G43 to G43.2, along Z; 0 after G49
  ToolTable tools;
  std::uint16_t changed = 0;  ///< a bit for each row that a line has changed; the owner clears

  /// Of coordinate system `number`, 0 is G54.
  [[gnu::cold]] Rotation rotation_of(std::size_t number) const {
    return system_rotation(systems_e7[number], rotations_e7[number]);
  }
  static Rotation system_rotation(const Place& origin_e7, std::int64_t angle_e7) {
    return angle_e7 == 0 ? Rotation{} : Rotation(0, 1, origin_e7, angle_e7);
  }
};

}  // namespace lamplock::program
