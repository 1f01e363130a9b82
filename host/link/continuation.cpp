#include "host/link/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lamplock::link {

bool is_at_rest(wire::MachineState state) {
  using wire::MachineState;
  return state == MachineState::idle || state == MachineState::alarm ||
         state == MachineState::estop;
}

Continuation at_rest(const job::Job& job, std::size_t first, std::uint32_t flashes) {
  first = std::min(first, job.size());
  const bool in_line =
      job.is_rows() && !job.header.dry && first < job.size() && job.rows.lines[first].to.light;
  return {first, in_line ? 0 : flashes, in_line ? first + 1 : first, true};
}

Continuation after_restart(const job::Job& job, const RestartMark& mark) {
  const std::size_t first = std::min<std::size_t>(mark.first_unfired, job.size());
  const bool several = first < job.targets.size() && job.targets[first].shots > 1;
  const bool in_doubt = first < job.size() && (mark.may_have_fired || several);
  return {first, 0, in_doubt ? first + 1 : first, true};
}

std::uint32_t flashes_of(std::span<const wire::Target> targets, std::size_t from, std::size_t next,
                         std::uint64_t shots) {
  if (next >= targets.size() || targets[next].shots == 0) return 0;
  std::uint64_t done = 0;
  for (std::size_t i = from; i < next; ++i) done += targets[i].shots;
  const std::uint64_t flashes = shots > done ? shots - done : 0;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(flashes, targets[next].shots - 1u));
}

std::string continuation_options(const Continuation& rest) {
  const std::string from = fmt::format("--from {}", rest.from);
  return rest.flashes == 0 || rest.in_doubt() ? from
                                              : from + fmt::format(" --fired {}", rest.flashes);
}

std::string doubt_text(const Continuation& rest, const std::string& item) {
  if (!rest.in_doubt()) return "";
  if (rest.from == rest.first + 1)
    return fmt::format("{} {} may have been fired", item, rest.first);
  return fmt::format("{}s {} to {} may have been fired", item, rest.first, rest.from - 1);
}

std::string continuation_text(const Continuation& rest, const std::string& item, bool is_kept) {
  if (!rest.settled && is_kept) return "continue with --resume, which asks the machine";
  const std::string text = "continue with " + continuation_options(rest);
  return rest.in_doubt() ? fmt::format("{} ({})", text, doubt_text(rest, item)) : text;
}

}  // namespace lamplock::link
