// Rapid ways of cutting orders: nearest neighbour, the search of `lamplock cut`, and the genetic
// algorithm of the document on cutting, on the same sheets.
//
// In:  a seed. Out: lengths and CPU times, for a table of `lamplock bench`. Who: `lamplock bench`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/cutting/cut_order.hpp"

namespace lamplock::bench {

/// A search and its name in the table.
struct CutSearchRow {
  const char* name;
  cutting::OrderOptions options;
};
inline const std::array<CutSearchRow, 5> cut_searches{{
    {"nearest", {cutting::OrderSearch::nearest, 0}},
    {"improved", {cutting::OrderSearch::improved, 0}},
    {"genetic 20", {cutting::OrderSearch::genetic, 20}},
    {"genetic 100", {cutting::OrderSearch::genetic, 100}},
    {"genetic 500", {cutting::OrderSearch::genetic, 500}},
}};
/// Parts of the sheets; each has 3 holes on average.
inline constexpr std::array<int, 4> cut_sheet_parts{2, 9, 36, 144};

/// One sheet: the rapid way and the CPU time of each search.
struct CutOrderFigures {
  std::size_t contours = 0;
  std::array<double, cut_searches.size()> rapid_mm{}, seconds{};
};

/// All sheets, with parts in rows and holes in them; `searched` is called after each search.
std::vector<CutOrderFigures> cut_order_figures(std::uint64_t seed,
                                               const std::function<void()>& searched);

/// The table.
std::string cut_order_table(const std::vector<CutOrderFigures>& rows, std::uint64_t seed);

}  // namespace lamplock::bench
