// The lines of a text DXF taken apart: pairs of a group code and its value (Autodesk, "DXF
// Reference": group codes in numerical order).
//
// In:  the bytes of a file. Out: group after group, entity after entity; numbers that are numbers.
// Who: read_dxf() and the parser of entities.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/model/place.hpp"
#include "host/model/text.hpp"
#include "host/points/point.hpp"

namespace lamplock::model {

struct DxfGroup {
  int code = 0;
  std::string_view value;  ///< without blanks around
};

/// One entity or table entry: what stands between two groups of code 0.
struct DxfEntity {
  std::string_view kind;         ///< value of the group of code 0
  std::vector<DxfGroup> groups;  ///< those behind it
};

/// Hands out groups one after the other; the bytes have to stay.
class DxfGroups {
 public:
  /// Throws Error (bad_input) for binary DXF and DWG.
  DxfGroups(const std::filesystem::path& file, std::string_view bytes);

  /// The next group; comments (999) are skipped. Throws Error (bad_input) if the file ends or there
  /// is no pair of code and value.
  DxfGroup next();
  /// Without taking it.
  const DxfGroup& peek();
  /// Takes a group of code 0 and all behind it up to the next of code 0 into `entity`, whose memory
  /// is used again. Throws Error (bad_input) if there is none.
  void next_entity(DxfEntity& entity);

  Place place_of(std::string_view value) const;
  /// The value of a group as a finite number, an integer. Throws Error (bad_input).
  double number(const DxfGroup& group) const;
  int integer(const DxfGroup& group) const;
  /// That of the last group of this code, `otherwise` if there is none.
  double number(const DxfEntity& entity, int code, double otherwise = 0) const;
  int integer(const DxfEntity& entity, int code, int otherwise = 0) const;
  std::string_view text(const DxfEntity& entity, int code, std::string_view otherwise = {}) const;
  /// From the groups of codes x, x + 10 and x + 20.
  points::Point point(const DxfEntity& entity, int x, const points::Point& otherwise = {}) const;

 private:
  const std::filesystem::path& file_;
  std::string_view bytes_;
  Lines lines_;
  DxfGroup ahead_;
  bool has_ahead_ = false;
};

}  // namespace lamplock::model
