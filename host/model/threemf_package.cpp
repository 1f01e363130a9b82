#include "host/model/threemf_package.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>

#include "host/file.hpp"
#include "host/model/threemf_namespaces.hpp"

namespace lamplock::model {
namespace {

constexpr const char* damaged_package = "the file is cut off or damaged: export it again";

/// Elements and attributes, which take up to 64 bytes each once they are read: 1.3 GB. A triangle
/// has four, a vertex too.
constexpr std::ptrdiff_t max_marks = 20'000'000;

bool is_utf16(std::string_view text) {
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
}

}  // namespace

std::string part_name(std::string_view target) {
  if (target.starts_with('/')) target.remove_prefix(1);
  std::string name;
  for (std::size_t i = 0; i < target.size(); ++i) {
    unsigned char decoded{};
    constexpr int hexadecimal = 16;
    // Two digits after a percent sign are a byte ("Uniform Resource Identifier", RFC 3986).
    if (target[i] == '%' && i + 2 < target.size() &&
        std::from_chars(&target[i + 1], &target[i + 1] + 2, decoded, hexadecimal).ptr ==
            &target[i + 1] + 2) {
      name += static_cast<char>(decoded);
      i += 2;
    } else {
      name += target[i];
    }
  }
  return name;
}

void ThreemfPackage::load_xml(const std::string& part, pugi::xml_document& document) const {
  const std::string text = archive_.unpacked(part);
  if (text.find('\0') != std::string::npos && !is_utf16(text))
    refuse(file_, fmt::format("part '{}' is not valid UTF-8", part), damaged_package);
  const auto marks =
      std::count(text.begin(), text.end(), '<') + std::count(text.begin(), text.end(), '=');
  if (marks > max_marks)
    refuse(file_, fmt::format("part '{}' has {} elements and attributes", part, marks),
           "reduce the mesh, or export it as binary STL");
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result)
    refuse(file_, fmt::format("part '{}' is not valid XML: {}", part, result.description()),
           damaged_package);
}

void ThreemfPackage::read_xml(const std::string& part, pugi::xml_document& document) const {
  load_xml(part, document);
  use_own_prefixes(file_, document);
}

pugi::xml_node ThreemfPackage::settings(const std::string& part,
                                        pugi::xml_document& document) const {
  load_xml(part, document);
  const pugi::xml_node config = document.child("config");
  if (!config) refuse(file_, fmt::format("part '{}' has no settings", part), damaged_package);
  return config;
}

std::string ThreemfPackage::model_part() const {
  constexpr std::string_view start_part =
      "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
  pugi::xml_document document;
  read_xml("_rels/.rels", document);
  std::string part;
  for (const pugi::xml_node relation : document.child("Relationships").children("Relationship")) {
    if (relation.attribute("Type").as_string() != start_part) continue;
    if (!part.empty()) refuse(file_, "it has more than one model", "export it again");
    part = part_name(relation.attribute("Target").as_string());
  }
  if (part.empty()) refuse(file_, "it names no part with a model", damaged_package);
  return part;
}

pugi::xml_node ThreemfPackage::model(const std::string& part, pugi::xml_document& document) const {
  read_xml(part, document);
  const pugi::xml_node model = document.child("model");
  if (!model) refuse(file_, fmt::format("part '{}' is not a model", part), damaged_package);
  check_required_extensions(file_, model);
  return model;
}

}  // namespace lamplock::model
