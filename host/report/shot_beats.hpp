// On which beat each shot fell, counted from the first one.
//
// In:  shots as the laser recorded them, the settings they were fired under. Out: a beat each.
// Who: the report's page, the estimate.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/settings_table.hpp"
#include "sim/trace/shots.hpp"

namespace lamplock::report {

/// Beats from the first shot, which has 0, in the order of `shots`. Where the lamp gives the beat,
/// or is given it, they are numbers of flashes; on a free beat they come from the times.
std::vector<std::uint32_t> beats_from_first(const sim::Shots& shots,
                                            const settings::Values& settings);

}  // namespace lamplock::report
