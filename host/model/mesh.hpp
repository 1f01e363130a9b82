// A triangle mesh in the units of its file: what the mesh readers give and what the discretisers
// take.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/model/brightness.hpp"
#include "host/points/point.hpp"

namespace lamplock::model {

/// Corners of equal position are one vertex; no triangle names a vertex twice.
struct Mesh {
  std::vector<points::Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Only if the file has colours of vertices or textures.
  std::optional<Brightness> brightness{};
  /// Pictures that the file names but that could not be read, each with the reason.
  std::vector<std::string> unread_pictures{};
};

}  // namespace lamplock::model
