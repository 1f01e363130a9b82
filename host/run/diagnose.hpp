// Runs a program on simulated servo drives and evaluates their encoders.
//
// In:  a program or none, the drives. Out: errors by axis; a picture. Who: `diagnose`.
#pragma once

#include <string>
#include <vector>

#include "host/program/servo_errors.hpp"
#include "host/program/servo_run.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

struct DiagnoseOptions {
  std::string input{};    ///< G-code; empty: the two trajectories of the paper
  std::string picture{};  ///< SVG; empty: none
  program_run::ServoMachine machine{};
  double feed_mm_min = 600;  ///< of the two trajectories
};

/// Throws Error.
std::vector<program_run::ServoErrors> diagnose(const DiagnoseOptions& options, Frontend& frontend);

}  // namespace lamplock::run
