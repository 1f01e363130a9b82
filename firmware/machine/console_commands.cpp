// Lines that begin with "$".
#include "firmware/machine/console.hpp"
#include "firmware/machine/console/program_text.hpp"
#include "shared/pulse_times.hpp"
#include "shared/settings_text.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

// Constants, because the compiler would count their characters at run time.
constexpr std::string_view lacks_sensor = " needs SENSOR, which this pin map lacks on a board ",
                           of_another_board = " of another board than ";
constexpr std::string_view version_begin = "[VER:1.1h.20261122:", product = "lamplock";

}  // namespace

void MachineConsole::answer_system_command(std::string_view line) {
  if (line.starts_with("$H") && line.size() <= 3) {
    const GcodeError error = begin_homing(line.substr(2));
    if (error != GcodeError::none) answer(error);  // otherwise answered when done
    return;
  }
  answer(system_command(line));
}

/// Commands for every state; the others need a machine at rest.
GcodeError MachineConsole::system_command(std::string_view line) {
  if (send_report(line)) return GcodeError::none;
  if (line == "$X") {
    if (machine_.state() == State::estop) return GcodeError::emergency_stop;
    end_refusal();
    if (machine_.state() == State::alarm) {
      if (door_open()) return GcodeError::door_open;
      reader_.end_lock();  // no shot before it is requested again
      report_message("Caution: Unlocked");
    }
    const Masked masked(mask_);
    handle(Event::unlock);  // without an alarm: a job that is held and has no host ends
    return GcodeError::none;
  }
  if (line.starts_with("$RST=") || line.starts_with("$I=") || line == "$BOOT" || line == "$C" ||
      line == "$SLP")
    return command_at_rest(line);
  return change_setting(line);
}

/// Commands that only request a report.
bool MachineConsole::send_report(std::string_view command) {
  TextLine line;
  if (command == "$$")
    list_settings();
  else if (command == "$I")
    report_version();
  else if (command == "$#")
    report_offsets(0, offset_lines);
  else if (command == "$N")
    report_start_up_lines();
  else if (command == "$G")
    write_modes(line, reader_.interpreter().modal(), values_.whole(Id::report_inches) != 0);
  else if (command == "$")
    write_help(line, {.sleep = true, .check = true, .homing = values_.whole(Id::homing) != 0});
  else
    return false;
  link_.send_text(line.view());
  return true;
}

void MachineConsole::report_version() {
  TextLine options;
  options.add("[OPT:VN,")
      .add(std::int64_t{motion::LineRing::capacity})
      .add(",")
      .add(std::int64_t{LineQueue::window})
      .add("]\r\n");
  const std::string_view text = reader_.kept().build_text.view();
  TextLine version;
  version.add(version_begin).add(text.empty() ? product : text).add("]\r\n");
  link_.send_text(version.view());
  link_.send_text(options.view());
  TextLine board;
  board.add("[BOARD:").add(board_.name).add("]\r\n");
  link_.send_text(board.view());
}

void MachineConsole::report_start_up_lines() {
  for (std::size_t i = 0; i < start_up_lines; ++i) {
    TextLine line;
    write_start_up_line(line, static_cast<int>(i), reader_.kept().start_up[i].view());
    link_.send_text(line.view());
  }
}

void MachineConsole::list_settings() {
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    TextLine line;
    settings::write_setting(line, static_cast<Id>(i), stored_);
    link_.send_text(line.view());
  }
}

GcodeError MachineConsole::keep_build_text(std::string_view text) {
  if (!reader_.kept().build_text.set(text)) return GcodeError::text_too_long;
  kept_due_ = true;
  return GcodeError::none;
}

GcodeError MachineConsole::command_at_rest(std::string_view line) {
  if (line == "$BOOT") return request_loader();
  if (!may_be_changed()) return GcodeError::not_idle;
  if (line.starts_with("$I=")) return keep_build_text(line.substr(3));
  const bool checks = line == "$C";
  if (checks || line == "$SLP") {
    const Event event = checks ? Event::toggle_check : Event::go_to_sleep;
    if (!machine_.accepts(event)) return GcodeError::not_idle;
    const Masked masked(mask_);
    handle(event);
  } else if (line == "$RST=$") {
    restore_defaults();
  } else if (line == "$RST=P") {
    reader_.clear_parameters();
  } else if (line == "$RST=#" || line == "$RST=*") {
    reader_.kept().clear_places();
    if (reader_.interpreter().state().system_rotation.active()) reader_.invalidate_position();
    kept_due_ = true;
    if (line != "$RST=#") restore_everything();
  } else {
    return GcodeError::unknown_command;
  }
  return GcodeError::none;
}

/// Also during an e-stop: the state of a board without wires, and of a machine made safe first. All
/// outputs are off in the loader.
GcodeError MachineConsole::request_loader() {
  if (!may_be_changed() && !(machine_.state() == State::estop && nothing_is_under_way()))
    return GcodeError::not_idle;
  loader_requested_ = true;
  return GcodeError::none;
}

GcodeError MachineConsole::change_setting(std::string_view line) {
  const settings::SettingLine asked = settings::read_setting(line);
  if (asked.id == Id::count && settings::needs_sensor(asked.number))
    return refuse_number(asked.number, lacks_sensor);
  if (asked.error != GcodeError::none) return asked.error;
  if (!may_be_changed() && !may_change_in_estop(asked.id)) return GcodeError::not_idle;
  settings::Values values = stored_;
  values.set_milli(asked.id, asked.milli);
  if (const GcodeError error = refuse_for_board(values); error != GcodeError::none) return error;
  std::uint16_t setting = 0;
  if (check_settings(values, setting) != Result::ok) return refuse_settings(values, setting);
  if (!(values == stored_)) take_over(values);
  return GcodeError::none;
}

/// Settings that can be changed in the e-stop: `$2` and `$3`, because a board with active low STEP
/// or DIR keeps its outputs off until they are set; those of drives, if a stored one keeps the
/// drives off.
bool MachineConsole::may_change_in_estop(Id id) {
  if (machine_.state() != State::estop || !nothing_is_under_way()) return false;
  if (id == Id::step_invert || id == Id::direction_invert) return true;
#if LAMPLOCK_DRIVE_SETTINGS
  return id >= Id::drive_current_x &&
         boards::unfit_drive_setting(board_.limits, stored_) != Id::count;
#else
  return false;
#endif
}

/// Reports which value of a setting the board does not have, if there is one.
GcodeError MachineConsole::refuse_for_board(const settings::Values& values) {
  const Id refused = boards::unfit_setting(board_.limits, values);
  if (refused == Id::count) return refuse_for_drives(values);
  const std::uint16_t number = settings::number(refused);
  if (refused == Id::lamp_frequency) {
    // The clock of the processor limits it.
    TextLine reason;
    reason.add(" at most ").add(std::int64_t{board_.limits.max_lamp_milli_hz / 1000});
    return refuse_number(number, reason.add(" Hz on a board ").view());
  }
  return refuse_number(number, settings::needs_sensor(number) ? lacks_sensor : of_another_board);
}

/// Reports why this board cannot have a setting.
GcodeError MachineConsole::refuse_number(std::uint16_t number, std::string_view reason) {
  TextLine text;
  text.add("$").add(number).add(reason).add(board_.name);
  report_message(text.view());
  return GcodeError::setting_out_of_range;
}

/// Reports what the drives of the board permit, if a value is not among it.
GcodeError MachineConsole::refuse_for_drives([[maybe_unused]] const settings::Values& values) {
#if LAMPLOCK_DRIVE_SETTINGS
  if (const Id refused = boards::unfit_drive_setting(board_.limits, values); refused != Id::count) {
    TextLine text;
    text.add("$").add(settings::number(refused));
    if (refused < Id::microsteps_x)
      text.add(" at most ")
          .add(std::int64_t{board_.limits.max_drive_current_ma})
          .add(" mA on a board ");
    else
      text.add(" is 1, 2, 4, 8, 16, 32, 64, 128 or 256 on a board ");
    text.add(board_.name);
    report_message(text.view());
    return GcodeError::setting_out_of_range;
  }
#endif
  return GcodeError::none;
}

/// Reports the highest rate that the pulses of an axis permit, if the rate set is higher; else
/// which setting contradicts others.
GcodeError MachineConsole::refuse_settings(const settings::Values& values, std::uint16_t setting) {
  const settings::RateExcess excess = settings::rate_excess(values);
  const bool is_rate = excess.axis >= 0 &&
                       setting == settings::number(settings::for_axis(Id::max_rate_x, excess.axis));
  TextLine text;
  if (is_rate && excess.is_shared)
    text.add("$110 and $111 together");
  else
    text.add("$").add(std::int64_t{setting});
  if (is_rate)
    text.add(" at most ").add_milli(excess.max_milli).add(" mm/min with $0 and $1077");
  else
    text.add(" contradicts other settings");
  report_message(text.view());
  return is_rate ? GcodeError::step_rate_too_high : GcodeError::setting_out_of_range;
}

/// Applies settings that the user has changed, at rest.
void MachineConsole::take_over(const settings::Values& values) {
  end_program();
  planning_.recall();
  stored_ = values;
  store_due_ = true;
  configure_reader();
  reader_.invalidate_position();  // steps per mm may have changed
  const Masked masked(mask_);
  use_settings(stored_);
}

void MachineConsole::restore_defaults() {
  report_message("Restoring defaults");
  settings::Values values;
  boards::fit_settings(board_.limits, values);
  take_over(values);
}

void MachineConsole::restore_everything() {
  for (KeptText& text : reader_.kept().start_up) text = {};
  reader_.kept().build_text = {};
  restore_defaults();
}

const PersistentState* MachineConsole::changed_kept() {
  constexpr unsigned shift = 1u << static_cast<int>(program::ParameterRow::shift);
  program::Parameters& parameters = reader_.kept().parameters;
  if ((parameters.changed & ~shift) != 0) kept_due_ = true;  // all but the shift are kept
  parameters.changed = 0;
  // Nothing may move while the flash is written.
  if (!kept_due_ || !may_be_changed()) return nullptr;
  kept_due_ = false;
  return &reader_.kept();
}

void MachineConsole::set_kept(const PersistentState& kept) {
  reader_.restore(kept);
  report_tool_length();
}

}  // namespace lamplock::machine
