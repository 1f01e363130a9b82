// What a machine cannot do of a plan, or does otherwise than the user expects.
//
// In:  operations with their values, the box of the plan, the settings of the machine. Out: an
//      Error, or warnings. Who: make_cut().
#pragma once

#include <string>
#include <vector>

#include "host/cutting/operation.hpp"
#include "host/cutting/post.hpp"
#include "host/geometry/bounds.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// Refuses a power whose S word is 0, where a cut needs light or a spindle that turns. Throws
/// Error(bad_input) about the operation.
void require_power(const std::vector<cutting::Operation>& operations, cutting::MachineType machine,
                   const settings::Values& values);

/// Throws Error(bad_input) about the drawing if the box of its plan is not inside the work space.
void require_inside(const std::string& drawing, const geometry::Bounds& box,
                    const settings::Values& values);

/// Tabs without a kerf; on a lamplock board with a laser its laser mode, and pierce times that it
/// does not permit.
std::vector<std::string> operation_warnings(const std::vector<cutting::Operation>& operations,
                                            const cutting::Post& post,
                                            const settings::Values& values);

}  // namespace lamplock::run
