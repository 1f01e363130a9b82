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
  explicit FaultFinder(const std::vector<Contour>& contours)
      : contours_(contours), starts_(contours.size()) {
    trees_.reserve(contours.size());
    for (std::size_t i = 0; i < contours.size(); ++i) {
      const std::size_t count = contours[i].edges.size();
      double along = 0;
      starts_[i].reserve(count + 1);
      std::vector<Box> boxes;
      boxes.reserve(count);
      for (const Edge& edge : contours[i].edges) {
        boxes.push_back(box_of(edge).grown(coincident_mm));
        starts_[i].push_back(along);
        along += length_of(edge);
      }
      starts_[i].push_back(along);
      trees_.emplace_back(boxes);
      for (std::size_t first = 0; first < count; first += portion) portions_.push_back({i, first});
    }
  }

  std::vector<Fault> find(std::size_t max_faults) const {
    const std::vector<std::vector<std::size_t>> others = others_about();
    const auto has_many = [](const auto& about) { return about.size() > max_listed; };
    const bool needs_all = std::any_of(others.begin(), others.end(), has_many);
    const AllEdges all_edges = needs_all ? every_edge() : AllEdges{{}, BoxTree({})};
    std::vector<std::vector<Fault>> found(portions_.size());
    geometry::for_each_index(found.size(), 0, [&](std::size_t part) {
      FaultList faults(max_faults);
      compare_portion(portions_[part], others[part], all_edges, faults);
      found[part] = faults.take();
    });
    FaultList all(max_faults);
    for (const std::vector<Fault>& part : found)
      for (const Fault& fault : part)
        if (!all.is_full()) all.add(fault);
    return all.take();
  }

 private:
  // Other contours about a portion that are searched one by one; of more the edges are searched.
  static constexpr std::size_t max_listed = 16;

  struct AllEdges {
    std::vector<EdgeNumber> numbers;
    BoxTree tree;
  };
  AllEdges every_edge() const {
    std::vector<EdgeNumber> numbers;
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      for (std::size_t j = 0; j < trees_[i].size(); ++j) {
        numbers.push_back({i, j});
        boxes.push_back(trees_[i].box(j));
      }
    }
    return {std::move(numbers), BoxTree(boxes)};
  }

  std::size_t end_of(const EdgeNumber& first) const {
    return std::min(trees_[first.contour].size(), first.edge + portion);
  }

  /// For each portion the later contours whose boxes meet its own; more than can be listed if they
  /// are many.
  std::vector<std::vector<std::size_t>> others_about() const {
    std::vector<Box> boxes;
    boxes.reserve(trees_.size());
    for (const BoxTree& one : trees_) boxes.push_back(one.extent());
    const BoxTree tree(boxes);
    std::vector<std::vector<std::size_t>> others(portions_.size());
    geometry::for_each_index(others.size(), 0, [&](std::size_t part) {
      const EdgeNumber& first = portions_[part];
      Box about;
      for (std::size_t i = first.edge; i < end_of(first); ++i)
        about.add(trees_[first.contour].box(i));
      tree.any(about, [&](std::size_t other) {
        if (other > first.contour) others[part].push_back(other);
        return others[part].size() > max_listed;
      });
      std::sort(others[part].begin(), others[part].end());
    });
    return others;
  }

  /// Compares the edges of a portion with later ones of their contour and of later contours.
  void compare_portion(const EdgeNumber& first, const std::vector<std::size_t>& others,
                       const AllEdges& all_edges, FaultList& faults) const {
    const std::size_t own = first.contour;
    for (std::size_t i = first.edge; i < end_of(first); ++i) {
      const Box& box = trees_[own].box(i);
      const auto compare_with = [&](const EdgeNumber& other) {
        if (!faults.is_full()) compare({own, i}, other, faults);
      };
      trees_[own].visit(box, [&](std::size_t j) {
        if (j > i) compare_with({own, j});
      });
      if (others.size() > max_listed) {
        all_edges.tree.visit(box, [&](std::size_t j) {
          if (all_edges.numbers[j].contour > own) compare_with(all_edges.numbers[j]);
        });
        continue;
      }
      for (const std::size_t other : others)
        trees_[other].visit(box, [&](std::size_t j) { compare_with({other, j}); });
    }
  }

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
  /// Of the edges, mm along each contour, and its length.
  std::vector<std::vector<double>> starts_;
  std::vector<BoxTree> trees_;        ///< of the edges of each contour
  std::vector<EdgeNumber> portions_;  ///< the first edge of each
};

}  // namespace

std::vector<Fault> contour_faults(const std::vector<Contour>& contours, std::size_t max_faults) {
  return FaultFinder(contours).find(max_faults);
}

}  // namespace lamplock::cutting
