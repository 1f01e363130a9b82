#include "host/cutting/simple_contours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/polygon_union.hpp"

namespace lamplock::cutting {
namespace {

// Chords deviate from arcs by at most this; far below the repeatability of a cut.
constexpr double chords_mm = 1e-4;
constexpr double max_chords_of_arc = 10'000;
// Sides of the union are on the chords of the contours to a few of its steps.
constexpr double on_chord_mm = 4 * union_grid_mm;
// Sides this short are the rounding of intersections.
constexpr double min_side_mm = 8 * union_grid_mm;
// The intersection of two arcs is this near to that of their chords, unless they nearly touch.
constexpr double max_shift_mm = 100 * chords_mm;

constexpr std::size_t no_edge = std::numeric_limits<std::size_t>::max();

/// A chord of an edge; of a line the line itself.
struct Chord {
  Edge line;
  std::size_t contour, edge;
};

/// Parts of an edge that are between chords.
int count_of_chords(const Edge& edge) {
  if (edge.is_line()) return 1;
  const double radius = std::max(radius_of(edge), chords_mm);
  const double step = 2 * std::acos(1 - chords_mm / radius);
  return static_cast<int>(std::min(max_chords_of_arc, std::abs(edge.sweep) / step)) + 1;
}

/// Part of a contour in the result.
struct Run {
  std::size_t contour = 0, edge = no_edge;  ///< none: a side that is on no chord
  bool is_backwards = false;
  Vec from, to;
};

class Simplifier {
 public:
  explicit Simplifier(const std::vector<Contour>& contours)
      : contours_(contours), tree_({}), origin_(contours.front().edges.front().from) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < contours.size(); ++i) {
      Polygon& polygon = polygons_.emplace_back();
      for (std::size_t j = 0; j < contours[i].edges.size(); ++j) {
        const Edge& edge = contours[i].edges[j];
        const int count = count_of_chords(edge);
        for (int k = 0; k < count; ++k) {
          const Edge line{point_at(edge, static_cast<double>(k) / count),
                          point_at(edge, static_cast<double>(k + 1) / count),
                          {},
                          0};
          polygon.push_back(line.from - origin_);
          if (line.from == line.to) continue;
          chords_.push_back({line, i, j});
          boxes.push_back(box_of(line));
        }
      }
    }
    tree_ = BoxTree(boxes);
  }

  SimpleContours simple() {
    SimpleContours exact = from(true);
    if (contour_faults(exact.contours, 1).empty()) return exact;
    return from(false);
  }

 private:
  std::vector<Polygon> boundary() const {
    std::vector<Polygon> all;
    double largest = 0;
    for (std::size_t i = 0; i < polygons_.size(); ++i) {
      // Of a contour that crosses itself, all it runs around.
      std::vector<Polygon> filled = united({polygons_[i]}, FillRule::non_zero);
      double area = 0;
      for (const Polygon& polygon : filled) area += area_of(polygon);
      const bool is_right = !is_counter_clockwise(contours_[i]);
      if (area > std::abs(largest)) largest = is_right ? -area : area;
      for (Polygon& polygon : filled) {
        if (is_right) std::reverse(polygon.begin(), polygon.end());
        all.push_back(std::move(polygon));
      }
    }
    std::vector<Polygon> result =
        united(all, largest < 0 ? FillRule::negative : FillRule::positive);
    if (largest < 0) {
      for (Polygon& polygon : result) std::reverse(polygon.begin(), polygon.end());
    }
    return result;
  }

  static double area_of(const Polygon& polygon) {
    double area = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      area += cross(polygon[i], polygon[(i + 1) % polygon.size()]) / 2;
    return area;
  }

  SimpleContours from(bool is_exact) const {
    SimpleContours result;
    for (Polygon& polygon : boundary()) {
      for (Vec& corner : polygon) corner = corner + origin_;
      const std::vector<Run> runs = runs_of(polygon);
      Contour contour;
      contour.closed = true;
      const std::size_t source = source_of(runs);
      contour.layer = contours_[source].layer;
      contour.edges = is_exact ? edges_of_runs(runs) : lines_of(polygon);
      if (contour.edges.size() < 2) continue;
      result.contours.push_back(std::move(contour));
      result.from.push_back(source);
    }
    return result;
  }

  static std::vector<Edge> lines_of(const Polygon& polygon) {
    std::vector<Edge> lines;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
      if (from != to) lines.push_back({from, to, {}, 0});
    }
    return lines;
  }

  /// The contour that most of their length is part of.
  std::size_t source_of(const std::vector<Run>& runs) const {
    std::vector<double> lengths(contours_.size());
    for (const Run& run : runs) lengths[run.contour] += distance(run.from, run.to);
    return static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) -
                                    lengths.begin());
  }

  /// The chord that a side of the union is part of.
  std::optional<std::size_t> chord_of(const Vec& from, const Vec& to) const {
    std::optional<std::size_t> found;
    double nearest = on_chord_mm;
    tree_.any_near((from + to) * 0.5, on_chord_mm, [&](std::size_t i) {
      const double away =
          std::max(distance_to(chords_[i].line, from), distance_to(chords_[i].line, to));
      if (away <= nearest && (!found || away < nearest)) {
        nearest = away;
        found = i;
      }
      return false;
    });
    return found;
  }

  /// Sides of one edge are one run.
  std::vector<Run> runs_of(const Polygon& polygon) const {
    std::vector<Run> runs;
    const auto continues = [](const Run& before, const Run& next) {
      return before.edge != no_edge && before.edge == next.edge && before.contour == next.contour &&
             before.is_backwards == next.is_backwards;
    };
    for (const Edge& side : lines_of(polygon)) {
      if (length_of(side) < min_side_mm) continue;
      Run run{0, no_edge, false, side.from, side.to};
      if (const auto i = chord_of(side.from, side.to)) {
        const Chord& chord = chords_[*i];
        const bool is_backwards = dot(side.to - side.from, chord.line.to - chord.line.from) < 0;
        run = {chord.contour, chord.edge, is_backwards, side.from, side.to};
      }
      if (!runs.empty() && continues(runs.back(), run)) {
        runs.back().to = run.to;
      } else {
        runs.push_back(run);
      }
    }
    if (runs.size() > 2 && continues(runs.back(), runs.front())) {
      runs.front().from = runs.back().from;
      runs.pop_back();
    }
    return runs;
  }

  const Edge& edge_of(const Run& run) const { return contours_[run.contour].edges[run.edge]; }

  /// Where a run ends and the next one begins, exactly.
  Vec joint(const Run& run, const Run& next) const {
    if (run.edge == no_edge || next.edge == no_edge) return run.to;
    const Edge &a = edge_of(run), &b = edge_of(next);
    Vec best = run.to;
    double nearest = max_shift_mm;
    const auto consider = [&](const Vec& at) {
      if (distance(at, run.to) >= nearest) return;
      nearest = distance(at, run.to);
      best = at;
    };
    const Vec &end = run.is_backwards ? a.from : a.to, &begin = next.is_backwards ? b.to : b.from;
    if (distance(end, begin) <= on_chord_mm) consider(end);
    for (const Vec& at : intersections(a, b, union_grid_mm)) consider(at);
    return best;
  }

  std::vector<Edge> edges_of_runs(const std::vector<Run>& runs) const {
    std::vector<Edge> edges;
    std::vector<Vec> joints;
    for (std::size_t i = 0; i < runs.size(); ++i)
      joints.push_back(joint(runs[i], runs[(i + 1) % runs.size()]));
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const Vec &from = joints[(i + runs.size() - 1) % runs.size()], &to = joints[i];
      if (from == to && runs.size() > 1) continue;
      edges.push_back(cut_from(runs[i], from, to));
    }
    return edges;
  }

  /// The part of the edge of a run between two points on it.
  Edge cut_from(const Run& run, const Vec& from, const Vec& to) const {
    if (run.edge == no_edge || edge_of(run).is_line()) return {from, to, {}, 0};
    const Edge along = run.is_backwards ? reversed(edge_of(run)) : edge_of(run);
    const double begin = distance(from, along.from) <= on_chord_mm ? 0 : part_at(along, from);
    const double end = distance(to, along.to) <= on_chord_mm ? 1 : part_at(along, to);
    if (end <= begin) return {from, to, {}, 0};
    // The part first with its own ends, so that it remains round when they are moved.
    const Edge part = cut_out(along, begin, end, point_at(along, begin), point_at(along, end));
    return with_ends(part, from, to);
  }

  const std::vector<Contour>& contours_;
  std::vector<Polygon> polygons_;  ///< about the origin
  std::vector<Chord> chords_;
  BoxTree tree_;
  Vec origin_;  ///< near the contours: the grid of the union has only so many digits
};

}  // namespace

SimpleContours simple_contours(const std::vector<Contour>& contours) {
  return Simplifier(contours).simple();
}

}  // namespace lamplock::cutting
