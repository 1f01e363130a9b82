#include "host/pendant/macro.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/letter_case.hpp"
#include "host/link/program_lines.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::pendant {
namespace {

/// Length of a line, without its end, that every version of grbl 1.1 accepts.
constexpr std::size_t max_line_size = 78;

/// M codes that neither turn on or fire a laser nor switch outputs other than air (docs/gcode.md).
constexpr std::array dark_codes{0, 1, 2, 5, 7, 8, 9, 30, 60};

bool is_dark(const program::Word& word) {
  if (word.letter == 'S') return false;
  return word.letter != 'M' ||
         (word.decimals == 0 &&
          std::find(dark_codes.begin(), dark_codes.end(), word.mantissa) != dark_codes.end());
}

}  // namespace

std::string laser_word(std::string_view line) {
  program::WordReader reader(line);
  program::Word word{};
  for (;;) {
    if (reader.next(word)) return "?";
    if (word.letter == 0) return "";
    if (!is_dark(word)) return fmt::format("{}{}", word.letter, word.mantissa);
  }
}

std::string macro_line(std::string_view line, bool laser, const std::string& where) {
  std::string text = link::line_to_send(line, where);
  const std::string upper = in_upper_case(text);
  if (text.size() > max_line_size)
    throw Error(Exit::bad_input, where, "a line is too long for a board",
                fmt::format("shorten it to {} characters", max_line_size));
  if (upper.starts_with('$')) {
    const bool known =
        upper.starts_with("$J=") || upper == "$X" || (upper.starts_with("$H") && upper.size() <= 3);
    if (!known)
      throw Error(Exit::bad_input, where, fmt::format("'{}' is not valid in a macro", text),
                  "of the $ commands, macros may have $H, $X and $J=");
    return text;
  }
  if (const std::string word = laser_word(text); !laser && !word.empty())
    throw Error(Exit::bad_input, where,
                fmt::format("'{}': {} may turn on a laser or switch an output", text, word),
                "leave it out, or add laser = true to the macro");
  return text;
}

}  // namespace lamplock::pendant
