#include "host/model/dxf_hatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host/geometry/vector.hpp"
#include "host/model/dxf_entities.hpp"
#include "host/model/spline.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using geometry::Affine;
using geometry::Point;
using std::numbers::pi;

double gap(const Point& p, const Point& q) { return norm(geometry::difference(p, q)); }

Point start_of(const Piece& piece) { return motion_at(piece, range_of(piece).from).at; }
Point end_of(const Piece& piece) { return motion_at(piece, range_of(piece).to).at; }

Piece reversed(Piece piece) {
  if (auto* line = std::get_if<Line>(&piece)) {
    std::swap(line->from, line->to);
  } else if (auto* arc = std::get_if<Arc>(&piece)) {
    std::swap(arc->start, arc->end);
  } else if (auto* spline = std::get_if<Spline>(&piece)) {
    std::reverse(spline->poles.begin(), spline->poles.end());
    std::reverse(spline->weights.begin(), spline->weights.end());
    std::reverse(spline->knots.begin(), spline->knots.end());
    const double sum = spline->knots.front() + spline->knots.back();
    for (double& knot : spline->knots) knot = sum - knot;
  }
  return piece;
}

/// An edge. Programs disagree on whether the angles of an ellipse are those of its rays or its
/// parameters: the second reading is kept until the neighbours decide.
struct Edge {
  Piece piece;
  std::optional<Piece> other;
};

/// Reads the groups of a HATCH in their order.
class HatchReader {
 public:
  HatchReader(const DxfGroups& dxf, const DxfEntity& hatch)
      : dxf_(dxf), hatch_(hatch), world_(dxf_world(dxf, hatch)) {}

  std::vector<DxfBoundary> read() {
    constexpr int boundary_paths = 91, path_type = 92;
    skip_to(boundary_paths);
    // The elevation is in the groups before.
    for (std::size_t i = 0; i < at_; ++i) {
      if (hatch_.groups[i].code == 30) elevation_ = dxf_.number(hatch_.groups[i]);
    }
    const double count = value_or(boundary_paths, 0);
    std::vector<DxfBoundary> boundaries;
    while (is_next(path_type) && found(boundaries.size()) < count) boundaries.push_back(boundary());
    check_count(boundaries.size(), count, "boundary", "boundaries");
    return boundaries;
  }

 private:
  bool is_next(int code) const {
    return at_ < hatch_.groups.size() && hatch_.groups[at_].code == code;
  }
  void skip_to(int code) {
    while (at_ < hatch_.groups.size() && hatch_.groups[at_].code != code) ++at_;
  }
  /// The value of the next group if it has this code.
  double value_or(int code, double otherwise) {
    return is_next(code) ? dxf_.number(hatch_.groups[at_++]) : otherwise;
  }
  double value(int code) {
    if (!is_next(code)) refuse_data(fmt::format("group {} of its boundary is missing", code));
    return dxf_.number(hatch_.groups[at_++]);
  }
  int integer(int code) {
    if (!is_next(code)) refuse_data(fmt::format("group {} of its boundary is missing", code));
    return dxf_.integer(hatch_.groups[at_++]);
  }
  Point point(int code) {
    const double x = value(code), y = value(code + 10);
    return {x, y, elevation_};
  }
  [[noreturn]] void refuse_data(const std::string& what) const {
    dxf_.position_of(hatch_.kind).refuse(what, "repair the drawing");
  }

  static double found(std::size_t size) { return static_cast<double>(size); }
  /// Refuses data that end before as many of something as they announce.
  void check_count(std::size_t size, double announced, std::string_view noun,
                   std::string_view plural = {}) const {
    if (found(size) < announced)
      refuse_data(fmt::format("its data end after {} of {:.10g}", count_text(size, noun, plural),
                              announced));
  }

  DxfBoundary boundary() {
    constexpr int polyline = 2;
    const int flags = integer(92);
    DxfBoundary result;
    if ((flags & polyline) != 0) {
      result.paths.push_back(bulged_outline());
    } else {
      result.paths = joined(edges());
    }
    std::erase_if(result.paths, [](const Path& path) { return path.pieces.empty(); });
    if (is_next(97)) ++at_;
    for (; is_next(330); ++at_) result.sources.emplace_back(hatch_.groups[at_].value);
    return result;
  }

  Path bulged_outline() {
    const bool has_bulges = value_or(72, 0) != 0;
    const bool closed = value_or(73, 1) != 0;
    const double count = value(93);
    std::vector<DxfVertex> vertices;
    while (is_next(10) && found(vertices.size()) < count) {
      const Point at = point(10);
      vertices.push_back({at, value_or(42, 0)});
    }
    check_count(vertices.size(), count, "vertex", "vertices");
    // Programs leave out bulges of 0, but never all that follows.
    const bool is_at_end = at_ == hatch_.groups.size();
    if (has_bulges && is_at_end && hatch_.groups.back().code != 42)
      refuse_data("its data end after a vertex without its bulge");
    return dxf_outline(vertices, closed, world_);
  }

  std::vector<Edge> edges() {
    const double count = value(93);
    std::vector<Edge> edges;
    while (is_next(72) && found(edges.size()) < count) edges.push_back(edge());
    check_count(edges.size(), count, "edge");
    return edges;
  }

  Edge edge() {
    const int kind = integer(72);
    if (kind == 1) {
      const Point from = point(10);
      return {in_world(Line{from, point(11)}), {}};
    }
    if (kind == 2) return {arc(), {}};
    if (kind == 3) return ellipse();
    if (kind == 4) return {spline(), {}};
    refuse_data(fmt::format("an edge of its boundary has the unknown type {}", kind));
  }

  Piece in_world(Piece piece) const { return transformed(std::move(piece), world_); }

  /// The angles of clockwise arcs are counted clockwise.
  static std::pair<double, double> sweep(double start_deg, double end_deg, bool forward) {
    const double turn = end_deg - start_deg, part = turn - 360 * std::floor(turn / 360);
    constexpr double min_deg = 1e-9;  // a smaller angle is a rounded full turn
    const double sign = forward ? geometry::radians_per_degree : -geometry::radians_per_degree;
    return {sign * start_deg, sign * (start_deg + (part < min_deg ? 360 : part))};
  }

  Piece arc() {
    const Point centre = point(10);
    const double radius = value(40);
    if (!(radius > 0)) refuse_data(fmt::format("the radius of an edge is {}", radius));
    const double start = value(50), end = value(51);
    const auto [from, to] = sweep(start, end, value_or(73, 1) != 0);
    return in_world(Arc{centre, {radius, 0, 0}, {0, radius, 0}, from, to});
  }

  Edge ellipse() {
    const Point centre = point(10);
    const double x = value(11), y = value(21), ratio = value(40);
    if (!(std::hypot(x, y) > 0) || !(ratio > 0)) refuse_data("an ellipse of its boundary is empty");
    const double start = value(50), end = value(51);
    const auto [from, to] = sweep(start, end, value_or(73, 1) != 0);
    const Arc by_parameter{centre, {x, y, 0}, {-y * ratio, x * ratio, 0}, from, to};
    // The parameter of the point on the ray of this angle is in the same quarter.
    const auto on_ray = [&](double angle) {
      const double turns = std::round(angle / (2 * pi)) * 2 * pi;
      return turns + std::atan2(std::sin(angle - turns) / ratio, std::cos(angle - turns));
    };
    Arc by_ray = by_parameter;
    by_ray.start = on_ray(from);
    by_ray.end = on_ray(to);
    return {in_world(by_ray), in_world(by_parameter)};
  }

  Piece spline() {
    Spline spline;
    const double degree = value(94);
    if (!(degree >= 1 && degree <= max_degree))
      refuse_data(fmt::format("a spline of its boundary has the degree {}", degree));
    spline.degree = static_cast<int>(degree);
    value_or(73, 0);
    value_or(74, 0);
    value_or(95, 0);
    value_or(96, 0);
    while (is_next(40)) spline.knots.push_back(value(40));
    while (is_next(10)) {
      spline.poles.push_back(point(10));
      if (is_next(42)) spline.weights.push_back(value(42));
    }
    skip_fit_data();
    const std::string fault = fault_of(spline);
    if (!fault.empty()) refuse_data(fault);
    return in_world(std::move(spline));
  }

  /// Fit points and tangents follow the poles from release 2010 on. A count of 97 that no fit point
  /// follows may be that of the source objects of the whole boundary: it belongs to them if a
  /// handle or the end of the edges comes after it.
  void skip_fit_data() {
    if (!is_next(97)) return;
    const std::size_t count = at_++;
    const bool has_fit_data =
        is_next(11) || is_next(12) || is_next(13) || is_next(72) || is_next(97);
    if (!has_fit_data) {
      at_ = count;
      return;
    }
    while (is_next(11) || is_next(21) || is_next(12) || is_next(22) || is_next(13) || is_next(23))
      ++at_;
  }

  /// Decides between the two readings of an ellipse by the ends of its neighbours.
  static void choose_ellipses(std::vector<Edge>& edges) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].other || edges.size() < 2) continue;
      const Piece& before = edges[(i + edges.size() - 1) % edges.size()].piece;
      const Piece& after = edges[(i + 1) % edges.size()].piece;
      const auto misfit = [&](const Piece& piece) {
        const Point from = start_of(piece), to = end_of(piece);
        return std::min(gap(end_of(before), from), gap(start_of(before), from)) +
               std::min(gap(start_of(after), to), gap(end_of(after), to));
      };
      if (misfit(*edges[i].other) < misfit(edges[i].piece))
        edges[i].piece = std::move(*edges[i].other);
    }
  }

  /// Appends an edge to the chain if one of its ends is the end of the chain.
  static bool append(Path& chain, Piece& edge) {
    const Point from = start_of(edge), to = end_of(edge);
    // Files have about 15 digits; programs that export drawings write fewer.
    constexpr double rounding = 1e-6;
    const double near = rounding * (1 + norm(from));
    const auto meets = [&](const Point& end) {
      return std::min(gap(end, from), gap(end, to)) <= near;
    };
    if (chain.pieces.size() == 1 && !meets(end_of(chain)) && meets(start_of(chain)))
      chain.pieces.front() = reversed(std::move(chain.pieces.front()));
    if (!meets(end_of(chain))) return false;
    const bool forward = gap(end_of(chain), from) <= gap(end_of(chain), to);
    chain.pieces.push_back(forward ? std::move(edge) : reversed(std::move(edge)));
    return true;
  }

  /// Chains of edges, each beginning where the one before ends; edges are reversed if they have to.
  static std::vector<Path> joined(std::vector<Edge> edges) {
    choose_ellipses(edges);
    std::vector<Path> paths;
    for (Edge& edge : edges) {
      const auto* line = std::get_if<Line>(&edge.piece);
      if (line != nullptr && line->from == line->to) continue;
      if (paths.empty() || !append(paths.back(), edge.piece))
        paths.push_back({{std::move(edge.piece)}});
    }
    return paths;
  }

  const DxfGroups& dxf_;
  const DxfEntity& hatch_;
  Affine world_;
  double elevation_ = 0;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<DxfBoundary> dxf_hatch(const DxfGroups& dxf, const DxfEntity& hatch) {
  return HatchReader(dxf, hatch).read();
}

}  // namespace lamplock::model
