#include "host/program/start_tool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace lamplock::program_run {

StartTool::StartTool(const std::optional<BoardState>& state, const program::Parameters& parameters)
    : parameters_(parameters), knows_selected_(state.has_value()) {
  if (!state) return;
  loaded_ = state->loaded_tool;
  length_of_board_e7_ = state->parameters.tool_length_e7;
}

bool StartTool::pass(const std::vector<ProgramWord>& words, const program::Modal& after) {
  for (const ProgramWord& word : words) {
    const bool changes = word.is('M', 6), sets = word.is('M', 61);
    if (word.letter == 'T' || sets) knows_selected_ = selects_ = true;
    if (sets) loading_ = Loading::set;
    if (!changes) continue;
    loading_ = Loading::change;
    changes_after_length_ = !lengths_.empty();
  }
  return note_length(words, after);
}

bool StartTool::note_length(const std::vector<ProgramWord>& words, const program::Modal& after) {
  const auto has = [&words](double code) {
    return std::ranges::any_of(words, [code](const auto& word) { return word.is('G', code); });
  };
  const bool of_tool = has(43), adds = has(43.2), of_word = has(43.1), ends = has(49);
  if (!of_tool && !adds && !of_word && !ends) return true;
  if (!adds) {
    lengths_.clear();
    changes_after_length_ = false;
  }
  if (ends) {
    lengths_.emplace_back("G49");
  } else if (of_word) {
    lengths_.push_back(fmt::format(
        "G43.1 Z{:.7f}",
        static_cast<double>(parameters_.tool_length_e7) / static_cast<double>(program::one_e7)));
  } else {
    double tool = after.loaded_tool;
    for (const ProgramWord& word : words) {
      if (word.letter != 'H') continue;
      if (!word.number()) return false;
      tool = *word.number();
    }
    lengths_.push_back(fmt::format("{} H{:.0f}", adds ? "G43.2" : "G43", tool));
  }
  return true;
}

bool StartTool::has_length_of_operator(const program::Modal& at_end) const {
  if (!changes_after_length_) return false;
  // `$#` has three decimals.
  constexpr std::int64_t resolution_e7 = program::one_e7 / 1000;
  const std::int64_t length_e7 = at_end.tool_length ? parameters_.tool_length_e7 : 0;
  return !length_of_board_e7_ || std::abs(*length_of_board_e7_ - length_e7) > resolution_e7;
}

void StartTool::add_lines(std::vector<std::string>& lines, const program::Modal& at_end) const {
  const std::uint32_t loaded = at_end.loaded_tool;
  bool is_selected = false;
  if (loading_ == Loading::set) {
    lines.push_back(fmt::format("M61 Q{}", loaded));
    is_selected = at_end.tool == loaded;
  } else if (loading_ == Loading::change && loaded_ != loaded) {
    lines.push_back(knows_selected_ ? fmt::format("T{} M6", loaded) : "M6");
    is_selected = at_end.tool == loaded;
  }
  const bool uses_tool = selects_ || loading_ != Loading::none;
  if (uses_tool && knows_selected_ && !is_selected)
    lines.push_back(fmt::format("T{}", at_end.tool));
  // Otherwise the board has the length.
  if (!changes_after_length_) lines.insert(lines.end(), lengths_.begin(), lengths_.end());
}

}  // namespace lamplock::program_run
