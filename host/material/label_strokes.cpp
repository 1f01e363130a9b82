#include "host/material/label_strokes.hpp"

#include <algorithm>
#include <string>
#include <variant>

#include "host/lettering/stroke_letters.hpp"
#include "host/model/curves.hpp"

namespace lamplock::material {

std::vector<Stroke> label_strokes(std::string_view text, double height_mm) {
  const lettering::StrokeLetters letters;
  const double scale = height_mm / letters.capital();
  std::vector<Stroke> strokes;
  for (const model::Path& path : letters.line(std::string(text)).paths) {
    Stroke& stroke = strokes.emplace_back();
    for (const model::Piece& piece : path.pieces) {
      const auto& line = std::get<model::Line>(piece);
      if (stroke.empty()) stroke.push_back({line.from.x * scale, line.from.y * scale});
      stroke.push_back({line.to.x * scale, line.to.y * scale});
    }
  }
  return strokes;
}

double label_width_mm(std::string_view text, double height_mm) {
  double width_mm = 0;
  for (const Stroke& stroke : label_strokes(text, height_mm))
    for (const LabelPoint& point : stroke) width_mm = std::max(width_mm, point.x_mm);
  return width_mm;
}

}  // namespace lamplock::material
