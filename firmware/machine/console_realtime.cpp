// Real-time bytes: holds, resets, the end of jogs, overrides, coolant.
#include "firmware/machine/console.hpp"
#include "shared/wire/realtime_inbox.hpp"

namespace lamplock::machine {
namespace {

using wire::HoldReason;

// Real-time bytes of grbl 1.1, besides those of shared/wire/realtime_inbox.hpp.
constexpr std::uint8_t byte_feed_full = 0x90;     // then +10, -10, +1, -1
constexpr std::uint8_t byte_rapid_full = 0x95;    // then 50 %, 25 %
constexpr std::uint8_t byte_spindle_full = 0x99;  // then as for the feed
constexpr std::uint8_t byte_flood = 0xa0, byte_mist = 0xa1;

constexpr std::uint8_t full_percent = 100;
constexpr std::array<std::uint8_t, 3> rapid_percents{100, 50, 25};
constexpr std::array<int, 5> override_changes{0, 10, -10, 1, -1};

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view line_runs = "Tool change: a line is not finished; '~' after it";

}  // namespace

void MachineConsole::change_override(std::uint8_t& percent, int by) {
  const int changed = by == 0 ? full_percent : percent + by;
  percent = static_cast<std::uint8_t>(changed < min_override   ? min_override
                                      : changed > max_override ? max_override
                                                               : changed);
}

void MachineConsole::override_byte(std::uint8_t byte) {
  const std::size_t feed = byte - std::size_t{byte_feed_full};
  const std::size_t rapid = byte - std::size_t{byte_rapid_full};
  const std::size_t spindle = byte - std::size_t{byte_spindle_full};
  if (feed < override_changes.size())
    change_override(overrides_.feed, override_changes[feed]);
  else if (rapid < rapid_percents.size())
    overrides_.rapid = rapid_percents[rapid];
  else if (spindle < override_changes.size())
    change_override(overrides_.spindle, override_changes[spindle]);
  else
    return;
  use_overrides();
}

/// Switches flood and mist manually in the states where grbl does; false for any other byte.
bool MachineConsole::toggle_coolant(std::uint8_t byte) {
  if (byte != byte_flood && byte != byte_mist) return false;
  const bool may = machine_.in(states(State::idle, State::running, State::holding));
  if (!may || machine_.framed() || machine_.homes()) return true;
  if (byte == byte_flood)
    reader_.toggle_flood();
  else
    reader_.toggle_mist();
  return true;
}

void MachineConsole::on_realtime(std::uint8_t byte) {
  if (byte == wire::byte_status) {
    status_line_due_ = true;
    return;
  }
  const Masked masked(mask_);
  switch (byte) {
    case wire::byte_door:
      handle(Event::door_byte, HoldReason::realtime);
      break;
    case wire::byte_hold:
      handle(Event::hold_byte, HoldReason::realtime);
      break;
    case wire::byte_tool:
      reader_.acknowledge_tool();
      break;
    case wire::byte_resume:
      if (machine_.changes_tool() && machine_.running() &&
          (reader_.users_line_runs() || !motion_.at_rest()))
        report_message(line_runs);
      // A job continues under the control of its host, which ends its own holds by a frame.
      if (!machine_.framed() || (machine_.hold_reason() != HoldReason::host && host_lives()))
        handle(Event::resume);
      else if (!host_lives() && !machine_.running())
        report_message("The host of the job is silent, '~' is ignored: 0x18 ends the job");
      break;
    case wire::byte_reset:
      link_.drop_input();
      if (machine_.framed()) refusal_ = Refusal::none;
      handle(Event::reset, HoldReason::reset);
      settle();
      break;
    case wire::byte_jog_cancel:
      handle(Event::cancel_jogs);
      break;
    default:
      if (!toggle_coolant(byte)) override_byte(byte);
      break;
  }
}

}  // namespace lamplock::machine
