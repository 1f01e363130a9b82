// Letters of single strokes: the tool runs along the middle of each stroke once.
//
// In:  the table strokes.txt. Out: open paths of lines. Who: texts of drawings, labels of cards.
#pragma once

#include <string>
#include <string_view>

#include "host/lettering/letters.hpp"

namespace lamplock::lettering {

/// ASCII and common letters of Latin-1. Capitals are 0.7 of the font size.
class StrokeLetters final : public Letters {
 public:
  LetteredLine line(const std::string& text) const override;
  std::string name() const override { return "the letters of single strokes"; }
  double capital() const override;
  double descent() const override;
};

/// The text of the table.
std::string_view strokes_text();

}  // namespace lamplock::lettering
