// Letters as curves, of a font or of single strokes.
//
// In:  lines of text. Out: curves, in parts of the font size. Who: text_curves().
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::lettering {

/// A line of text that begins in the origin, x along the baseline, y upwards; the font size is 1.
struct LetteredLine {
  std::vector<model::Path> paths;
  double width = 0;         ///< to where the next letter would begin
  std::size_t missing = 0;  ///< letters that there are not
};

class Letters {
 public:
  virtual ~Letters() = default;
  virtual LetteredLine line(const std::string& text) const = 0;
  virtual std::string name() const = 0;  ///< for messages
  virtual double capital() const = 0;    ///< height of a capital letter
  virtual double descent() const = 0;    ///< from the baseline down, positive

 protected:
  Letters() = default;
  Letters(const Letters&) = default;
  Letters& operator=(const Letters&) = default;
};

}  // namespace lamplock::lettering
