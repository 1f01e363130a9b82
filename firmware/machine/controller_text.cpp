// Text reports of the machine, and lines that begin with "$".
#include "firmware/machine/console/program_text.hpp"
#include "firmware/machine/controller.hpp"
#include "firmware/machine/runners/program_motion.hpp"
#include "shared/settings_text.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

constexpr std::string_view ok_line = "ok\r\n";
constexpr std::string_view version_begin = "[VER:1.1h.20261122:", product = "lamplock";

/// Position of the machine and speed along its path.
void report_motion(ReportedStatus& status, const stepper::MotionState& motion,
                   const settings::Values& values) {
  std::uint64_t squares = 0;
  for (int a = 0; a < status.axes; ++a) {
    const stepper::AxisState& axis = motion.axis[index(a)];
    const auto steps_per_mm_milli = static_cast<std::uint32_t>(values.milli(Id::steps_per_mm_x, a));
    status.machine_e7[index(a)] = place_of(axis, values, a);
    const std::int64_t steps_per_min =
        (Int128::product(axis.speed_q62, 60 * std::int64_t{ticks_per_second}) >> 62).to_int64();
    const std::int64_t um_min = mul_div(abs64(steps_per_min), 1'000'000, steps_per_mm_milli);
    squares += wide_product(static_cast<std::uint32_t>(um_min), static_cast<std::uint32_t>(um_min));
  }
  status.feed_um_min = isqrt(squares);
}

/// A bit for each of pin_letters.
std::uint16_t active_pins(InputSet active) {
  constexpr std::uint16_t probe_pin = 1u << pin_letters.find('P');
  constexpr std::uint16_t door_pin = 1u << pin_letters.find('D');
  constexpr auto first_limit = static_cast<unsigned>(pin_letters.find('X'));
  unsigned pins = unsigned{engaged_axes(active)} << first_limit;
  if ((active & set_of(Input::probe)) != 0) pins |= probe_pin;
  if ((active & set_of(Input::door)) != 0) pins |= door_pin;
  return static_cast<std::uint16_t>(pins);
}

/// Modal values of the program.
void report_program(ReportedStatus& status, const program::Interpreter& interpreter) {
  const program::Modal& modal = interpreter.modal();
  status.work_offset_e7 = interpreter.work_offset_e7();
  if (modal.spindle != program::Spindle::off) status.speed_milli = modal.speed_milli;
  status.clockwise = modal.spindle == program::Spindle::constant;
  status.counterclockwise = modal.spindle == program::Spindle::proportional;
  status.flood = modal.flood;
  status.mist = modal.mist;
}

}  // namespace

void Controller::tell_version() {
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
}

void Controller::answer_system_command(std::string_view line) {
  if (line.starts_with("$H") && line.size() <= 3) {
    const GcodeError error = begin_homing(line.substr(2));
    if (error != GcodeError::none) answer(error);  // otherwise answered when done
    return;
  }
  answer(system_command(line));
}

/// Commands for every state; the others need a machine at rest.
GcodeError Controller::system_command(std::string_view line) {
  if (tell(line)) return GcodeError::none;
  if (line == "$X") {
    if (machine_.state() == State::estop) return GcodeError::emergency_stop;
    end_refusal();
    if (machine_.state() == State::alarm) {
      if (door_open()) return GcodeError::door_open;
      reader_.end_lock();  // no shot before it is requested again
      say("Caution: Unlocked");
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
bool Controller::tell(std::string_view command) {
  TextLine line;
  if (command == "$$")
    list_settings();
  else if (command == "$I")
    tell_version();
  else if (command == "$#")
    tell_offsets(0, offset_lines);
  else if (command == "$N")
    tell_start_up_lines();
  else if (command == "$G")
    write_modes(line, reader_.interpreter().modal(), values_.whole(Id::report_inches) != 0);
  else if (command == "$")
    write_help(line, {.sleep = true, .check = true, .homing = values_.whole(Id::homing) != 0});
  else
    return false;
  link_.send_text(line.view());
  return true;
}

void Controller::tell_offsets(int first, int end) {
  const ReportedOffsets offsets{reader_.kept().parameters, reader_.interpreter().modal(), probe_,
                                values_.whole(Id::axes), values_.whole(Id::report_inches) != 0};
  for (int i = first; i < end; ++i) {
    TextLine line;
    write_offset(line, i, offsets);
    link_.send_text(line.view());
  }
}

void Controller::tell_start_up_lines() {
  for (std::size_t i = 0; i < start_up_lines; ++i) {
    TextLine line;
    write_start_up_line(line, static_cast<int>(i), reader_.kept().start_up[i].view());
    link_.send_text(line.view());
  }
}

GcodeError Controller::keep_build_text(std::string_view text) {
  if (!reader_.kept().build_text.set(text)) return GcodeError::text_too_long;
  kept_due_ = true;
  return GcodeError::none;
}

GcodeError Controller::command_at_rest(std::string_view line) {
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
  } else if (line == "$RST=#" || line == "$RST=*") {
    reader_.kept().clear_places();
    kept_due_ = true;
    if (line != "$RST=#") restore_everything();
  } else {
    return GcodeError::unknown_command;
  }
  return GcodeError::none;
}

/// Also during an e-stop: the state of a board without wires, and of a machine made safe first. All
/// outputs are off in the loader.
GcodeError Controller::request_loader() {
  if (!may_be_changed() && !(machine_.state() == State::estop && nothing_is_under_way()))
    return GcodeError::not_idle;
  loader_requested_ = true;
  return GcodeError::none;
}

bool Controller::nothing_is_under_way() const {
  return runner_.at_rest() && !shots_.undecided() && !program_unfinished();
}

bool Controller::may_be_changed() const {
  return machine_.in(states(State::idle, State::check, State::alarm)) && nothing_is_under_way();
}

GcodeError Controller::change_setting(std::string_view line) {
  const settings::SettingLine asked = settings::read_setting(line);
  if (asked.error != GcodeError::none) return asked.error;
  if (!may_be_changed()) return GcodeError::not_idle;
  settings::Values values = stored_;
  values.set_milli(asked.id, asked.milli);
  std::uint16_t setting = 0;
  if (check_settings(values, setting) != Result::ok) return GcodeError::setting_out_of_range;
  if (!(values == stored_)) take_over(values);
  return GcodeError::none;
}

/// Applies settings that the user has changed, at rest.
void Controller::take_over(const settings::Values& values) {
  end_program();
  planning_.recall();
  stored_ = values;
  store_due_ = true;
  configure_reader();
  reader_.invalidate_position();  // steps per mm may have changed
  const Masked masked(mask_);
  use_settings(stored_);
}

void Controller::restore_defaults() {
  say("Restoring defaults");
  take_over(settings::Values{});
}

void Controller::restore_everything() {
  for (KeptText& text : reader_.kept().start_up) text = {};
  reader_.kept().build_text = {};
  restore_defaults();
}

const PersistentState* Controller::changed_kept() {
  constexpr unsigned shift = 1u << static_cast<int>(program::ParameterRow::shift);
  program::Parameters& parameters = reader_.kept().parameters;
  if ((parameters.changed & ~shift) != 0) kept_due_ = true;  // all but the shift are kept
  parameters.changed = 0;
  // Nothing may move while the flash is written.
  if (!kept_due_ || !may_be_changed()) return nullptr;
  kept_due_ = false;
  return &reader_.kept();
}

void Controller::set_kept(const PersistentState& kept) { reader_.restore(kept); }

void Controller::list_settings() {
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    TextLine line;
    settings::write_setting(line, static_cast<Id>(i), stored_);
    link_.send_text(line.view());
  }
}

void Controller::say(std::string_view text) {
  TextLine line;
  line.add("[MSG:").add(text).add("]\r\n");
  link_.send_text(line.view());
}

[[gnu::hot]] void Controller::answer(GcodeError error) {
  if (error == GcodeError::none) {
    link_.send_text(ok_line);
    return;
  }
  TextLine text;
  text.add("error:").add(std::int64_t{static_cast<int>(error)}).add("\r\n");
  link_.send_text(text.view());
}

void Controller::send_banner() { link_.send_text("\r\nGrbl 1.1h ['$' for help]\r\n"); }

std::string_view Controller::state_name() const {
  const bool rests = runner_.at_rest();
  switch (machine_.state()) {
    case State::idle:
      return "Idle";
    case State::check:
      return "Check";
    case State::sleep:
      return "Sleep";
    case State::running:
    case State::stopping:
    case State::resetting:
    case State::aborting:
      if (machine_.homes()) return "Home";
      return machine_.jogs() ? std::string_view("Jog") : std::string_view("Run");
    case State::holding:
      return rests ? "Hold:0" : "Hold:1";
    case State::door:
      if (parking_.comes_back()) return "Door:3";
      if (parking_.stage() != Parking::Stage::off && parking_.stage() != Parking::Stage::parked)
        return "Door:2";
      if (!rests) return "Door:2";
      return door_open() ? "Door:1" : "Door:0";
    case State::alarm:
    case State::estop:
      break;
  }
  return "Alarm";
}

ReportedStatus Controller::reported_status() const {
  stepper::MotionState motion;
  ReportedStatus status;
  {
    const Masked masked(mask_);
    motion = runner_.generator().state();
    status.state = state_name();
    status.line = program_.line();
  }
  stepper::snap_to_motors(runner_.generator().kinematics(), motion);
  status.busy = machine_.activity() != Activity::none;
  status.axes = values_.whole(Id::axes);
  report_motion(status, motion, values_);
  report_program(status, reader_.interpreter());
  status.free_lines = beat_locked() ? runner_.queue().free() : program_.free();
  constexpr std::size_t beyond = LineQueue::capacity - LineQueue::window;
  const std::size_t room = receive_room();
  status.free_bytes = static_cast<std::uint32_t>(room > beyond ? room - beyond : 0);
  status.overrides = overrides_;
  status.pins = active_pins(inputs_);
  return status;
}

/// Waits for room: a host that reads no answers gets its status later.
void Controller::send_status_line() {
  if (link_.room() < status_room) return;
  TextLine line;
  reporter_.begin(line, reported_status(),
                  static_cast<std::uint32_t>(values_.whole(Id::report_mask)),
                  values_.whole(Id::report_inches) != 0);
  add_beats(line);
  line.add(">\r\n");
  if (link_.send_text(line.view())) status_line_due_ = false;
}

void Controller::add_beats(TextLine& line) const {
  line.add(clock_.locked() ? "|Lamp:1," : "|Lamp:0,").add(std::int64_t{clock_.edges()});
  wire::Status status;
  fill_status(status);
  const BeatsByReason &inside = status.beats_by_reason, &outside = status.beats_outside;
  for (std::size_t i = 0; i < beat_reason_count; ++i)
    line.add(i == 0 ? "|Beats:" : ",").add(std::int64_t{inside[i]} + outside[i]);
}

void Controller::fill_status(wire::Status& status) const {
  const Masked masked(mask_);
  static_cast<wire::StatusSummary&>(status) = standing();
  status.received = runner_.queue().end();
  status.first_unfired = runner_.queue().begin();
  status.shots = shots_.ledger().shots();
  status.beats = shots_.ledger().beats();
  status.beats_before = shots_.ledger().beats_before();
  status.starvations = runner_.starvations();
  status.beats_by_reason = shots_.ledger().by_reason();
  status.beats_outside = shots_.ledger().outside();
  status.shots_made = shots_.checks().made;
  status.shots_not_made = shots_.checks().not_made;
  status.repeats = shots_.checks().repeats;
  if (rows_.known()) rows_.fill_status(status);
}

}  // namespace lamplock::machine
