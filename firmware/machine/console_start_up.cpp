// Start-up lines ($N): kept, and run after power-up and a reset.
#include "firmware/machine/console.hpp"
#include "firmware/machine/console/program_text.hpp"

namespace lamplock::machine {

/// "$N0=line": run, and then kept.
GcodeError MachineConsole::keep_start_up_line(std::string_view line) {
  constexpr std::size_t head = 4;  // "$N0="
  const std::size_t number = static_cast<std::size_t>(line[2] - '0');
  if (line.size() < head || number >= start_up_lines || line[3] != '=')
    return GcodeError::unknown_command;
  if (!machine_.idle() || program_unfinished()) return GcodeError::not_idle;
  const std::string_view text = line.substr(head);
  if (!new_start_up_text_.set(text)) return GcodeError::text_too_long;
  const GcodeError error = text.empty() ? GcodeError::none : begin_program_line(text);
  if (error != GcodeError::none) return error;
  new_start_up_ = static_cast<std::uint8_t>(number);
  if (text.empty()) keep_new_start_up_line();
  return GcodeError::none;
}

/// The line that has run is a new start-up line.
void MachineConsole::keep_new_start_up_line() {
  reader_.kept().start_up[new_start_up_] = new_start_up_text_;
  new_start_up_ = start_up_lines;
  kept_due_ = true;
}

/// After power-up and a reset; false if no line is left, or none may run.
[[gnu::hot]] bool MachineConsole::run_start_up_line() {
  if (start_up_next_ >= start_up_lines || reader_.line_open()) return false;
  if (machine_.locked()) start_up_next_ = start_up_lines;
  if (!machine_.idle() || link_.room() < answer_room) return false;
  const std::string_view text = reader_.kept().start_up[start_up_next_++].view();
  if (text.empty()) return true;
  const GcodeError error = begin_program_line(text);
  own_line_ = error == GcodeError::none;
  TextLine line;
  write_start_up_result(line, text, static_cast<int>(error));
  link_.send_text(line.view());
  return true;
}

}  // namespace lamplock::machine
