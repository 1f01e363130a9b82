#include "host/cutting/offset_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "host/cutting/box_tree.hpp"

namespace lamplock::cutting {
namespace {

// Rounding of intersections: points nearer than this to both edges are on them.
constexpr double on_edge_mm = 1e-9;

/// Finds the points that are at least at the distance from all contours, and in no mitre.
class Clearance {
 public:
  Clearance(const std::vector<Contour>& contours, const std::vector<Mitre>& mitres,
            double distance_mm)
      : mitres_(mitres), distance_(distance_mm), edge_tree_({}), mitre_tree_({}) {
    std::vector<Box> boxes, mitre_boxes;
    for (const Contour& contour : contours) {
      for (const Edge& edge : contour.edges) {
        edges_.push_back(&edge);
        boxes.push_back(box_of(edge));
      }
    }
    for (const Mitre& mitre : mitres) {
      Box& box = mitre_boxes.emplace_back();
      for (const Vec& corner : mitre.corners) box.add(corner);
    }
    edge_tree_ = BoxTree(boxes);
    mitre_tree_ = BoxTree(mitre_boxes);
  }

  /// True if all points of an edge are nearer for certain: the middles of its parts are so much
  /// nearer to one of the contours.
  bool is_too_near(const Edge& edge, int halvings = max_halvings) const {
    const double length = length_of(edge), reach = distance_ - offset_end_mm - length / 2;
    const Vec middle = point_at(edge, 0.5);
    if (reach > 0 && edge_tree_.any_near(middle, reach, [&](std::size_t i) {
          return distance_to(*edges_[i], middle) < reach;
        }))
      return true;
    return halvings > 0 && length < max_length * distance_ &&
           is_too_near(cut_out(edge, 0, 0.5, edge.from, middle), halvings - 1) &&
           is_too_near(cut_out(edge, 0.5, 1, middle, edge.to), halvings - 1);
  }

  bool has_room(const Vec& at) const {
    const double least = distance_ - offset_end_mm;
    return !edge_tree_.any_near(at, distance_, [&](std::size_t i) {
      return distance_to(*edges_[i], at) < least;
    }) && !mitre_tree_.any(Box{at, at}, [&](std::size_t i) {
      return mitres_[i].contains(at, offset_end_mm);
    });
  }

 private:
  // The longest edges that are halved are arcs of a full turn around a corner.
  static constexpr int max_halvings = 6;
  static constexpr double max_length = 2 * std::numbers::pi;

  const std::vector<Mitre>& mitres_;
  double distance_;
  std::vector<const Edge*> edges_;
  BoxTree edge_tree_, mitre_tree_;
};

/// Where raw edges intersect.
struct Cut {
  std::size_t raw;
  double part;  ///< of the length of the edge
  Vec at;
};

std::vector<Box> boxes_of(const std::vector<RawEdge>& raw,
                          const std::vector<std::size_t>& numbers) {
  std::vector<Box> boxes;
  boxes.reserve(numbers.size());
  for (const std::size_t i : numbers) boxes.push_back(box_of(raw[i].edge).grown(on_edge_mm));
  return boxes;
}

/// The numbers of the raw edges that may be part of the offset. Where edges are short against the
/// distance, most of them are nearer to others, and each of these would intersect all others. So
/// edges with many others about them are checked.
std::vector<std::size_t> useful_edges(const std::vector<RawEdge>& raw, const Clearance& clearance) {
  constexpr int many = 16;
  std::vector<std::size_t> all(raw.size()), useful;
  std::iota(all.begin(), all.end(), std::size_t{0});
  const BoxTree tree(boxes_of(raw, all));
  useful.reserve(raw.size());
  for (const std::size_t i : all) {
    int others = 0;
    const bool is_crowded = tree.any(tree.box(i), [&](std::size_t) { return ++others > many; });
    if (!is_crowded || !clearance.is_too_near(raw[i].edge)) useful.push_back(i);
  }
  return useful;
}

/// The intersections of these raw edges, along each of them.
std::vector<Cut> cuts_of(const std::vector<RawEdge>& raw, const std::vector<std::size_t>& used) {
  const BoxTree tree(boxes_of(raw, used));
  std::vector<Cut> cuts;
  const auto cut = [&](std::size_t i, const Vec& at) {
    const Edge& edge = raw[i].edge;
    if (distance(at, edge.from) > offset_end_mm && distance(at, edge.to) > offset_end_mm)
      cuts.push_back({i, part_at(edge, at), at});
  };
  for (std::size_t i = 0; i < used.size(); ++i) {
    tree.visit(tree.box(i), [&](std::size_t j) {
      if (j <= i) return;
      for (const Vec& at : intersections(raw[used[i]].edge, raw[used[j]].edge, on_edge_mm)) {
        cut(used[i], at);
        cut(used[j], at);
      }
    });
  }
  std::sort(cuts.begin(), cuts.end(), [](const Cut& p, const Cut& q) {
    return p.raw != q.raw ? p.raw < q.raw : p.part < q.part;
  });
  return cuts;
}

/// Pieces of these raw edges between their intersections.
std::vector<OffsetPiece> pieces_of(const std::vector<RawEdge>& raw,
                                   const std::vector<std::size_t>& used) {
  const std::vector<Cut> cuts = cuts_of(raw, used);
  std::vector<OffsetPiece> pieces;
  pieces.reserve(used.size() + cuts.size());
  auto cut = cuts.begin();
  for (const std::size_t i : used) {
    const Edge& edge = raw[i].edge;
    const double length = length_of(edge);
    double begin = 0;
    Vec from = edge.from;
    const auto add = [&](double end, const Vec& to) {
      if ((end - begin) * length <= offset_end_mm) return;
      pieces.push_back({cut_out(edge, begin, end, from, to), i, begin, end});
      begin = end;
      from = to;
    };
    for (; cut != cuts.end() && cut->raw == i; ++cut) add(cut->part, cut->at);
    add(1, edge.to);
  }
  return pieces;
}

}  // namespace

std::vector<OffsetPiece> pieces_at_distance(const std::vector<Contour>& contours,
                                            const RawOffset& raw, double distance_mm) {
  const Clearance clearance(contours, raw.mitres, distance_mm);
  std::vector<OffsetPiece> pieces = pieces_of(raw.edges, useful_edges(raw.edges, clearance));
  std::erase_if(pieces, [&](const OffsetPiece& piece) {
    return !clearance.has_room(point_at(piece.edge, 0.5));
  });
  return pieces;
}

}  // namespace lamplock::cutting
