#include "host/model/read_3mf.hpp"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string>
#include <utility>

#include "host/file.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/model/threemf_model.hpp"
#include "host/model/threemf_objects.hpp"
#include "host/model/threemf_package.hpp"
#include "host/model/threemf_part.hpp"
#include "host/model/threemf_settings.hpp"
#include "host/model/transform.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

ThreemfModel read_model(const path& file, const ThreemfPackage& package) {
  ThreemfModel model;
  model.number_of_part(package.model_part());
  // A part may name further parts.
  for (std::size_t number = 0; number < model.parts.size(); ++number) {
    const std::string name = model.parts[number];
    pugi::xml_document document;
    read_threemf_part(file, static_cast<int>(number), package.model(name, document), model);
  }
  return model;
}

/// Copies the objects to their places.
class Placing {
 public:
  Placing(const path& file, const ThreemfPackage& package, const ThreemfModel& model,
          MeshBuilder& mesh)
      : file_(file), package_(package), model_(model), mesh_(mesh) {}

  /// By recursion, to the depth that check_placed() permits. Objects in a support are supports.
  void add(const ThreemfComponent& component, const geometry::Affine& outside) {
    const ThreemfObject& object = model_.objects.at(component.object);
    if (!object.is_engraved) {
      ++left_out_;
      return;
    }
    const geometry::Affine map = outside * component.transform;
    // A mirrored object would be inside out.
    const bool is_mirrored = determinant(map) < 0;
    for (const ThreemfTriangle& triangle : object.triangles)
      add_triangle(object, triangle, map, is_mirrored);
    for (const ThreemfComponent& inner : object.inside) add(inner, map);
  }

  int left_out() const { return left_out_; }
  std::size_t triangles() const { return triangles_; }

 private:
  void add_triangle(const ThreemfObject& object, const ThreemfTriangle& triangle,
                    const geometry::Affine& map, bool is_mirrored) {
    MeshTriangle placed;
    for (std::size_t i = 0; i < 3; ++i)
      placed.corners[i] = map(object.vertices[triangle.corners[i]]);
    if (triangle.group != ThreemfTriangle::no_group) {
      const ThreemfProperties& group = model_.properties[static_cast<std::size_t>(triangle.group)];
      if (group.picture.empty()) {
        placed.lights.emplace();
        for (std::size_t i = 0; i < 3; ++i) (*placed.lights)[i] = group.lights[triangle.entries[i]];
      } else {
        placed.textured.texture = mesh_.texture(
            group.picture, [&] { return decode_bitmap(file_, package_.bytes(group.picture)); });
        for (std::size_t i = 0; i < 3; ++i)
          placed.textured.corners[i] = group.places[triangle.entries[i]];
      }
    }
    if (is_mirrored) {
      std::swap(placed.corners[1], placed.corners[2]);
      std::swap(placed.textured.corners[1], placed.textured.corners[2]);
      if (placed.lights) std::swap((*placed.lights)[1], (*placed.lights)[2]);
    }
    mesh_.add(placed);
    ++triangles_;
  }

  const path& file_;
  const ThreemfPackage& package_;
  const ThreemfModel& model_;
  MeshBuilder& mesh_;
  int left_out_ = 0;
  std::size_t triangles_ = 0;
};

}  // namespace

void read_3mf(const path& file, MeshBuilder& mesh) {
  check_is_file(file);
  const ThreemfPackage package(file);
  ThreemfModel model = read_model(file, package);
  const LeftOutVolumes left_out = leave_out_modifiers(package, model);
  check_placed(file, model);
  Placing placing(file, package, model, mesh);
  for (const ThreemfComponent& item : model.items) placing.add(item, {});
  for (const std::string& warning : left_out.warnings) mesh.warn(warning);
  if (placing.triangles() == 0 && (placing.left_out() > 0 || left_out.count > 0))
    refuse(file,
           fmt::format("nothing is left to engrave: {}",
                       placing.left_out() > 0
                           ? fmt::format("{} of type support or other",
                                         count_text(static_cast<std::size_t>(placing.left_out()),
                                                    "object is", "objects are"))
                           : left_out.warnings.back()),
           "export the objects as models");
  if (placing.left_out() > 0)
    mesh.warn(fmt::format("{} of type support or other left out",
                          count_text(static_cast<std::size_t>(placing.left_out()), "object")));
  if (model.has_unprinted_items) mesh.warn("objects that are not to be printed are left out");
  if (model.has_unread_colours)
    mesh.warn("colours of a kind that is not read (multiproperties or another) count as white");
}

}  // namespace lamplock::model
