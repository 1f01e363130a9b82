// Numbers for people: the one form of the whole program, its reports and pages.
//
// In:  a count. Out: "1 234 567". Who: progress, summaries; host/report/page/data.js has the same
// form.
#pragma once

#include <cstdint>
#include <string>

namespace lamplock {

/// Digits in groups of three, with spaces between the groups.
std::string grouped(std::uint64_t number);

}  // namespace lamplock
