// Pieces of a surface: triangles that are halved at their longest side until darts cover them.
// Called by blue_noise().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "host/geometry/vector.hpp"
#include "host/points/dart_gaps.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {

/// A part of a triangle of a mesh.
struct TrianglePiece {
  Corners corners;
  std::array<double, 3> sides_mm2{};  // squares of lengths; side i is from corner i to the next one
  double area_mm2 = 0;
  double radius_mm = 0;        // of darts in it
  std::uint32_t triangle = 0;  // of the mesh

  static constexpr std::size_t corner_count = 3;
  const geometry::Point& corner(std::size_t i) const { return corners[i]; }
  double measure() const { return area_mm2; }

  /// The side i that is longest.
  std::size_t longest() const {
    // Products instead of branches, half of which the processor would predict wrongly.
    const std::size_t first = sides_mm2[1] > sides_mm2[0] ? 1 : 0;
    return first + static_cast<std::size_t>(sides_mm2[2] > sides_mm2[first]) * (2 - first);
  }
  double longest_mm2() const { return sides_mm2[longest()]; }

  Ball ball() const;
};

inline std::size_t next_corner(std::size_t i) { return i == 2 ? 0 : i + 1; }

inline geometry::Point middle_of(const geometry::Point& p, const geometry::Point& q) {
  return {(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2};
}

/// A triangle `a b c` whose longest side is `a b`, and the point that halves this side.
struct SideCut {
  explicit SideCut(const TrianglePiece& piece)
      : a(piece.longest()),
        b(next_corner(a)),
        c(next_corner(b)),
        middle(middle_of(piece.corners[a], piece.corners[b])) {}

  /// The half with corner a.
  TrianglePiece half_a(const TrianglePiece& whole) const {
    TrianglePiece part = half(whole);
    part.corners = {whole.corners[a], middle, whole.corners[c]};
    part.sides_mm2 = {whole.sides_mm2[a] / 4, cut_mm2(whole), whole.sides_mm2[c]};
    return part;
  }
  /// The half with corner b.
  TrianglePiece half_b(const TrianglePiece& whole) const {
    TrianglePiece part = half(whole);
    part.corners = {middle, whole.corners[b], whole.corners[c]};
    part.sides_mm2 = {whole.sides_mm2[a] / 4, whole.sides_mm2[b], cut_mm2(whole)};
    return part;
  }

  std::size_t a, b, c;
  geometry::Point middle;

 private:
  double cut_mm2(const TrianglePiece& whole) const {
    return square_of_distance(middle, whole.corners[c]);
  }
  /// What both halves have.
  static TrianglePiece half(const TrianglePiece& whole) {
    TrianglePiece part;
    part.area_mm2 = whole.area_mm2 / 2;
    part.radius_mm = whole.radius_mm;
    part.triangle = whole.triangle;
    return part;
  }
};

/// Its centre is the middle of the longest side.
inline Ball TrianglePiece::ball() const {
  constexpr double rounding = 1 + 1e-9;
  const SideCut cut(*this);
  const double square =
      std::max(sides_mm2[cut.a] / 4, square_of_distance(cut.middle, corners[cut.c]));
  return {cut.middle, std::sqrt(square) * rounding};
}

}  // namespace lamplock::points
