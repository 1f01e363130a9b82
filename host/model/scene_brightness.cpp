#include "host/model/scene_brightness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/model/read_bitmap.hpp"

namespace lamplock::model {

SceneBrightness::SceneBrightness(const aiScene& scene, const std::filesystem::path& file,
                                 std::map<std::string, std::string> pictures)
    : scene_(scene),
      file_(file),
      pictures_(std::move(pictures)),
      // "glTF 2.0 Specification", 3.7.2.1: COLOR_0 is linear; the other formats do not specify it.
      linear_(lower_extension(file) == ".glb"),
      textures_(scene.mNumMaterials) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const bool pictured =
        mesh.HasTextureCoords(0) && texture_of(mesh.mMaterialIndex) != Brightness::no_texture;
    wanted_ = wanted_ || mesh.HasVertexColors(0) || pictured;
  }
}

void SceneBrightness::add(const aiMesh& mesh, const aiFace& triangle) {
  if (!wanted_) return;  // most meshes need no memory for it
  std::array<float, 3> lights{1, 1, 1};
  Brightness::Textured textured;
  textured.texture = texture_of(mesh.mMaterialIndex);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const unsigned index = triangle.mIndices[corner];
    if (mesh.HasVertexColors(0)) lights[corner] = luma(mesh.mColors[0][index]);
    if (!mesh.HasTextureCoords(0)) continue;
    textured.corners[corner] = {mesh.mTextureCoords[0][index].x, mesh.mTextureCoords[0][index].y};
  }
  coloured_ = coloured_ || mesh.HasVertexColors(0);
  if (!mesh.HasTextureCoords(0)) textured.texture = Brightness::no_texture;
  all_.corners.push_back(lights);
  all_.textured.push_back(textured);
}

std::optional<Brightness> SceneBrightness::take(std::span<const std::uint32_t> kept) {
  if (!coloured_) all_.corners.clear();
  if (all_.textures.empty()) all_.textured.clear();
  if (all_.corners.empty() && all_.textured.empty()) return std::nullopt;
  // `kept` ascends, so each triangle moves to a place that was already read.
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!all_.corners.empty()) all_.corners[i] = all_.corners[kept[i]];
    if (!all_.textured.empty()) all_.textured[i] = all_.textured[kept[i]];
  }
  if (!all_.corners.empty()) all_.corners.resize(kept.size());
  if (!all_.textured.empty()) all_.textured.resize(kept.size());
  return std::move(all_);
}

/// Rec. ITU-R BT.601, as for pictures (bitmap.cpp).
float SceneBrightness::luma(const aiColor4D& colour) const {
  const float value = 0.299F * colour.r + 0.587F * colour.g + 0.114F * colour.b;
  const float clamped = value > 0 ? std::min(value, 1.0F) : 0.0F;  // NaN gives 0
  constexpr float display_gamma = 2.2F;
  return linear_ ? std::pow(clamped, 1 / display_gamma) : clamped;
}

std::uint32_t SceneBrightness::texture_of(unsigned material) {
  if (material >= textures_.size()) return Brightness::no_texture;
  std::optional<std::uint32_t>& known = textures_[material];
  if (known) return *known;
  known = Brightness::no_texture;
  const std::string material_name = scene_.mMaterials[material]->GetName().C_Str();
  if (const auto found = pictures_.find(material_name); found != pictures_.end()) {
    known = read_texture(found->second);
    return *known;
  }
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    if (scene_.mMaterials[material]->GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
    known = read_texture(name.C_Str());
    break;
  }
  return *known;
}

std::uint32_t SceneBrightness::read_texture(const std::string& name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) return static_cast<std::uint32_t>(found - names_.begin());
  Bitmap bitmap;
  try {
    bitmap = picture(name);
  } catch (const Error& error) {
    unread_.push_back(fmt::format("{} ({})", name, error.message()));
    return Brightness::no_texture;
  }
  names_.push_back(name);
  all_.textures.push_back(std::move(bitmap));
  return static_cast<std::uint32_t>(names_.size() - 1);
}

Bitmap SceneBrightness::picture(const std::string& name) const {
  const aiTexture* inside = scene_.GetEmbeddedTexture(name.c_str());
  if (inside == nullptr) {
    std::string beside = name;
    std::replace(beside.begin(), beside.end(), '\\', '/');
    return read_bitmap(file_.parent_path() / beside);
  }
  // The library marks a compressed picture by a height of 0; its width is the number of bytes.
  if (inside->mHeight != 0)
    refuse(file_, "an embedded picture is not compressed", "use PNG or JPEG");
  const char* data = reinterpret_cast<const char*>(inside->pcData);
  return decode_bitmap(file_, std::string(data, inside->mWidth));
}

}  // namespace lamplock::model
