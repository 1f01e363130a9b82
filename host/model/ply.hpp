// The PLY format (Greg Turk, "The PLY Polygon File Format", Stanford, 1994). In: the bytes of a
// file. Out: the header, points, or triangles with brightness, in full precision; every element
// must be present. Called by the readers of point lists and meshes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/mesh_builder.hpp"

namespace lamplock::model {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> list_count;  // type of the count if this is a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

/// The element with strips of triangles, as scanners write it.
inline constexpr std::string_view ply_strips = "tristrips";

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t data_offset = 0;  // of the first byte after end_header
  std::string picture{};        // of a comment "TextureFile", as MeshLab writes it

  /// Elements of that name in the file, 0 if there is no such element.
  std::size_t count(std::string_view name) const;
  /// True for a mesh: the file has faces or strips of triangles.
  bool has_surface() const { return count("face") > 0 || count(ply_strips) > 0; }
};

/// Throws Error (bad_input, naming `path`) for a header that is damaged or cut off.
PlyHeader read_ply_header(const std::filesystem::path& path, std::string_view bytes);

/// Reads every element and returns the vertices. Throws Error (bad_input, naming `path`) if
/// elements are missing, a vertex is not finite (named by index from 0), x, y or z is missing, a
/// face names a vertex that does not exist, or the vertices are joined by edges only.
geometry::PointCloud read_ply_vertices(const std::filesystem::path& path, std::string_view bytes,
                                       const PlyHeader& header);

/// Reads the faces and strips as triangles, with colours of vertices and faces and a picture as
/// brightness. Throws the same errors.
void read_ply(const std::filesystem::path& path, std::string_view bytes, MeshBuilder& mesh);

}  // namespace lamplock::model
