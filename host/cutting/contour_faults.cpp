// contour_faults(): where contours cross themselves or others, and where edges overlap.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"
#include "host/cutting/place_grid.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

// Differences below this are rounding: a thousandth of the resolution of the coordinates.
constexpr double coincident_mm = 1e-6;
// How far from a common point the two contours are compared to see whether they cross there.
constexpr double probe_mm = 1e-3;
// More of them are found more slowly.
constexpr std::size_t usual_crossings = 1024;

// Edges that are compared with all others at once, by one thread.
constexpr std::size_t portion = 1024;

struct EdgeNumber {
  std::size_t contour, edge;
};

/// Faults in the order in which they are found, each of them once.
class FaultList {
 public:
  explicit FaultList(std::size_t max_faults)
      : max_faults_(max_faults), crossings_(probe_mm, std::min(max_faults, usual_crossings)) {}

  bool is_full() const { return faults_.size() >= max_faults_; }

  void add(const Fault& fault) {
    if (fault.kind != FaultKind::overlap) {
      // A crossing at a corner is found with each of the edges that meet there.
      if (crossings_.any(fault.at, [&](std::size_t i) {
            const Fault& known = faults_[i];
            return known.contour == fault.contour && known.other == fault.other &&
                   distance(known.at, fault.at) <= probe_mm;
          }))
        return;
      crossings_.add(fault.at, faults_.size());
    }
    faults_.push_back(fault);
  }

  std::vector<Fault> take() { return std::move(faults_); }

 private:
  std::size_t max_faults_;
  std::vector<Fault> faults_;
  PlaceGrid crossings_;  ///< numbers of faults
};

class FaultFinder {
 public:
  explicit FaultFinder(const std::vector<Contour>& contours) : contours_(contours) {
    for (std::size_t i = 0; i < contours.size(); ++i) {
      double along = 0;
      std::vector<double>& starts = starts_.emplace_back();
      for (std::size_t j = 0; j < contours[i].edges.size(); ++j) {
        const Edge& edge = contours[i].edges[j];
        numbers_.push_back({i, j});
        boxes_.push_back(box_of(edge).grown(coincident_mm));
        starts.push_back(along);
        along += length_of(edge);
      }
      starts.push_back(along);
    }
  }

  std::vector<Fault> find(std::size_t max_faults) const {
    const BoxTree tree(boxes_);
    std::vector<std::vector<Fault>> found((numbers_.size() + portion - 1) / portion);
    geometry::for_each_index(found.size(), 0, [&](std::size_t part) {
      FaultList faults(max_faults);
      const std::size_t end = std::min(numbers_.size(), (part + 1) * portion);
      for (std::size_t i = part * portion; i < end; ++i) {
        tree.visit(boxes_[i], [&](std::size_t j) {
          if (j > i && !faults.is_full()) compare(numbers_[i], numbers_[j], faults);
        });
      }
      found[part] = faults.take();
    });
    FaultList all(max_faults);
    for (const std::vector<Fault>& part : found)
      for (const Fault& fault : part)
        if (!all.is_full()) all.add(fault);
    return all.take();
  }

 private:
  const Edge& edge(const EdgeNumber& number) const {
    return contours_[number.contour].edges[number.edge];
  }

  bool follows(const EdgeNumber& a, const EdgeNumber& b) const {
    if (a.contour != b.contour) return false;
    const Contour& contour = contours_[a.contour];
    if (a.edge + 1 == b.edge) return true;
    return contour.closed && a.edge + 1 == contour.edges.size() && b.edge == 0;
  }

  void compare(const EdgeNumber& a, const EdgeNumber& b, FaultList& faults) const {
    const Overlap overlap = overlap_of(edge(a), edge(b), coincident_mm);
    if (overlap.length_mm > probe_mm) {
      faults.add({FaultKind::overlap, overlap.middle, overlap.length_mm, a.contour, b.contour});
      return;
    }
    for (const Vec& at : intersections(edge(a), edge(b), coincident_mm)) {
      const bool is_joint = (follows(a, b) && distance(at, edge(a).to) <= probe_mm / 10) ||
                            (follows(b, a) && distance(at, edge(b).to) <= probe_mm / 10);
      if (!is_joint && cross_at(at, a, b)) faults.add(crossing_at(at, a, b));
    }
  }

  /// A place on a contour, mm along it.
  double along(const EdgeNumber& number, const Vec& at) const {
    const double part = std::clamp(part_at(edge(number), at), 0.0, 1.0);
    return starts_[number.contour][number.edge] + part * length_of(edge(number));
  }

  /// The point of a contour at a distance along it; false beyond the ends of an open one.
  bool point_along(std::size_t number, double along, Vec& point) const {
    const Contour& contour = contours_[number];
    const std::vector<double>& starts = starts_[number];
    const double total = starts.back();
    if (contour.closed) along -= std::floor(along / total) * total;
    if (along < 0 || along > total) return false;
    const auto next = std::upper_bound(starts.begin(), starts.end() - 1, along);
    const auto i = static_cast<std::size_t>(next - starts.begin()) - 1;
    const double length = starts[i + 1] - starts[i];
    point =
        point_at(contour.edges[i], length > 0 ? std::min(1.0, (along - starts[i]) / length) : 0);
    return true;
  }

  /// True if the two branches of b leave the point on different sides of a.
  bool cross_at(const Vec& at, const EdgeNumber& a, const EdgeNumber& b) const {
    const double on_a = along(a, at), on_b = along(b, at);
    Vec back_a, ahead_a, back_b, ahead_b;
    if (!point_along(a.contour, on_a - probe_mm, back_a) ||
        !point_along(a.contour, on_a + probe_mm, ahead_a) ||
        !point_along(b.contour, on_b - probe_mm, back_b) ||
        !point_along(b.contour, on_b + probe_mm, ahead_b))
      return false;
    const auto angle = [&](const Vec& point) {
      const Vec from = ahead_a - at, to = point - at;
      const double turn = std::atan2(cross(from, to), dot(from, to));
      return turn < 0 ? turn + 2 * std::acos(-1.0) : turn;
    };
    // Branches that run into each other touch.
    constexpr double same = 1e-6;
    const double end = angle(back_a), first = angle(back_b), second = angle(ahead_b);
    const auto side = [&](double turn) {
      if (turn < same || std::abs(turn - end) < same || turn > 2 * std::acos(-1.0) - same) return 0;
      return turn < end ? 1 : -1;
    };
    return side(first) * side(second) < 0;
  }

  Fault crossing_at(const Vec& at, const EdgeNumber& a, const EdgeNumber& b) const {
    Fault fault{FaultKind::crossing, at, 0, a.contour, b.contour};
    if (a.contour == b.contour) {
      fault.kind = FaultKind::self_intersection;
      fault.size_mm = std::abs(along(a, at) - along(b, at));
      if (contours_[a.contour].closed)
        fault.size_mm = std::min(fault.size_mm, starts_[a.contour].back() - fault.size_mm);
    }
    return fault;
  }

  const std::vector<Contour>& contours_;
  std::vector<EdgeNumber> numbers_;
  std::vector<Box> boxes_;
  std::vector<std::vector<double>>
      starts_;  ///< of the edges, mm along each contour, and its length
};

}  // namespace

std::vector<Fault> contour_faults(const std::vector<Contour>& contours, std::size_t max_faults) {
  return FaultFinder(contours).find(max_faults);
}

}  // namespace lamplock::cutting
