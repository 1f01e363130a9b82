#include "host/program/program_flow.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "firmware/program/decimal.hpp"
#include "host/program/flow_files.hpp"
#include "host/program/flow_place.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/flow_values.hpp"
#include "host/program/loaded_tool.hpp"
#include "host/program/program_words.hpp"
#include "host/program/saved_modes.hpp"
#include "host/program/subprogram_call.hpp"
#include "host/units.hpp"

namespace lamplock::program_run {
namespace {

/// A repeat that is under way.
struct Repeat {
  std::size_t begin = 0;
  std::int64_t left = 0;
};

/// What continues after a call.
struct FlowCall {
  const FlowUnit* unit = nullptr;
  std::size_t next = 0;
  std::vector<Repeat> repeats{};
  std::optional<FlowValues::Locals> locals{};  ///< of a sub
  std::size_t program = 0;                     ///< of M98: its begin
  std::int64_t left = 0;                       ///< its further runs
  std::optional<program::Modal> modes{};       ///< of M73, for its end
};

class FlowRun {
 public:
  FlowRun(std::vector<link::ProgramLine> lines, const std::string& file,
          const settings::Values& values, const std::optional<BoardState>& state,
          const ProcessValues* process)
      : main_(flow_unit_of(std::move(lines), file)),
        unit_(&main_),
        values_(values, state ? &*state : nullptr),
        process_{process, in_units(values, settings::Id::max_spindle_speed)} {}

  std::vector<link::ProgramLine> run() {
    while (!values_.has_ended()) {
      if (next_ == unit_->statements.size()) {
        if (calls_.empty()) break;
        end_of_file();
        continue;
      }
      at_ = next_++;
      if (++steps_ > max_flow_steps)
        refuse(fmt::format("the program has executed {} statements in a row without a line for the "
                           "machine, the limit of the host",
                           max_flow_steps),
               "check that its loops end, or divide the program");
      const auto& logs = statement().line.logs;
      logs_.insert(logs_.end(), logs.begin(), logs.end());
      if (statement().word) {
        take_messages();
        execute(*statement().word);
      } else {
        plain(statement().line.text);
      }
    }
    // Those after M2 are never executed.
    if (!messages_.empty() && !values_.has_ended())
      lines_.push_back({line_number(), {}, std::exchange(messages_, {})});
    return link::separate_messages(std::move(lines_));
  }

 private:
  const FlowStatement& statement() const { return unit_->statements[at_]; }

  FlowPlace here() const { return {*unit_, at_, line_number()}; }
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const {
    here().refuse(what, remedy);
  }
  /// As FlowPlace::refuse_fault().
  void refuse_fault(std::string_view text, const program::Fault& fault,
                    std::optional<std::size_t> index = {}) const {
    here().refuse_fault(text, fault, values_.interpreter(), index);
  }

  /// The line of the program that was read, not of a file that it calls.
  std::size_t line_number() const {
    return calls_.empty() || unit_ == &main_ ? statement().line.number : called_at_;
  }

  void take_messages() {
    messages_ += values_.messages(here().messages_with(process_, values_.inches()));
  }

  /// For a text that reads what only the running machine knows.
  void refuse_unknown(std::string_view text) {
    here().refuse_results(text);
    if (const std::string use = values_.unknown_tool(text); !use.empty())
      refuse(fmt::format("{} needs the tool in the spindle, which the board does not report", use),
             std::string(unknown_tool_remedy));
  }

  void plain(const std::string& source) {
    if (source.starts_with('$')) return emit(source);
    const std::string text = here().line_with(process_, values_.inches());
    refuse_unknown(text);
    const int code = subprogram_code(text);
    if (code == 98) return call_program(text);
    if (code == 99) return end_program(text);
    run_block(text);
  }

  void run_block(std::string text) {
    constexpr int save_and_restore = 73;
    const std::string rest = without_code(text, 'M', save_and_restore);
    if (rest.size() < trimmed(text).size() && !calls_.empty()) {
      calls_.back().modes = values_.modal();
      text = rest;
    }
    std::string with_numbers;
    refuse_fault(text, values_.run(text, with_numbers));
    if (!is_restoring_) take_messages();
    if (!with_numbers.empty()) emit(with_numbers);
  }

  /// The modes of M73, at the end of its sub or program.
  void restore_modes() {
    if (calls_.empty() || !calls_.back().modes) return;
    const program::Modal saved = *std::exchange(calls_.back().modes, {});
    if (const std::string lost = lost_modes(saved, values_.modal()); !lost.empty())
      refuse(fmt::format("M73 does not restore {} at the end of a sub", lost),
             "restore it before the end");
    is_restoring_ = true;
    for (const std::string& line : lines_to_restore(saved, values_.modal())) run_block(line);
    is_restoring_ = false;
  }

  void emit(const std::string& text) {
    if (lines_.size() == max_flow_lines)
      refuse(fmt::format("the program has more than {} lines", max_flow_lines),
             "check the conditions of its loops");
    lines_.push_back(
        {line_number(), text, std::exchange(messages_, {}), {}, std::exchange(logs_, {})});
    if (unit_ != &main_) lines_.back().origin = text_of(here().place());
    const link::ProgramLine& read = statement().line;
    const bool is_as_read = unit_ == &main_ && text == read.text && read.source.empty();
    if (!is_restoring_ && !is_as_read)
      lines_.back().source = read.source.empty() ? read.text : read.source;
    steps_ = 0;
  }

  // --- values ---------------------------------------------------------------------------------

  std::vector<std::int64_t> arguments(const FlowWord& word) {
    const std::string text =
        here().value_with(process_, values_.inches(), word.arguments, word.arguments_at);
    refuse_unknown(text);
    std::vector<std::int64_t> values;
    for (std::uint16_t index = 0; index < text.size();) {
      std::int64_t e9 = 0;
      if (text[index] != '[') refuse("a value is not in square brackets", "write [value]");
      refuse_fault(text, values_.value(text, index, e9), word.arguments_at);
      values.push_back(e9);
    }
    return values;
  }
  std::int64_t argument(const FlowWord& word) {
    const auto values = arguments(word);
    if (values.size() != 1)
      refuse(fmt::format("{} has {} values", name_of(word.flow), values.size()),
             "write one value in square brackets after it");
    return values.front();
  }
  bool condition(std::size_t i) {
    at_ = i;
    return argument(*statement().word) != 0;
  }
  void no_arguments(const FlowWord& word) const {
    if (!word.arguments.empty())
      refuse(fmt::format("{} has no value", name_of(word.flow)), "remove what follows it");
  }
  static std::int64_t rounded(std::int64_t e9) {
    return (e9 + program::one_e9 / 2) / program::one_e9;
  }

  // --- O-words --------------------------------------------------------------------------------

  void execute(const FlowWord& word) {
    const FlowStatement& now = statement();
    switch (word.flow) {
      case Flow::sub:
        next_ = now.other + 1;
        return;
      case Flow::call:
        return call(word);
      case Flow::endsub:
      case Flow::returning:
        return leave(word);
      case Flow::branch:
        return branch();
      case Flow::else_branch:
      case Flow::otherwise:
        next_ = now.end + 1;
        return;
      case Flow::loop:
        if (!condition(at_)) next_ = now.other + 1;
        return;
      case Flow::endwhile:
        no_arguments(word);
        next_ = now.other;
        return;
      case Flow::do_while:
        if (condition(at_)) next_ = now.other + 1;
        return;
      case Flow::repeat:
        return begin_repeat(word);
      case Flow::endrepeat:
        no_arguments(word);
        return end_repeat(now.other);
      case Flow::breaking:
        no_arguments(word);
        leave_repeats(now.other, true);
        next_ = unit_->statements[now.other].other + 1;
        return;
      case Flow::continuing:
        return continue_loop(word, now.other);
      case Flow::do_loop:
      case Flow::endif:
        no_arguments(word);
        return;
    }
  }

  void branch() {
    for (std::size_t i = at_;;) {
      const FlowStatement& one = unit_->statements[i];
      const Flow flow = one.word->flow;
      const bool is_condition = flow == Flow::branch || flow == Flow::else_branch;
      next_ = i + 1;
      if (!is_condition || condition(i)) return;
      i = one.other;
    }
  }

  void begin_repeat(const FlowWord& word) {
    const std::int64_t count = rounded(argument(word));
    if (count <= 0)
      next_ = statement().other + 1;
    else
      repeats_.push_back({at_, count});
  }
  void end_repeat(std::size_t begin) {
    if (repeats_.empty() || repeats_.back().begin != begin) return;
    if (--repeats_.back().left > 0)
      next_ = begin + 1;
    else
      repeats_.pop_back();
  }
  void leave_repeats(std::size_t loop, bool itself) {
    while (!repeats_.empty() &&
           (repeats_.back().begin > loop || (itself && repeats_.back().begin == loop)))
      repeats_.pop_back();
  }
  void continue_loop(const FlowWord& word, std::size_t loop) {
    no_arguments(word);
    leave_repeats(loop, false);
    const bool is_while = unit_->statements[loop].word->flow == Flow::loop;
    next_ = is_while ? loop : unit_->statements[loop].other;
  }

  // --- calls ----------------------------------------------------------------------------------

  void push(FlowCall call) {
    if (calls_.size() == max_calls)
      refuse(fmt::format("calls are nested more than {} deep", max_calls),
             "check that the sub does not call itself without end");
    if (unit_ == &main_) called_at_ = statement().line.number;
    call.unit = unit_;
    call.next = next_;
    call.repeats = std::exchange(repeats_, {});
    calls_.push_back(std::move(call));
  }
  void pop() {
    FlowCall call = std::move(calls_.back());
    calls_.pop_back();
    if (call.locals) values_.leave(*call.locals);
    unit_ = call.unit;
    next_ = call.next;
    repeats_ = std::move(call.repeats);
  }

  std::string label_of(const FlowWord& word) {
    if (word.label.front() != '#' && word.label.front() != '[') return word.label;
    std::int64_t e9 = 0;
    std::uint16_t index = 0;
    refuse_fault(word.label, values_.value(word.label, index, e9), word.label_at);
    return fmt::format("{}", rounded(e9));
  }

  void call(const FlowWord& word) {
    const std::string label = label_of(word);
    std::vector<std::int64_t> values = arguments(word);
    if (values.size() > max_arguments)
      refuse(fmt::format("the call has {} values", values.size()),
             fmt::format("give at most {}", max_arguments));
    const FlowPlace place = here();
    const FlowUnit* unit =
        place.with_line([&] { return files_.with_sub(label, *unit_, place.place()); });
    push({});
    calls_.back().locals = values_.enter(values);
    values_.set("_value", 0);
    values_.set("_value_returned", 0);
    unit_ = unit;
    next_ = unit->subs.at(label) + 1;
  }

  void leave(const FlowWord& word) {
    if (calls_.empty() || !calls_.back().locals)
      refuse("the sub was not called", "write subs before or after the lines that are executed");
    const auto values = arguments(word);
    if (values.size() > 1) refuse("more than one value is returned", "return one value");
    restore_modes();
    pop();
    if (values.empty()) return;
    values_.set("_value", values.front());
    values_.set("_value_returned", program::one_e9);
  }

  // --- M98, M99 -------------------------------------------------------------------------------

  void call_program(const std::string& text) {
    std::string with_numbers;
    refuse_fault(text, values_.run(text, with_numbers));
    take_messages();
    const SubprogramCall call = subprogram_call_of(with_numbers, *unit_, here());
    if (call.runs <= 0) return;
    push({.program = call.first, .left = call.runs - 1});
    next_ = call.first;
  }

  /// The other words of its line act before it.
  void end_program(const std::string& text) {
    if (calls_.empty() || calls_.back().locals)
      refuse("M99 ends no program: none was called", "write M30 at the end of the main program");
    const std::string rest = without_code(text, 'M', 99);
    for (const ProgramWord& word : words_of(rest))
      if (word.letter == 'P' || word.letter == 'L')
        refuse(
            fmt::format("M99 {} is not supported: it would continue elsewhere", trimmed(word.text)),
            "write M99 alone; O-words have loops and branches");
    run_block(rest);
    restore_modes();
    repeats_.clear();
    if (calls_.back().left-- > 0)
      next_ = calls_.back().program;
    else
      pop();
  }

  void end_of_file() {
    at_ = unit_->statements.size() - 1;
    refuse("the program that M98 called has no end", "add M99");
  }

  FlowUnit main_;
  FlowFiles files_{main_};
  const FlowUnit* unit_;
  FlowValues values_;
  FlowProcess process_;
  std::size_t at_ = 0, next_ = 0, steps_ = 0, called_at_ = 0;
  bool is_restoring_ = false;  ///< the lines of the host for M73, not of the file
  std::vector<Repeat> repeats_;
  std::vector<FlowCall> calls_;
  std::vector<std::string> logs_;  ///< ProgramLine::logs of the next line
  std::string messages_;           ///< for the next line
  std::vector<link::ProgramLine> lines_;
};

}  // namespace

std::vector<link::ProgramLine> run_flow(std::vector<link::ProgramLine> lines,
                                        const std::string& file, const settings::Values& values,
                                        const std::optional<BoardState>& state,
                                        const ProcessValues* process) {
  return FlowRun(std::move(lines), file, values, state, process).run();
}

}  // namespace lamplock::program_run
