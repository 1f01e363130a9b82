// Collects the curves that the readers find: places, checks and counts them, so that no file can
// exhaust the memory by nested blocks or lose the precision of its numbers.
//
// In:  paths and points in the file's units with the map to mm. Out: Curves.
// Who: read_dxf(), read_svg().
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "host/geometry/affine.hpp"
#include "host/model/curves.hpp"
#include "host/model/file_position.hpp"

namespace lamplock::model {

class CurveCollector {
 public:
  /// Both throw Error (bad_input) for coordinates that are not finite or beyond farthest_mm, and
  /// for more pieces or points than allowed. A path without pieces is left out; one that returns to
  /// its start is closed.
  void add(Path path, const geometry::Affine& map, const std::string& layer,
           const FilePosition& place);
  void add(const geometry::Point& point, const geometry::Affine& map, const FilePosition& place);

  /// The path in mm. Throws Error (bad_input) as add().
  static Path placed(Path path, const geometry::Affine& map, const FilePosition& place);

  /// Counts copies of blocks, which cost time even if they draw nothing. Throws as add().
  void spend(std::size_t pieces, const FilePosition& place);
  void leave_out(const std::string& name, std::size_t count = 1);
  void warn(std::string warning);
  /// The numbers of the file are taken as mm; the last warning.
  void warn_of_unit(std::string warning);
  void set_unit(double mm_per_unit) { curves_.mm_per_unit = mm_per_unit; }

  /// The number of a layer, a new one for its first use.
  std::uint32_t layer_number(const std::string& name);

  /// The drawing, also an empty one.
  Curves collected() && { return std::move(curves_); }
  /// The drawing. Throws Error (bad_input) if there is nothing in it.
  Curves finished(const std::filesystem::path& file) &&;

 private:
  Curves curves_;
  std::map<std::string, std::uint32_t> layers_;
  std::size_t spent_ = 0;
};

/// Appends a line unless its length is 0.
void append_line(Path& path, const geometry::Point& from, const geometry::Point& to);

}  // namespace lamplock::model
