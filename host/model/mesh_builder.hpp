// Collects the triangles of a mesh file in double precision.
//
// In:  triangles with brightness and pictures, from the reader of a format. Out: a Mesh whose
//      corners of equal position are one vertex.
// Who: the readers of the mesh formats, called by read_mesh().
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/brightness.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::model {

/// A triangle of a file. Without `lights` it is white.
struct MeshTriangle {
  std::array<geometry::Point, 3> corners{};
  std::optional<std::array<float, 3>> lights{};  // brightness of the corners
  Brightness::Textured textured{};               // texture: number from MeshBuilder::texture()
};

class MeshBuilder {
 public:
  /// `file` is named in errors.
  explicit MeshBuilder(const std::filesystem::path& file) : file_(file) {}

  void add(const MeshTriangle& triangle);

  /// The number of a picture. `read` is called once for each name; if it throws an Error, or
  /// the pictures are too large together, it is listed as unread and its surface is white.
  std::uint32_t texture(const std::string& name, const std::function<Bitmap()>& read);

  /// Notes a point that the file stores in single precision. `mm` is the length of its unit.
  void stored_in_single(const geometry::Point& point, double mm);

  /// Adds a line to the warnings of the mesh.
  void warn(std::string line) { warnings_.push_back(std::move(line)); }

  /// The mesh: equal corners merged, seams of rounding joined, triangles without area by shared
  /// corners dropped. Throws Error (bad_input): no triangle, too many, a corner that is not finite.
  /// Call it once, at the end.
  Mesh take();

 private:
  void require_finite_corners() const;
  void warn_of_precision(const Mesh& mesh);
  std::optional<Brightness> brightness_of(const std::vector<std::uint32_t>& kept);

  const std::filesystem::path& file_;
  std::vector<geometry::Point> corners_;
  bool coloured_ = false, textured_ = false;
  Brightness all_;
  std::map<std::string, std::uint32_t> textures_;
  std::vector<std::string> unread_, warnings_;
  std::size_t pixels_ = 0;
  double max_single_ = 0, single_mm_ = 1;
};

/// Brightness of a colour of sRGB values 0..1 (Rec. ITU-R BT.601, as for pictures in
/// read_bitmap.cpp); values outside are limited, NaN is 0.
float luma(double red, double green, double blue);

}  // namespace lamplock::model
