// Reads brightness from a scene of the mesh library: colours of vertices and pictures of materials.
// In: the scene, triangle by triangle in the order of the reader. Out: the brightness for a Mesh.
// Called by read_mesh().
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
  /// `file`: pictures are searched in its folder, and errors name it; `pictures`: those of
  /// materials by name that the scene does not contain. Scene and file must outlive this.
  SceneBrightness(const aiScene& scene, const std::filesystem::path& file,
                  std::map<std::string, std::string> pictures);

  /// Adds the next triangle; its indices must exist in `mesh`.
  void add(const aiMesh& mesh, const aiFace& triangle);

  /// Brightness of the remaining triangles, by their number from 0. Empty if the file has neither
  /// colours nor pictures.
  std::optional<Brightness> take(std::span<const std::uint32_t> kept);

  /// Pictures that are missing or cannot be read, each with the reason; their surface counts as
  /// white.
  const std::vector<std::string>& unread() const { return unread_; }

 private:
  float luma(const aiColor4D& colour) const;
  std::uint32_t texture_of(unsigned material);
  std::uint32_t read_texture(const std::string& name);
  Bitmap picture(const std::string& name) const;

  const aiScene& scene_;
  const std::filesystem::path& file_;
  std::map<std::string, std::string> pictures_;
  bool linear_ = false;  // colours of vertices are linear light, not sRGB values
  bool wanted_ = false;  // any mesh has brightness
  bool coloured_ = false;
  Brightness all_;
  std::vector<std::optional<std::uint32_t>> textures_;  // of each material, once looked at
  std::vector<std::string> names_, unread_;
};

}  // namespace lamplock::model
