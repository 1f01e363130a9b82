#include "host/cutting/dark_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <vector>

#include "host/error.hpp"
#include "host/gcode_comments.hpp"
#include "host/letter_case.hpp"

namespace lamplock::cutting {
namespace {

bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

struct DarkWord {
  char letter = 0;
  std::optional<double> number{};  ///< empty: an expression, or a parameter
};

/// Controllers differ in what "S0 5", "S0,5" and "S1=5" mean.
std::optional<double> number_at(std::string_view text, std::size_t at) {
  const auto skip_blanks = [&] {
    while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  };
  skip_blanks();
  const bool is_negative = at < text.size() && text[at] == '-';
  if (is_negative) ++at;
  double number = 0;
  const auto [stop, error] = std::from_chars(text.data() + at, text.data() + text.size(), number,
                                             std::chars_format::fixed);
  if (error != std::errc{}) return std::nullopt;
  at = static_cast<std::size_t>(stop - text.data());
  skip_blanks();
  constexpr std::string_view continuations = "0123456789.,=+-";
  if (at < text.size() && continuations.find(text[at]) != std::string_view::npos)
    return std::nullopt;
  return is_negative ? -number : number;
}

/// Words of one letter. Text of several letters is the name of a command, or of its values.
std::vector<DarkWord> dark_words_of(std::string_view line) {
  const std::string text = in_upper_case(without_comments(line));
  std::vector<DarkWord> words;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_in_name =
        (i > 0 && is_letter(text[i - 1])) || (i + 1 < text.size() && is_letter(text[i + 1]));
    if (is_letter(text[i]) && !is_in_name) words.push_back({text[i], number_at(text, i + 1)});
  }
  return words;
}

class DarkProof {
 public:
  /// False if the line may switch the light on.
  bool is_dark(std::string_view line) {
    const std::vector<DarkWord> words = dark_words_of(line);
    bool needs_power = false, has_output = false, has_zero = false;
    for (const DarkWord& word : words) {
      if (word.letter == 'S') {
        if (word.number != 0.0) return false;
        is_power_zero_ = true;
      }
      if (word.letter == 'Q') has_zero = word.number == 0.0;
      if (word.letter != 'M') continue;
      if (!word.number) return false;
      const double code = *word.number;
      // Spindle on; the fan output of Marlin, which drives lasers.
      needs_power = needs_power || code == 3 || code == 4 || code == 106;
      // Switched outputs of LinuxCNC.
      if (code >= 62 && code <= 65) return false;
      // Its analogue outputs.
      has_output = has_output || code == 67 || code == 68;
    }
    return (!needs_power || is_power_zero_) && (!has_output || has_zero);
  }

 private:
  bool is_power_zero_ = false;
};

}  // namespace

void require_dark_words(const std::string& text, const std::string& where) {
  DarkProof proof;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    if (!proof.is_dark(line)) refuse_light(where, number, line);
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
}

void refuse_light(const std::string& where, std::size_t number, std::string_view line) {
  throw Error(Exit::bad_input, where,
              fmt::format("line {} of its program without light, '{}', may switch the light on",
                          number, line),
              "write {power} in the place of a fixed power, and no outputs that may be the light");
}

}  // namespace lamplock::cutting
