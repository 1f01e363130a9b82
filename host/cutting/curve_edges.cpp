// edges_of(): lines and circles as they are, ellipses and splines as arcs with continuous
// direction. Nearly straight arcs become lines.
//
// Programs of drawings write straight sides as splines or arcs, whose deviation from the chord is
// the rounding of the file. As arcs they would have radii of kilometres, which neither a program
// nor the intersection of two edges can hold with the precision of the drawing. So no arc leaves
// edges_of() that is nearly straight or has such a radius.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
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
// A curve that is this close to its chord is a line, whatever its directions.
constexpr double straight_mm = 1e-7;
// An arc this close to its chord is a line if it turns little: half the tolerance of curves, which
// is half the last of the three decimals of programs.
constexpr double nearly_straight_mm = model::flat_mm / 2;
// An arc that turns further is part of a round shape, however small. A kerf of 0.2 mm makes an arc
// of model::flat_mm of a corner with this angle.
constexpr double max_straight_sweep = 0.01;
// Arcs of larger radii become lines. The radius is the maximum coordinate of the interpreter
// (firmware/program/value.hpp). grbl computes arcs with the 24 bits of a float, which are 0.001 mm
// at 8 m.
constexpr double max_radius_mm = 10'000;
// 2^-40 of a curve of 10^9 mm is a micrometre.
constexpr int max_halvings = 40;
// Two arcs that turn further than this differ too much from any smooth curve between their ends.
constexpr double max_fitted_sweep = 0.75 * pi;

Vec seen_from_above(const geometry::Point& p) { return {p.x, p.y}; }

/// True if nothing but the number of its radius distinguishes an arc from its chord.
bool is_nearly_straight(const Edge& arc) {
  const double sweep = std::abs(arc.sweep);
  // The sagitta of a small sweep s is r s^2 / 8.
  return sweep <= max_straight_sweep && length_of(arc) * sweep / 8 <= nearly_straight_mm;
}

void require_room(const std::vector<Edge>& edges, double more) {
  if (static_cast<double>(edges.size()) + more > static_cast<double>(model::max_pieces))
    throw Error(Exit::bad_input, "curve",
                fmt::format("it needs more than {} lines and arcs", model::max_pieces),
                "simplify the drawing or use a larger curve tolerance");
}

/// Appends an edge; of an arc that is nearly straight or too large its chords.
void append_edge(const Edge& edge, std::vector<Edge>& edges) {
  double chords = 0;
  if (!edge.is_line() && is_nearly_straight(edge)) {
    chords = 1;
  } else if (!edge.is_line() && radius_of(edge) > max_radius_mm) {
    const double radius = radius_of(edge);
    chords = std::ceil(std::abs(edge.sweep) * std::sqrt(radius / (8 * nearly_straight_mm)));
  }
  require_room(edges, chords);
  if (chords == 0) return edges.push_back(edge);
  const auto count = static_cast<std::size_t>(chords);
  Vec from = edge.from;
  for (std::size_t i = 1; i <= count; ++i) {
    const Vec to = point_at(edge, static_cast<double>(i) / chords);
    if (from != to) edges.push_back({from, to, {}, 0});
    from = to;
  }
}

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

  /// Appends a line if the curve is nearly straight; several lines would have corners that the
  /// curve does not have.
  bool append_chord(const model::Range& range) {
    const Edge chord{at(range.from), at(range.to), {}, 0};
    if (chord.from == chord.to) return false;
    const auto is_along_chord = [&](double parameter) {
      const auto ahead = direction(parameter);
      const Vec way = chord.to - chord.from;
      return ahead && dot(*ahead, way) > 0 &&
             std::abs(cross(*ahead, way)) <= max_straight_sweep / 2 * norm(way);
    };
    const Vec middle = at(range.from + (range.to - range.from) / 2);
    if (distance_to(chord, middle) > nearly_straight_mm || !is_along_chord(range.from) ||
        !is_along_chord(range.to) || !is_along(range, nearly_straight_mm, chord, chord))
      return false;
    edges_.push_back(chord);
    return true;
  }

  void fit(const model::Range& range, int halvings = max_halvings) {
    require_room(edges_, 0);
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
        const bool are_straight =
            is_nearly_straight(arcs->first) && is_nearly_straight(arcs->second);
        if (are_straight && append_chord(range)) return;
        append_edge(arcs->first, edges_);
        append_edge(arcs->second, edges_);
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
    append_edge({from, middle, centre, signed_sweep / 2}, edges);
    append_edge({middle, to, centre, signed_sweep / 2}, edges);
  } else if (sweep != 0) {
    append_edge({from, to, centre, signed_sweep}, edges);
  }
}

/// The same curve with a parameter that grows along it, so that its speed is its direction.
model::Arc with_growing_parameter(const model::Arc& arc) {
  if (arc.end >= arc.start) return arc;
  return {arc.centre, arc.u, {-arc.v.x, -arc.v.y, -arc.v.z}, -arc.start, -arc.end};
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
    const model::Arc along = with_growing_parameter(arc);
    const model::Piece forwards = along;
    // Quarter turns, each without an inflection.
    const double sweep = along.end - along.start;
    const double parts = std::max(1.0, std::ceil(sweep / (pi / 2)));
    for (int i = 0; i < parts; ++i)
      CurveFitter(forwards, tolerance_mm, edges)
          .fit({along.start + sweep * i / parts, along.start + sweep * (i + 1) / parts});
  }
  void operator()(const model::Spline& spline) const {
    const std::vector<double> breaks = model::breaks_of(spline);
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      CurveFitter fitter(piece, tolerance_mm, edges);
      if (fitter.append_chord({breaks[i], breaks[i + 1]})) continue;
      // As many parts as the piece can have inflections.
      const double width = (breaks[i + 1] - breaks[i]) / spline.degree;
      for (int part = 0; part < spline.degree; ++part) {
        const double from = breaks[i] + part * width;
        const double to = part + 1 == spline.degree ? breaks[i + 1] : from + width;
        fitter.fit({from, to});
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
