// Questions about models that were probably meant in another size or position.
//
// In:  an object of a description, its box in the glass, the number of its points. Out: questions,
//      one line each; none about what the user has decided.
// Who: object_points().
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/glass/description.hpp"
#include "host/model/input.hpp"

namespace lamplock::run {

/// A model whose file is in inches, centimetres or metres becomes a tiny object with few points; a
/// mesh whose y axis points up lies flat. Point lists are engraved as given and have no questions.
std::vector<std::string> size_hints(const glass::Object& object, model::InputKind kind,
                                    const geometry::Bounds& box, std::size_t points);

}  // namespace lamplock::run
