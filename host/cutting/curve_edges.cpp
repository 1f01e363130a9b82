// edges_of(): lines and circles as they are, ellipses and splines as arcs with continuous
// direction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "host/cutting/contour.hpp"
#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/model/spline.hpp"

namespace lamplock::cutting {
namespace {

using std::numbers::pi;

// An ellipse whose radii differ by less, in parts of the larger one, is a circle: the rounding of a
// drawing with 10 digits.
constexpr double round_ratio = 1e-9;
// A curve that is this close to its chord is a line.
constexpr double straight_mm = 1e-7;
// 2^-40 of a curve of 10^9 mm is a micrometre.
constexpr int max_halvings = 40;
// Two arcs that turn further than this differ too much from any smooth curve between their ends.
constexpr double max_fitted_sweep = 0.75 * pi;

Vec seen_from_above(const geometry::Point& p) { return {p.x, p.y}; }

/// The arc that leaves `from` in this unit direction and ends at `to`; a line if it is straight.
Edge tangent_arc(const Vec& from, const Vec& direction, const Vec& to) {
  const Vec chord = to - from;
  const double half = std::atan2(cross(direction, chord), dot(direction, chord));
  const double sagitta = norm(chord) * std::abs(std::tan(half / 2)) / 2;
  if (sagitta < straight_mm / 100) return {from, to, {}, 0};
  const double radius = norm(chord) / (2 * std::sin(half));
  return {from, to, from - right_of(direction) * radius, 2 * half};
}

/// Two arcs from `p` to `q` with these unit directions at the ends and one direction where they
/// meet (Bolton, "Biarc curves", Computer-Aided Design 7, 1975); both tangents are of one length.
std::optional<std::pair<Edge, Edge>> two_arcs(const Vec& p, const Vec& at_p, const Vec& q,
                                              const Vec& at_q) {
  const Vec chord = q - p, both = at_p + at_q;
  const double a = 2 * (1 - dot(at_p, at_q)), b = dot(chord, both), c = dot(chord, chord);
  const double root = std::sqrt(b * b + a * c);
  // The positive root of a t^2 + 2 b t - c in the form that has no cancellation for small a.
  const double sum = b + root;
  if (!(sum > 0)) return std::nullopt;
  const double tangent = c / sum;
  const Vec meet = (p + q + (at_p - at_q) * tangent) * 0.5;
  const Edge first = tangent_arc(p, at_p, meet);
  const Edge second = reversed(tangent_arc(q, at_q * -1, meet));
  if (std::abs(first.sweep) > max_fitted_sweep || std::abs(second.sweep) > max_fitted_sweep)
    return std::nullopt;
  return std::pair{first, second};
}

/// Appends edges along a smooth curve.
class CurveFitter {
 public:
  CurveFitter(const model::Piece& piece, double tolerance_mm, std::vector<Edge>& edges)
      : piece_(piece), tolerance_(tolerance_mm), edges_(edges) {}

  void fit(const model::Range& range, int halvings = max_halvings) {
    if (edges_.size() > model::max_pieces)
      throw Error(Exit::bad_input, "curve",
                  fmt::format("it needs more than {} arcs", model::max_pieces),
                  "simplify the drawing or use a larger curve tolerance");
    const Vec p = at(range.from), q = at(range.to);
    const Edge chord{p, q, {}, 0};
    if (halvings == 0 || is_along(range, straight_mm, chord, chord)) {
      if (p != q) edges_.push_back(chord);
      return;
    }
    const auto p_dir = direction(range.from), q_dir = direction(range.to);
    if (p_dir && q_dir && p != q) {
      const auto arcs = two_arcs(p, *p_dir, q, *q_dir);
      if (arcs && is_along(range, tolerance_, arcs->first, arcs->second)) {
        edges_.push_back(arcs->first);
        edges_.push_back(arcs->second);
        return;
      }
    }
    const double middle = range.from + (range.to - range.from) / 2;
    fit({range.from, middle}, halvings - 1);
    fit({middle, range.to}, halvings - 1);
  }

 private:
  // The deviation is sampled, so the samples have a part of the tolerance only.
  static constexpr int samples = 15;
  static constexpr double part_of_tolerance = 0.75;

  Vec at(double parameter) const { return seen_from_above(model::motion_at(piece_, parameter).at); }
  std::optional<Vec> direction(double parameter) const {
    const Vec speed = seen_from_above(model::motion_at(piece_, parameter).speed);
    const double length = norm(speed);
    if (!(length > 0)) return std::nullopt;
    return speed * (1 / length);
  }

  bool is_along(const model::Range& range, double tolerance, const Edge& first,
                const Edge& second) const {
    for (int i = 1; i <= samples; ++i) {
      const Vec point = at(range.from + (range.to - range.from) * i / (samples + 1));
      const auto is_near = [&](const Edge& edge) {
        if (edge.from == edge.to) return distance(edge.from, point) <= tolerance;
        return distance_to(edge, point) <= tolerance * part_of_tolerance;
      };
      if (!is_near(first) && !is_near(second)) return false;
    }
    return true;
  }

  const model::Piece& piece_;
  double tolerance_;
  std::vector<Edge>& edges_;
};

void append_circle(const model::Arc& arc, double turn, std::vector<Edge>& edges) {
  const Vec centre = seen_from_above(arc.centre), u = seen_from_above(arc.u),
            v = seen_from_above(arc.v);
  const auto at = [&](double t) { return centre + u * std::cos(t) + v * std::sin(t); };
  const double sweep = std::clamp(arc.end - arc.start, -2 * pi, 2 * pi);
  const double signed_sweep = sweep * turn;
  const Vec from = at(arc.start), to = at(arc.start + sweep);
  // Arcs of up to half a turn: their centres follow from their ends without loss of digits.
  if (std::abs(sweep) > pi) {
    const Vec middle = at(arc.start + sweep / 2);
    edges.push_back({from, middle, centre, signed_sweep / 2});
    edges.push_back({middle, to, centre, signed_sweep / 2});
  } else if (sweep != 0) {
    edges.push_back({from, to, centre, signed_sweep});
  }
}

struct PieceEdges {
  double tolerance_mm;
  const model::Piece& piece;
  std::vector<Edge>& edges;

  void operator()(const model::Line& line) const {
    const Vec from = seen_from_above(line.from), to = seen_from_above(line.to);
    if (from != to) edges.push_back({from, to, {}, 0});
  }
  void operator()(const model::Arc& arc) const {
    const Vec u = seen_from_above(arc.u), v = seen_from_above(arc.v);
    const double larger = std::max(norm(u), norm(v));
    if (!(larger > 0)) return;
    const double off = std::max(std::abs(norm(u) - norm(v)), std::abs(dot(u, v)) / larger);
    if (off <= round_ratio * larger) return append_circle(arc, cross(u, v) > 0 ? 1 : -1, edges);
    // Quarter turns, each without an inflection.
    const double sweep = arc.end - arc.start;
    const double parts = std::max(1.0, std::ceil(std::abs(sweep) / (pi / 2)));
    for (int i = 0; i < parts; ++i)
      CurveFitter(piece, tolerance_mm, edges)
          .fit({arc.start + sweep * i / parts, arc.start + sweep * (i + 1) / parts});
  }
  void operator()(const model::Spline& spline) const {
    const std::vector<double> breaks = model::breaks_of(spline);
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      // As many parts as the piece can have inflections.
      const double width = (breaks[i + 1] - breaks[i]) / spline.degree;
      for (int part = 0; part < spline.degree; ++part) {
        const double from = breaks[i] + part * width;
        const double to = part + 1 == spline.degree ? breaks[i + 1] : from + width;
        CurveFitter(piece, tolerance_mm, edges).fit({from, to});
      }
    }
  }
};

}  // namespace

std::vector<Edge> edges_of(const model::Path& path, double curve_tolerance_mm) {
  geometry::require_positive(curve_tolerance_mm, "curve", "tolerance");
  std::vector<Edge> edges;
  for (const model::Piece& piece : path.pieces)
    std::visit(PieceEdges{curve_tolerance_mm, piece, edges}, piece);
  return edges;
}

}  // namespace lamplock::cutting
