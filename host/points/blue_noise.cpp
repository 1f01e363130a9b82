#include "host/points/blue_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/dart_gaps.hpp"
#include "host/points/poisson_blocks.hpp"
#include "host/points/surface_blocks.hpp"
#include "host/points/triangle_piece.hpp"

namespace lamplock::points {
namespace {

/// Points per square distance on a saturated surface (random sequential adsorption of discs covers
/// 0.547 of a plane: Feder, "Random Sequential Adsorption", 1980; the radius of a disc is half the
/// distance).
constexpr double saturated = 0.547 / (3.14159265358979 / 4);

/// Darts per square distance in each round. Blocks of a round are processed one after the other; a
/// short first round prevents full blocks next to empty ones.
constexpr std::array<double, 2> rounds{0.5, 2.5};

/// Pieces longer than this fraction of the distance are divided before they get a dart.
constexpr double max_piece = 0.75;
/// A search finds the darts for all parts of a piece up to this length.
constexpr double max_searched = 4 * max_piece;
/// Shorter pieces are dropped: their places are further than the distance from a point by at most
/// this.
constexpr double min_piece = 1.0 / 32;

using SeenTriangle = SeenPiece<TrianglePiece>;

geometry::Point random_place(const Corners& corners, geometry::Random& random) {
  double b = random.uniform(), c = random.uniform();
  if (b + c > 1) {
    b = 1 - b;
    c = 1 - c;
  }
  const auto at = [&](double geometry::Point::*axis) {
    const double from = corners[0].*axis;
    return from + b * (corners[1].*axis - from) + c * (corners[2].*axis - from);
  };
  return {at(&geometry::Point::x), at(&geometry::Point::y), at(&geometry::Point::z)};
}

/// Surface, distance and density.
class Surface {
 public:
  Surface(const model::Mesh& mesh, const BlueNoiseOptions& options)
      : mesh_(mesh), distance_(options.distance_mm) {
    if (options.tone && mesh.brightness) tone_ = options.tone;
  }

  Dart dart_at(const geometry::Point& place, std::uint32_t triangle,
               geometry::Random& random) const {
    if (!tone_) return {place, distance_, true};
    const double density = density_at(place, triangle);
    const double part = density * max_radius_distances * max_radius_distances;
    return {place, radius_for(density), part >= 1 || random.uniform() < part};
  }

  Dart dart_in(const TrianglePiece& piece, geometry::Random& random) const {
    return dart_at(random_place(piece.corners, random), piece.triangle, random);
  }

  bool contains(const TrianglePiece&, const geometry::Point&) const { return true; }

  /// Calls `found` with each half that is not covered.
  template <class Found>
  void halve(const SeenTriangle& whole, const NearDarts& near, const Found& found) const {
    const SideCut cut(whole.piece);
    const auto& seen = whole.at_corner;
    const DartSet at_middle = near.excluding(cut.middle, whole.piece.radius_mm);
    using Sets = std::array<DartSet, 3>;
    const auto visit = [&](const Sets& at_corner, const auto& half_of) {
      // With one radius for all darts, most halves are covered and need not be made.
      if (!tone_ && have_common_dart(at_corner)) return;
      SeenTriangle half{half_of(whole.piece), at_corner};
      if (tone_) {
        half.piece.radius_mm = radius_of(half.piece);
        half.at_corner = {};
        half.look(near);
        if (half.is_covered()) return;
      }
      found(half);
    };
    visit(Sets{seen[cut.a], at_middle, seen[cut.c]},
          [&](const TrianglePiece& piece) { return cut.half_a(piece); });
    visit(Sets{at_middle, seen[cut.b], seen[cut.c]},
          [&](const TrianglePiece& piece) { return cut.half_b(piece); });
  }

  /// Calls `found` with each quarter that is not covered.
  template <class Found>
  void split(const SeenTriangle& whole, const NearDarts& near, const Found& found) const {
    const double min_mm = min_piece * whole.piece.radius_mm;
    if (whole.piece.longest_mm2() <= min_mm * min_mm) return;
    halve(whole, near, [&](const SeenTriangle& half) { halve(half, near, found); });
  }

  TrianglePiece piece_of(const Corners& corners, std::uint32_t triangle) const {
    TrianglePiece piece{corners, {}, area_of(corners), distance_, triangle};
    for (std::size_t i = 0; i < 3; ++i)
      piece.sides_mm2[i] = square_of_distance(corners[i], corners[next_corner(i)]);
    piece.radius_mm = radius_of(piece);
    return piece;
  }

  /// The smallest radius at a corner.
  double radius_of(const TrianglePiece& piece) const {
    if (!tone_) return distance_;
    double radius = max_radius_distances * distance_;
    for (const geometry::Point& corner : piece.corners) {
      radius = std::min(radius, radius_for(density_at(corner, piece.triangle)));
    }
    return radius;
  }

 private:
  double radius_for(double density) const {
    return distance_ / std::max(std::sqrt(density), 1 / max_radius_distances);
  }

  double density_at(const geometry::Point& place, std::uint32_t triangle) const {
    const Corners corners = corners_of(mesh_, triangle);
    const double all = area_of(corners);
    const double b = area_of({corners[0], place, corners[2]}) / all;
    const double c = area_of({corners[0], corners[1], place}) / all;
    return tone_->density(mesh_.brightness->at(triangle, b, c));
  }

  const model::Mesh& mesh_;
  double distance_;
  std::optional<ToneCurve> tone_;
};

/// The surface inside one block.
struct BlockSurface {
  std::vector<Corners> pieces;
  std::vector<std::uint32_t> triangles;  // of each piece
  std::vector<double> areas;             // of all pieces up to each

  /// The piece where the sum of areas exceeds `area`. A product instead of a branch, half of which
  /// the processor would predict wrongly.
  std::size_t piece_at(double area) const {
    const double* first = areas.data();
    for (std::size_t left = areas.size(); left > 1;) {
      const std::size_t half = left / 2;
      first += half * static_cast<std::size_t>(first[half - 1] <= area);
      left -= half;
    }
    return static_cast<std::size_t>(first - areas.data());
  }

  BlockSurface(const model::Mesh& mesh, std::span<const std::uint32_t> in_block,
               const geometry::Bounds& box) {
    double area = 0;
    for (const std::uint32_t triangle : in_block) {
      cut_to_box(corners_of(mesh, triangle), box, pieces);
      for (std::size_t i = triangles.size(); i < pieces.size(); ++i) {
        triangles.push_back(triangle);
        areas.push_back(area += area_of(pieces[i]));
      }
    }
  }
};

void throw_darts(BlockDarts& block, const BlockSurface& part, const Surface& surface,
                 double per_mm2, geometry::Random& random) {
  if (part.pieces.empty()) return;
  const double area = part.areas.back();
  // A fraction of a dart is the probability of one more.
  const auto count = static_cast<std::size_t>(area * per_mm2 + random.uniform());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t piece = part.piece_at(random.uniform() * area);
    const Dart dart =
        surface.dart_at(random_place(part.pieces[piece], random), part.triangles[piece], random);
    if (block.is_free(dart.place, dart.radius_mm)) block.add(dart);
  }
}

/// The open pieces of a surface in a block.
class OpenTriangles {
 public:
  OpenTriangles(BlockDarts& block, const Surface& surface, double distance_mm,
                geometry::Random& random)
      : surface_(surface), distance_(distance_mm), gaps_(block, surface, random) {}

  /// Halves a piece until its parts are short or covered.
  void add(const TrianglePiece& piece) {
    if (is_longer(piece, max_searched)) {
      const SideCut cut(piece);
      for (TrianglePiece half : {cut.half_a(piece), cut.half_b(piece)}) {
        half.radius_mm = surface_.radius_of(half);
        add(half);
      }
      return;
    }
    SeenTriangle seen{piece};
    const NearDarts& near = gaps_.look_round(piece);
    seen.look(near);
    if (!seen.is_covered()) add_open(seen, near);
  }

  void fill() { gaps_.fill(); }

 private:
  bool is_longer(const TrianglePiece& piece, double distances) const {
    return piece.longest_mm2() > distances * distances * distance_ * distance_;
  }

  void add_open(const SeenTriangle& seen, const NearDarts& near) {
    if (!is_longer(seen.piece, max_piece)) return gaps_.add(seen);
    surface_.halve(seen, near, [&](const SeenTriangle& half) { add_open(half, near); });
  }

  const Surface& surface_;
  double distance_;
  GapFiller<TrianglePiece, Surface> gaps_;
};

void fill_block(BlockDarts& block, const BlockSurface& part, const Surface& surface,
                double distance_mm, geometry::Random& random) {
  OpenTriangles open(block, surface, distance_mm, random);
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    open.add(surface.piece_of(part.pieces[i], part.triangles[i]));
  }
  open.fill();
}

double area_of_mesh(const model::Mesh& mesh) {
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) area += area_of(corners_of(mesh, i));
  return area;
}

}  // namespace

geometry::PointCloud blue_noise(const model::Mesh& mesh, const BlueNoiseOptions& options) {
  geometry::require_positive(options.distance_mm, "blue noise", "distance");
  if (options.tone) require_valid(*options.tone, "blue noise");
  require_sound(mesh, "blue noise");
  const double distance_mm = options.distance_mm;
  const BlockGrid grid =
      grid_over(bounds(mesh.vertices), block_distances * distance_mm, "blue noise");
  geometry::require_count(saturated * area_of_mesh(mesh) / distance_mm / distance_mm, "blue noise");
  const SurfaceBlocks blocks = surface_blocks(mesh, grid, "blue noise");
  const Surface surface(mesh, options);
  const geometry::Random seeds(options.seed);
  DartBlocks darts(grid, blocks.blocks, distance_mm);
  for (std::size_t round = 0; round <= rounds.size(); ++round) {
    darts.for_each(options.threads, [&](std::size_t block, BlockDarts& in_block) {
      geometry::Random random(seeds.fork(block * (rounds.size() + 1) + round));
      const BlockSurface part(mesh, blocks.of(block), darts.box(block));
      if (round < rounds.size()) {
        throw_darts(in_block, part, surface, rounds[round] / (distance_mm * distance_mm), random);
      } else {
        fill_block(in_block, part, surface, distance_mm, random);
      }
    });
  }
  return darts.take();
}

}  // namespace lamplock::points
