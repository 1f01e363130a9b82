#include "host/cli/console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/interrupt.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/line_editor.hpp"
#include "host/cli/live_line.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/standard_streams.hpp"
#include "host/cli/wrapped_text.hpp"
#include "host/duration_text.hpp"
#include "host/printable.hpp"

namespace lamplock::cli {
namespace {

/// Prints text that ends with a line end, above what is shown at the bottom of the terminal.
void print(std::FILE* out, const std::string& text) {
  LineEditor* const editor = LineEditor::shown();
  if (editor != nullptr && ::isatty(::fileno(out)) == 1) return editor->print(text);
  LiveLine::print(out, text);
}

}  // namespace

void Console::line(const std::string& text) {
  print(out_, wrapped_for(out_, printable(text)) + '\n');
}

void Console::text(const std::string& text) { print(out_, text); }

void Console::require_output() { cli::require_output(); }

void Console::phase(const std::string& name, const std::string& what) {
  const std::chrono::duration<double> taken = Clock::now() - phase_start_;
  say("{:<8} {} ({})", name, what, duration_text(taken.count()));
  restart_clock();
}

void Console::notice(const std::string& text) {
  print(stderr, wrapped_for(stderr, printable(text)) + '\n');
}

std::unique_ptr<run::Progress> Console::progress(std::string title, std::size_t total,
                                                 std::size_t first) {
  return std::make_unique<ProgressBar>(std::move(title), total, first);
}

std::unique_ptr<run::Interrupts> Console::interrupts() { return std::make_unique<Interrupt>(); }

std::unique_ptr<run::LineInput> Console::line_input() {
  return std::make_unique<Keyboard>(Keyboard::Beside::progress);
}

std::unique_ptr<run::LineInput> Console::dialogue_input() {
  if (out_ == stdout && LineEditor::can_edit()) return std::make_unique<LineEditor>();
  return std::make_unique<Keyboard>(Keyboard::Beside::nothing);
}

bool Console::can_ask() const { return ::isatty(STDIN_FILENO) == 1; }

bool Console::confirms(const std::string& question) {
  write_text(stderr, question);
  std::string answer;
  return std::getline(std::cin, answer) && answer == "yes";
}

void Console::document(const Json& json) {
  if (!json_) return;
  // A file name need not be valid UTF-8.
  write_text(stdout, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace lamplock::cli
