// Lines of the host: their order, their answers.
#include "firmware/machine/console.hpp"
#include "firmware/machine/console/system_line.hpp"

namespace lamplock::machine {
namespace {

/// Maximum lines of a program in one round of the main loop, which has other work.
constexpr int max_lines_at_once = 4;
/// Room for a list, which is an answer to "$"; without it lines wait.
constexpr std::size_t list_room = 2048;
/// In the queue, for a line that was too long or damaged.
constexpr std::string_view lost_line = "\x01";

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view stopped_at_error = "Stopped at an error: '$X' or reset to continue";

}  // namespace

[[gnu::hot]] std::size_t MachineConsole::receive_room() const {
  const std::size_t open = link_.line_size();
  return reader_.free() > open ? reader_.free() - open : 0;
}

[[gnu::hot]] void MachineConsole::on_line(std::string_view line) {
  while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
  if (begins_at_once(line)) {
    begin_line(line);
    return begin_program();
  }
  if (reader_.tool_acknowledged() && !before_jog_cancel_ && !begin_users_lines())
    return answer(GcodeError::tool_change_pending);
  if (!reader_.push(line)) return answer(GcodeError::line_too_long);
  if (line.starts_with('$') && is_jog(line)) last_jog_ = now_;
  if (before_jog_cancel_) lines_at_cancel_ = reader_.lines();
  work_lines();
}

/// After the acknowledgement of a tool change: lines are the user's from now on. False if the line
/// of M6 has other commands after it, or is a start-up line.
bool MachineConsole::begin_users_lines() {
  lines_at_cancel_ = 0;
  return !own_line_ && new_start_up_ == start_up_lines && reader_.begin_users_lines();
}

void MachineConsole::on_line_too_long() { on_line(lost_line); }

/// No line may be begun now.
[[gnu::hot]] bool MachineConsole::lines_are_held() const {
  if (machine_.ends() && !machine_.framed()) return true;
  if (program_.cancelling() || program_.batch_waits()) return true;
  // After a cancelled jog, until the machine is at rest at the start of the next line.
  return reader_.off_target() && !program_.idle() && !rows_.active();
}

/// A received line of a program is the next one and need not be queued: usually so.
[[gnu::hot]] bool MachineConsole::begins_at_once(std::string_view line) const {
  if (lines_due() || before_jog_cancel_ || lines_at_cancel_ != 0) return false;
  return !line.starts_with('$') && !lines_are_held() && link_.room() >= answer_room + status_room;
}

/// Lines have been begun: the machine runs a program from now on.
[[gnu::hot]] void MachineConsole::begin_program() {
  const bool points = beat_locked() && runner_.queue().size() != 0;
  const bool runs = !program_.drained() || program_.shines_at_rest();
  const bool busy = reader_.line_open() || runs || points;
  if (!busy || machine_.activity() != Activity::none) return;
  const Masked masked(mask_);
  handle(Event::begin_program);
}

[[gnu::hot]] void MachineConsole::work_lines() {
  if (machine_.homes()) return work_homing();
  for (int i = 0; i < max_lines_at_once && !machine_.homes(); ++i) {
    if (reader_.line_open() && !finish_line()) break;
    if (lines_are_held()) break;
    if (run_start_up_line()) continue;
    if (start_up_next_ < start_up_lines && start_up_waits()) break;
    if (!reader_.lines_wait()) break;
    const std::size_t answer_size = reader_.front() == '$' ? list_room : answer_room;
    if (link_.room() < answer_size + status_room) break;
    std::array<char, wire::max_line> room;
    const std::string_view line = reader_.take_line(room);
    begin_line(line.starts_with('$') ? plain_system_line(std::span(room).first(line.size()))
                                     : line);
    if (lines_at_cancel_ != 0) --lines_at_cancel_;
  }
  if (!reader_.lines_wait()) lines_at_cancel_ = 0;
  begin_program();
}

/// Continues the open line; false if it waits.
[[gnu::hot]] bool MachineConsole::finish_line() {
  using Step = ProgramReader::Step;
  for (;;) {
    switch (reader_.step(values_, work_space_, now_, machine_.checks())) {
      case Step::nothing:
        return true;
      case Step::waits:
        return false;
      case Step::done:
        if (!own_line_) {
          if (new_start_up_ != start_up_lines) keep_new_start_up_line();
          answer(GcodeError::none);
        }
        own_line_ = false;
        return true;
      case Step::outside:
        leave_work_space();
        return true;
      case Step::pauses:
        pause();
        return false;
      case Step::changes:
        if (!change_over(reader_.wanted_lock())) return false;
        break;
      case Step::returns:
        return_from_tool_change();
        break;
      case Step::probes:
        if (!work_probe()) return false;
        break;
      case Step::inputs:
        if (!work_input_wait()) return false;
        break;
      case Step::ended:
        report_end();
        break;
      case Step::lights: {
        const Masked masked(mask_);
        program_.shine_at_rest(reader_.light_power(values_), reader_.max_light_power(values_),
                               reader_.light_ticks(values_));
        break;
      }
      case Step::overrides: {
        const Masked masked(mask_);
        use_overrides();
        break;
      }
    }
  }
}

/// The alarm comes before the answer, as in grbl.
void MachineConsole::leave_work_space() {
  const bool answers = !own_line_;
  own_line_ = false;
  if (!machine_.checks()) {
    const Masked masked(mask_);
    raise_alarm(alarm_soft_limit);
  }
  if (answers) answer(GcodeError::bad_target);
}

/// M2 and M30: switches off everything that the program has switched.
void MachineConsole::report_end() {
  report_message("Pgm End");
  end_overrides_of_program();
  const Masked masked(mask_);
  outputs_off();
}

[[gnu::hot]] void MachineConsole::begin_line(std::string_view line) {
  new_start_up_ = start_up_lines;
  if (line.empty()) return answer(GcodeError::none);
  if (line == lost_line) {
    answer(GcodeError::line_too_long);
    return stop_after(GcodeError::line_too_long);
  }
  const bool starts_up = line.starts_with("$N") && line.size() > 2;
  if (line.front() == '$' && !starts_up && !line.starts_with("$J="))
    return answer_system_command(line);
  const GcodeError error = starts_up             ? keep_start_up_line(line)
                           : line.front() == '$' ? begin_jog(line.substr(3))
                                                 : begin_program_line(line);
  if (reader_.has_ignored()) report_about(line);
  if (error == GcodeError::none && reader_.line_open()) {
    finish_line();
    return;
  }
  answer(error);
  if (line.front() != '$') stop_after(error);
}

/// Messages of the line; words without effect, each once in a program.
void MachineConsole::report_about(std::string_view line) {
  const unsigned words = reader_.take_ignored();
  if ((words & program::message_bit) != 0)
    for (TextLine text; reader_.take_message(line, text); text = {}) report_message(text.view());
  if ((words & ~unsigned{program::message_bit}) == 0) return;
  TextLine text;
  text.add("No effect:");
  for (std::size_t i = 0; i < std::size(program::ignored_words); ++i)
    if ((words >> i & 1u) != 0) text.add(" ").add(program::ignored_words[i]);
  report_message(text.view());
}

/// A line of a program was refused: with $981 no other is accepted; accepted lines run to their
/// end.
void MachineConsole::stop_after(GcodeError error) {
  const bool of_line = error != GcodeError::none && error != GcodeError::locked &&
                       error != GcodeError::not_idle && error != GcodeError::door_open;
  if (!of_line || machine_.checks() || reader_.awaits_tool() ||
      values_.whole(settings::Id::stop_at_error) == 0)
    return;
  refuse_lines(Refusal::until_unlocked, stopped_at_error);
}

}  // namespace lamplock::machine
