#include "host/run/continue_command.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace lamplock::run {
namespace {

/// Options of a begin, or of one run only.
constexpr std::array<std::string_view, 3> with_value{"--from", "--fired", "--hold-at"};
constexpr std::array<std::string_view, 2> flags{"--resume", "--discard"};

template <class List>
bool is_in(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// A word that a shell reads as it is written.
std::string quoted(const std::string& word) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::string continue_command(const std::vector<std::string>& words, const link::Continuation& rest,
                             bool is_kept) {
  if (words.empty()) return "";
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view name = std::string_view(words[i]).substr(0, words[i].find('='));
    if (is_in(flags, words[i])) continue;
    if (is_in(with_value, name)) {
      if (name == words[i]) ++i;  // its value is the next word
      continue;
    }
    text += quoted(words[i]) + " ";
  }
  return text + (!rest.settled && is_kept ? "--resume" : link::go_on_options(rest));
}

}  // namespace lamplock::run
