// Where the readers of curves put what they find: placed, checked and counted, so that no file,
// however it nests its blocks, ends in exhausted memory or in numbers without digits.
//
// In:  paths and points in the file's units with the map to mm. Out: Curves.
// Who: read_dxf(), read_svg().
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "host/model/affine.hpp"
#include "host/model/curves.hpp"
#include "host/model/place.hpp"

namespace lamplock::model {

class CurveCollector {
 public:
  /// Both throw Error (bad_input) for coordinates that are not finite or beyond farthest_mm, and
  /// for more than there may be. A path without pieces is left out; one that returns to its start
  /// is closed.
  void add(Path path, const Affine& map, const std::string& layer, const Place& place);
  void add(const points::Point& point, const Affine& map, const Place& place);

  /// Counts what costs time but may draw nothing: copies of blocks. Throws as add().
  void spend(std::size_t pieces, const Place& place);
  void leave_out(const std::string& name, std::size_t count = 1);

  /// The drawing. Throws Error (bad_input) if there is nothing in it.
  Curves finished(const std::filesystem::path& file) &&;

 private:
  std::uint32_t layer_number(const std::string& name);

  Curves curves_;
  std::map<std::string, std::uint32_t> layers_;
  std::size_t spent_ = 0;
};

/// Appends a line if it goes anywhere.
void append_line(Path& path, const points::Point& from, const points::Point& to);

}  // namespace lamplock::model
