// Errors before the first shot: a script may repeat the command after the correction (status 2).
//
// In:  an error of a phase in which nothing was fired and nothing has moved. Out: the same error
//      with the status of that phase. Who: run_job(), run_program(), operate(), keep_progress().
// The parts of the program that talk to a board do not know whether their caller has fired before.
#pragma once

#include "host/error.hpp"
#include "host/link/not_stopped.hpp"

namespace lamplock::run {

/// Does what comes before the first shot. An Error(job_failed) becomes Error(bad_input), except
/// that a machine could not be stopped: it may fire.
template <class Action>
auto before_firing(Action action) {
  try {
    return action();
  } catch (const link::NotStopped&) {
    throw;
  } catch (const Error& error) {
    if (error.exit() != Exit::job_failed) throw;
    throw error.with(Exit::bad_input);
  }
}

}  // namespace lamplock::run
