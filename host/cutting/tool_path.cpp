#include "host/cutting/tool_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/cutting/contour_walk.hpp"
#include "host/error.hpp"

namespace lamplock::cutting {
namespace {

using std::numbers::pi;

/// Angle by which a direction has to turn to become another one, -pi..pi.
double turn_between(const Vec& from, const Vec& to) {
  return std::atan2(cross(from, to), dot(from, to));
}

/// The edge as one or two arcs of at most half a circle.
std::vector<Edge> halved(const Edge& edge) {
  if (std::abs(edge.sweep) <= pi * (1 + 1e-9)) return {edge};
  const Vec middle = point_at(edge, 0.5);
  return {cut_out(edge, 0, 0.5, edge.from, middle), cut_out(edge, 0.5, 1, middle, edge.to)};
}

/// One way along edges, in which the tool descends by the same angle everywhere.
void append_leg(std::vector<ToolMove>& moves, const std::vector<Edge>& edges, double z_from_mm,
                double z_per_mm) {
  double z = z_from_mm;
  for (const Edge& whole : edges) {
    for (const Edge& edge : halved(whole)) {
      const double next = z - z_per_mm * length_of(edge);
      moves.push_back({edge, z, next});
      z = next;
    }
  }
}

std::vector<Edge> turned_back(const std::vector<Edge>& edges) {
  std::vector<Edge> back;
  for (auto edge = edges.rbegin(); edge != edges.rend(); ++edge) back.push_back(reversed(*edge));
  return back;
}

/// Back and forth along the begin of these edges, down to the height of the pass.
void append_ramp(std::vector<ToolMove>& moves, const std::vector<Edge>& edges,
                 const PassHeights& pass, const Tooling& tooling) {
  const Contour way{edges, false};
  const double depth = pass.from_mm - pass.to_mm, room = length_of(way);
  if (depth <= 0 || room <= 0) return;
  const double ramp = depth / std::tan(tooling.ramp_deg * pi / 180);
  // As many ways back and forth as the room needs.
  const double pairs = std::ceil(ramp / 2 / room);
  const double leg = ramp / 2 / pairs, slope = depth / ramp;
  const std::vector<Edge> forth = edges_between(way, 0, leg), back = turned_back(forth);
  for (int i = 0; i < static_cast<int>(pairs); ++i) {
    const double z = pass.from_mm - depth * i / pairs;
    append_leg(moves, forth, z, slope);
    append_leg(moves, back, z - slope * leg, slope);
  }
  moves.back().z_to_mm = pass.to_mm;
}

/// The way of the swivel axis along an edge.
Edge swivelled(const Edge& edge, double offset_mm) {
  const Vec first = edge.from + direction_at(edge, 0) * offset_mm;
  if (!edge.is_line()) return arc_from(edge.centre, first, edge.sweep);
  return {first, edge.to + direction_at(edge, 1) * offset_mm, {}, 0};
}

[[noreturn]] void refuse_profile(const Vec& at, const char* what, const char* remedy) {
  throw Error(Exit::bad_input, "lathe",
              fmt::format("the contour at ({:.3f}, {:.3f}) {}", at.x, at.y, what), remedy);
}

/// Refuses what a turning tool would follow through the workpiece. Everything outside of a profile
/// is turned off, so it has one radius at each place along the axis.
void require_profile(const Stroke& stroke) {
  // A contour that begins on the axis is on it to the rounding of drawings.
  constexpr double slack_mm = 1e-6;
  // Ends that are joined differ by the tolerance of the drawing, 0.01 mm without another one.
  constexpr double max_back_mm = 0.01;
  const Vec begin = stroke.front().edge.from, end = stroke.back().edge.to;
  constexpr const char* how = "draw the profile from one end of the workpiece to the other";
  if (distance(begin, end) <= max_back_mm)
    refuse_profile(begin, "is closed, and the tool would cut through the workpiece", how);
  // Along the axis in the direction of the stroke.
  const bool is_forward = end.x >= begin.x;
  double farthest = is_forward ? begin.x : -begin.x;
  const auto refuse_back = [&](const Vec& at) {
    refuse_profile(at, "goes back along the axis, and the tool would cut into the workpiece", how);
  };
  for (const CutMove& move : stroke) {
    const Edge& edge = move.edge;
    const Box box = box_of(edge);
    if (box.low.y < -slack_mm)
      refuse_profile(box.low, "is beyond the axis of rotation",
                     "draw the contour above the axis, which is y = 0");
    if (edge.is_line() && box.high.y <= slack_mm && length_of(edge) > slack_mm)
      refuse_profile(edge.from, "runs along the axis of rotation, where no workpiece would remain",
                     how);
    if ((is_forward ? box.low.x : -box.high.x) < farthest - max_back_mm) refuse_back(edge.from);
    farthest = std::max(farthest, is_forward ? box.high.x : -box.low.x);
  }
  if ((is_forward ? end.x : -end.x) < farthest - max_back_mm) refuse_back(end);
}

}  // namespace

std::vector<ToolMove> mill_path(const Stroke& stroke, const PassHeights& pass,
                                const Tooling& tooling) {
  std::vector<ToolMove> moves;
  const auto bottom_of = [&](const CutMove& move) {
    return tooling.surface_mm + move.power * (pass.final_mm - tooling.surface_mm);
  };
  double z = pass.from_mm;  // of the tool
  for (std::size_t i = 0; i < stroke.size();) {
    const double bottom = bottom_of(stroke[i]), to = std::max(pass.to_mm, bottom);
    std::vector<Edge> level;  // the moves in this height
    for (; i < stroke.size() && bottom_of(stroke[i]) == bottom; ++i)
      level.push_back(stroke[i].edge);
    // The pass before has cut down to here.
    const double from = std::min(z, std::max(pass.from_mm, bottom));
    append_ramp(moves, level, {from, to, pass.final_mm}, tooling);
    append_leg(moves, level, to, 0);
    z = to;
  }
  return moves;
}

std::vector<ToolMove> knife_path(const Stroke& stroke, const PassHeights& pass,
                                 const Tooling& tooling, Vec& heading) {
  // Smaller turns are those of edges that touch each other, to rounding.
  constexpr double min_turn = 1e-6;
  const double offset_mm = tooling.knife_offset_mm;
  std::vector<ToolMove> moves;
  double z = tooling.surface_mm;
  for (const CutMove& move : stroke) {
    const double turn = turn_between(heading, direction_at(move.edge, 0));
    if (offset_mm > 0 && std::abs(turn) > min_turn)
      moves.push_back({arc_from(move.edge.from, move.edge.from + heading * offset_mm, turn), z, z});
    z = pass.to_mm;
    moves.push_back({swivelled(move.edge, offset_mm), z, z});
    heading = direction_at(move.edge, 1);
  }
  return moves;
}

std::vector<ToolMove> lathe_path(const Stroke& stroke, const PassHeights& pass,
                                 const Tooling& tooling) {
  require_profile(stroke);
  const Vec away{0, pass.to_mm - pass.final_mm + tooling.away_mm};
  std::vector<ToolMove> moves;
  for (const CutMove& move : stroke) {
    Edge edge = move.edge;
    edge.from = edge.from + away;
    edge.to = edge.to + away;
    edge.centre = edge.centre + away;
    moves.push_back({edge, 0, 0});
  }
  return moves;
}

}  // namespace lamplock::cutting
