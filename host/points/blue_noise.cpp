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

namespace lamplock::points {
namespace {

/// Points per square distance on a saturated surface (random sequential adsorption of discs covers
/// 0.547 of a plane: Feder, "Random Sequential Adsorption", 1980; the radius of a disc is half the
/// distance).
constexpr double saturated = 0.547 / (3.14159265358979 / 4);

/// Darts per square distance in each round. Blocks of a round are processed one after the other;
/// short first rounds prevent full blocks next to empty ones.
constexpr std::array<double, 4> rounds{0.25, 0.5, 1, 2};

/// Pieces longer than this fraction of the distance are hardly ever covered by one point.
constexpr double max_piece = 0.75;
/// Shorter pieces are dropped: their places are further than the distance from a point by at most
/// this.
constexpr double min_piece = 1.0 / 32;

struct TrianglePiece {
  Corners corners;
  std::uint32_t triangle = 0;
  double radius_mm = 0;
  double measure() const { return area_of(corners); }
  geometry::Bounds box() const { return geometry::bounds(corners); }
  template <class Darts>
  bool is_covered(const Darts& darts) const {
    return darts.is_covered(corners, radius_mm);
  }
};

geometry::Point between(const geometry::Point& p, const geometry::Point& q) {
  return {(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2};
}

/// Index i of the longest side, from corner i to i + 1, and its length.
std::pair<std::size_t, double> max_side(const Corners& corners) {
  std::size_t longest = 0;
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double side = square_of_distance(corners[i], corners[(i + 1) % 3]);
    if (side > square) {
      square = side;
      longest = i;
    }
  }
  return {longest, std::sqrt(square)};
}

/// The two halves of a triangle, cut at its longest side.
std::array<Corners, 2> halves(const Corners& corners, std::size_t longest) {
  const geometry::Point& a = corners[longest];
  const geometry::Point& b = corners[(longest + 1) % 3];
  const geometry::Point& c = corners[(longest + 2) % 3];
  const geometry::Point middle = between(a, b);
  return {Corners{a, middle, c}, Corners{middle, b, c}};
}

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

  std::optional<Dart> dart_in(const TrianglePiece& piece, geometry::Random& random) const {
    return dart_at(random_place(piece.corners, random), piece.triangle, random);
  }

  void split(const TrianglePiece& piece, std::vector<TrianglePiece>& smaller) const {
    const auto [longest, length] = max_side(piece.corners);
    if (length <= min_piece * piece.radius_mm) return;
    for (const Corners& half : halves(piece.corners, longest)) {
      for (const Corners& quarter : halves(half, max_side(half).first)) {
        smaller.push_back(piece_of(quarter, piece.triangle));
      }
    }
  }

  TrianglePiece piece_of(const Corners& corners, std::uint32_t triangle) const {
    if (!tone_) return {corners, triangle, distance_};
    double radius = max_radius_distances * distance_;
    for (const geometry::Point& corner : corners) {
      radius = std::min(radius, radius_for(density_at(corner, triangle)));
    }
    return {corners, triangle, radius};
  }

  const model::Mesh& mesh() const { return mesh_; }

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
    const auto found =
        std::upper_bound(part.areas.begin(), part.areas.end() - 1, random.uniform() * area);
    const auto piece = static_cast<std::size_t>(found - part.areas.begin());
    const Dart dart =
        surface.dart_at(random_place(part.pieces[piece], random), part.triangles[piece], random);
    if (block.is_free(dart.place, dart.radius_mm)) block.add(dart);
  }
}

/// Halves a piece until its parts are short or covered.
void gather_open(const BlockDarts& block, const Surface& surface, const TrianglePiece& piece,
                 double max_mm, std::vector<TrianglePiece>& open) {
  const auto [longest, length] = max_side(piece.corners);
  // Larger pieces are hardly ever covered: the search would not pay.
  if (length < 2 * max_mm && piece.is_covered(block)) return;
  if (length <= max_mm) {
    open.push_back(piece);
    return;
  }
  for (const Corners& half : halves(piece.corners, longest)) {
    gather_open(block, surface, surface.piece_of(half, piece.triangle), max_mm, open);
  }
}

void fill_block(BlockDarts& block, const BlockSurface& part, const Surface& surface,
                double distance_mm, geometry::Random& random) {
  std::vector<TrianglePiece> open;
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    gather_open(block, surface, surface.piece_of(part.pieces[i], part.triangles[i]),
                max_piece * distance_mm, open);
  }
  fill_gaps(block, std::move(open), random, surface);
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
