#include "host/model/threemf_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/text.hpp"
#include "host/model/threemf_package.hpp"
#include "host/model/threemf_properties.hpp"
#include "host/model/transform.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;
using std::filesystem::path;

/// Real packages have one part for each object.
constexpr std::size_t max_threemf_parts = 10'000;
/// Items and components of the file; 110 bytes each.
constexpr std::size_t max_components = 1'000'000;

/// A property of an object or a triangle.
struct Choice {
  int group = ThreemfTriangle::no_group;
  std::uint32_t entry = 0;
};

class PartReader {
 public:
  PartReader(const path& file, int number, xml_node part, ThreemfModel& model)
      : file_(file),
        number_(number),
        part_(part),
        model_(model),
        mm_(unit_mm()),
        resources_node_(only_child(part, "resources", "the model")),
        resources_(file, resources_node_, model) {}

  void read() {
    for (const xml_node node : resources_node_.children("object")) read_object(node);
    if (number_ == 0) read_build();
  }

 private:
  [[noreturn]] void fail(const std::string& of, const std::string& what) const {
    refuse(file_, fmt::format("{} {}", of, what),
           has_decimal_comma(what) ? write_decimal_points : "repair the model");
  }

  int number(xml_node node, const char* name, const std::string& of) const {
    return threemf_number(file_, node, name, of);
  }

  xml_node only_child(xml_node node, const char* name, const std::string& of) const {
    const xml_node child = node.child(name);
    if (!child || child.next_sibling(name))
      fail(of, fmt::format("must have exactly one <{}>", name));
    return child;
  }

  /// Length of the part's unit; other parts without one have that of the first.
  double unit_mm() {
    struct Unit {
      std::string_view name;
      double mm;
    };
    constexpr std::array<Unit, 6> units{{{"micron", 0.001},
                                         {"millimeter", 1},
                                         {"centimeter", 10},
                                         {"inch", 25.4},
                                         {"foot", 304.8},
                                         {"meter", 1000}}};
    const pugi::xml_attribute unit = part_.attribute("unit");
    if (!unit) return number_ == 0 ? 1 : model_.unit_mm;
    const auto* const found =
        std::ranges::find(units, std::string_view(unit.as_string()), &Unit::name);
    if (found == units.end())
      refuse(file_, fmt::format("'{:.20}' is not a unit of 3MF", unit.as_string()),
             "export it in millimetres");
    if (number_ == 0) model_.unit_mm = found->mm;
    return found->mm;
  }

  void read_object(xml_node node) {
    const ThreemfKey key{number_, number(node, "id", "an object")};
    const std::string name = model_.name_of(key);
    ThreemfObject object;
    const std::string_view type = node.attribute("type").as_string("model");
    object.is_engraved = type != "support" && type != "solidsupport" && type != "other";
    if (object.is_engraved && type != "model" && type != "surface")
      fail(name, fmt::format("has the type '{:.20}'", type));
    const xml_node mesh = node.child("mesh"), components = node.child("components");
    if (mesh && components) fail(name, "is a mesh and has components");
    if (!mesh && !components) fail(name, "has neither a mesh nor components");
    if (mesh)
      read_mesh_of(only_child(node, "mesh", name), choice_of_object(node, name), name, object);
    if (components) {
      only_child(node, "components", name);
      for (const xml_node component : components.children("component"))
        object.inside.push_back(placed(component, "a component of " + name));
    }
    model_.objects.emplace(key, std::move(object));
  }

  void read_mesh_of(xml_node mesh, const Choice& choice, const std::string& name,
                    ThreemfObject& object) {
    for (const xml_node child : mesh.children())
      if (std::string_view(child.name()) == "b:beamlattice")
        refuse(file_, fmt::format("{} has a beam lattice, which is not read", name),
               "convert the lattice to a mesh before the export");
    for (const xml_node vertex : only_child(mesh, "vertices", name).children("vertex"))
      object.vertices.push_back(point(vertex, object.vertices.size(), name));
    for (const xml_node node : only_child(mesh, "triangles", name).children("triangle"))
      object.triangles.push_back(triangle(node, choice, name, object));
  }

  geometry::Point point(xml_node vertex, std::size_t index, const std::string& object) const {
    std::array<double, 3> values{};
    constexpr std::array<const char*, 3> axes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const char* text = vertex.attribute(axes[axis]).as_string();
      const auto value = length(text);
      if (!value)
        fail(fmt::format("vertex {} of {}", index, object),
             fmt::format("has {} '{:.20}'{}", axes[axis], text,
                         has_decimal_comma(text) ? ", a decimal comma" : ""));
      values[axis] = *value;
    }
    return {values[0], values[1], values[2]};
  }

  ThreemfTriangle triangle(xml_node node, const Choice& choice, const std::string& name,
                           const ThreemfObject& object) {
    const auto here = [&] {
      return fmt::format("triangle {} of {}", object.triangles.size(), name);
    };
    ThreemfTriangle triangle;
    constexpr std::array<const char*, 3> corners{"v1", "v2", "v3"}, entries{"p1", "p2", "p3"};
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corners[i] = index(node, corners[i], here);
      if (triangle.corners[i] >= object.vertices.size())
        fail(here(),
             fmt::format("names vertex {} of {}", triangle.corners[i], object.vertices.size()));
    }
    triangle.group = choice.group;
    triangle.entries.fill(choice.entry);
    if (!node.attribute("p1")) return triangle;
    if (node.attribute("pid")) triangle.group = group(number(node, "pid", here()), here());
    for (std::size_t i = 0; i < 3; ++i)
      triangle.entries[i] =
          node.attribute(entries[i]) ? index(node, entries[i], here) : triangle.entries[0];
    if (triangle.group == ThreemfTriangle::no_group) return triangle;
    for (const std::uint32_t entry : triangle.entries) require_entry(triangle.group, entry, here);
    return triangle;
  }

  /// As number(), but the name of the element is made only for an error: there are many triangles.
  template <class Name>
  std::uint32_t index(xml_node node, const char* attribute, const Name& name) const {
    const auto value = to_integer(node.attribute(attribute).as_string());
    if (value && *value >= 0 && *value <= INT32_MAX) return static_cast<std::uint32_t>(*value);
    return static_cast<std::uint32_t>(number(node, attribute, name()));
  }

  template <class Name>
  void require_entry(int group, std::uint32_t entry, const Name& name) const {
    const std::size_t size = model_.properties[static_cast<std::size_t>(group)].size();
    if (entry >= size) fail(name(), fmt::format("chooses colour {} of {}", entry, size));
  }

  int group(int id, const std::string& of) {
    const int found = resources_.group(id, of);
    if (found == ThreemfTriangle::no_group) model_.has_unread_colours = true;
    return found;
  }

  Choice choice_of_object(xml_node node, const std::string& name) {
    if (!node.attribute("pid")) return {};
    Choice choice{group(number(node, "pid", name), name), 0};
    if (node.attribute("pindex"))
      choice.entry = static_cast<std::uint32_t>(number(node, "pindex", name));
    if (choice.group != ThreemfTriangle::no_group)
      require_entry(choice.group, choice.entry, [&] { return name; });
    return choice;
  }

  /// A finite length in mm.
  std::optional<double> length(std::string_view text) const {
    const auto value = to_double(trimmed(text));
    if (!value || !std::isfinite(*value * mm_)) return std::nullopt;
    return *value * mm_;
  }

  /// The object that an item or a component places.
  ThreemfComponent placed(xml_node node, const std::string& of) {
    ThreemfComponent component;
    if (++model_.components > max_components)
      refuse(file_, fmt::format("more than {} placed objects", max_components), "place fewer");
    component.object = {number_, number(node, "objectid", of)};
    if (const pugi::xml_attribute other = node.attribute("p:path"))
      component.object.first = model_.number_of_part(part_name(other.as_string()));
    if (model_.parts.size() > max_threemf_parts)
      refuse(file_, fmt::format("it has more than {} parts", max_threemf_parts), "place fewer");
    if (const pugi::xml_attribute transform = node.attribute("transform"))
      component.transform = transform_of(transform.as_string(), of);
    return component;
  }

  /// Twelve numbers: the images of the unit vectors, then that of the origin.
  geometry::Affine transform_of(std::string_view text, const std::string& of) const {
    std::array<double, 12> m{};
    std::size_t count = 0;
    for (auto field = next_field(text); !field.empty(); field = next_field(text), ++count) {
      const auto value = to_double(field);
      if (!value || !std::isfinite(*value))
        fail(of, fmt::format("is transformed by '{:.20}'", field));
      if (count < m.size()) m[count] = *value;
    }
    if (count != m.size()) fail(of, fmt::format("is transformed by {} numbers, not 12", count));
    const geometry::Affine map{{m[0], m[1], m[2]},
                               {m[3], m[4], m[5]},
                               {m[6], m[7], m[8]},
                               {m[9] * mm_, m[10] * mm_, m[11] * mm_}};
    if (determinant(map) == 0) fail(of, "is transformed into a plane");
    return map;
  }

  void read_build() {
    const xml_node build = only_child(part_, "build", "the model");
    int count = 0;
    for (const xml_node item : build.children("item")) {
      const ThreemfComponent one = placed(item, fmt::format("item {} of the build", count++));
      // An attribute of slicers; the specification has none.
      const bool is_printed = item.attribute("printable").as_bool(true);
      if (is_printed) model_.items.push_back(one);
      model_.has_unprinted_items = model_.has_unprinted_items || !is_printed;
    }
    if (model_.items.empty())
      refuse(file_, "nothing is built: it has no item to print", "place an object");
  }

  const path& file_;
  int number_;
  xml_node part_;
  ThreemfModel& model_;
  double mm_;
  xml_node resources_node_;
  ThreemfResources resources_;
};

}  // namespace

int ThreemfModel::number_of_part(const std::string& name) {
  const auto [found, is_new] = part_numbers.try_emplace(name, static_cast<int>(parts.size()));
  if (is_new) parts.push_back(name);
  return found->second;
}

std::string ThreemfModel::name_of(const ThreemfKey& object) const {
  std::string name = fmt::format("object {}", object.second);
  if (object.first > 0)
    name += fmt::format(" of part '{}'", parts[static_cast<std::size_t>(object.first)]);
  return name;
}

void read_threemf_part(const path& file, int number, xml_node part, ThreemfModel& model) {
  PartReader(file, number, part, model).read();
}

}  // namespace lamplock::model
