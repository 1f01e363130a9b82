#include "host/model/threemf_properties.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "host/file.hpp"
#include "host/model/mesh_builder.hpp"
#include "host/model/text.hpp"
#include "host/model/threemf_package.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// "#RRGGBB" or "#RRGGBBAA", of sRGB values; the opacity does not count.
std::optional<float> light_of(std::string_view text) {
  constexpr std::size_t rgb = 7, rgba = 9;  // with the #
  text = trimmed(text);
  if (!text.starts_with('#') || (text.size() != rgb && text.size() != rgba)) return std::nullopt;
  std::uint32_t value = 0;
  constexpr int hexadecimal = 16;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data() + 1, end, value, hexadecimal).ptr != end) return std::nullopt;
  if (text.size() == rgba) value >>= 8;
  return luma((value >> 16) / 255.0, (value >> 8 & 0xFF) / 255.0, (value & 0xFF) / 255.0);
}

}  // namespace

int threemf_number(const std::filesystem::path& file, xml_node node, const char* name,
                   const std::string& of) {
  const char* text = node.attribute(name).as_string();
  const auto value = to_integer(trimmed(text));
  if (!value || *value < 0 || *value > std::numeric_limits<int>::max())
    refuse(file, fmt::format("{} has {} '{:.20}'", of, name, text), "repair the model");
  return static_cast<int>(*value);
}

ThreemfResources::ThreemfResources(const std::filesystem::path& file, xml_node resources,
                                   ThreemfModel& model)
    : file_(file), model_(model) {
  for (const xml_node node : resources.children())
    if (node.type() == pugi::node_element) add(node);
}

void ThreemfResources::fail(const std::string& of, const std::string& what) const {
  refuse(file_, fmt::format("{} {}", of, what), "repair the model");
}

void ThreemfResources::add(xml_node node) {
  const std::string kind = node.name();
  if (!node.attribute("id")) {
    if (kind == "object") fail("an object", "has no id");
    return;
  }
  const int id = threemf_number(file_, node, "id", kind);
  const std::string name = fmt::format("{} {}", kind, id);
  const auto [at, is_new] = resources_.try_emplace(id, Resource{.kind = kind, .picture = {}});
  if (!is_new) fail("the model", fmt::format("has the id {} twice", id));
  std::optional<ThreemfProperties> group;
  if (kind == "basematerials") {
    group = colours(node, "base", "displaycolor", name);
  } else if (kind == "m:colorgroup") {
    group = colours(node, "m:color", "color", name);
  } else if (kind == "m:texture2dgroup") {
    group = places(node, name);
  } else if (kind == "m:compositematerials") {
    group = mixtures(node, name);
  } else if (kind == "m:texture2d") {
    at->second.picture = part_name(node.attribute("path").as_string());
    if (at->second.picture.empty()) fail(name, "names no picture");
  }
  if (!group) return;
  at->second.group = static_cast<int>(model_.properties.size());
  model_.properties.push_back(*std::move(group));
}

ThreemfProperties ThreemfResources::colours(xml_node node, const char* entry, const char* colour,
                                            const std::string& name) const {
  ThreemfProperties group;
  for (const xml_node child : node.children(entry)) {
    const char* text = child.attribute(colour).as_string();
    const auto light = light_of(text);
    if (!light) fail(name, fmt::format("has the colour '{:.20}'", text));
    group.lights.push_back(*light);
  }
  return group;
}

ThreemfProperties ThreemfResources::places(xml_node node, const std::string& name) const {
  const auto picture = resources_.find(threemf_number(file_, node, "texid", name));
  if (picture == resources_.end() || picture->second.kind != "m:texture2d")
    fail(name, "has a picture that does not exist");
  ThreemfProperties group;
  group.picture = picture->second.picture;
  for (const xml_node child : node.children("m:tex2coord")) {
    const char *u = child.attribute("u").as_string(), *v = child.attribute("v").as_string();
    const auto right = to_double(trimmed(u)), up = to_double(trimmed(v));
    if (!right || !up || !std::isfinite(*right) || !std::isfinite(*up))
      fail(name, fmt::format("has the place '{:.20}', '{:.20}'", u, v));
    group.places.push_back({static_cast<float>(*right), static_cast<float>(*up)});
  }
  return group;
}

/// The mean of base materials by their shares.
ThreemfProperties ThreemfResources::mixtures(xml_node node, const std::string& name) const {
  const int bases = group(threemf_number(file_, node, "matid", name), name);
  ThreemfProperties mixed;
  if (bases == ThreemfTriangle::no_group) fail(name, "mixes materials that are not base materials");
  const std::vector<float>& lights = model_.properties[static_cast<std::size_t>(bases)].lights;
  std::vector<float> of_indices;
  std::string_view indices = node.attribute("matindices").as_string();
  for (auto field = next_field(indices); !field.empty(); field = next_field(indices)) {
    const auto index = to_integer(field);
    if (!index || *index < 0 || *index >= std::ssize(lights))
      fail(name, fmt::format("mixes material '{:.20}' of {}", field, lights.size()));
    of_indices.push_back(lights[static_cast<std::size_t>(*index)]);
  }
  for (const xml_node child : node.children("m:composite")) {
    double sum = 0, light = 0;
    std::size_t at = 0;
    std::string_view values = child.attribute("values").as_string();
    for (auto field = next_field(values); !field.empty(); field = next_field(values), ++at) {
      const auto share = to_double(field);
      if (!share || !(*share >= 0) || !std::isfinite(*share) || at >= of_indices.size())
        fail(name, fmt::format("has the share '{:.20}'", field));
      sum += *share;
      light += *share * of_indices[at];
    }
    mixed.lights.push_back(sum > 0 ? static_cast<float>(light / sum) : 1.0F);
  }
  return mixed;
}

int ThreemfResources::group(int id, const std::string& of) const {
  const auto found = resources_.find(id);
  if (found == resources_.end())
    fail(of, fmt::format("has the properties {}, which do not exist", id));
  const std::string& kind = found->second.kind;
  if (kind == "object" || kind == "m:texture2d")
    fail(of, fmt::format("has the properties {}, which are of kind {}", id, kind));
  return found->second.group;
}

}  // namespace lamplock::model
