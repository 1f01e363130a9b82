// The beat of each shot, counted from the first one.
//
// In:  shots recorded by the laser, the settings of the job. Out: the beat of each shot.
// Who: the report's page, the estimate.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/settings_table.hpp"
#include "sim/world/shots.hpp"

namespace lamplock::report {

/// Beats from the first shot, which has 0, in the order of `shots`. With a lamp, as master or
/// slave, they are numbers of flashes; with a free beat they are computed from the times.
std::vector<std::uint32_t> beats_from_first(const sim::Shots& shots,
                                            const settings::Values& settings);

}  // namespace lamplock::report
