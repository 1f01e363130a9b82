// What it means for the user that the machine refuses a frame of a job.
//
// In:  the refusal, the last status, where the job can continue. Out: an error. Who: JobSender.
#pragma once

#include <cstdint>
#include <string>

#include "shared/wire/messages.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// The job that was refused, and the machine's state.
struct RefusalPlace {
  std::string item;           ///< of the job: "point" or "line"
  std::uint32_t session = 0;  ///< of the job
  wire::Status status;        ///< the last one, of any session
  std::string board;          ///< name of the board for remedies
  /// How the job continues, since a new start would fire points twice; empty if it cannot.
  std::string advice;
};

/// Throws the refusal as an Error for the user: job_failed for a state of the machine, no_device
/// for another version, RefusedSetting and bad_input for what the job asks for.
[[noreturn]] void throw_refusal(const wire::Refused& refused, const RefusalPlace& at);

}  // namespace lamplock::link
