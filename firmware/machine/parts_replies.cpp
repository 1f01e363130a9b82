// Answers and messages to the host.
#include "firmware/machine/parts.hpp"

namespace lamplock::machine {
namespace {

constexpr std::string_view ok_line = "ok\r\n";

}  // namespace

void MachineParts::report_message(std::string_view text) {
  TextLine line;
  line.add("[MSG:").add(text).add("]\r\n");
  link_.send_text(line.view());
}

[[gnu::hot]] void MachineParts::answer(GcodeError error) {
  if (error == GcodeError::none) {
    link_.send_text(ok_line);
    return;
  }
  TextLine text;
  text.add("error:").add(std::int64_t{static_cast<int>(error)}).add("\r\n");
  link_.send_text(text.view());
}

void MachineParts::send_banner() { link_.send_text("\r\nGrbl 1.1h ['$' for help]\r\n"); }

/// What a terminal shows after power-up and a reset.
void MachineParts::greet() {
  send_banner();
  if (machine_.state() == State::alarm) report_message(unlock_text);
  report_tool_length();
}

/// It survives a reset and power-off.
void MachineParts::report_tool_length() {
  if (!reader_.interpreter().modal().tool_length) return;
  TextLine text;
  text.add("Tool length offset ");
  add_length(text, reader_.kept().parameters.tool_length_e7, false);
  text.add(" mm is active: G49 ends it");
  report_message(text.view());
}

}  // namespace lamplock::machine
