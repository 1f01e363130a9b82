#include "host/model/read_obj.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/file.hpp"
#include "host/model/mesh_checks.hpp"
#include "host/model/mtl.hpp"
#include "host/model/polygon_triangles.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/model/text.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// Distinct names of libraries that are read.
constexpr std::size_t max_libraries = 100;

/// Reads the lines of an OBJ in order; negative indices count back from the last vertex.
class ObjReader {
 public:
  ObjReader(const path& file, MeshBuilder& mesh) : file_(file), mesh_(mesh) {}

  void line(std::size_t number, std::string_view text) {
    number_ = number;
    const std::string_view word = next_field(text);
    if (word == "v") {
      vertex(text);
    } else if (word == "vt") {
      const auto u = to_double(next_field(text)), v = to_double(next_field(text));
      places_.push_back({static_cast<float>(u.value_or(0)), static_cast<float>(v.value_or(0))});
    } else if (word == "f") {
      face(text);
    } else if (word == "usemtl") {
      material_ = number_of_material(trimmed(text));
    } else if (word == "mtllib") {
      const std::string names(trimmed(text));
      if (libraries_.size() < max_libraries && libraries_.try_emplace(names, true).second)
        for (const std::string& missing : read_material_libraries(file_, names, materials_))
          mesh_.warn(fmt::format("{} cannot be opened: its materials are white", missing));
    }
  }

  void end() {
    number_ = max_line_;
    if (max_vertex_ > vertices_.size())
      damaged(fmt::format("a face names vertex {} of {}", max_vertex_, vertices_.size()));
    std::size_t begin = 0;
    for (const Face& one : faces_) {
      add_face(one, begin);
      begin = one.end;
    }
  }

 private:
  struct Corner {
    std::uint32_t vertex = 0;
    std::int64_t place = -1;  // -1: none
  };
  struct Face {
    std::size_t end = 0;  // of its corners
    std::size_t line = 0;
    std::size_t material = 0;
  };

  void vertex(std::string_view text) {
    const geometry::Point point =
        take_point(file_, number_, text, "a vertex without three numbers");
    require_finite(file_, vertices_.size(), point);
    std::array<double, 3> more{};
    std::size_t count = 0;
    for (auto field = next_field(text); count < more.size() && !field.empty();
         field = next_field(text), ++count) {
      const auto value = to_double(field);
      if (!value) break;
      more[count] = *value;
    }
    vertices_.push_back(point);
    // One further number is the weight of a rational curve, which has no effect on faces.
    if (count == 3) {  // a colour: an extension that many programs write
      lights_.resize(vertices_.size() - 1, 1.0F);
      lights_.push_back(luma(more[0], more[1], more[2]));
    }
  }

  void face(std::string_view text) {
    std::size_t count = 0;
    for (std::string_view field = next_field(text); !field.empty() && field.front() != '#';
         field = next_field(text), ++count)
      corners_.push_back(corner(field));
    if (count < 3) damaged(fmt::format("a face of {} corners", count));
    faces_.push_back({corners_.size(), number_, material_});
  }

  /// "vertex", "vertex/place", "vertex//normal" or "vertex/place/normal".
  Corner corner(std::string_view field) {
    const std::size_t slash = std::min(field.find('/'), field.size());
    const auto index = to_integer(field.substr(0, slash));
    const auto count = static_cast<long long>(vertices_.size());
    if (!index || *index == 0 || *index < -count || *index > UINT32_MAX)
      damaged(fmt::format("'{:.20}' is not a vertex from 1 to {}", field, count));
    Corner corner;
    corner.vertex = static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
    if (corner.vertex >= max_vertex_) {
      max_vertex_ = corner.vertex + std::size_t{1};
      max_line_ = number_;
    }
    if (slash == field.size()) return corner;
    const std::string_view rest = field.substr(slash + 1);
    const auto place = to_integer(rest.substr(0, rest.find('/')));
    const auto places = static_cast<long long>(places_.size());
    if (place && *place > 0) corner.place = *place - 1;
    if (place && *place < 0 && *place >= -places) corner.place = places + *place;
    return corner;
  }

  void add_face(const Face& face, std::size_t begin) {
    polygon_.clear();
    for (std::size_t i = begin; i < face.end; ++i)
      polygon_.push_back(vertices_[corners_[i].vertex]);
    const auto triangles = triangles_of(polygon_);
    if (triangles.empty())
      refuse(file_,
             fmt::format("line {}: a concave face of {} corners", face.line, polygon_.size()),
             "split the faces into triangles before the export");
    const Material* material = material_of(face);
    const std::uint32_t texture = texture_of(material);
    for (const auto& indices : triangles) {
      MeshTriangle triangle;
      bool has_places = true;
      if (material != nullptr && material->light && texture == Brightness::no_texture)
        triangle.lights = {*material->light, *material->light, *material->light};
      if (!lights_.empty() && !triangle.lights) triangle.lights = {1, 1, 1};
      for (std::size_t i = 0; i < 3; ++i) {
        const Corner& corner = corners_[begin + indices[i]];
        triangle.corners[i] = polygon_[indices[i]];
        if (corner.vertex < lights_.size()) (*triangle.lights)[i] *= lights_[corner.vertex];
        has_places = has_places && corner.place >= 0 && corner.place < std::ssize(places_);
        if (has_places)
          triangle.textured.corners[i] = places_[static_cast<std::size_t>(corner.place)];
      }
      if (has_places) triangle.textured.texture = texture;
      mesh_.add(triangle);
    }
  }

  /// Null without a material. Materials may be defined after their use.
  const Material* material_of(const Face& face) const {
    if (face.material == 0) return nullptr;
    const auto found = materials_.find(material_names_[face.material - 1]);
    return found == materials_.end() ? nullptr : &found->second;
  }

  /// A picture replaces the colour: programs write any colour, black too, beside a picture.
  std::uint32_t texture_of(const Material* material) {
    if (material == nullptr || material->picture.empty()) return Brightness::no_texture;
    return mesh_.texture(material->picture, [&] {
      std::string name = material->picture;
      std::replace(name.begin(), name.end(), '\\', '/');
      return read_bitmap(file_.parent_path() / name);
    });
  }

  std::size_t number_of_material(std::string_view name) {
    const auto [found, is_new] =
        material_numbers_.try_emplace(std::string(name), material_names_.size() + 1);
    if (is_new) material_names_.emplace_back(name);
    return found->second;
  }

  [[noreturn]] void damaged(std::string_view what) const { refuse_mesh_line(file_, number_, what); }

  const path& file_;
  MeshBuilder& mesh_;
  std::size_t number_ = 0, max_vertex_ = 0, max_line_ = 0;
  std::vector<geometry::Point> vertices_, polygon_;
  std::vector<float> lights_;  // of vertices; shorter if the last ones have no colour
  std::vector<TexturePlace> places_;
  std::vector<Corner> corners_;
  std::vector<Face> faces_;
  std::map<std::string, bool> libraries_;
  Materials materials_;
  std::vector<std::string> material_names_;
  std::map<std::string, std::size_t> material_numbers_;
  std::size_t material_ = 0;  // 0: none, otherwise index in material_names_ + 1
};

}  // namespace

void read_obj(const path& file, std::string_view bytes, MeshBuilder& mesh) {
  ObjReader reader(file, mesh);
  Lines lines(bytes);
  std::string joined;  // a backslash at the end of a line continues it on the next
  while (const auto line = lines.next()) {
    if (line->ends_with('\\')) {
      joined.append(line->substr(0, line->size() - 1)).append(" ");
      continue;
    }
    reader.line(lines.number(), joined.empty() ? *line : joined.append(*line));
    joined.clear();
  }
  reader.line(lines.number(), joined);
  reader.end();
}

}  // namespace lamplock::model
