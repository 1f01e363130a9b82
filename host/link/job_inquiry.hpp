// Asks a board, before a job is begun, for the progress of an earlier one, and ends that one.
//
// In:  a transport. Out: the status of the board at rest; the mark of a restart.
// Who: KeptJob. Only frames are used: no line is sent.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "host/link/connection.hpp"
#include "host/link/restart_mark.hpp"
#include "host/link/transport.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// One inquiry.
class JobInquiry {
 public:
  /// The transport must outlive the inquiry.
  explicit JobInquiry(Transport& transport);

  /// Asks for the status; a job of one of these sessions that is unfinished is stopped first.
  /// Throws Error: no_device (no answer, another version), job_failed (the board does not stop).
  wire::Status end_job(std::span<const std::uint32_t> sessions);
  /// The board's message about a restart, if any; valid after end_job().
  const std::optional<RestartMark>& restart_mark() const { return mark_; }

 private:
  using Time = std::chrono::microseconds;

  wire::Status ask();
  std::optional<wire::Status> wait_for_answer(Time until);
  std::optional<wire::Status> receive();

  Transport& transport_;
  Connection connection_;
  std::optional<RestartMark> mark_;
  std::uint32_t tag_;
};

}  // namespace lamplock::link
