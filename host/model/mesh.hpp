// A triangle mesh: output of the mesh readers, input of the discretisers. Its unit is a mm if the
// format of the file has a unit (3MF, GLB), otherwise that of the file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/brightness.hpp"

namespace lamplock::model {

/// Corners of equal position are one vertex; no triangle has a vertex twice.
struct Mesh {
  std::vector<geometry::Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Present if the file has colours or textures.
  std::optional<Brightness> brightness{};
  /// Pictures named in the file that could not be read, each with the reason.
  std::vector<std::string> unread_pictures{};
  /// Lines for the user about parts of the file that were left out or lost precision.
  std::vector<std::string> reader_warnings{};
};

}  // namespace lamplock::model
