// Parses a board's message about the job during which it crashed
// (firmware/boards/rp2040/storage/restart_record.hpp).
// In:  lines of text from the board. Out: the job and its progress. Who: JobSender, JobInquiry.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lamplock::link {

/// A watchdog or a fault has restarted the board during this job.
struct RestartMark {
  std::uint32_t session = 0;
  std::uint32_t first_unfired = 0;
  bool may_have_fired = false;  ///< the shot at that point was already commanded
};

/// The mark in "[MSG:Started by watchdog, job 7 first point not fired 12, which may have been]".
std::optional<RestartMark> parse_restart_mark(std::string_view line);

}  // namespace lamplock::link
