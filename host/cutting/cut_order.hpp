// Order of cutting: contours inside others first, with a short rapid way.
//
// In:  contours and their tree, the position of the machine. Out: the order, where each contour
//      begins, and the length of the rapid moves.
// Who: the preparation of a cut.
//
// A part that is cut free may move or tilt, so its holes have to be cut before it. This is a
// condition that every step of the search keeps, not a sorting before or after it: holes of
// different parts may still be cut in one sweep.
//
//   nearest neighbour -> (2-opt, Or-opt -> best start points for this order) ... -> order
//   up to max_exact contours: all orders, by dynamic programming over sets of contours
//
// Nearest neighbour alone and a genetic algorithm, that of the document on cutting, are there to be
// compared with it: `lamplock bench --rows cutting`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// Up to this number of contours the order is the best of all (for the start points considered).
inline constexpr std::size_t max_exact = 8;
/// Start points considered on a closed contour: corners if it has so many, and points between them.
inline constexpr std::size_t starts_of_closed = 16;

/// One contour in the order.
struct CutStep {
  std::size_t contour = 0;
  bool backwards =
      false;             ///< an open contour is cut from its end; closed ones keep their direction
  std::size_t edge = 0;  ///< a closed contour begins on this edge ...
  double part = 0;       ///< ... at this part of its length, 0 <= part < 1
};

struct CutOrder {
  std::vector<CutStep> steps;  ///< each contour once
  double rapid_mm = 0;         ///< from the position of the machine to the last contour
};

enum class OrderSearch : std::uint8_t { improved, nearest, genetic };
/// In the order of OrderSearch.
inline constexpr std::array<std::string_view, 3> order_search_names{"improved", "nearest",
                                                                    "genetic"};

struct OrderOptions {
  OrderSearch search = OrderSearch::improved;
  std::size_t population = 100;  ///< orders in a generation of the genetic algorithm
};

/// The order of a search; `nearest`: always the nearest contour that may be cut. The others are
/// never longer than it. The same input has the same result. Open contours for which `is_directed`
/// is true are never cut backwards; empty: none. Throws Error (bad_input) unless there is one place
/// for each contour and every contour is inside of its parents alone.
CutOrder cut_order(const std::vector<Contour>& contours, const std::vector<ContourPlace>& places,
                   const Vec& position, const OrderOptions& options = {},
                   const std::vector<bool>& is_directed = {});

/// The contour as it is cut: it begins at the start point of the step.
Contour as_cut(const Contour& contour, const CutStep& step);

}  // namespace lamplock::cutting
