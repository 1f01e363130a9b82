// Reads the path whose feed is optimised: a program of G-code, or a polyline.
//
// In:  a file. Out: its blocks. Who: optimise_feed().
#pragma once

#include <string>

#include "host/feed_optimiser/feed_program.hpp"
#include "host/job/profile.hpp"

namespace lamplock::run {

/// A file with an extension of point lists is a polyline, any other a program. With a machine a
/// program has to be inside its work space. Throws Error(bad_input), also for programs whose places
/// depend on what a board has stored.
feed_optimiser::FeedProgram read_feed_program(const std::string& file, const job::Profile& profile,
                                              bool has_machine);

}  // namespace lamplock::run
