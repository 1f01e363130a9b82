#include "host/model/clip.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host/geometry/vector.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/piece_part.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using Place = ArcLength::Place;

/// A curve may be the outline itself, which is a polygon here: both deviate by flat_mm.
constexpr double on_outline_mm = 2 * flat_mm;

/// A count that no work permits; finite for a cast.
constexpr double max_chords = 1e9;

double square_of_distance_to_edge(const Point& at, const Point& p, const Point& q) {
  const double x = q.x - p.x, y = q.y - p.y, square = x * x + y * y;
  const double along = (at.x - p.x) * x + (at.y - p.y) * y;
  const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0;
  const double dx = at.x - p.x - t * x, dy = at.y - p.y - t * y;
  return dx * dx + dy * dy;
}

/// The number of chords of a piece that are within flat_mm of it.
double chords_of(const Piece& piece) {
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const double radius = std::hypot(norm(arc->u), norm(arc->v));
    const double step = 4 * std::asin(std::sqrt(std::min(1.0, flat_mm / radius / 2)));
    return std::ceil(std::abs(arc->end - arc->start) / std::min(step, std::numbers::pi / 4));
  }
  if (const auto* spline = std::get_if<Spline>(&piece)) {
    // The chord of a part h deviates by at most h^2 / 8 times the second derivative, which the
    // second differences of the poles bound.
    double bend = 0;
    for (std::size_t i = 0; i + 2 < spline->poles.size(); ++i) {
      const Point &p = spline->poles[i], &q = spline->poles[i + 1], &r = spline->poles[i + 2];
      bend = std::max(bend, std::hypot(p.x - 2 * q.x + r.x, p.y - 2 * q.y + r.y));
    }
    const double degree = spline->degree;
    return std::ceil(std::sqrt(degree * (degree - 1) * bend / 8 / flat_mm)) + 1;
  }
  return 1;
}

/// Finds the parameters at which a piece may enter or leave a region.
class Crossings {
 public:
  Crossings(const ClipRegions& regions, ClipWork& work, const FilePosition& place)
      : regions_(regions), work_(work), place_(place) {}

  /// The parts of a piece between crossings that are inside, in its direction.
  std::vector<Range> inside(const Piece& piece) {
    std::vector<Range> kept;
    const std::vector<double> at = parameters(piece);
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const double middle = at[i] + (at[i + 1] - at[i]) / 2;
      if (!contains(motion_at(piece, middle).at)) continue;
      if (!kept.empty() && kept.back().to == at[i])
        kept.back().to = at[i + 1];
      else
        kept.push_back({at[i], at[i + 1]});
    }
    return kept;
  }

 private:
  bool contains(const Point& point) {
    return std::all_of(regions_.begin(), regions_.end(),
                       [&](const auto& region) { return region->contains(point, work_, place_); });
  }

  /// Both ends and all crossings, in the direction of the piece.
  std::vector<double> parameters(const Piece& piece) {
    const Range range = range_of(piece);
    const auto count =
        static_cast<std::size_t>(std::min(std::max(1.0, chords_of(piece)), max_chords));
    work_.spend(count, place_);
    std::vector<double> found{range.from, range.to};
    Point p = motion_at(piece, range.from).at;
    const double step = (range.to - range.from) / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double from = range.from + step * static_cast<double>(i);
      const double to = i + 1 < count ? from + step : range.to;
      const Point q = motion_at(piece, to).at;
      parts_.clear();
      for (const auto& region : regions_) region->cross(p, q, parts_, work_, place_);
      for (const double part : parts_) found.push_back(from + part * (to - from));
      p = q;
    }
    work_.spend_on_sorting(found.size(), place_);
    const bool forward = range.from < range.to;
    std::sort(found.begin(), found.end(),
              [&](double a, double b) { return forward ? a < b : b < a; });
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  const ClipRegions& regions_;
  ClipWork& work_;
  const FilePosition& place_;
  std::vector<double> parts_;
};

/// The kept stretches of a path from place to place.
class Stretches {
 public:
  explicit Stretches(const Path& path) : path_(path) {}

  void add(std::size_t piece, const Range& range) {
    const bool continues = !kept_.empty() && is_end(kept_.back().second) &&
                           kept_.back().second.piece + 1 == piece &&
                           range.from == range_of(path_.pieces[piece]).from;
    if (continues)
      kept_.back().second = {piece, range.to};
    else
      kept_.push_back({{piece, range.from}, {piece, range.to}});
  }

  bool is_whole() const {
    return kept_.size() == 1 && is_start_of_path(kept_.front().first) &&
           is_end_of_path(kept_.back().second);
  }

  /// The stretches as paths; on a closed path the last may continue in the first.
  std::vector<Path> paths() const {
    std::vector<Path> parts;
    for (const auto& [from, to] : kept_) parts.push_back(part_of(path_, from, to));
    const bool wraps = path_.closed && parts.size() > 1 && is_start_of_path(kept_.front().first) &&
                       is_end_of_path(kept_.back().second);
    if (wraps) {
      std::vector<Piece>& last = parts.back().pieces;
      last.insert(last.end(), parts.front().pieces.begin(), parts.front().pieces.end());
      parts.front() = std::move(parts.back());
      parts.pop_back();
    }
    std::erase_if(parts, [](const Path& part) { return part.pieces.empty(); });
    return parts;
  }

 private:
  bool is_end(const Place& place) const {
    return place.parameter == range_of(path_.pieces[place.piece]).to;
  }
  bool is_start_of_path(const Place& place) const {
    return place.piece == 0 && place.parameter == range_of(path_.pieces.front()).from;
  }
  bool is_end_of_path(const Place& place) const {
    return place.piece + 1 == path_.pieces.size() && is_end(place);
  }

  const Path& path_;
  std::vector<std::pair<Place, Place>> kept_;
};

}  // namespace

void ClipWork::spend(std::size_t tests, const FilePosition& place) {
  // One to two seconds.
  constexpr std::size_t max_tests = 60'000'000;
  spent_ += tests;
  if (spent_ > max_tests)
    place.refuse("the clip paths of the drawing are too complex",
                 "apply them in the drawing program");
}

void ClipWork::spend_on_sorting(std::size_t crossings, const FilePosition& place) {
  // A comparison takes as long as a test.
  spend(crossings * static_cast<std::size_t>(std::bit_width(crossings)), place);
}

ClipShape::ClipShape(const std::vector<Path>& outlines, bool even_odd, ClipRegions clips,
                     ClipWork& work, const FilePosition& place)
    : even_odd_(even_odd), clips_(std::move(clips)) {
  // Limits the memory for edges and index to some hundred MB.
  constexpr double tests_per_edge = 64;
  for (const Path& outline : outlines) {
    double chords = 0;
    for (const Piece& piece : outline.pieces) chords += chords_of(piece);
    work.spend(static_cast<std::size_t>(std::min(chords, max_chords) * tests_per_edge), place);
    const geometry::PointCloud ring = flattened(outline, flat_mm);
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) edges_.push_back({ring[i], ring[i + 1]});
    // Fills close every outline.
    if (ring.back() != ring.front()) edges_.push_back({ring.back(), ring.front()});
  }
  build_index();
}

void ClipShape::build_index() {
  if (edges_.empty()) return;
  low_ = std::numeric_limits<double>::infinity();
  double high = -low_;
  for (const Edge& edge : edges_) {
    low_ = std::min({low_, edge.p.y, edge.q.y});
    high = std::max({high, edge.p.y, edge.q.y});
  }
  // As many slabs as the edges allow without being in too many of them.
  constexpr std::size_t max_slabs = 4096, max_entries_per_edge = 16;
  std::size_t count = std::clamp<std::size_t>(edges_.size() / 4, 1, max_slabs);
  for (;; count /= 2) {
    slabs_.assign(std::max<std::size_t>(count, 1), {});
    slab_height_ = std::max((high - low_) / static_cast<double>(slabs_.size()), on_outline_mm);
    std::size_t entries = 0;
    for (const Edge& edge : edges_)
      entries += slab_of(std::max(edge.p.y, edge.q.y) + on_outline_mm) -
                 slab_of(std::min(edge.p.y, edge.q.y) - on_outline_mm) + 1;
    if (count <= 1 || entries <= max_entries_per_edge * edges_.size()) break;
  }
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    const std::size_t last = slab_of(std::max(edges_[i].p.y, edges_[i].q.y) + on_outline_mm);
    for (std::size_t slab = first_slab_of(edges_[i]); slab <= last; ++slab)
      slabs_[slab].push_back(i);
  }
}

std::size_t ClipShape::slab_of(double y) const {
  const double slab = (y - low_) / slab_height_;
  return static_cast<std::size_t>(std::clamp(slab, 0.0, static_cast<double>(slabs_.size() - 1)));
}

std::size_t ClipShape::first_slab_of(const Edge& edge) const {
  return slab_of(std::min(edge.p.y, edge.q.y) - on_outline_mm);
}

bool ClipShape::contains(const Point& point, ClipWork& work, const FilePosition& place) const {
  if (edges_.empty()) return false;
  const std::vector<std::uint32_t>& near = slabs_[slab_of(point.y)];
  work.spend(near.size(), place);
  int winding = 0;
  bool is_on_outline = false;
  for (const std::uint32_t i : near) {
    const auto& [p, q] = edges_[i];
    if (square_of_distance_to_edge(point, p, q) <= on_outline_mm * on_outline_mm) {
      is_on_outline = true;
      break;
    }
    if ((p.y <= point.y) == (q.y <= point.y)) continue;
    const double side = (q.x - p.x) * (point.y - p.y) - (point.x - p.x) * (q.y - p.y);
    if (p.y <= point.y && side > 0) ++winding;
    if (p.y > point.y && side < 0) --winding;
  }
  const bool inside = even_odd_ ? winding % 2 != 0 : winding != 0;
  return (is_on_outline || inside) &&
         std::all_of(clips_.begin(), clips_.end(),
                     [&](const auto& clip) { return clip->contains(point, work, place); });
}

void ClipShape::cross(const Point& p, const Point& q, std::vector<double>& parts, ClipWork& work,
                      const FilePosition& place) const {
  for (const auto& clip : clips_) clip->cross(p, q, parts, work, place);
  if (edges_.empty()) return;
  const double x = q.x - p.x, y = q.y - p.y;
  const std::size_t first = slab_of(std::min(p.y, q.y)), last = slab_of(std::max(p.y, q.y));
  for (std::size_t slab = first; slab <= last; ++slab) {
    work.spend(slabs_[slab].size() + 1, place);
    for (const std::uint32_t i : slabs_[slab]) {
      // An edge is tested once, in the first slab that it shares with the segment.
      if (slab != first && slab != first_slab_of(edges_[i])) continue;
      const Point &a = edges_[i].p, &b = edges_[i].q;
      const double ex = b.x - a.x, ey = b.y - a.y;
      const double area = x * ey - y * ex;
      if (area == 0) continue;  // parallel
      const double on_segment = ((a.x - p.x) * ey - (a.y - p.y) * ex) / area;
      const double on_edge = ((a.x - p.x) * y - (a.y - p.y) * x) / area;
      constexpr double rounding = 1e-9;
      const auto is_within = [](double part) { return part >= -rounding && part <= 1 + rounding; };
      if (is_within(on_segment) && is_within(on_edge))
        parts.push_back(std::clamp(on_segment, 0.0, 1.0));
    }
  }
}

bool ClipRegion::contains(const Point& point, ClipWork& work, const FilePosition& place) const {
  return std::any_of(shapes_.begin(), shapes_.end(),
                     [&](const ClipShape& shape) { return shape.contains(point, work, place); });
}

void ClipRegion::cross(const Point& p, const Point& q, std::vector<double>& parts, ClipWork& work,
                       const FilePosition& place) const {
  work.spend(1 + shapes_.size(), place);
  for (const ClipShape& shape : shapes_) shape.cross(p, q, parts, work, place);
}

std::vector<Path> clipped(Path path, const ClipRegions& regions, ClipWork& work,
                          const FilePosition& place) {
  if (regions.empty()) return {std::move(path)};
  Crossings crossings(regions, work, place);
  Stretches stretches(path);
  for (std::size_t i = 0; i < path.pieces.size(); ++i) {
    for (const Range& range : crossings.inside(path.pieces[i])) stretches.add(i, range);
  }
  if (stretches.is_whole()) return {std::move(path)};
  return stretches.paths();
}

}  // namespace lamplock::model
