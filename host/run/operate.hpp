// What an operator does at the machine between jobs: teach zero, go there, change the glass, fire
// test flashes.
//
// In:  a board, an operation. Out: the places that the board keeps; the outcome of test flashes.
// Who: `operate`.
#pragma once

#include <cstdint>
#include <string>

#include "host/link/operator.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

struct OperateOptions {
  BoardOptions board;
  MachineOptions machine;
  std::string axes;
  bool teach = false;
  unsigned flashes = 1, channel = 0;
  std::uint32_t energy = 0;
};

/// Does one operation, which an interrupt of the user ends. Throws Error.
link::Places operate(const OperateOptions& options, link::Operation operation, Frontend& frontend);

/// The position of the machine and the places that it keeps. Throws Error.
link::Places ask_places(const OperateOptions& options);

/// Fires test flashes at the machine's position. Throws Error where nothing was done.
JobOutcome fire_test_flashes(const OperateOptions& options, Frontend& frontend);

}  // namespace lamplock::run
