// Runs a program of G-code without a machine: errors, time, bounds, a picture of its path.
//
// In:  a program, a machine. Out: the run. Who: `check`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/program/process_values.hpp"
#include "host/program/program_run.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

struct CheckOptions {
  std::string input{}, picture{};  ///< picture: SVG; empty: none
  MachineOptions machine{};
  std::size_t max_problems = 20;
  std::optional<program_run::ProcessValues> process{};  ///< of the chosen material
  std::string tools{};          ///< tool table (tool_file.hpp); empty: no tools
  std::string user_commands{};  ///< folder of M100 to M199; empty: none are permitted
};

/// A program that was run, and what the user may want to know about it.
struct CheckedProgram : program_run::ProgramRun {
  std::vector<std::string> notes{};
  std::vector<std::string> probe_logs{};  ///< names of the logs that it opens
};

/// Throws Error if a file cannot be read or written; wrong lines are in the result.
CheckedProgram check_program(const CheckOptions& options);

}  // namespace lamplock::run
