// Colours of 3MF files ("Materials and Properties Extension", 3MF Consortium, version 1.2, and the
// base materials of the core specification). In: the resources of a part. Out: groups of
// brightness values and of places in pictures. Called by the reader of a part (threemf_part.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <pugixml.hpp>
#include <string>

#include "host/model/threemf_model.hpp"

namespace lamplock::model {

/// The resources of one part by their ids.
class ThreemfResources {
 public:
  /// Reads all resources but objects, of which it takes the ids only. Groups are added to `model`.
  /// Throws Error (bad_input, naming `file` and the resource): an id that is missing or occurs
  /// twice, an invalid colour or place, a picture or material that does not exist.
  ThreemfResources(const std::filesystem::path& file, pugi::xml_node resources,
                   ThreemfModel& model);

  /// The index of a group in ThreemfModel::properties; ThreemfTriangle::no_group for a group of a
  /// kind that is not read. Throws Error if `id` is no group; `of` names the user of the group.
  int group(int id, const std::string& of) const;

 private:
  struct Resource {
    std::string kind;
    int group = ThreemfTriangle::no_group;
    std::string picture;
  };

  void add(pugi::xml_node node);
  ThreemfProperties colours(pugi::xml_node node, const char* entry, const char* colour,
                            const std::string& name) const;
  ThreemfProperties places(pugi::xml_node node, const std::string& name) const;
  ThreemfProperties mixtures(pugi::xml_node node, const std::string& name) const;
  [[noreturn]] void fail(const std::string& of, const std::string& what) const;

  const std::filesystem::path& file_;
  ThreemfModel& model_;
  std::map<int, Resource> resources_;
};

/// An attribute that must be an integer from 0 to 2^31 - 1. Throws Error (bad_input), naming `of`.
int threemf_number(const std::filesystem::path& file, pugi::xml_node node, const char* name,
                   const std::string& of);

}  // namespace lamplock::model
