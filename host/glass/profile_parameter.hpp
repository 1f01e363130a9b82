// The parameter that several descriptions have: the file of a machine profile.
//
// In:  the name of a file. Out: its parameter. Who: descriptions of jobs and of cuts.
#pragma once

#include <string>

#include "host/glass/parameters.hpp"

namespace lamplock::glass {

/// `profile`, --machine. The text must outlive it.
Parameter profile_parameter(std::string& file);

}  // namespace lamplock::glass
