// Arc length along a path, exactly: where is the point that lies s mm from the start?
//
// In:  a path. Out: its length, points by their distance along it.
// Who: divide(); cutting.
//
// Lines and circles have closed forms. The speed of ellipses and splines is integrated by
// Gauss-Legendre quadrature over pieces halved until both halves agree with the whole, and the
// integral is inverted by Newton's method held inside the piece. No polyline stands in for the
// curve.
#pragma once

#include <cstddef>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

class ArcLength {
 public:
  /// Keeps a reference to `path`. Time and memory grow with the pieces and how bent they are.
  /// Throws Error (bad_input) if the path is too bent to be measured (too many pieces).
  explicit ArcLength(const Path& path);

  /// mm.
  double total() const { return total_; }
  /// The point `s` mm from the start, 0 .. total(); beyond, the end. Fastest if `s` rises from call
  /// to call.
  points::Point at(double s);

 private:
  /// A stretch of one piece over which the speed is smooth.
  struct Stretch {
    std::size_t piece;
    Range range;
    double begins_at, length;  ///< mm along the path
  };
  void add(std::size_t piece);
  void add_smooth(std::size_t piece, Range range, double length, int depth);
  double parameter_at(const Stretch& stretch, double along) const;

  const Path& path_;
  std::vector<Stretch> stretches_;
  double total_ = 0;
  std::size_t last_ = 0;
};

}  // namespace lamplock::model
