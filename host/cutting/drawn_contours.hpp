// Finds the drawn contours that a beam cuts into; they are edges of what remains of a sheet.
//
// In:  closed contours as they are drawn, with their numbers; the path of a beam. Out: the contours
//      that are nearer to it than half its width.
// Who: the plan of a job, and leads.
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

class DrawnContours {
 public:
  DrawnContours() : tree_({}) {}

  void add(const Contour& contour, std::size_t number);
  /// After the last contour, before the first question.
  void index();

  struct Cut {
    std::size_t contour = 0;  ///< number of the contour that the beam cuts into
    Vec at;                   ///< the place on it that is nearest to the path of the beam
    double distance_mm = 0;   ///< from that path
  };
  /// The contours, other than `own`, that are nearer to a path than `reach_mm`, half the width of
  /// its beam; each of them once.
  std::vector<Cut> cut_by(const Contour& path, std::size_t own, double reach_mm) const;
  bool are_cut_by(const Edge& edge, std::size_t own, double reach_mm) const;

 private:
  template <class Found>
  bool is_cut(const Edge& edge, std::size_t i, double reach_mm, const Found& found) const;

  std::vector<Edge> edges_;
  std::vector<std::size_t> numbers_;  ///< of the contour of each edge
  BoxTree tree_;
};

/// The other contours near one of a sheet; by default none.
struct Neighbours {
  const DrawnContours* drawn = nullptr;
  std::size_t own = 0;  ///< number of the contour that is cut

  bool are_cut_by(const Edge& edge, double reach_mm) const {
    return drawn != nullptr && drawn->are_cut_by(edge, own, reach_mm);
  }
};

}  // namespace lamplock::cutting
