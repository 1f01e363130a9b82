// Brightness out of a scene of the mesh library: colours of vertices and pictures that materials
// name. Comes in: the scene, triangle by triangle as the reader takes them. Goes out: what a Mesh
// carries of it. Called by read_mesh().
#pragma once

#include <assimp/scene.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/model/brightness.hpp"

namespace lamplock::model {

class SceneBrightness {
 public:
  /// `file` is where pictures are looked for beside, and what errors name; `pictures` are those of
  /// materials by name that the scene does not know of. Scene and file outlive this.
  SceneBrightness(const aiScene& scene, const std::filesystem::path& file,
                  std::map<std::string, std::string> pictures);

  /// The next triangle; its indices exist in `mesh`.
  void add(const aiMesh& mesh, const aiFace& triangle);

  /// Of those triangles, by their number from 0, that the mesh has in the end. Nothing if the file
  /// has neither colours nor pictures.
  std::optional<Brightness> take(std::span<const std::uint32_t> kept);

  /// Pictures that are missing or cannot be read, each with the reason: there the surface counts
  /// as white.
  const std::vector<std::string>& unread() const { return unread_; }

 private:
  float luma(const aiColor4D& colour) const;
  std::uint32_t texture_of(unsigned material);
  std::uint32_t read_texture(const std::string& name);
  Bitmap picture(const std::string& name) const;

  const aiScene& scene_;
  const std::filesystem::path& file_;
  std::map<std::string, std::string> pictures_;
  bool linear_ = false;  // colours of vertices are light, not values of a picture
  bool wanted_ = false;  // any mesh has brightness
  bool coloured_ = false;
  Brightness all_;
  std::vector<std::optional<std::uint32_t>> textures_;  // of each material, once looked at
  std::vector<std::string> names_, unread_;
};

}  // namespace lamplock::model
