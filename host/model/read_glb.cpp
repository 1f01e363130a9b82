#include "host/model/read_glb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/file.hpp"
#include "host/model/glb.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/model/threemf_package.hpp"
#include "host/model/transform.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using nlohmann::json;
using std::filesystem::path;

constexpr double glb_unit_mm = 1000;

/// As for 3MF (threemf_objects.cpp), unless the file itself is larger: six bytes of indices are the
/// least that a triangle takes without copies.
constexpr std::size_t max_placed_triangles = 8'000'000, min_triangle_bytes = 6;
/// Nodes and primitives with all their copies; as for objects of 3MF.
constexpr std::size_t max_placed_parts = 100'000;

[[noreturn]] void refuse_value(const path& file, const std::string& what) {
  refuse(file, what, "the file is damaged: export it again");
}

/// An index that another part of the description gives.
std::size_t index_in(const path& file, const json& index, std::size_t count, const char* what) {
  if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= count)
    refuse_value(file, fmt::format("it names {} {:.20} of {}", what, index.dump(), count));
  return index.get<std::size_t>();
}

/// Fills `values` with a list of numbers; leaves them if the list is missing.
template <std::size_t count>
void read_numbers(const path& file, const json& object, const char* key,
                  std::array<double, count>& values) {
  const auto found = object.find(key);
  if (found == object.end()) return;
  if (!found->is_array() || found->size() < count)
    refuse_value(file, fmt::format("'{}' does not have {} numbers", key, count));
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = found->at(i).get<double>();
    if (!std::isfinite(values[i])) refuse_value(file, fmt::format("'{}' is not finite", key));
  }
}

/// Position of a node relative to its parent.
geometry::Affine map_of_node(const path& file, const json& node) {
  if (node.contains("matrix")) {
    std::array<double, 16> m{};  // by columns
    read_numbers(file, node, "matrix", m);
    return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
  }
  std::array<double, 3> move{}, scale{1, 1, 1};
  std::array<double, 4> turn{0, 0, 0, 1};  // a quaternion; its real part is the last
  read_numbers(file, node, "translation", move);
  read_numbers(file, node, "rotation", turn);
  read_numbers(file, node, "scale", scale);
  const auto [x, y, z, w] = turn;
  geometry::Affine map{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                       {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                       {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)},
                       {move[0], move[1], move[2]}};
  return map * geometry::scaled(scale[0], scale[1], scale[2]);
}

/// Brightness as displayed of the brightness of linear light ("glTF 2.0 Specification", 3.7.2.1 and
/// 3.9.2: colours of vertices and base colours are linear).
float displayed(double red, double green, double blue) {
  constexpr float display_gamma = 2.2F;
  return std::pow(luma(red, green, blue), 1 / display_gamma);
}

/// The material of a primitive.
struct Surface {
  std::array<double, 4> factor{1, 1, 1, 1};
  bool has_factor = false;
  std::uint32_t texture = Brightness::no_texture;
  std::string places{};  // the attribute with the places in the picture
};

class GlbReader {
 public:
  GlbReader(const path& file, std::string_view bytes, MeshBuilder& mesh)
      : file_(file),
        glb_(open_glb(file, bytes)),
        mesh_(mesh),
        max_triangles_(std::max(max_placed_triangles, bytes.size() / min_triangle_bytes)) {}

  void read() {
    const geometry::Affine to_mm =
        y_up_to_z_up() * geometry::scaled(glb_unit_mm, glb_unit_mm, glb_unit_mm);
    const json& nodes = list(*glb_.document, "nodes");
    for (const std::size_t root : roots()) add_node(nodes[root], to_mm);
    report_unread();
  }

 private:
  /// Throws Error if nothing but points and lines is drawn.
  void report_unread() const {
    const std::string lines = count_text(unread_.primitives, "primitive") + " of points or lines";
    if (placed_ == 0 && unread_.primitives > 0)
      refuse(file_, fmt::format("it has {} and no triangles", lines),
             "export it as a mesh of triangles");
    if (unread_.primitives > 0) mesh_.warn(lines + " not read: points and lines have no surface");
    if (!unread_.skins.empty())
      mesh_.warn(count_text(unread_.skins.size(), "skin") +
                 " not read: the mesh is in its rest pose");
    if (unread_.morphs > 0)
      mesh_.warn(fmt::format("morph targets of {} not read: the mesh has its base shape",
                             count_text(unread_.morphs, "shape")));
  }

  const json& list(const json& object, const char* key) const {
    static const json none = json::array();
    const auto found = object.find(key);
    if (found == object.end()) return none;
    if (!found->is_array()) refuse_value(file_, fmt::format("'{}' is not a list", key));
    return *found;
  }

  /// The nodes of the scene; without scenes, all nodes that are not children.
  std::vector<std::size_t> roots() const {
    const json& scenes = list(*glb_.document, "scenes");
    const json& nodes = list(*glb_.document, "nodes");
    const auto first = glb_.document->find("scene");
    std::vector<std::size_t> roots;
    if (scenes.empty() && first == glb_.document->end()) {
      std::vector<bool> is_child(nodes.size());
      for (const json& node : nodes)
        for (const json& child : list(node, "children"))
          is_child[index_in(file_, child, nodes.size(), "node")] = true;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!is_child[i]) roots.push_back(i);
      return roots;
    }
    const std::size_t scene =
        first == glb_.document->end() ? 0 : index_in(file_, *first, scenes.size(), "scene");
    for (const json& root : list(scenes[scene], "nodes"))
      roots.push_back(index_in(file_, root, nodes.size(), "node"));
    return roots;
  }

  /// Notes a skin and morph targets with a weight that change the mesh of a node.
  void note_unread_shape(const json& node, const json& mesh) {
    if (node.contains("skin")) unread_.skins.insert(node.at("skin").get<std::uint64_t>());
    const json& primitives = list(mesh, "primitives");
    if (std::ranges::none_of(primitives,
                             [&](const json& one) { return !list(one, "targets").empty(); }))
      return;
    const json& weights = list(node.contains("weights") ? node : mesh, "weights");
    // Copies of a mesh share one list, which may be long.
    if (!unread_.weights.insert(&weights).second) return;
    if (std::ranges::any_of(weights, [](const json& one) { return one.get<double>() != 0; }))
      ++unread_.morphs;
  }

  /// By recursion, to the depth that open_glb() permits.
  void add_node(const json& node, const geometry::Affine& outside) {
    count_part();
    const json& nodes = list(*glb_.document, "nodes");
    const geometry::Affine map = outside * map_of_node(file_, node);
    if (const auto index = node.find("mesh"); index != node.end()) {
      const json& meshes = list(*glb_.document, "meshes");
      const json& mesh = meshes[index_in(file_, *index, meshes.size(), "mesh")];
      note_unread_shape(node, mesh);
      for (const json& primitive : list(mesh, "primitives")) add_primitive(primitive, map);
    }
    for (const json& child : list(node, "children"))
      add_node(nodes[index_in(file_, child, nodes.size(), "node")], map);
  }

  void count_part() {
    if (++parts_ > max_placed_parts)
      refuse(file_, fmt::format("more than {} nodes and primitives", max_placed_parts),
             "join some of them");
  }

  std::optional<GlbAccessor> accessor(const json& owner, const std::string& key) const {
    const auto found = owner.find(key);
    if (found == owner.end()) return std::nullopt;
    const std::size_t count = list(*glb_.document, "accessors").size();
    return GlbAccessor(glb_, index_in(file_, *found, count, "accessor"));
  }

  void add_primitive(const json& primitive, const geometry::Affine& map) {
    count_part();
    enum : std::uint64_t { triangles = 4, strip, fan };
    const auto mode = primitive.value<std::uint64_t>("mode", triangles);
    if (mode > fan) refuse_value(file_, fmt::format("a primitive has the mode {}", mode));
    if (mode < triangles) {
      ++unread_.primitives;
      return;
    }
    const auto found = primitive.find("attributes");
    if (found == primitive.end()) refuse_value(file_, "a primitive has no attributes");
    const json& attributes = *found;
    const auto positions = accessor(attributes, "POSITION");
    if (!positions) return;
    if (positions->components() != 3) refuse_value(file_, "a position is not of three numbers");
    const auto indices = accessor(primitive, "indices");
    const std::size_t count = indices ? indices->count() : positions->count();
    const std::size_t shapes = count < 3 ? 0 : mode == triangles ? count / 3 : count - 2;
    placed_ += shapes;
    if (placed_ > max_triangles_)
      refuse(file_, fmt::format("more than {} placed triangles", max_triangles_),
             "place fewer copies");
    Primitive one{map, *positions, indices, accessor(attributes, "COLOR_0"), {}, {}};
    if (const auto material = primitive.find("material"); material != primitive.end())
      one.surface = surface_of(*material);
    one.places = accessor(attributes, one.surface.places);
    const bool is_mirrored = determinant(map) < 0;
    for (std::size_t i = 0; i < shapes; ++i) {
      std::array<std::size_t, 3> corners{3 * i, 3 * i + 1, 3 * i + 2};
      if (mode == strip) corners = {i, i + 1 + i % 2, i + 2 - i % 2};
      if (mode == fan) corners = {i + 1, i + 2, 0};
      if (is_mirrored) std::swap(corners[1], corners[2]);
      add_triangle(one, corners);
    }
  }

  struct Primitive {
    const geometry::Affine& map;
    GlbAccessor positions;
    std::optional<GlbAccessor> indices, colours;
    Surface surface;
    std::optional<GlbAccessor> places;
  };

  void add_triangle(const Primitive& one, const std::array<std::size_t, 3>& corners) {
    MeshTriangle triangle;
    // Length of the file's unit under the map, for the warning about precision.
    const double unit_mm = std::cbrt(std::abs(determinant(one.map)));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t vertex = vertex_of(one, corners[i]);
      const geometry::Point at{one.positions.at(vertex, 0), one.positions.at(vertex, 1),
                               one.positions.at(vertex, 2)};
      if (one.positions.is_single() && geometry::is_finite(at)) mesh_.stored_in_single(at, unit_mm);
      triangle.corners[i] = one.map(at);
      if (one.colours || one.surface.has_factor) {
        if (!triangle.lights) triangle.lights = {1, 1, 1};
        (*triangle.lights)[i] = light_at(one, vertex);
      }
      if (!one.places || vertex >= one.places->count() || one.places->components() != 2) continue;
      // The places of glTF have v downwards.
      triangle.textured = {one.surface.texture, triangle.textured.corners};
      triangle.textured.corners[i] = {static_cast<float>(one.places->at(vertex, 0)),
                                      static_cast<float>(1 - one.places->at(vertex, 1))};
    }
    mesh_.add(triangle);
  }

  std::size_t vertex_of(const Primitive& one, std::size_t corner) const {
    const double index = one.indices ? one.indices->at(corner, 0) : static_cast<double>(corner);
    if (!(index >= 0 && index < static_cast<double>(one.positions.count())))
      refuse(file_, fmt::format("a triangle names vertex {} of {}", index, one.positions.count()),
             "repair the model");
    return static_cast<std::size_t>(index);
  }

  static float light_at(const Primitive& one, std::size_t vertex) {
    std::array<double, 3> colour{one.surface.factor[0], one.surface.factor[1],
                                 one.surface.factor[2]};
    const auto& colours = one.colours;
    if (colours && vertex < colours->count() && colours->components() >= 3)
      for (std::size_t i = 0; i < 3; ++i) colour[i] *= colours->at(vertex, i);
    return displayed(colour[0], colour[1], colour[2]);
  }

  Surface surface_of(const json& index) {
    const json& materials = list(*glb_.document, "materials");
    const json& material = materials[index_in(file_, index, materials.size(), "material")];
    Surface surface;
    const auto found = material.find("pbrMetallicRoughness");
    if (found == material.end() || !found->is_object()) return surface;
    surface.has_factor = found->contains("baseColorFactor");
    read_numbers(file_, *found, "baseColorFactor", surface.factor);
    const auto picture = found->find("baseColorTexture");
    if (picture == found->end()) return surface;
    surface.places = fmt::format("TEXCOORD_{}", picture->value<std::uint64_t>("texCoord", 0));
    surface.texture = texture_of(*picture);
    return surface;
  }

  std::uint32_t texture_of(const json& picture) {
    const json& textures = list(*glb_.document, "textures");
    const json& images = list(*glb_.document, "images");
    const json& texture =
        textures[index_in(file_, picture.at("index"), textures.size(), "texture")];
    const auto source = texture.find("source");
    // Without a source an extension has the picture.
    if (source == texture.end()) return Brightness::no_texture;
    const std::size_t number = index_in(file_, *source, images.size(), "image");
    const json& image = images[number];
    if (const auto uri = image.find("uri"); uri != image.end()) {
      const auto name = part_name(uri->get<std::string>());
      return mesh_.texture(name.substr(0, name.find(',')),
                           [&] { return read_bitmap(file_.parent_path() / name); });
    }
    return mesh_.texture(fmt::format("image {}", number), [&] {
      const json& views = list(*glb_.document, "bufferViews");
      const json& view =
          views[index_in(file_, image.at("bufferView"), views.size(), "buffer view")];
      return decode_bitmap(
          file_, std::string(glb_.buffer.substr(view.value<std::size_t>("byteOffset", 0),
                                                view.value<std::size_t>("byteLength", 0))));
    });
  }

  const path& file_;
  Glb glb_;
  MeshBuilder& mesh_;
  std::size_t max_triangles_, placed_ = 0, parts_ = 0;
  /// What the drawn nodes have and the reader does not read.
  struct Unread {
    std::size_t primitives = 0, morphs = 0;
    std::set<std::uint64_t> skins{};
    std::set<const json*> weights{};  // of morph targets
  };
  Unread unread_{};
};

}  // namespace

void read_glb(const path& file, std::string_view bytes, MeshBuilder& mesh) {
  GlbReader reader(file, bytes, mesh);
  try {
    reader.read();
  } catch (const json::exception&) {
    refuse_value(file, "its description has values of a wrong kind");
  }
}

}  // namespace lamplock::model
