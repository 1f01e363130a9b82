#include "host/program/flow_unit.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/program/program_error.hpp"
#include "host/program/program_words.hpp"
#include "host/program/user_command.hpp"
#include "host/text.hpp"

namespace lamplock::program_run {
namespace {

/// Joins the statements of one file.
class FlowLinker {
 public:
  explicit FlowLinker(FlowUnit& unit) : unit_(unit) {}

  void link() {
    for (std::size_t i = 0; i < unit_.statements.size(); ++i) {
      note_program_number(i);
      if (unit_.statements[i].word) link(i);
    }
    if (open_.empty()) return;
    const FlowStatement& begin = unit_.statements[open_.back()];
    refuse(begin, fmt::format("'{}' has no end", text_of(begin)),
           fmt::format("add o{} end{}", begin.word->label,
                       begin.word->flow == Flow::sub ? "sub" : name_of(begin.word->flow)));
  }

 private:
  static std::string text_of(const FlowStatement& statement) {
    return fmt::format("o{} {}", statement.word->label, name_of(statement.word->flow));
  }
  [[noreturn]] void refuse(const FlowStatement& statement, const std::string& what,
                           const std::string& remedy) const {
    throw ProgramError({unit_.file, statement.line.number}, what, remedy);
  }

  void note_program_number(std::size_t i) {
    const FlowStatement& statement = unit_.statements[i];
    if (statement.word) return;
    const auto words = words_of(statement.line.text);
    for (const ProgramWord& word : words)
      if (word.letter == 'O')
        if (const auto number = word.number())
          unit_.programs.try_emplace(fmt::format("{:.0f}", *number), i);
    const std::string_view text = trimmed(statement.line.text);
    if (text.starts_with(':'))
      if (const auto number = number_of<double>(trimmed(text.substr(1))))
        unit_.programs.try_emplace(fmt::format("{:.0f}", *number), i);
  }

  void link(std::size_t i) {
    FlowStatement& statement = unit_.statements[i];
    switch (statement.word->flow) {
      case Flow::sub:
        begin_sub(i);
        return;
      case Flow::branch:
      case Flow::do_loop:
      case Flow::repeat:
        open_.push_back(i);
        return;
      case Flow::loop:
        if (!open_.empty() && is_open(statement, Flow::do_loop)) {
          statement.word->flow = Flow::do_while;
          close(i, {Flow::do_loop});
        } else {
          open_.push_back(i);
        }
        return;
      case Flow::else_branch:
      case Flow::otherwise:
        close(i, {Flow::branch, Flow::else_branch});
        open_.push_back(i);
        return;
      case Flow::endif:
        close(i, {Flow::branch, Flow::else_branch, Flow::otherwise});
        end_branches(i);
        return;
      case Flow::endwhile:
        close(i, {Flow::loop});
        return;
      case Flow::endrepeat:
        close(i, {Flow::repeat});
        return;
      case Flow::endsub:
        close(i, {Flow::sub});
        return;
      case Flow::breaking:
      case Flow::continuing:
        statement.other = loop_of(statement);
        return;
      case Flow::returning:
        if (open_.empty() || unit_.statements[open_.front()].word->flow != Flow::sub)
          refuse(statement, "return is outside of a sub", "write it between sub and endsub");
        return;
      case Flow::call:
      case Flow::do_while:
        return;
    }
  }

  bool is_open(const FlowStatement& statement, Flow flow) const {
    const FlowWord& word = *unit_.statements[open_.back()].word;
    return word.flow == flow && word.label == statement.word->label;
  }

  void begin_sub(std::size_t i) {
    const FlowStatement& statement = unit_.statements[i];
    if (!open_.empty())
      refuse(statement, "a sub begins inside of " + text_of(unit_.statements[open_.back()]),
             "end that before it");
    if (!unit_.subs.try_emplace(statement.word->label, i).second)
      refuse(statement, fmt::format("there are two subs o{}", statement.word->label),
             "give one of them another label");
    open_.push_back(i);
  }

  void close(std::size_t i, std::initializer_list<Flow> begins) {
    FlowStatement& statement = unit_.statements[i];
    for (const Flow flow : begins)
      if (!open_.empty() && is_open(statement, flow)) {
        const std::size_t begin = open_.back();
        open_.pop_back();
        unit_.statements[begin].other = i;
        statement.other = begin;
        back_[i] = begin;
        return;
      }
    const std::string inside =
        open_.empty() ? "nothing is open" : text_of(unit_.statements[open_.back()]) + " is open";
    refuse(statement, fmt::format("'{}' has no begin here: {}", text_of(statement), inside),
           "give begin and end the same label, and end what begins inside first");
  }

  /// All branches before endif, by their links back.
  void end_branches(std::size_t endif) {
    std::size_t i = endif;
    do {
      i = back_[i];
      unit_.statements[i].end = endif;
    } while (unit_.statements[i].word->flow != Flow::branch);
  }

  std::size_t loop_of(const FlowStatement& statement) const {
    for (std::size_t k = open_.size(); k-- > 0;) {
      const FlowWord& word = *unit_.statements[open_[k]].word;
      const bool is_loop =
          word.flow == Flow::loop || word.flow == Flow::do_loop || word.flow == Flow::repeat;
      if (is_loop && word.label == statement.word->label) return open_[k];
    }
    refuse(statement,
           fmt::format("'{}' is in no loop o{}", text_of(statement), statement.word->label),
           "give it the label of the loop that it leaves or continues");
  }

  FlowUnit& unit_;
  std::vector<std::size_t> open_;            ///< begins without their end yet
  std::map<std::size_t, std::size_t> back_;  ///< of ends and of branches: their begin
};

}  // namespace

FlowUnit flow_unit_of(std::vector<link::ProgramLine> lines, const std::string& file) {
  FlowUnit unit;
  unit.file = file;
  for (link::ProgramLine& line : lines) {
    std::optional<FlowWordFault> fault;
    FlowStatement statement{std::move(line)};
    if (!statement.line.text.starts_with('$'))
      statement.word = flow_word_of(statement.line.text, fault);
    if (fault) throw ProgramError({file, statement.line.number}, fault->what, fault->remedy);
    unit.statements.push_back(std::move(statement));
  }
  FlowLinker(unit).link();
  return unit;
}

int subprogram_code(std::string_view line) {
  constexpr int call = 98, end = 99;
  if (line.find("98") == std::string_view::npos && line.find("99") == std::string_view::npos)
    return 0;
  for (const ProgramWord& word : words_of(line))
    for (const int code : {call, end})
      if (word.is('M', code)) return code;
  return 0;
}

bool has_flow(std::string_view text) {
  text = without_byte_order_mark(text);
  while (!text.empty()) {
    const std::string line = link::text_to_send(take_line(text));
    if (line.empty() || line.front() == '$') continue;
    std::optional<FlowWordFault> ignored;
    if (flow_word_of(line, ignored) || subprogram_code(line) != 0) return true;
    // The values of P and Q.
    if (line.find_first_of("#[") != std::string::npos && is_user_command(line)) return true;
  }
  return false;
}

}  // namespace lamplock::program_run
