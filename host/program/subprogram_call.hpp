// M98: the program that a line calls, and how often.
//
// In:  a line with M98, its values as numbers. Out: the call. Who: program_flow.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "host/program/flow_place.hpp"
#include "host/program/flow_unit.hpp"

namespace lamplock::program_run {

struct SubprogramCall {
  std::size_t first = 0;  ///< statement of the program
  std::int64_t runs = 1;  ///< none if it is not positive
};

/// Throws ProgramError at `place` for other words in the line, and for a program that the unit does
/// not have.
SubprogramCall subprogram_call_of(const std::string& line, const FlowUnit& unit,
                                  const FlowPlace& place);

}  // namespace lamplock::program_run
