// Which machine a command is about.
//
// In:  the command line. Out: a profile of the machine. Who: the commands that need one.
#pragma once

#include <optional>
#include <string>

#include "host/glass/description.hpp"
#include "host/job/profile.hpp"

namespace lamplock::cli {

class Command;

/// Which machine, and what is to be different for this job.
struct MachineOptions {
  std::string machine{};
  std::optional<double> lamp_hz{}, accel_m_s2{}, speed_m_s{};
  std::optional<std::string> lamp_mode{};

  void add_machine(Command& app);    ///< --machine alone
  void add_overrides(Command& app);  ///< lamp, acceleration, speed

  /// Profile with the overrides. Throws Error(bad_input).
  job::Profile profile() const;
};

/// The same of a description.
job::Profile profile_of(const glass::MachineChoice& machine);

}  // namespace lamplock::cli
