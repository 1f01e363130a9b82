// The drawing of a cutting job as shapes: read, in mm, in its place, joined, with operations.
//
// In:  a description. Out: contours with their operations and layers; what the user has to know.
// Who: the use case of cutting.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/run/cut_description.hpp"

namespace lamplock::run {

struct CutDrawing {
  std::vector<cutting::Shape> shapes;
  std::vector<std::string> layers;  ///< of each shape
  std::vector<std::string> warnings;
  std::size_t texts = 0;  ///< that are curves now
  std::string font;       ///< file of their font, or name of their letters
};

/// Throws Error(bad_input) for a file that is no drawing by its name.
void require_drawing_name(const std::string& file);

/// Throws Error(bad_input): a file that is no drawing or cannot be read, a drawing without a unit,
/// a layer or colour that is not in it, nothing for an operation to do, text without a font.
CutDrawing read_cut_drawing(const CutDescription& description);

/// One line for each kind of fault: how many, and where the first is. `tolerance_mm`: of joined
/// ends.
std::vector<std::string> fault_texts(const std::vector<cutting::Fault>& faults,
                                     double tolerance_mm);

}  // namespace lamplock::run
