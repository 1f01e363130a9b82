#include "host/model/mesh_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/geometry/bounds.hpp"
#include "host/geometry/vector.hpp"
#include "host/model/join_seams.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

/// A step of single precision larger than this part of the object is reported: 0.01 mm of 100 mm,
/// about the size of a crack in glass.
constexpr double max_step_of_size = 1e-4;

/// Pixels of the pictures after which no further one is read; each has at most 100 million.
constexpr std::size_t max_texture_pixels = 200'000'000;

/// Corners of equal position become one vertex, numbered in order of first use. `kept`: the
/// remaining triangles.
Mesh merge_corners(const std::vector<geometry::Point>& corners, std::vector<std::uint32_t>& kept) {
  std::vector<std::uint32_t> by_position(corners.size());
  std::iota(by_position.begin(), by_position.end(), 0u);
  std::sort(by_position.begin(), by_position.end(), [&](std::uint32_t a, std::uint32_t b) {
    const geometry::Point &p = corners[a], &q = corners[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  std::vector<std::uint32_t> first(corners.size());  // the first corner at the same position
  for (std::size_t i = 0; i < by_position.size(); ++i) {
    const bool same = i > 0 && corners[by_position[i]] == corners[by_position[i - 1]];
    first[by_position[i]] = same ? first[by_position[i - 1]] : by_position[i];
  }
  Mesh mesh;
  std::vector<std::uint32_t>& vertex = by_position;  // its memory is used again
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (first[i] == i) {
      vertex[i] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(corners[i]);
    }
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const std::uint32_t a = vertex[first[i]], b = vertex[first[i + 1]], c = vertex[first[i + 2]];
    if (a == b || b == c || c == a) continue;
    mesh.triangles.push_back({a, b, c});
    kept.push_back(static_cast<std::uint32_t>(i / 3));
  }
  return mesh;
}

bool has_area(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const geometry::Point &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]],
                        &c = mesh.vertices[triangle[2]];
  const geometry::Point normal =
      geometry::cross(geometry::difference(b, a), geometry::difference(c, a));
  return normal.x != 0 || normal.y != 0 || normal.z != 0;
}

/// Removes vertices that no triangle uses.
void drop_unused_vertices(Mesh& mesh) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.vertices.size(), unused);
  std::vector<geometry::Point> vertices;
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& vertex : triangle) {
      std::uint32_t& now = number[vertex];
      if (now == unused) {
        now = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(mesh.vertices[vertex]);
      }
      vertex = now;
    }
  mesh.vertices = std::move(vertices);
}

/// Drops triangles without area that reach out of the box of all others, whose size and place they
/// would change; the rest of them may close seams. Returns their number.
std::size_t drop_strays(Mesh& mesh, std::vector<std::uint32_t>& kept) {
  const auto area = [&](const auto& triangle) { return has_area(mesh, triangle); };
  if (std::all_of(mesh.triangles.begin(), mesh.triangles.end(), area)) return 0;
  std::vector<geometry::Point> solid;
  for (const auto& triangle : mesh.triangles)
    if (area(triangle))
      for (const std::uint32_t vertex : triangle) solid.push_back(mesh.vertices[vertex]);
  if (solid.empty()) return 0;
  const geometry::Bounds box = geometry::bounds(solid);
  const auto is_outside = [&](std::uint32_t vertex) {
    return !box.contains(mesh.vertices[vertex]);
  };
  std::size_t left = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (std::any_of(mesh.triangles[i].begin(), mesh.triangles[i].end(), is_outside)) continue;
    mesh.triangles[left] = mesh.triangles[i];
    kept[left++] = kept[i];
  }
  const std::size_t strays = mesh.triangles.size() - left;
  mesh.triangles.resize(left);
  kept.resize(left);
  if (strays != 0) drop_unused_vertices(mesh);
  return strays;
}

/// Keeps the entries of `list` that `kept` numbers; `kept` ascends.
template <class Entry>
void keep(std::vector<Entry>& list, const std::vector<std::uint32_t>& kept) {
  if (list.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) list[i] = list[kept[i]];
  list.resize(kept.size());
}

}  // namespace

void MeshBuilder::add(const MeshTriangle& triangle) {
  const std::size_t count = corners_.size() / 3;
  for (const geometry::Point& corner : triangle.corners)
    // + 0.0 makes -0 and 0 one position
    corners_.push_back({corner.x + 0.0, corner.y + 0.0, corner.z + 0.0});
  // The lists begin with the first triangle that has brightness: most meshes need no memory for it.
  if (triangle.lights && !coloured_) {
    coloured_ = true;
    all_.corners.resize(count, {1, 1, 1});
  }
  if (triangle.textured.texture != Brightness::no_texture && !textured_) {
    textured_ = true;
    all_.textured.resize(count);
  }
  if (coloured_) all_.corners.push_back(triangle.lights.value_or(std::array<float, 3>{1, 1, 1}));
  if (textured_) all_.textured.push_back(triangle.textured);
}

std::uint32_t MeshBuilder::texture(const std::string& name, const std::function<Bitmap()>& read) {
  const auto [known, is_new] = textures_.try_emplace(name, Brightness::no_texture);
  if (!is_new) return known->second;
  try {
    if (pixels_ > max_texture_pixels) refuse(name, "too many pixels", "use smaller pictures");
    Bitmap bitmap = flattened(read(), white);  // a surface has no holes
    pixels_ += bitmap.grey.size();
    known->second = static_cast<std::uint32_t>(all_.textures.size());
    all_.textures.push_back(std::move(bitmap));
  } catch (const Error& error) {
    unread_.push_back(fmt::format("{} ({})", name, error.message()));
  }
  return known->second;
}

void MeshBuilder::stored_in_single(const geometry::Point& point, double mm) {
  const double largest = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)});
  if (largest * mm <= max_single_ * single_mm_) return;
  max_single_ = largest;
  single_mm_ = mm;
}

Mesh MeshBuilder::take() {
  if (corners_.size() > std::numeric_limits<std::uint32_t>::max())
    refuse(file_, fmt::format("{} triangles are too many", corners_.size() / 3), "reduce the mesh");
  require_finite_corners();
  std::vector<std::uint32_t> kept;
  Mesh mesh = merge_corners(corners_, kept);
  if (mesh.triangles.empty())
    refuse(file_, "the mesh is empty: it has no triangle", "give a model with a surface");
  if (const std::size_t strays = drop_strays(mesh, kept); strays != 0)
    warn(fmt::format(
        "{} out of the object: left out",
        count_text(strays, "triangle without area reaches", "triangles without area reach")));
  if (join_seams(mesh, kept) != 0) drop_unused_vertices(mesh);
  mesh.brightness = brightness_of(kept);
  mesh.unread_pictures = std::move(unread_);
  warn_of_precision(mesh);
  mesh.reader_warnings = std::move(warnings_);
  return mesh;
}

void MeshBuilder::require_finite_corners() const {
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const geometry::Point& p = corners_[i];
    if (geometry::is_finite(p)) continue;
    refuse(file_,
           fmt::format("corner {} of triangle {} is ({}, {}, {})", i % 3, i / 3, p.x, p.y, p.z),
           "repair the model");
  }
}

void MeshBuilder::warn_of_precision(const Mesh& mesh) {
  if (max_single_ == 0) return;
  // The distance of two neighbouring numbers of single precision, 24 bits.
  const double step = std::ldexp(1.0, std::ilogb(max_single_) - 23);
  const double size = geometry::bounds(mesh.vertices).max_side();
  if (step * single_mm_ <= max_step_of_size * size) return;
  warn(
      fmt::format("coordinates near {:.9g} are stored in single precision, in steps of {:.2g}, and "
                  "the object is only {:.4g} long: move it to the origin before it is exported",
                  max_single_, step, size / single_mm_));
}

std::optional<Brightness> MeshBuilder::brightness_of(const std::vector<std::uint32_t>& kept) {
  if (!coloured_ && !textured_) return std::nullopt;
  keep(all_.corners, kept);
  keep(all_.textured, kept);
  return std::move(all_);
}

float luma(double red, double green, double blue) {
  const double value = 0.299 * red + 0.587 * green + 0.114 * blue;
  return static_cast<float>(value > 0 ? std::min(value, 1.0) : 0.0);  // NaN gives 0
}

}  // namespace lamplock::model
