#include "host/link/job_refusal.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "host/link/not_ready.hpp"
#include "host/link/refused_setting.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::link {
namespace {

/// Throws why a machine takes no job; `then` follows the remedy.
[[noreturn]] void throw_not_ready(const NotReady& reason, const std::string& where,
                                  const std::string& then) {
  throw Error(Exit::job_failed, where, reason.what, reason.remedy + then);
}

std::string describe_setting(std::uint32_t number) {
  const auto id = settings::find_number(static_cast<std::uint16_t>(number));
  if (number == 0 || id == settings::Id::count) return "the job header";
  return fmt::format("${} ({})", number, settings::row(id).name);
}

}  // namespace

void throw_refusal(const wire::Refused& refused, const RefusalPlace& at) {
  const bool of_point = refused.type != wire::FrameType::begin;
  const std::string where = of_point ? fmt::format("{} {}", at.item, refused.value) : "machine";
  // After a refusal in mid-job the remedy must not be a new start: it would fire points twice.
  const std::string then = of_point && !at.advice.empty() ? ", then " + at.advice : "";
  switch (refused.result) {
    case Result::busy:
      if (at.status.session != 0 && at.status.session != at.session)
        throw Error(
            Exit::job_failed, where,
            fmt::format("holds an unfinished job of another run or program (session {:08x}, {} {} "
                        "is the first not done)",
                        at.status.session, at.item, at.status.first_unfired),
            fmt::format(
                "finish it there, continue it with --resume and its own job, or replace it: "
                "lamplock send FILE --discard{}",
                board_option(at.board)) +
                then);
      if (at.status.state == wire::MachineState::hold)
        throw_not_ready(why_held(at.board), where, then);
      throw Error(Exit::job_failed, where, "another job is running",
                  "wait until that job ends, or stop it" + then);
    case Result::held:
      throw_not_ready(why_held(at.board), where, then);
    case Result::no_job:
      throw Error(Exit::job_failed, where, "the job was ended by the machine",
                  of_point ? at.advice : "start it again");
    case Result::locked:
      throw_not_ready(why_locked(at.status, at.board), where, then);
    case Result::door_open:
      throw_not_ready(why_stopped(at.status, at.board), where, then);
    case Result::bad_version:
      throw Error(Exit::no_device, where, "its firmware has another protocol version",
                  "install the firmware and the program of the same release");
    case Result::settings_mismatch:
      throw RefusedSetting(0, where, "the job was made for other settings",
                           "make the job again with this machine's profile" + then);
    case Result::out_of_bounds:
      throw Error(Exit::bad_input, where, "is outside the machine's work space",
                  "check travel and corner in the machine profile" + then);
    case Result::unreachable:
      throw Error(Exit::bad_input, where, "cannot be reached within the machine's limits",
                  "check speed, acceleration and beats" + then);
    case Result::bad_value:
      if (of_point)
        throw Error(Exit::bad_input, where,
                    "its record has a value that the machine does not allow",
                    "use the machine's own settings, which $$ lists" + then);
      throw RefusedSetting(
          refused.value, where,
          fmt::format("{} has a value that the machine does not allow",
                      describe_setting(refused.value)),
          "make the job with the machine's own settings, which lamplock settings list shows");
    case Result::unsupported:
      throw Error(Exit::bad_input, where,
                  "the job uses a channel or axis that the machine lacks or has disabled",
                  "check the channel ($924) and the axes" + then);
    default:
      throw Error(Exit::bad_input, where,
                  fmt::format("refuses the job (result {})", static_cast<int>(refused.result)),
                  "install the firmware and the program of the same release" + then);
  }
}

}  // namespace lamplock::link
