#include "host/program/tool_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "firmware/program/interpreter.hpp"
#include "firmware/program/parameters.hpp"
#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"
#include "host/program/line_fault.hpp"
#include "host/program/program_words.hpp"
#include "host/text.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {
namespace {

constexpr std::string_view tool_remedy =
    "write lines like G10 L1 P2 Z38.6 R1.5, or the answer of the board to $#";

class ToolReader {
 public:
  explicit ToolReader(const std::string& file) : file_(file) {}

  void read(std::string_view text) {
    text = without_byte_order_mark(text);
    for (number_ = 1; !text.empty(); ++number_) take(trimmed(take_line(text)));
  }
  const program::ToolTable& tools() const { return parameters_.tools; }

 private:
  [[noreturn]] void refuse(const std::string& what, std::string_view remedy = tool_remedy) const {
    throw Error(Exit::bad_input, fmt::format("{}:{}", file_, number_), what, std::string(remedy));
  }

  void take(std::string_view line) {
    if (line.starts_with("[T:"))
      take_report(line);
    else if (!line.starts_with('[') && link::parse_answer(line) != 0 && !link::is_banner(line))
      take_block(link::text_to_send(line));
  }

  void take_report(std::string_view line) {
    const auto tool = parse_tool(line, false);
    if (!tool) refuse(fmt::format("'{}' is not a tool as a board reports it", line));
    if (!parameters_.tools.set(*tool))
      refuse(fmt::format("a board has room for {} tools", program::ToolTable::capacity),
             "remove tools that the program does not use");
  }

  /// G10 L1 with its unit.
  void take_block(const std::string& line) {
    if (line.find_first_not_of("% \t") == std::string::npos) return;
    if (!is_entry(line)) refuse(fmt::format("'{}' does not enter a tool", line));
    const program::Fault fault = interpreter_.run(line);
    if (!fault) return;
    const auto seen = describe_fault(line, fault, max_axes, &interpreter_);
    refuse(fmt::format("error:{} {}", static_cast<int>(fault.error), seen.text),
           seen.remedy.empty() ? tool_remedy : std::string_view(seen.remedy));
  }

  static bool is_entry(std::string_view line) {
    constexpr std::string_view letters = "NGLPZR";
    constexpr int inches = 20, millimetres = 21, absolute = 90, enter = 10;
    const auto words = words_of(line);
    return std::ranges::all_of(words, [&](const ProgramWord& word) {
      if (word.letter == 'G')
        return word.is('G', inches) || word.is('G', millimetres) || word.is('G', absolute) ||
               word.is('G', enter);
      if (word.letter == 'L') return word.is('L', 1);
      return letters.find(word.letter) != std::string_view::npos;
    });
  }

  const std::string& file_;
  std::size_t number_ = 0;
  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_{parameters_, options_};
};

}  // namespace

program::ToolTable tools_of(std::string_view text, const std::string& file) {
  ToolReader reader(file);
  reader.read(text);
  if (reader.tools().empty())
    throw Error(Exit::bad_input, file, "it has no tool", std::string(tool_remedy));
  return reader.tools();
}

}  // namespace lamplock::program_run
