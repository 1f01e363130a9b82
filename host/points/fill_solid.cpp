#include "host/points/fill_solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/bounds.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"
#include "host/model/join_seams.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/points/dart_gaps.hpp"
#include "host/points/inside.hpp"
#include "host/points/mesh_parts.hpp"
#include "host/points/poisson_blocks.hpp"
#include "host/points/surface_blocks.hpp"

namespace lamplock::points {
namespace {

/// Points per cubic distance in a saturated body (random sequential adsorption of balls fills 0.384
/// of space: Torquato, Uche and Stillinger, "Random sequential addition of hard spheres in high
/// Euclidean dimensions", 2006; the radius of a ball is half the distance).
constexpr double saturated_solid = 0.384 / (3.14159265358979 / 6);

/// Darts per cubic distance in each round (see blue_noise.cpp).
constexpr std::array<double, 4> solid_rounds{0.25, 0.5, 1, 2};

/// Cubes smaller than this fraction of the distance are dropped. Half of it would give 2 % more
/// points in three times the time.
constexpr double min_cube = 1.0 / 4;

constexpr int cells_in_a_row = 16;  // cells of a distance in a block of block_distances

/// Corner i of a cube: bit 0 is the higher x, bit 1 the higher y, bit 2 the higher z.
geometry::Point corner_of(const geometry::Point& low, double side, std::size_t i) {
  return {low.x + ((i & 1) != 0 ? side : 0), low.y + ((i & 2) != 0 ? side : 0),
          low.z + ((i & 4) != 0 ? side : 0)};
}

geometry::Point centre_of(const geometry::Point& low, double side) {
  return {low.x + side / 2, low.y + side / 2, low.z + side / 2};
}

struct CubePiece {
  geometry::Point low;
  double side_mm = 0;
  bool at_surface = false;
  double radius_mm = 0;

  static constexpr std::size_t corner_count = 8;
  geometry::Point corner(std::size_t i) const { return corner_of(low, side_mm, i); }
  double measure() const { return side_mm * side_mm * side_mm; }
  Ball ball() const {
    constexpr double half_diagonal = 0.8660254037845;  // 3^0.5 / 2, rounded up
    return {centre_of(low, side_mm), half_diagonal * side_mm};
  }
};

using SeenCube = SeenPiece<CubePiece>;

/// A cube of one distance.
struct Cell {
  geometry::Point low;
  bool at_surface = false;
};

/// The body, its distance and density.
class Body {
 public:
  Body(const model::Mesh& mesh, const Inside& inside, const SolidOptions& options)
      : options_(options),
        inside_(inside),
        cells_(surface_blocks(mesh, grid_over(bounds(mesh.vertices), options.distance_mm, "solid"),
                              "solid")) {}

  bool contains(const geometry::Point& place) const { return inside_.contains(place); }

  /// The part of the body in a block, in cells.
  std::vector<Cell> cells_of(const BlockIndex& block) const {
    std::vector<Cell> found;
    const BlockIndex first{block.x * cells_in_a_row, block.y * cells_in_a_row,
                           block.z * cells_in_a_row};
    for (int i = 0; i < cells_in_a_row; ++i) {
      for (int j = 0; j < cells_in_a_row; ++j) {
        add_column({first.x + i, first.y + j, first.z}, found);
      }
    }
    return found;
  }

  /// A random dart in a cube, maybe outside the body.
  Dart dart_in(const geometry::Point& low, double side, geometry::Random& random) const {
    const geometry::Point place{low.x + side * random.uniform(), low.y + side * random.uniform(),
                                low.z + side * random.uniform()};
    const double radius = radius_at(place);
    const double most = max_radius_distances * options_.distance_mm;
    if (radius <= most) return {place, radius, true};
    return {place, most, random.uniform() < std::pow(most / radius, 3)};
  }

  Dart dart_in(const CubePiece& piece, geometry::Random& random) const {
    return dart_in(piece.low, piece.side_mm, random);
  }

  bool contains(const CubePiece& piece, const geometry::Point& place) const {
    return !piece.at_surface || contains(place);
  }

  CubePiece piece_of(const geometry::Point& low, double side, bool at_surface) const {
    CubePiece piece{low, side, at_surface, options_.distance_mm};
    const double most = max_radius_distances * options_.distance_mm;
    if (options_.light_depth_mm > 0) {
      piece.radius_mm = std::min(radius_at(centre_of(low, side)), most);
    }
    return piece;
  }

  /// The parts of a cube are not too small.
  bool can_split(const CubePiece& piece) const {
    constexpr double rounding = 1e-9;
    return piece.side_mm / 2 >= min_cube * piece.radius_mm * (1 - rounding);
  }

  /// Calls `found` with each eighth of a cube that is not covered.
  template <class Found>
  void split(const SeenCube& whole, const NearDarts& near, const Found& found) const {
    const CubePiece& piece = whole.piece;
    if (!can_split(piece)) return;
    const double half = piece.side_mm / 2;
    std::array<DartSet, 27> at_corner{};  // of all parts: three in a row, from low to high
    const auto at = [half](double low, std::size_t i) {
      return low + static_cast<double>(i) * half;
    };
    const auto in_row = [](std::size_t i) { return (i & 1) + 3 * (i >> 1 & 1) + 9 * (i >> 2); };
    for (std::size_t i = 0; i < 8; ++i) at_corner[2 * in_row(i)] = whole.at_corner[i];
    for (std::size_t i = 0; i < at_corner.size(); ++i) {
      if (i % 3 != 1 && i / 3 % 3 != 1 && i / 9 != 1) continue;  // a corner of the whole cube
      at_corner[i] = near.excluding(
          {at(piece.low.x, i % 3), at(piece.low.y, i / 3 % 3), at(piece.low.z, i / 9)},
          piece.radius_mm);
    }
    for (std::size_t i = 0; i < 8; ++i) {
      SeenCube part{piece_of(corner_of(piece.low, half, i), half, piece.at_surface)};
      if (options_.light_depth_mm > 0) {
        part.look(near);  // it has a radius of its own
      } else {
        for (std::size_t k = 0; k < 8; ++k) part.at_corner[k] = at_corner[in_row(i) + in_row(k)];
      }
      if (!part.is_covered()) found(part);
    }
  }

 private:
  /// Adds cells of a column. Only the surface separates inside and outside, so one test is enough
  /// for all cells between two cells of the surface.
  void add_column(const BlockIndex& first, std::vector<Cell>& found) const {
    auto surface = std::lower_bound(cells_.blocks.begin(), cells_.blocks.end(), first);
    std::optional<bool> inside;
    BlockIndex cell = first;
    for (; cell.z < first.z + cells_in_a_row; ++cell.z) {
      const geometry::Point low = cells_.grid.box(cell).low;
      const bool at_surface = surface != cells_.blocks.end() && *surface == cell;
      if (at_surface) {
        ++surface;
        inside.reset();
      } else if (!inside) {
        inside = contains(centre_of(low, options_.distance_mm));
      }
      if (at_surface || *inside) found.push_back({low, at_surface});
    }
  }

  double radius_at(const geometry::Point& place) const {
    if (options_.light_depth_mm <= 0) return options_.distance_mm;
    const double light = std::exp(-inside_.filled_above_mm(place) / options_.light_depth_mm);
    return options_.distance_mm / std::cbrt(std::max(light, options_.min_density));
  }

  const SolidOptions& options_;
  const Inside& inside_;
  SurfaceBlocks cells_;
};

void require_valid(const model::Mesh& mesh, const SolidOptions& options) {
  geometry::require_positive(options.distance_mm, "solid", "distance");
  if (!(options.light_depth_mm >= 0) || !std::isfinite(options.light_depth_mm)) {
    throw Error(Exit::bad_input, "solid", fmt::format("light depth {} mm", options.light_depth_mm),
                "give 0 or a positive depth");
  }
  if (!(options.min_density > 0 && options.min_density <= 1)) {
    throw Error(Exit::bad_input, "solid", fmt::format("lowest density {}", options.min_density),
                "give more than 0, at most 1");
  }
  require_sound(mesh, "solid");
}

/// The mesh, or if it is not closed, the mesh without duplicates of triangles.
model::Mesh closed_mesh(const model::Mesh& mesh, const std::string& name) {
  const model::MeshFaults faults = model::find_faults(mesh);
  model::Mesh result;
  result.vertices = mesh.vertices;
  result.triangles = mesh.triangles;
  if (faults.closed || mesh.triangles.empty()) return result;
  result.triangles = without_duplicates(result.triangles);
  if (result.triangles.size() < mesh.triangles.size() && model::find_faults(result).closed)
    return result;
  const std::vector<std::string> lines = model::warnings(faults);
  throw Error(Exit::bad_input, name,
              fmt::format("the mesh is not closed ({}; the widest gap is about {:.2g} mm)",
                          lines.empty() ? "" : lines.front(), model::widest_gap_mm(mesh)),
              "repair the model or fill its surface");
}

double volume_of(const geometry::Bounds& box) {
  return (box.high.x - box.low.x) * (box.high.y - box.low.y) * (box.high.z - box.low.z);
}

/// Blocks with surface and blocks wholly inside.
std::vector<BlockIndex> blocks_of(const model::Mesh& mesh, const BlockGrid& grid,
                                  const Body& body) {
  const SurfaceBlocks surface = surface_blocks(mesh, grid, "solid");
  const BlockIndex last = grid.of(bounds(mesh.vertices).high);
  geometry::require_count((last.x + 1.0) * (last.y + 1.0) * (last.z + 1.0), "solid");
  std::vector<BlockIndex> blocks;
  for (BlockIndex i; i.x <= last.x; ++i.x) {
    for (i.y = 0; i.y <= last.y; ++i.y) {
      for (i.z = 0; i.z <= last.z; ++i.z) {
        if (std::binary_search(surface.blocks.begin(), surface.blocks.end(), i) ||
            body.contains(centre_of(grid.box(i).low, grid.side_mm))) {
          blocks.push_back(i);
        }
      }
    }
  }
  return blocks;
}

void throw_darts(BlockDarts& block, std::span<const Cell> cells, const Body& body,
                 double distance_mm, double per_cell, geometry::Random& random) {
  if (cells.empty()) return;
  const auto size = static_cast<double>(cells.size());
  const auto count = static_cast<std::size_t>(size * per_cell + random.uniform());
  for (std::size_t i = 0; i < count; ++i) {
    const Cell& cell = cells[static_cast<std::size_t>(random.uniform() * size)];
    const Dart dart = body.dart_in(cell.low, distance_mm, random);
    if (!block.is_free(dart.place, dart.radius_mm)) continue;
    if (!cell.at_surface || body.contains(dart.place)) block.add(dart);
  }
}

void fill_block(BlockDarts& block, std::span<const Cell> cells, const Body& body,
                double distance_mm, geometry::Random& random) {
  GapFiller<CubePiece, Body> gaps(block, body, random);
  for (const Cell& cell : cells) {
    SeenCube whole{body.piece_of(cell.low, distance_mm, cell.at_surface)};
    const NearDarts& near = gaps.look_round(whole.piece);
    whole.look(near);
    if (whole.is_covered()) continue;
    if (!body.can_split(whole.piece)) gaps.add(whole);
    body.split(whole, near, [&](const SeenCube& part) { gaps.add(part); });
  }
  gaps.fill();
}

}  // namespace

geometry::PointCloud fill_solid(const model::Mesh& any_mesh, const SolidOptions& options) {
  require_valid(any_mesh, options);
  const model::Mesh mesh = closed_mesh(any_mesh, options.name);
  if (mesh.triangles.empty()) return {};
  const double distance_mm = options.distance_mm;
  const BlockGrid grid = grid_over(bounds(mesh.vertices), block_distances * distance_mm, "solid");
  const double thinnest = options.light_depth_mm > 0 ? options.min_density : 1;
  const Inside inside(mesh);
  const double volume_mm3 = std::min(inside.volume_mm3(), volume_of(bounds(mesh.vertices)));
  geometry::require_count(
      thinnest * saturated_solid * volume_mm3 / distance_mm / distance_mm / distance_mm, "solid");
  const Body body(mesh, inside, options);
  DartBlocks darts(grid, blocks_of(mesh, grid, body), distance_mm);
  const geometry::Random seeds(options.seed);
  for (std::size_t round = 0; round <= solid_rounds.size(); ++round) {
    darts.for_each(options.threads, [&](std::size_t block, BlockDarts& in_block) {
      geometry::Random random(seeds.fork(block * (solid_rounds.size() + 1) + round));
      const std::vector<Cell> cells = body.cells_of(darts.index(block));
      if (round < solid_rounds.size()) {
        throw_darts(in_block, cells, body, distance_mm, solid_rounds[round], random);
      } else {
        fill_block(in_block, cells, body, distance_mm, random);
      }
    });
    geometry::require_count(static_cast<double>(darts.count()), "solid");
  }
  return darts.take();
}

}  // namespace lamplock::points
