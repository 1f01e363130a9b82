// The elements of an SVG file with entities expanded and styles resolved into attributes.
//
// In:  the bytes of a file. Out: its root, elements by id, their places for errors.
// Who: read_svg(), its clip paths.
#pragma once

#include <filesystem>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>

#include "host/model/file_position.hpp"

namespace lamplock::model {

/// Nested groups and uses; drawings have a dozen levels.
inline constexpr int max_svg_depth = 200;

class SvgDocument {
 public:
  /// `file` must outlive it. Throws Error (bad_input) naming file and line: invalid XML, another
  /// document than svg, entities without bounds, elements nested too deeply, style sheets that are
  /// too complex.
  SvgDocument(const std::filesystem::path& file, std::string bytes);
  SvgDocument(const SvgDocument&) = delete;
  SvgDocument& operator=(const SvgDocument&) = delete;

  const pugi::xml_node& root() const { return root_; }
  FilePosition position_of(const pugi::xml_node& node) const;
  /// The element with an id; null if there is none.
  pugi::xml_node find(std::string_view id) const;
  /// The element that "url(#id)" refers to; null if there is none.
  pugi::xml_node find_url(std::string_view value) const;
  /// The element that a `use` refers to by its attribute href, "#id" in it. Throws Error
  /// (bad_input) if there is none; null for an element of another file.
  pugi::xml_node used_by(const pugi::xml_node& use) const;
  /// What of the document is not read, by kind: rules of style sheets, elements of other
  /// namespaces, entities and style sheets of other files.
  const std::map<std::string, std::size_t>& left_out() const { return left_out_; }

 private:
  /// By an id, as it is or with percent codes.
  pugi::xml_node find_fragment(std::string_view fragment) const;
  void keep_svg();
  void number_ids(const pugi::xml_node& node, int depth);

  const std::filesystem::path& file_;
  std::string text_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::unordered_map<std::string, pugi::xml_node> by_id_;
  std::map<std::string, std::size_t> left_out_;
};

}  // namespace lamplock::model
