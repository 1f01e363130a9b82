// Contours of a drawing: curves joined to what a laser cuts in one go.
//
// In:  the curves of a drawing (host/model). Out: open and closed contours of lines and arcs, what
//      is wrong with them with place and size, and which contour lies inside which.
// Who: the compensation and the order of cutting.
//
//   curves -> edges_of() -> join_contours() -> contour_faults(), contour_tree()
//
// Lines and circular arcs stay exact. Ellipses and splines become arcs within a tolerance. The
// drawing is seen from above: z is omitted. Only curves of one layer are joined, because a layer
// may be cut, engraved or ignored by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/edge.hpp"
#include "host/model/curves.hpp"

namespace lamplock::cutting {

/// A chain of edges, each beginning exactly at the end of the one before; never empty.
struct Contour {
  std::vector<Edge> edges;
  bool closed = false;  ///< the last edge ends exactly where the first begins
  model::FillRule fill_rule = model::FillRule::even_odd;  ///< of its area
  bool covers = false;                                    ///< as of model::Path
  std::uint32_t layer = 0;
  model::Colour colour = model::no_colour;  ///< of its first curve in the file
  std::uint32_t area = 0;                   ///< as of model::Path, of its first curve
};

/// mm along lines and arcs.
double length_of(const Contour& contour);
/// mm^2, positive for a closed contour that runs counter-clockwise; an open one has none, 0.
double signed_area(const Contour& contour);
/// True if a closed contour has its inside on the left. Of one that crosses itself, with loops of
/// equal areas in both directions, the loop farther right or above decides; without any, it is
/// true.
bool is_counter_clockwise(const Contour& contour);
Box box_of(const Contour& contour);
Contour reversed(const Contour& contour);
/// "contour of LENGTH mm at (x, y)", for errors.
std::string contour_text(const Contour& contour);
/// True if the point is inside of a closed contour that does not cross itself.
bool is_inside(const Contour& contour, const Vec& at);

/// How a contour or its place in the drawing differs from what the user expects of it.
enum class FaultKind {
  bridged_gap,        ///< ends that were joined although they differed; size: their distance
  gap,                ///< an end of an open contour; size: distance to the nearest other open end
  duplicate,          ///< a contour that was removed; size: its length
  dot,                ///< a curve that was removed because its length is 0
  self_intersection,  ///< size: length of the shorter loop that the crossing cuts off
  crossing,           ///< of two contours; size: 0
  narrow,     ///< the beam does not fit; size: between the points where it touches both sides
  vanished,   ///< a contour, or a part of it, that has no offset; size: its length
  overlap,    ///< edges on the same line or arc; size: length of the common part
  unhatched,  ///< an area between two lines of its hatch; size: its height
  unfilled,   ///< an outline without a fill beside filled areas that are engraved; size: as above
  beams,      ///< of two contours, which cross; size: 0
  near        ///< the beam along one contour cuts into another; size: of the gap between them
};
struct Fault {
  FaultKind kind = FaultKind::gap;
  Vec at;
  double size_mm = 0;
  /// Number of the contour; that of its equal for a duplicate, none for a dot.
  std::optional<std::size_t> contour;
  /// The other contour of a crossing or an overlap.
  std::optional<std::size_t> other = std::nullopt;
};

struct JoinOptions {
  /// Ends nearer than this are joined, the nearest first; contours that differ by less are
  /// duplicates, unless they are short against it. mm.
  double tolerance_mm = 0.01;
  /// Ellipses and splines deviate from the arcs that replace them by at most this. mm.
  double curve_tolerance_mm = model::flat_mm;
  /// A number for each layer: of two equal contours on layers with the same number the second one
  /// is a duplicate. Empty: on the same layer.
  std::vector<std::size_t> duplicate_groups{};
};

/// The lines and arcs of a path. Throws Error (bad_input) if it needs more than model::max_pieces.
std::vector<Edge> edges_of(const model::Path& path, double curve_tolerance_mm);

struct JoinedContours {
  std::vector<Contour> contours;  ///< in the order of the file, by their first curve
  std::vector<Fault> faults;      ///< bridged_gap, gap, duplicate, dot
};
/// Throws Error (bad_input) for a tolerance that is not positive, and as edges_of().
JoinedContours join_contours(const model::Curves& curves, const JoinOptions& options);

/// Self-intersections, crossings and overlaps, at most `max_faults`: a drawing with more of them is
/// not meant to be cut. Contours that touch in a point do not cross.
std::vector<Fault> contour_faults(const std::vector<Contour>& contours,
                                  std::size_t max_faults = 1000);

enum class ContourKind {
  open,
  outside,  ///< in no other contour
  hole,     ///< in an odd number of others
  island    ///< in an even number of others: a part inside a hole of another part
};
struct ContourPlace {
  ContourKind kind = ContourKind::open;
  std::optional<std::size_t> parent;  ///< the smallest closed contour around this one
  std::size_t depth = 0;              ///< number of closed contours around it
};
inline bool is_part(const ContourPlace& place) { return place.kind != ContourKind::hole; }
/// The place of each contour. Of contours that cross the result is that of most of their points.
std::vector<ContourPlace> contour_tree(const std::vector<Contour>& contours);

}  // namespace lamplock::cutting
