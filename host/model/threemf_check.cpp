#include "host/model/threemf_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/text.hpp"
#include "host/model/threemf_objects.hpp"
#include "host/model/zip_archive.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;
using std::filesystem::path;

constexpr const char* damaged = "the file is cut off or damaged: export it again";

/// Elements and attributes, which take up to 64 bytes each once they are read: 2 GB. A triangle has
/// four, a vertex too.
constexpr std::ptrdiff_t max_marks = 30'000'000;

/// Reads the XML of a part with the parser of the mesh library. `text` must outlive the call only.
void read_xml(const path& file, const std::string& name, const std::string& text,
              pugi::xml_document& document) {
  if (text.find('\0') != std::string::npos)
    refuse(file, fmt::format("part '{}' is not valid UTF-8", name), damaged);
  const auto marks =
      std::count(text.begin(), text.end(), '<') + std::count(text.begin(), text.end(), '=');
  if (marks > max_marks)
    refuse(file, fmt::format("part '{}' has {} elements and attributes", name, marks),
           "reduce the mesh, or export it as binary STL");
  const pugi::xml_parse_result result = document.load_string(text.c_str(), pugi::parse_full);
  if (!result)
    refuse(file, fmt::format("part '{}' is not valid XML: {}", name, result.description()),
           damaged);
}

/// The part with the model ("Open Packaging Conventions", ECMA-376 part 2, chapter 9.3).
std::string model_part(const path& file, const ZipArchive& archive) {
  constexpr const char* relations = "_rels/.rels";
  constexpr std::string_view start_part =
      "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
  pugi::xml_document document;
  read_xml(file, relations, archive.unpacked(relations), document);
  std::string part;
  for (const xml_node relation : document.child("Relationships").children("Relationship")) {
    if (relation.attribute("Type").as_string() != start_part) continue;
    if (!part.empty()) refuse(file, "it has more than one model", "export it again");
    part = relation.attribute("Target").as_string();
  }
  if (part.starts_with('/')) part.erase(0, 1);
  if (part.empty()) refuse(file, "it names no part with a model", damaged);
  return part;
}

/// Kinds of resources with ids.
enum class Kind { object, colours, other };

struct Resource {
  Kind kind = Kind::other;
  int values = 0;  ///< of colours
};

/// The subject of an error; converted to text only for an error, because there are many triangles.
struct Named {
  std::string_view what;
  std::int64_t number = -1;
  std::string_view of{};

  std::string text() const {
    std::string name(what);
    if (number >= 0) name += fmt::format(" {}", number);
    if (!of.empty()) name += fmt::format(" of {}", of);
    return name;
  }
};

/// Check of one model part.
class ModelCheck {
 public:
  ModelCheck(const path& file, xml_node model) : file_(file), model_(model) {}

  void check() {
    const xml_node resources = only_child(model_, "resources", {"the model"});
    for (const xml_node node : resources.children()) add_resource(node);
    for (const xml_node node : resources.children("object")) check_object(node);
    check_placed(file_, objects_, built());
  }

 private:
  [[noreturn]] void fail(const Named& of, const std::string& what) const {
    refuse(file_, fmt::format("{} {}", of.text(), what), damaged);
  }

  xml_node only_child(xml_node node, const char* name, const Named& of) const {
    const xml_node child = node.child(name);
    if (!child || child.next_sibling(name))
      fail(of, fmt::format("must have exactly one <{}>", name));
    return child;
  }

  /// An attribute that must be a number from 0.
  int number(xml_node node, const char* name, const Named& of) const {
    const char* text = node.attribute(name).as_string();
    const auto value = to_integer(text);
    if (!value || *value < 0 || *value > std::numeric_limits<int>::max())
      fail(of, fmt::format("has {} '{:.20}'", name, text));
    return static_cast<int>(*value);
  }

  void add_resource(xml_node node) {
    const std::string_view name = node.name();
    if (!node.attribute("id")) {
      if (name == "object") fail({"an object"}, "has no id");
      return;
    }
    const int id = number(node, "id", {name});
    if (!resources_.try_emplace(id, resource(node, name)).second)
      fail({"the model"}, fmt::format("has the id {} twice", id));
  }

  static Resource resource(xml_node node, std::string_view name) {
    if (name == "object") return {Kind::object, 0};
    if (name == "basematerials") return {Kind::colours, count(node, "base")};
    if (name == "m:texture2dgroup") return {Kind::colours, count(node, "m:tex2coord")};
    if (name != "m:colorgroup") return {Kind::other, 0};
    Resource colours{Kind::colours, 0};
    // Mesh libraries count only colours that they can parse.
    for (const xml_node colour : node.children("m:color")) {
      const std::string_view text = colour.attribute("color").as_string();
      constexpr std::size_t rgb = 7, rgba = 9;  // with the #
      if (text.starts_with('#') && (text.size() == rgb || text.size() == rgba)) ++colours.values;
    }
    return colours;
  }

  static int count(xml_node node, const char* name) {
    const auto children = node.children(name);
    return static_cast<int>(std::distance(children.begin(), children.end()));
  }

  void check_object(xml_node node) {
    const int id = number(node, "id", {"an object"});
    const std::string name = fmt::format("object {}", id);
    ThreemfObject object;
    const xml_node mesh = node.child("mesh"), components = node.child("components");
    if (mesh && components) fail({name}, "is a mesh and has components");
    check_colours(node, {"pindex"}, {name});
    if (mesh) object.triangles = check_mesh(only_child(node, "mesh", {name}), name);
    if (components) {
      only_child(node, "components", {name});
      for (const xml_node component : components.children("component"))
        object.inside.push_back(placed_id(component, {"a component", -1, name}));
    }
    objects_.emplace(id, std::move(object));
  }

  /// The number of triangles.
  std::uint64_t check_mesh(xml_node mesh, const std::string& object) const {
    const xml_node vertices = only_child(mesh, "vertices", {object});
    const xml_node triangles = only_child(mesh, "triangles", {object});
    // The mesh library writes colours of vertices while it reads triangles.
    bool vertices_first = false;
    for (xml_node next = vertices; next; next = next.next_sibling())
      vertices_first = vertices_first || next == triangles;
    if (!vertices_first) fail({object}, "has triangles before vertices");
    int vertex_count = 0;
    for (const xml_node vertex : vertices.children("vertex"))
      check_vertex(vertex, {"vertex", vertex_count++, object});
    Named here{"triangle", 0, object};
    for (const xml_node triangle : triangles.children("triangle")) {
      for (const char* corner : {"v1", "v2", "v3"}) {
        const int vertex = number(triangle, corner, here);
        if (vertex >= vertex_count)
          fail(here, fmt::format("names vertex {} of {}", vertex, vertex_count));
      }
      check_colours(triangle, {"p1", "p2", "p3"}, here);
      ++here.number;
    }
    return static_cast<std::uint64_t>(here.number);
  }

  void check_vertex(xml_node vertex, const Named& of) const {
    for (const char* axis : {"x", "y", "z"}) {
      const char* text = vertex.attribute(axis).as_string();
      if (!is_number(text)) fail(of, fmt::format("has {} '{:.20}'", axis, text));
    }
  }

  /// A number that is finite in the single precision of the mesh library, too.
  static bool is_number(std::string_view text) {
    const auto value = to_double(text);
    return value && std::abs(*value) <= std::numeric_limits<float>::max();
  }

  /// Checks the colours that a node selects from a resource.
  void check_colours(xml_node node, std::initializer_list<const char*> choices,
                     const Named& of) const {
    if (!node.attribute("pid")) return;
    const auto found = resources_.find(number(node, "pid", of));
    if (found == resources_.end() || found->second.kind != Kind::colours) return;
    for (const char* choice : choices) {
      if (!node.attribute(choice)) continue;
      const int colour = number(node, choice, of);
      if (colour >= found->second.values)
        fail(of, fmt::format("chooses colour {} of {}", colour, found->second.values));
    }
  }

  /// The object that an item or a component places.
  int placed_id(xml_node node, const Named& of) const {
    if (node.attribute("p:path"))
      refuse(file_, of.text() + " is in another part of the file",
             "export it without the production extension, or as STL");
    if (const pugi::xml_attribute transform = node.attribute("transform"))
      check_transform(transform.as_string(), of);
    return number(node, "objectid", of);
  }

  void check_transform(std::string_view text, const Named& of) const {
    constexpr int matrix = 12;
    int numbers = 0;
    for (auto field = next_field(text); !field.empty(); field = next_field(text), ++numbers)
      if (!is_number(field)) fail(of, fmt::format("is transformed by '{:.20}'", field));
    if (numbers != matrix)
      fail(of, fmt::format("is transformed by {} numbers, not {}", numbers, matrix));
  }

  std::vector<int> built() const {
    const xml_node build = only_child(model_, "build", {"the model"});
    std::vector<int> items;
    for (const xml_node item : build.children("item"))
      items.push_back(placed_id(item, {"item", std::ssize(items), "the build"}));
    if (items.empty()) refuse(file_, "nothing is built: it has no item", "place an object");
    return items;
  }

  const path& file_;
  xml_node model_;
  std::map<int, Resource> resources_;
  ThreemfObjects objects_;
};

}  // namespace

void check_3mf(const path& file) {
  const ZipArchive archive(file);
  const std::string part = model_part(file, archive);
  pugi::xml_document document;
  read_xml(file, part, archive.unpacked(part), document);
  const xml_node model = document.child("model");
  if (!model) refuse(file, fmt::format("part '{}' is not a model", part), damaged);
  ModelCheck(file, model).check();
}

}  // namespace lamplock::model
