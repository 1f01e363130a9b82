// Parses the lines of a text DXF: pairs of a group code and its value (Autodesk, "DXF Reference":
// group codes in numerical order).
//
// In:  the bytes of a file. Out: groups and entities in order; checked numbers.
// Who: read_dxf() and the parser of entities.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/file_position.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {

struct DxfGroup {
  int code = 0;
  std::string_view value;  ///< without blanks at both ends
};

/// One entity or table entry: a group of code 0 and the groups up to the next one.
struct DxfEntity {
  std::string_view kind;         ///< value of the group of code 0
  std::vector<DxfGroup> groups;  ///< the groups after it
};

/// Returns groups in order; the bytes must outlive it.
class DxfGroups {
 public:
  /// `was_binary`: the text was made of a binary DXF. Throws Error (bad_input) for DWG.
  DxfGroups(const std::filesystem::path& file, std::string_view bytes, bool was_binary = false);

  /// Reads the next group; comments (999) are skipped. Throws Error (bad_input) if the file ends or
  /// there is no pair of code and value.
  DxfGroup next();
  /// The next group, which next() will return.
  const DxfGroup& peek();
  /// Reads a group of code 0 and the groups up to the next one into `entity`, whose memory is
  /// reused. Throws Error (bad_input) if there is none.
  void next_entity(DxfEntity& entity);

  FilePosition position_of(std::string_view value) const;
  /// The value of a group as a finite number, an integer. Throws Error (bad_input).
  double number(const DxfGroup& group) const;
  int integer(const DxfGroup& group) const;
  /// The value of the last group of this code, `otherwise` if there is none.
  double number(const DxfEntity& entity, int code, double otherwise = 0) const;
  int integer(const DxfEntity& entity, int code, int otherwise = 0) const;
  std::string_view text(const DxfEntity& entity, int code, std::string_view otherwise = {}) const;
  /// From the groups of codes x, x + 10 and x + 20.
  geometry::Point point(const DxfEntity& entity, int x,
                        const geometry::Point& otherwise = {}) const;

 private:
  const std::filesystem::path& file_;
  std::string_view bytes_;
  bool was_binary_;
  Lines lines_;
  DxfGroup ahead_;
  bool has_ahead_ = false;
};

}  // namespace lamplock::model
