// Which machine a job is made for: a profile and what the user has set instead of its values.
//
// In:  values that the command line (host/cli/machine_options.hpp) or a description has set. Out: a
//      profile. Who: the use cases that make jobs, and those that simulate a board.
#pragma once

#include <optional>
#include <string>

#include "host/glass/description.hpp"
#include "host/job/profile.hpp"

namespace lamplock::run {

struct MachineOptions {
  std::string machine{};  ///< file of the profile; empty: the default machine
  std::optional<double> lamp_hz{}, accel_m_s2{}, speed_m_s{};
  std::optional<std::string> lamp_mode{};  ///< slave, master or none

  /// The profile with these values. Throws Error(bad_input).
  job::Profile profile() const;
};

/// The profile of a description. Throws Error(bad_input).
job::Profile profile_of(const glass::MachineChoice& machine);

}  // namespace lamplock::run
