// The place of an object in numbers, as the handles of a page change it, and in the words of a
// description (host/glass/transformation.hpp).
//
// In:  transformations of a description. Out: those that a page keeps, and the numbers of the last
//      ones; transformations again. Who: the scene of the page.
//
//   kept transformations -> mirror -> scale -> rotate about x, y, z -> move
//
// All but the kept ones are about the middle of the block, as in the description.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace lamplock::serve {

struct Placement {
  std::array<bool, 3> mirror{};
  double scale = 1;
  std::array<double, 3> turn_deg{}, move_mm{};
  friend bool operator==(const Placement&, const Placement&) = default;
};

struct PlacedWords {
  std::vector<std::string> kept{};  ///< before the placement
  Placement placement{};            ///< of the longest end that has its order
};

PlacedWords split_words(const std::vector<std::string>& transformations);
/// Without those that change nothing; numbers to 1e-6.
std::vector<std::string> words_of(const Placement& placement);

}  // namespace lamplock::serve
