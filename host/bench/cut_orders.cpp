#include "host/bench/cut_orders.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include "host/geometry/random.hpp"

namespace lamplock::bench {
namespace {

using cutting::Contour;
using cutting::Vec;

constexpr double cell_mm = 50, part_mm = 40, max_hole_mm = 4;

/// A closed polygon of straight lines.
Contour polygon(const std::vector<Vec>& corners) {
  Contour contour{{}, true};
  for (std::size_t i = 0; i < corners.size(); ++i)
    contour.edges.push_back({corners[i], corners[(i + 1) % corners.size()], {}, 0});
  return contour;
}

Contour square(const Vec& low, double side_mm) {
  return polygon({low, low + Vec{side_mm, 0}, low + Vec{side_mm, side_mm}, low + Vec{0, side_mm}});
}

/// Square parts in rows, each with up to six square holes in a grid of three by two.
std::vector<Contour> sheet_of(int parts, geometry::Random& random) {
  constexpr int columns_of_holes = 3;
  constexpr std::uint64_t max_holes = 6;
  const int columns = static_cast<int>(std::ceil(std::sqrt(parts)));
  std::vector<Contour> contours;
  for (int part = 0; part < parts; ++part) {
    const Vec low = Vec{cell_mm * (part % columns), cell_mm * (part / columns)} +
                    Vec{8 * random.uniform(), 8 * random.uniform()};
    contours.push_back(square(low, part_mm));
    const auto holes = static_cast<int>(random.next() % (max_holes + 1));
    for (int hole = 0; hole < holes; ++hole) {
      const Vec at{4 + 12.0 * (hole % columns_of_holes), 6 + 18.0 * (hole / columns_of_holes)};
      contours.push_back(square(low + at + Vec{4 * random.uniform(), 6 * random.uniform()},
                                max_hole_mm * (0.5 + random.uniform() / 2)));
    }
  }
  return contours;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

std::vector<CutOrderFigures> cut_order_figures(std::uint64_t seed,
                                               const std::function<void()>& searched) {
  geometry::Random random(seed);
  std::vector<CutOrderFigures> rows;
  for (const int parts : cut_sheet_parts) {
    const std::vector<Contour> contours = sheet_of(parts, random);
    const auto places = cutting::contour_tree(contours);
    CutOrderFigures row;
    row.contours = contours.size();
    for (std::size_t i = 0; i < cut_searches.size(); ++i) {
      const double before = cpu_seconds();
      row.rapid_mm[i] =
          cutting::cut_order(contours, places, {0, 0}, cut_searches[i].options).rapid_mm;
      row.seconds[i] = cpu_seconds() - before;
      searched();
    }
    rows.push_back(row);
  }
  return rows;
}

std::string cut_order_table(const std::vector<CutOrderFigures>& rows, std::uint64_t seed) {
  std::string text = fmt::format(
      "Rapid way of cutting orders in mm, and CPU seconds, on sheets of square parts with holes,\n"
      "seed {}; genetic with its population\n\ncontours",
      seed);
  for (const CutSearchRow& search : cut_searches) text += fmt::format("{:>18}", search.name);
  text += "\n";
  for (const CutOrderFigures& row : rows) {
    text += fmt::format("{:>8}", row.contours);
    for (std::size_t i = 0; i < cut_searches.size(); ++i)
      text += fmt::format("{:>10.0f} {:>5.2f} s", row.rapid_mm[i], row.seconds[i]);
    text += "\n";
  }
  return text;
}

}  // namespace lamplock::bench
