// A grid of nodes along three axes, each node in a control volume of its own.
//
// In:  places of nodes. Out: widths of volumes, distances. Who: the heat solver and its runs.
//
// The first and last nodes of an axis are on its ends, with half a volume each:
//
//   |--o-------o------o---|        o node, | face; faces are in the middle between nodes
//
// so the first node along z is the surface itself. An axis of a single node has a given width: a
// column of 1 mm2 is the problem in depth alone.
#pragma once

#include <cstddef>
#include <vector>

namespace lamplock::thermal {

class Axis {
 public:
  /// Nodes in rising order, at least two.
  explicit Axis(std::vector<double> nodes);
  /// One node at 0.
  static Axis single(double width_mm);

  std::size_t size() const { return nodes_.size(); }
  double node(std::size_t i) const { return nodes_[i]; }
  double width(std::size_t i) const { return faces_[i + 1] - faces_[i]; }
  /// Lower end of volume i; face(size()) is the upper end of the last.
  double face(std::size_t i) const { return faces_[i]; }
  /// From node i to the next.
  double gap(std::size_t i) const { return nodes_[i + 1] - nodes_[i]; }
  const std::vector<double>& nodes() const { return nodes_; }
  /// The node nearest to a place.
  std::size_t nearest(double place) const;

 private:
  Axis() = default;
  std::vector<double> nodes_, faces_;
};

/// Depths from 0 to `depth`, at least two; each distance is `growth` times the one above it.
std::vector<double> depth_nodes(double depth, std::size_t count, double growth);

/// Equal distances of about `fine` from `focus_low` to `focus_high`; outside of it each distance is
/// `growth` times the one before, up to both ends. The focus is cut off at the ends.
struct Grading {
  double fine = 0, growth = 1.4;
};
std::vector<double> graded_nodes(double low, double high, double focus_low, double focus_high,
                                 const Grading& grading);

struct Grid {
  Axis x, y, z;  ///< z: depth below the surface
  std::size_t size() const { return x.size() * y.size() * z.size(); }
  std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * y.size() + j) * x.size() + i;
  }
  /// Nodes of the surface are the first ones.
  std::size_t surface_size() const { return x.size() * y.size(); }
};

}  // namespace lamplock::thermal
