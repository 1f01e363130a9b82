// Which axes a program has given a place: until then they are where the machine is.
//
// In:  the path of a program that starts at 0, and the same program from other places. Out: the
//      axes whose places are the same after each move. Who: read_feed_program(), which writes the
//      places of the plan into another program.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/program/program_path.hpp"

namespace lamplock::run {

/// A bit for each of X, Y and Z, after each step of `path`. Throws Error(bad_input) for a move
/// whose way depends on where the machine is; rapids to a place do not count as such.
std::vector<std::uint8_t> placed_axes(const std::vector<program_run::PathStep>& path,
                                      std::string_view text, const settings::Values& values,
                                      const std::string& file);

}  // namespace lamplock::run
