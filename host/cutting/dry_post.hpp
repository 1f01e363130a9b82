// The lines of a post-processor for a run without air.
//
// In:  the templates of one controller. Out: the same without the words M7 and M8.
// Who: the use case of cutting, for dry runs and frames.
#pragma once

#include "host/cutting/post.hpp"

namespace lamplock::cutting {

/// The events of air are not written in a run without it. Lines of other events may switch it on,
/// too: they lose their words M7 and M8, but not those in comments.
Post without_air(Post post);

}  // namespace lamplock::cutting
