// Parameters that only a running machine knows.
//
// In:  a line of a program, upper or lower case. Out: the first such parameter in it.
// Who: the host, where it computes the values of a program before the machine runs it.
#pragma once

#include <array>
#include <string_view>

namespace lamplock::program_run {

/// Places of the last probe, its contact, and the result of M66; empty if the line reads none.
inline std::string_view result_in(std::string_view line) {
  constexpr std::array<std::string_view, 6> results{"#5061", "#5062", "#5063",
                                                    "#5064", "#5070", "#5399"};
  for (const std::string_view result : results)
    if (line.find(result) != std::string_view::npos) return result;
  return {};
}

}  // namespace lamplock::program_run
