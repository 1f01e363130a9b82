// What a 3MF file describes, with all lengths in mm: output of the reader of a part
// (threemf_part.hpp), input of read_3mf().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/geometry/affine.hpp"
#include "host/model/brightness.hpp"

namespace lamplock::model {

/// The number of a part in ThreemfModel::parts, and an id in this part.
using ThreemfKey = std::pair<int, int>;

/// A group of properties: brightness values, or places of a picture.
struct ThreemfProperties {
  std::vector<float> lights{};
  std::vector<TexturePlace> places{};
  std::string picture{};  // name of a part; empty for brightness values

  std::size_t size() const { return picture.empty() ? lights.size() : places.size(); }
};

struct ThreemfTriangle {
  std::array<std::uint32_t, 3> corners{};  // indices of vertices
  int group = no_group;                    // index into ThreemfModel::properties
  std::array<std::uint32_t, 3> entries{};  // of the group
  static constexpr int no_group = -1;
};

struct ThreemfComponent {
  ThreemfKey object{};
  geometry::Affine transform{};
};

/// A mesh, or other objects inside.
struct ThreemfObject {
  bool is_engraved = true;  // false for supports
  std::vector<geometry::Point> vertices{};
  std::vector<ThreemfTriangle> triangles{};
  std::vector<ThreemfComponent> inside{};
};

using ThreemfObjects = std::map<ThreemfKey, ThreemfObject>;

struct ThreemfModel {
  std::vector<std::string> parts{};  // names; the first has the build
  std::map<std::string, int> part_numbers{};
  double unit_mm = 1;          // of the first part
  std::size_t components = 0;  // and items
  ThreemfObjects objects{};
  std::vector<ThreemfProperties> properties{};
  std::vector<ThreemfComponent> items{};  // the build
  bool has_unread_colours = false;        // properties of a kind that is not read
  bool has_unprinted_items = false;

  /// The number of a part, which is appended if it is new.
  int number_of_part(const std::string& name);
  /// "object 4", and its part if that is not the first.
  std::string name_of(const ThreemfKey& object) const;
};

}  // namespace lamplock::model
