#include "host/model/threemf_namespaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {
namespace {

struct ThreemfNamespace {
  std::string_view uri, prefix;
  bool is_read;
};

constexpr std::string_view other_prefix = "other";

constexpr std::array<ThreemfNamespace, 8> threemf_namespaces{
    {{"http://schemas.microsoft.com/3dmanufacturing/core/2015/02", "", true},
     {"http://schemas.microsoft.com/3dmanufacturing/material/2015/02", "m", true},
     {"http://schemas.microsoft.com/3dmanufacturing/production/2015/06", "p", true},
     // Names of sets of triangles; they change no geometry.
     {"http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07", "t", true},
     {"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02", "b", false},
     {"http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07", "b2", false},
     {"http://schemas.openxmlformats.org/package/2006/relationships", "", true},
     {"http://www.w3.org/XML/1998/namespace", "xml", true}}};

const ThreemfNamespace* namespace_of(std::string_view uri) {
  const auto* const found = std::ranges::find(threemf_namespaces, uri, &ThreemfNamespace::uri);
  return found == threemf_namespaces.end() ? nullptr : found;
}

/// The prefix that an attribute declares; false if it declares none.
bool declares(std::string_view attribute, std::string_view& prefix) {
  constexpr std::string_view word = "xmlns";
  if (!attribute.starts_with(word)) return false;
  attribute.remove_prefix(word.size());
  if (!attribute.empty() && attribute.front() != ':') return false;
  prefix = attribute.empty() ? attribute : attribute.substr(1);
  return true;
}

/// Visits all elements in the order of the document.
class Renaming : public pugi::xml_tree_walker {
 public:
  bool for_each(pugi::xml_node& node) override {
    if (node.type() != pugi::node_element) return true;
    leave_scopes();
    for (const pugi::xml_attribute attribute : node.attributes()) {
      std::string_view prefix;
      if (declares(attribute.name(), prefix)) declare(prefix, attribute.value());
    }
    if (declared_ > max_declarations) return false;
    if (const auto name = renamed(node.name(), true)) node.set_name(name->c_str());
    for (pugi::xml_attribute attribute : node.attributes()) {
      const std::string_view was = attribute.name();
      // An attribute without a prefix belongs to its element.
      if (was.find(':') == std::string_view::npos || was.starts_with("xmlns:")) continue;
      if (const auto name = renamed(was, false)) attribute.set_name(name->c_str());
    }
    return true;
  }

 private:
  /// Real files have about ten.
  static constexpr int max_declarations = 1000;

  struct Scope {
    int depth;
    std::string prefix;
  };

  void leave_scopes() {
    while (!scopes_.empty() && scopes_.back().depth >= depth()) {
      own_[scopes_.back().prefix].pop_back();
      scopes_.pop_back();
    }
  }

  void declare(std::string_view prefix, std::string_view uri) {
    ++declared_;
    const ThreemfNamespace* known = namespace_of(uri);
    own_[std::string(prefix)].push_back(known != nullptr ? known->prefix : other_prefix);
    scopes_.push_back({depth(), std::string(prefix)});
  }

  /// The new name, if it is another one.
  std::optional<std::string> renamed(std::string_view name, bool is_element) const {
    const std::size_t colon = name.find(':');
    const std::string_view prefix =
        colon == std::string_view::npos ? std::string_view{} : name.substr(0, colon);
    const auto found = own_.find(prefix);
    const bool known = found != own_.end() && !found->second.empty();
    const std::string_view own = known ? found->second.back() : other_prefix;
    if (own == prefix || (!is_element && prefix == "xml")) return std::nullopt;
    const std::string_view local = colon == std::string_view::npos ? name : name.substr(colon + 1);
    return own.empty() ? std::string(local) : fmt::format("{}:{}", own, local);
  }

  std::map<std::string, std::vector<std::string_view>, std::less<>> own_;  // by prefix of the file
  std::vector<Scope> scopes_;
  int declared_ = 0;
};

/// The namespace that a prefix of the root element means; "" if it declares none.
std::string_view declared_namespace(pugi::xml_node model, std::string_view prefix) {
  for (const pugi::xml_attribute attribute : model.attributes()) {
    std::string_view declared;
    if (declares(attribute.name(), declared) && declared == prefix) return attribute.value();
  }
  return {};
}

}  // namespace

void use_own_prefixes(const std::filesystem::path& file, pugi::xml_document& document) {
  Renaming renaming;
  if (!document.traverse(renaming))
    refuse(file, "it declares more than 1000 XML namespaces", "export it again");
}

void check_required_extensions(const std::filesystem::path& file, pugi::xml_node model) {
  std::string_view rest = model.attribute("requiredextensions").as_string();
  for (std::string_view prefix = next_field(rest); !prefix.empty(); prefix = next_field(rest)) {
    const std::string_view uri = declared_namespace(model, prefix);
    const ThreemfNamespace* known = namespace_of(uri);
    if (known != nullptr && known->is_read) continue;
    if (known != nullptr && known->prefix.starts_with('b'))
      refuse(file, "it has a beam lattice, which is not read",
             "convert the lattice to a mesh before the export");
    refuse(file,
           fmt::format("it requires the extension '{:.80}', which is not read",
                       uri.empty() ? prefix : uri),
           "export it without this extension, or as STL");
  }
}

}  // namespace lamplock::model
