#include "host/program/missing_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "firmware/program/modal.hpp"
#include "firmware/program/statement.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

struct NeededWord {
  char letter;  ///< of the command, G or M
  double code;
  char needed;
  std::string_view meaning;
};

constexpr std::string_view output_number = "the number of the output",
                           retract_level = "the level at which the feed begins",
                           hole_bottom = "the bottom of the hole",
                           bottom_dwell = "the dwell at the bottom in seconds",
                           peck_depth = "the depth of a peck";

/// In the order of their commands. The depth of a cycle is along the normal of its plane: Z here.
constexpr NeededWord needed_words[] = {
    {'G', 4, 'P', "the dwell in seconds"},
    {'G', 5, 'I', "the first control point in X"},
    {'G', 5, 'J', "the first control point in Y"},
    {'G', 5, 'P', "the second control point in X"},
    {'G', 5, 'Q', "the second control point in Y"},
    {'G', 5.2, 'X', "the place of the control point"},
    {'G', 5.2, 'Y', "the place of the control point"},
    {'G', 10, 'L', "what it sets: 1, 2, 10, 11 or 20"},
    {'G', 10, 'P', "the number of the coordinate system or tool"},
    {'G', 41.1, 'D', "the diameter of the cutter"},
    {'G', 42.1, 'D', "the diameter of the cutter"},
    {'G', 43.2, 'H', "the number of the tool"},
    {'G', 54.1, 'P', "the number of the coordinate system, 1 to 3"},
    {'G', 68, 'R', "the angle in degrees"},
    {'G', 73, 'R', retract_level},
    {'G', 73, 'Z', hole_bottom},
    {'G', 73, 'Q', peck_depth},
    {'G', 81, 'R', retract_level},
    {'G', 81, 'Z', hole_bottom},
    {'G', 82, 'R', retract_level},
    {'G', 82, 'Z', hole_bottom},
    {'G', 82, 'P', bottom_dwell},
    {'G', 83, 'R', retract_level},
    {'G', 83, 'Z', hole_bottom},
    {'G', 83, 'Q', peck_depth},
    {'G', 85, 'R', retract_level},
    {'G', 85, 'Z', hole_bottom},
    {'G', 86, 'R', retract_level},
    {'G', 86, 'Z', hole_bottom},
    {'G', 86, 'P', bottom_dwell},
    {'G', 89, 'R', retract_level},
    {'G', 89, 'Z', hole_bottom},
    {'G', 89, 'P', bottom_dwell},
    {'M', 61, 'Q', "the number of the tool in the spindle"},
    {'M', 62, 'P', output_number},
    {'M', 63, 'P', output_number},
    {'M', 64, 'P', output_number},
    {'M', 65, 'P', output_number},
    {'M', 66, 'P', "the number of the input"},
    {'M', 66, 'Q', "the longest wait in seconds"},
    {'M', 67, 'E', output_number},
    {'M', 67, 'Q', "the value in per cent"},
    {'M', 68, 'E', output_number},
    {'M', 68, 'Q', "the value in per cent"},
    {'M', 126, 'P', "1 for on or 0 for off"},
    {'M', 127, 'P', "pulses per unit of length"},
    {'M', 128, 'P', "the length of a pulse in microseconds"},
    {'M', 130, 'P', "0 for points along the path or 1 for free ones"},
};

struct CommandCode {
  char letter = 0;
  double code = 0;
};

class MissingWords {
 public:
  MissingWords(std::string_view line, const program::Interpreter* interpreter)
      : line_(link::text_to_send(line)),
        words_(words_of(line_)),
        state_(interpreter == nullptr ? program::State{} : interpreter->state()) {}

  /// `at`: the text from the word at fault.
  std::optional<std::string> text(std::string_view at) const {
    const CommandCode command = command_at(at);
    std::vector<std::string> missing;
    for (const NeededWord& row : needed_words) {
      if (row.letter != command.letter || row.code != command.code) continue;
      const char needed = row.needed == 'Z' ? depth_letter() : row.needed;
      if (!has(needed) && !is_optional(row) && !is_kept(row)) missing.push_back(word_text(row));
    }
    if (missing.empty()) return std::nullopt;
    return fmt::format("'{}{}' needs {}", command.letter, command.code,
                       fmt::join(missing, " and "));
  }

 private:
  bool has(char letter) const {
    return std::ranges::any_of(words_, [&](const ProgramWord& w) { return w.letter == letter; });
  }
  bool has(char letter, double code) const {
    return std::ranges::any_of(words_, [&](const ProgramWord& w) { return w.is(letter, code); });
  }

  static const NeededWord* row_of(const ProgramWord& word) {
    const auto* const row = std::ranges::find_if(
        needed_words, [&](const NeededWord& one) { return word.is(one.letter, one.code); });
    return row == std::end(needed_words) ? nullptr : row;
  }

  /// The command at fault; a modal one if the fault is at another word.
  CommandCode command_at(std::string_view at) const {
    const std::string text = link::text_to_send(at);
    const auto first = words_of(text);
    if (!first.empty())
      if (const NeededWord* row = row_of(first.front())) return {row->letter, row->code};
    constexpr double nurbs = 5.2, tenths = 10;
    if (state_.nurbs.count != 0 || has('G', nurbs)) return {'G', nurbs};
    return {'G', static_cast<int>(state_.modal.motion) / tenths};
  }

  program::Plane plane() const {
    if (has('G', 17)) return program::Plane::xy;
    if (has('G', 18)) return program::Plane::zx;
    return has('G', 19) ? program::Plane::yz : state_.modal.plane;
  }
  char depth_letter() const { return axis_letters[program::axes_of(plane()).normal]; }

  std::string word_text(const NeededWord& row) const {
    constexpr std::string_view letters_with_an = "AEFHILMNORSX";
    const char letter = row.needed == 'Z' ? depth_letter() : row.needed;
    const bool is_with_an = letters_with_an.find(letter) != std::string_view::npos;
    return fmt::format("{} {} word ({})", is_with_an ? "an" : "a", letter, row.meaning);
  }

  /// A spline without I and J continues the previous one; M66 waits with an L other than 0 only.
  bool is_optional(const NeededWord& row) const {
    if (row.letter == 'G' && row.code == 5 && (row.needed == 'I' || row.needed == 'J'))
      return !has('I') && !has('J');
    return row.letter == 'M' && row.code == 66 && row.needed == 'Q' && (!has('L') || has('L', 0));
  }

  /// A cycle keeps its words until another one begins.
  bool is_kept(const NeededWord& row) const {
    constexpr double tenths = 10;
    if (row.letter != 'G' || !program::is_cycle(state_.modal.motion) ||
        row.code * tenths != static_cast<int>(state_.modal.motion))
      return false;
    const program::CycleWords& words = state_.cycle;
    switch (row.needed) {
      case 'R':
        return words.has_retract;
      case 'Z':
        return words.has_depth;
      case 'P':
        return words.has_dwell;
      default:
        return words.has_peck;
    }
  }

  std::string line_;
  std::vector<ProgramWord> words_;
  program::State state_;
};

}  // namespace

std::optional<std::string> missing_words(std::string_view line, std::size_t column,
                                         const program::Interpreter* interpreter) {
  return MissingWords(line, interpreter).text(line.substr(column - 1));
}

}  // namespace lamplock::program_run
