// Exact arc length along a path: finds the point at s mm from the start.
//
// In:  a path. Out: its length, points by their distance along it.
// Who: divide(); cutting.
//
// The speed is integrated by Gauss-Legendre quadrature over pieces halved until both halves agree
// with the whole (at once for lines and circles, whose speed is constant); the integral is inverted
// by Newton's method limited to the piece. The curve is not replaced by a polyline.
#pragma once

#include <cstddef>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

class ArcLength {
 public:
  /// Keeps a reference to `path`, which must outlive this. Time and memory grow with the pieces and
  /// their curvature. Throws Error (bad_input) if the path is too complex (too many pieces).
  explicit ArcLength(const Path& path);

  /// mm.
  double total() const { return total_; }
  /// The point `s` mm from the start, 0 .. total(); beyond, the end. A search among the pieces
  /// and a few evaluations of the curve.
  geometry::Point at(double s);

  /// A place on the path: a piece and the parameter on it.
  struct Place {
    std::size_t piece = 0;
    double parameter = 0;
  };
  /// The place `s` mm from the start, as at().
  Place place(double s);

 private:
  /// A stretch of one piece over which the speed is smooth.
  struct Stretch {
    std::size_t piece;
    Range range;
    double begins_at, length;  ///< mm along the path
  };
  void add(std::size_t piece);
  void add_smooth(std::size_t piece, const Range& range, double length, int depth);
  double parameter_at(const Stretch& stretch, double along) const;

  const Path& path_;
  std::vector<Stretch> stretches_;
  double agree_mm_ = 0;  ///< tolerance for the piece that is being added
  double total_ = 0;
  std::size_t last_ = 0;
};

}  // namespace lamplock::model
