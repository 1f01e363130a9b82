// What `engrave` and `job` have in common: from an input to a job.
#pragma once

#include <string>

#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/run_job.hpp"

namespace lamplock::cli {

/// Everything that decides what is engraved, and how.
struct EngravingOptions {
  std::string input{};
  MachineOptions machine{};
  PointsOptions points{};
  OrderOption order{};
  ModeOption mode{};
  unsigned flashes = 1;

  /// Adds all options; the input is optional if the command can do without.
  void add(CLI::App& app, bool input_required);
};

/// Reads, discretises, orders and rounds to steps. Throws Error(bad_input).
Work make_work(const EngravingOptions& options, bool dry, Console& console);

}  // namespace lamplock::cli
