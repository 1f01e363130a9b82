#include "host/model/svg_background.hpp"

#include <cmath>
#include <cstddef>
#include <variant>

namespace lamplock::model {

bool is_filled_box(const Path& outline, const geometry::Bounds& page) {
  constexpr std::size_t max_lines = 8;  // programs divide sides
  if (outline.pieces.size() > max_lines) return false;
  double area = 0;
  for (const Piece& piece : outline.pieces) {
    const auto* line = std::get_if<Line>(&piece);
    if (line == nullptr) return false;
    area += (line->from.x * line->to.y - line->to.x * line->from.y) / 2;
  }
  Curves curves;
  curves.paths.push_back(outline);
  const geometry::Bounds box = bounds(curves);
  const double whole = (box.high.x - box.low.x) * (box.high.y - box.low.y);
  constexpr double rounding = 1e-6;
  return box.low.x <= page.low.x + flat_mm && box.low.y <= page.low.y + flat_mm &&
         box.high.x >= page.high.x - flat_mm && box.high.y >= page.high.y - flat_mm &&
         std::abs(std::abs(area) - whole) <= rounding * whole;
}

}  // namespace lamplock::model
