// Why a board refuses the settings of a job, in words.
//
// In:  the refusal, the job, the board. Out: an error with the values of the job and of the board
//      and with the way to a job that the board accepts.
// Who: run_job().
#pragma once

#include "host/job/job.hpp"
#include "host/link/refused_setting.hpp"
#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::run {

/// Asks the board for its settings and throws Error(bad_input); the refusal itself if the board
/// does not answer. The caller has ended the job on this port.
[[noreturn]] void explain_refusal(const link::RefusedSetting& refusal, const job::Job& job,
                                  link::Transport& port, const BoardOptions& options);

}  // namespace lamplock::run
