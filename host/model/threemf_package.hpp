// The package of a 3MF file ("Open Packaging Conventions", ECMA-376 part 2). In: a file. Out: the
// name of the part with the model, parts as XML or bytes. Called by read_3mf().
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "host/model/zip_archive.hpp"

namespace lamplock::model {

class ThreemfPackage {
 public:
  /// Throws Error (bad_input, naming `file`), as all functions: no archive, cut off, a zip bomb.
  explicit ThreemfPackage(const std::filesystem::path& file) : file_(file), archive_(file) {}

  /// The part that the package starts with.
  std::string model_part() const;

  /// Reads a part with a model into `document`, with the prefixes of threemf_namespaces.hpp, and
  /// returns its root. Throws Error: no such part, not XML, too large, not a model, an extension
  /// that is required and not read.
  pugi::xml_node model(const std::string& part, pugi::xml_document& document) const;

  /// Reads a part with settings of a slicer and returns its element `config`. Throws Error: as
  /// model(), or no such element.
  pugi::xml_node settings(const std::string& part, pugi::xml_document& document) const;

  bool has(const std::string& part) const { return archive_.has(part); }

  /// The bytes of a part.
  std::string bytes(const std::string& part) const { return archive_.unpacked(part); }

 private:
  void load_xml(const std::string& part, pugi::xml_document& document) const;
  /// As load_xml(), with the prefixes of threemf_namespaces.hpp.
  void read_xml(const std::string& part, pugi::xml_document& document) const;

  const std::filesystem::path& file_;
  ZipArchive archive_;
};

/// The name in the archive of a part that is named by an absolute path or from the root.
std::string part_name(std::string_view target);

}  // namespace lamplock::model
