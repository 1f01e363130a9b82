// Clips curves to regions of the page (W3C, "CSS Masking Module Level 1", clipping paths).
//
// In:  regions by their outlines, a path; mm, only x and y matter.
// Out: the parts of the path inside all regions, exact curves whose ends are within flat_mm of the
//      outline.
// Who: read_svg().
//
// A region is the union of shapes. Outlines become polygons with the tolerance flat_mm; what is on
// an outline is inside. An index of the edges by their y limits the tests, whose number is counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/curves.hpp"
#include "host/model/file_position.hpp"

namespace lamplock::model {

class ClipRegion;
using ClipRegions = std::vector<std::shared_ptr<const ClipRegion>>;

/// Counts tests of edges, and what is done with the crossings found, so that no drawing takes
/// hours.
class ClipWork {
 public:
  /// Throws Error (bad_input) if there were too many.
  void spend(std::size_t tests, const FilePosition& place);
  /// Counts the sorting of crossings of one piece. Throws as spend().
  void spend_on_sorting(std::size_t crossings, const FilePosition& place);

 private:
  std::size_t spent_ = 0;
};

/// A shape of a clip path: closed polygons filled by a rule, and regions that clip the shape.
class ClipShape {
 public:
  /// Throws Error (bad_input) by `work` if the outlines need too many edges.
  ClipShape(const std::vector<Path>& outlines, bool even_odd, ClipRegions clips, ClipWork& work,
            const FilePosition& place);

  bool contains(const geometry::Point& point, ClipWork& work, const FilePosition& place) const;
  /// Appends where the segment from p (0) to q (1) crosses the outlines.
  void cross(const geometry::Point& p, const geometry::Point& q, std::vector<double>& parts,
             ClipWork& work, const FilePosition& place) const;

 private:
  struct Edge {
    geometry::Point p, q;
  };
  void build_index();
  std::size_t slab_of(double y) const;
  /// The first slab that an edge is in.
  std::size_t first_slab_of(const Edge& edge) const;

  std::vector<Edge> edges_;
  bool even_odd_;
  ClipRegions clips_;
  double low_ = 0, slab_height_ = 1;
  std::vector<std::vector<std::uint32_t>> slabs_;  ///< edges by y
};

/// The union of its shapes; without shapes it is empty.
class ClipRegion {
 public:
  explicit ClipRegion(std::vector<ClipShape> shapes) : shapes_(std::move(shapes)) {}
  bool contains(const geometry::Point& point, ClipWork& work, const FilePosition& place) const;
  void cross(const geometry::Point& p, const geometry::Point& q, std::vector<double>& parts,
             ClipWork& work, const FilePosition& place) const;

 private:
  std::vector<ClipShape> shapes_;
};

/// The parts of a path inside all regions; a path that is wholly inside is returned as it is.
/// Throws Error (bad_input) by `work`.
std::vector<Path> clipped(Path path, const ClipRegions& regions, ClipWork& work,
                          const FilePosition& place);

}  // namespace lamplock::model
