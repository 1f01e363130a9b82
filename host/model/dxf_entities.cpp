#include "host/model/dxf_entities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host/geometry/vector.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/spline.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using geometry::radians_per_degree;
using std::numbers::pi;

// Flatter arcs deviate from their chord by less than a billionth of its length.
constexpr double min_bulge = 1e-9;

[[noreturn]] void refuse_entity(const DxfGroups& dxf, const DxfEntity& entity,
                                const std::string& what) {
  dxf.position_of(entity.kind).refuse(what, "repair the drawing");
}

/// The normal of an entity's plane.
Point extrusion_of(const DxfGroups& dxf, const DxfEntity& entity) {
  const Point normal = dxf.point(entity, 210, {0, 0, 1});
  const double length = norm(normal);
  if (!(length > 0)) refuse_entity(dxf, entity, "its extrusion direction is zero");
  return times(normal, 1 / length);
}

/// The map from an entity's own coordinates to the world's, by the "arbitrary axis algorithm" of
/// the DXF Reference.
geometry::Affine world_of(const Point& normal) {
  constexpr double near_z = 1.0 / 64;
  const bool along_z = std::abs(normal.x) < near_z && std::abs(normal.y) < near_z;
  const Point across = cross(along_z ? Point{0, 1, 0} : Point{0, 0, 1}, normal);
  const Point x = times(across, 1 / norm(across));
  return {x, cross(normal, x), normal, {}};
}

Piece in_world(Piece piece, const geometry::Affine& world) {
  return world == geometry::Affine{} ? std::move(piece) : transformed(std::move(piece), world);
}

/// Appends the arc from p to q in a plane of constant z; the bulge is the tangent of a quarter of
/// the angle, positive for counter-clockwise.
void append_bulged(Path& path, const Point& p, const Point& q, double bulge,
                   const geometry::Affine& world) {
  if (p == q) return;
  if (std::abs(bulge) < min_bulge) {
    path.pieces.push_back(in_world(Line{p, q}, world));
    return;
  }
  const Point chord{q.x - p.x, q.y - p.y, 0};
  const double aside = (1 / bulge - bulge) / 4;  // of the centre, to the left, in chords
  const Point centre{(p.x + q.x) / 2 - aside * chord.y, (p.y + q.y) / 2 + aside * chord.x, p.z};
  const double radius = std::hypot(p.x - centre.x, p.y - centre.y);
  const double start = std::atan2(p.y - centre.y, p.x - centre.x);
  path.pieces.push_back(in_world(
      Arc{centre, {radius, 0, 0}, {0, radius, 0}, start, start + 4 * std::atan(bulge)}, world));
}

Path line_of(const DxfGroups& dxf, const DxfEntity& entity) {
  // Kept even without length: it may be a dot.
  return {{Line{dxf.point(entity, 10), dxf.point(entity, 11)}}};
}

Path light_polyline_of(const DxfGroups& dxf, const DxfEntity& entity) {
  const double elevation = dxf.number(entity, 38);
  std::vector<DxfVertex> vertices;
  for (const DxfGroup& group : entity.groups) {
    if (group.code == 10) {
      vertices.push_back({{dxf.number(group), 0, elevation}});
    } else if (!vertices.empty() && group.code == 20) {
      vertices.back().at.y = dxf.number(group);
    } else if (!vertices.empty() && group.code == 42) {
      vertices.back().bulge = dxf.number(group);
    }
  }
  return dxf_outline(vertices, (dxf.integer(entity, 70) & 1) != 0,
                     world_of(extrusion_of(dxf, entity)));
}

Path arc_of(const DxfGroups& dxf, const DxfEntity& entity, bool whole) {
  const double radius = dxf.number(entity, 40);
  if (!(radius > 0)) refuse_entity(dxf, entity, fmt::format("its radius is {}", radius));
  Arc arc{dxf.point(entity, 10), {radius, 0, 0}, {0, radius, 0}, 0, 2 * pi};
  if (!whole) {
    const double start = dxf.number(entity, 50), sweep = dxf.number(entity, 51) - start;
    const double part = sweep - 360 * std::floor(sweep / 360);
    constexpr double min_deg = 1e-9;  // a smaller angle is a rounded full turn
    arc.start = start * radians_per_degree;
    arc.end = arc.start + (part < min_deg ? 360 : part) * radians_per_degree;
  }
  return {{in_world(arc, world_of(extrusion_of(dxf, entity)))}, whole};
}

Path ellipse_of(const DxfGroups& dxf, const DxfEntity& entity) {
  const Point major = dxf.point(entity, 11);
  const double ratio = dxf.number(entity, 40, 1);
  if (!(norm(major) > 0) || !(ratio > 0))
    refuse_entity(dxf, entity, fmt::format("the ellipse has no extent (ratio {})", ratio));
  const Point minor = times(cross(extrusion_of(dxf, entity), major), ratio);
  Arc arc{dxf.point(entity, 10), major, minor, dxf.number(entity, 41),
          dxf.number(entity, 42, 2 * pi)};
  constexpr double whole = 2 * pi - 1e-9;  // files contain rounded full turns
  const bool closed = std::abs(arc.end - arc.start) >= whole;
  if (closed)
    arc.end = arc.start + 2 * pi;
  else if (arc.end <= arc.start)
    arc.end += 2 * pi;
  return {{arc}, closed};
}

std::optional<Path> spline_of(const DxfGroups& dxf, const DxfEntity& entity) {
  Spline spline;
  spline.degree = dxf.integer(entity, 71, 3);
  for (const DxfGroup& group : entity.groups) {
    if (group.code == 40) {
      spline.knots.push_back(dxf.number(group));
    } else if (group.code == 41) {
      spline.weights.push_back(dxf.number(group));
    } else if (group.code == 10) {
      spline.poles.push_back({dxf.number(group), 0, 0});
    } else if (!spline.poles.empty() && group.code == 20) {
      spline.poles.back().y = dxf.number(group);
    } else if (!spline.poles.empty() && group.code == 30) {
      spline.poles.back().z = dxf.number(group);
    }
  }
  if (spline.poles.empty()) return std::nullopt;
  const std::string fault = fault_of(spline);
  if (!fault.empty()) refuse_entity(dxf, entity, fault);
  return Path{{std::move(spline)}};
}

/// The four corners by their group codes; three-cornered ones repeat the third or leave out the
/// fourth.
std::vector<Point> corners_of(const DxfGroups& dxf, const DxfEntity& entity) {
  std::vector<Point> corners;
  for (const int code : {10, 11, 12, 13})
    corners.push_back(dxf.point(entity, code, corners.empty() ? Point{} : corners.back()));
  if (corners[3] == corners[2]) corners.pop_back();
  return corners;
}

}  // namespace

geometry::Affine dxf_world(const DxfGroups& dxf, const DxfEntity& entity) {
  return world_of(extrusion_of(dxf, entity));
}

Path dxf_outline(const std::vector<DxfVertex>& vertices, bool closed,
                 const geometry::Affine& world) {
  Path path;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    append_bulged(path, vertices[i].at, vertices[i + 1].at, vertices[i].bulge, world);
  }
  path.closed = closed;
  if (closed && !vertices.empty()) {
    append_bulged(path, vertices.back().at, vertices.front().at, vertices.back().bulge, world);
  }
  return path;
}

std::vector<Path> dxf_face(const DxfGroups& dxf, const DxfEntity& face) {
  const std::vector<Point> corners = corners_of(dxf, face);
  const auto invisible = static_cast<unsigned>(dxf.integer(face, 70));
  std::vector<Path> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point &from = corners[i], &to = corners[(i + 1) % corners.size()];
    // The flag of a triangle's last edge may be that of the fourth one.
    const bool is_last = i + 1 == corners.size();
    const unsigned flags = is_last && corners.size() == 3 ? 4U | 8U : 1U << i;
    if ((invisible & flags) == 0 && from != to) edges.push_back({{Line{from, to}}});
  }
  return edges;
}

Path dxf_solid(const DxfGroups& dxf, const DxfEntity& solid) {
  std::vector<Point> corners = corners_of(dxf, solid);
  // Stored as two pairs of opposite sides.
  if (corners.size() == 4) std::swap(corners[2], corners[3]);
  std::vector<DxfVertex> vertices;
  vertices.reserve(corners.size());
  for (const Point& corner : corners) vertices.push_back({corner});
  return dxf_outline(vertices, true, dxf_world(dxf, solid));
}

std::optional<Path> dxf_path(const DxfGroups& dxf, const DxfEntity& entity) {
  if (entity.kind == "LINE") return line_of(dxf, entity);
  if (entity.kind == "LWPOLYLINE") return light_polyline_of(dxf, entity);
  if (entity.kind == "ARC") return arc_of(dxf, entity, false);
  if (entity.kind == "CIRCLE") return arc_of(dxf, entity, true);
  if (entity.kind == "ELLIPSE") return ellipse_of(dxf, entity);
  if (entity.kind == "SPLINE") return spline_of(dxf, entity);
  if (entity.kind == "SOLID" || entity.kind == "TRACE") return dxf_solid(dxf, entity);
  return std::nullopt;
}

bool is_dxf_surface(const DxfGroups& dxf, const DxfEntity& polyline) {
  constexpr int mesh = 16, polyface = 64;
  return (dxf.integer(polyline, 70) & (mesh | polyface)) != 0;
}

Path dxf_polyline(const DxfGroups& dxf, const DxfEntity& polyline,
                  const std::vector<DxfEntity>& vertices) {
  constexpr int closed = 1, in_space = 8, frame_of_spline = 16;
  const int flags = dxf.integer(polyline, 70);
  const bool flat = (flags & in_space) == 0;
  const double elevation = dxf.number(polyline, 30);
  std::vector<DxfVertex> corners;
  for (const DxfEntity& vertex : vertices) {
    if ((dxf.integer(vertex, 70) & frame_of_spline) != 0) continue;
    DxfVertex corner{dxf.point(vertex, 10), flat ? dxf.number(vertex, 42) : 0};
    if (flat) corner.at.z = elevation;
    corners.push_back(corner);
  }
  return dxf_outline(corners, (flags & closed) != 0,
                     flat ? world_of(extrusion_of(dxf, polyline)) : geometry::Affine{});
}

DxfInsert dxf_insert(const DxfGroups& dxf, const DxfEntity& insert) {
  DxfInsert copies;
  copies.block = dxf.text(insert, 2);
  const Point at = dxf.point(insert, 10);
  copies.frame = world_of(extrusion_of(dxf, insert)) * geometry::moved(at.x, at.y, at.z) *
                 geometry::turned_about_z(dxf.number(insert, 50));
  copies.scale = geometry::scaled(dxf.number(insert, 41, 1), dxf.number(insert, 42, 1),
                                  dxf.number(insert, 43, 1));
  copies.columns = std::max(1, dxf.integer(insert, 70, 1));
  copies.rows = std::max(1, dxf.integer(insert, 71, 1));
  copies.column = dxf.number(insert, 44);
  copies.row = dxf.number(insert, 45);
  return copies;
}

}  // namespace lamplock::model
