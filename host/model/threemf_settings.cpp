#include "host/model/threemf_settings.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <pugixml.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "host/error.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// Calls `visit` with each object of the first part, which has the build, and with its settings:
/// once for each object, so that many settings of one object do not take quadratic time.
template <class Visit>
void for_each_object(xml_node config, ThreemfModel& model, const Visit& visit) {
  std::set<int> known;
  for (const xml_node node : config.children("object")) {
    const int id = node.attribute("id").as_int(-1);
    const auto found = model.objects.find({0, id});
    if (found != model.objects.end() && known.insert(id).second) visit(found->second, node);
  }
}

bool is_printed_volume(xml_node volume) {
  for (const xml_node entry : volume.children("metadata"))
    if (std::string_view(entry.attribute("key").as_string()) == "volume_type")
      return std::string_view(entry.attribute("value").as_string()) == "ModelPart";
  // Old versions mark modifiers in this way and have no types.
  for (const xml_node entry : volume.children("metadata"))
    if (std::string_view(entry.attribute("key").as_string()) == "modifier")
      return std::string_view(entry.attribute("value").as_string()) != "1";
  return true;
}

/// PrusaSlicer: volumes are ranges of the triangles of an object, both ends included.
std::size_t leave_out_volumes(xml_node config, ThreemfModel& model) {
  std::size_t left_out = 0;
  for_each_object(config, model, [&](ThreemfObject& object, xml_node node) {
    const std::size_t count = object.triangles.size();
    std::vector<int> changes(count + 1);  // of the number of ranges that have a triangle
    for (const xml_node volume : node.children("volume")) {
      const auto first = volume.attribute("firstid").as_ullong(count);
      const auto last = volume.attribute("lastid").as_ullong(count);
      if (is_printed_volume(volume) || first > last || last >= count) continue;
      ++changes[first];
      --changes[last + 1];
      ++left_out;
    }
    std::size_t kept = 0;
    int ranges = 0;
    for (std::size_t i = 0; i < count; ++i) {
      ranges += changes[i];
      if (ranges == 0) object.triangles[kept++] = object.triangles[i];
    }
    object.triangles.resize(kept);
  });
  return left_out;
}

/// Bambu Studio, OrcaSlicer: parts are components of an object, named by the id of their object.
std::size_t leave_out_parts(xml_node config, ThreemfModel& model) {
  std::size_t left_out = 0;
  for_each_object(config, model, [&](ThreemfObject& object, xml_node node) {
    std::set<int> ids;
    for (const xml_node part : node.children("part"))
      if (std::string_view(part.attribute("subtype").as_string("normal_part")) != "normal_part")
        ids.insert(part.attribute("id").as_int(-1));
    left_out += std::erase_if(object.inside, [&](const ThreemfComponent& component) {
      return ids.contains(component.object.second);
    });
  });
  return left_out;
}

}  // namespace

LeftOutVolumes leave_out_modifiers(const ThreemfPackage& package, ThreemfModel& model) {
  LeftOutVolumes left_out;
  for (const auto& [part, leave_out] :
       {std::pair{"Metadata/Slic3r_PE_model.config", &leave_out_volumes},
        std::pair{"Metadata/model_settings.config", &leave_out_parts}}) {
    if (!package.has(part)) continue;
    pugi::xml_document document;
    try {
      left_out.count += leave_out(package.settings(part, document), model);
    } catch (const Error& error) {
      left_out.warnings.push_back(fmt::format(
          "the settings of the slicer are not read, modifiers and supports count as parts ({})",
          error.message()));
    }
  }
  if (left_out.count > 0)
    left_out.warnings.push_back(fmt::format(
        "modifiers, negative volumes and supports of the slicer left out: {}", left_out.count));
  return left_out;
}

}  // namespace lamplock::model
