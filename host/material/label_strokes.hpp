// Letters of single strokes, for labels that a laser engraves.
//
// In:  a text, the height of its capitals. Out:
// lines. Who: the test cards.
#pragma once

#include <string_view>
#include <vector>

namespace lamplock::material {

struct LabelPoint {
  double x_mm = 0, y_mm = 0;
};
/// Points that lines connect, from the lower left corner of the text.
using Stroke = std::vector<LabelPoint>;

/// The strokes of a text. A character that has no strokes is left blank.
std::vector<Stroke> label_strokes(std::string_view text, double height_mm);
/// To the right edge of the last stroke.
double label_width_mm(std::string_view text, double height_mm);

}  // namespace lamplock::material
