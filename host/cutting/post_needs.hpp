// What a plan needs of the lines of a post-processor: without one of them the program would lack
// something that was asked for, or the light would be on in a dry run.
//
// In:  the templates of one controller, a plan with its operations. Out: an error, or warnings.
// Who: the use case of cutting.
#pragma once

#include <string>
#include <vector>

#include "host/cutting/post.hpp"

namespace lamplock::cutting {

/// Throws Error (bad_input), with `where` and the event of the missing line, for depths, air,
/// pierce times, compensation by the controller, changes of the power within a stroke or among
/// operations, and darkness, if the post-processor has no line that writes them. An event whose
/// lines are empty text needs nothing: air_on = "". The texts are warnings: of a power or a feed
/// that is the same everywhere and that no line writes.
std::vector<std::string> require_lines(const Post& post, const std::string& where,
                                       const CutPlan& plan,
                                       const std::vector<Operation>& operations);

}  // namespace lamplock::cutting
