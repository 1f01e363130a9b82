#include "host/model/read_mesh.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <tuple>

#include "host/file.hpp"
#include "host/model/glb.hpp"
#include "host/model/input.hpp"
#include "host/model/mesh_builder.hpp"
#include "host/model/mesh_checks.hpp"
#include "host/model/mtl.hpp"
#include "host/model/ply.hpp"
#include "host/model/read_3mf.hpp"
#include "host/model/scene_brightness.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// Returns the number of bytes that the library may read.
std::size_t check(const path& file, const std::string& bytes) {
  const std::string extension = lower_extension(file);
  if (extension == ".stl") return check_stl(file, bytes);
  if (extension == ".obj") {
    check_obj(file, bytes);
  } else if (extension == ".ply") {
    read_ply_vertices(file, bytes, read_ply_header(file, bytes));
  } else if (extension == ".glb") {
    check_glb(file, bytes);
  } else {
    refuse(file, fmt::format("'{}' is not a mesh format", extension),
           fmt::format("give a mesh ({})", extensions(InputKind::mesh)));
  }
  return bytes.size();
}

/// Collects the triangles of all nodes, three corners each.
class Collector {
 public:
  Collector(const aiScene& scene, const path& file, std::map<std::string, std::string> pictures)
      : scene_(scene), file_(file), brightness_(scene, file, std::move(pictures)) {
    add_node(*scene.mRootNode, aiMatrix4x4());
  }

  const std::vector<geometry::Point>& corners() const { return corners_; }
  SceneBrightness& brightness() { return brightness_; }

 private:
  void add_node(const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[m]];
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        // Points and lines have no surface.
        if (mesh.mFaces[f].mNumIndices == 3) add_triangle(mesh, mesh.mFaces[f], transform);
      }
    }
    for (unsigned child = 0; child < node.mNumChildren; ++child) {
      add_node(*node.mChildren[child], transform);
    }
  }

  void add_triangle(const aiMesh& mesh, const aiFace& face, const aiMatrix4x4& transform) {
    for (unsigned corner = 0; corner < 3; ++corner) {
      const unsigned index = face.mIndices[corner];
      if (index >= mesh.mNumVertices) {
        refuse(file_, fmt::format("a triangle names vertex {} of {}", index, mesh.mNumVertices),
               "repair the model");
      }
      const aiVector3D v = transform * mesh.mVertices[index];
      // + 0.0 makes -0 and 0 one position
      corners_.push_back({static_cast<double>(v.x) + 0.0, static_cast<double>(v.y) + 0.0,
                          static_cast<double>(v.z) + 0.0});
    }
    brightness_.add(mesh, face);
  }

  const aiScene& scene_;
  const path& file_;
  SceneBrightness brightness_;
  std::vector<geometry::Point> corners_;
};

void require_finite_corners(const path& file, const std::vector<geometry::Point>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const geometry::Point& p = corners[i];
    if (geometry::is_finite(p)) continue;
    refuse(file,
           fmt::format("corner {} of triangle {} is ({}, {}, {})", i % 3, i / 3, p.x, p.y, p.z),
           "repair the model");
  }
}

/// Corners of equal position become one vertex, numbered in order of first use. `kept`: the
/// remaining triangles.
Mesh merged_corners(const std::vector<geometry::Point>& corners, std::vector<std::uint32_t>& kept) {
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
  std::vector<std::uint32_t> vertex(corners.size());
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

}  // namespace

Mesh read_mesh(const path& file) { return decode_mesh(file, read_file(file)); }

Mesh decode_mesh(const path& file, std::string bytes) {
  if (lower_extension(file) == ".3mf") {
    MeshBuilder builder(file);
    read_3mf(file, builder);
    return builder.take();
  }
  const std::size_t length = check(file, bytes);
  const std::string extension = lower_extension(file);
  std::map<std::string, std::string> pictures;
  if (extension == ".obj") {
    pictures = pictures_of_materials(file, bytes);
    bytes = without_material_libraries(std::move(bytes));
  }
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), length, aiProcess_Triangulate,
                                                     extension.c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    refuse(file, "the mesh library refuses it: " + reason, "export the file again");
  }
  Collector collector(*scene, file, std::move(pictures));
  const std::vector<geometry::Point>& corners = collector.corners();
  if (corners.size() > std::numeric_limits<std::uint32_t>::max()) {
    refuse(file, fmt::format("{} triangles are too many", corners.size() / 3), "reduce the mesh");
  }
  require_finite_corners(file, corners);
  std::vector<std::uint32_t> kept;
  Mesh mesh = merged_corners(corners, kept);
  if (mesh.triangles.empty()) {
    refuse(file, "the mesh is empty: it has no triangle", "give a model with a surface");
  }
  mesh.brightness = collector.brightness().take(kept);
  mesh.unread_pictures = collector.brightness().unread();
  return mesh;
}

}  // namespace lamplock::model
