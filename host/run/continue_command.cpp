#include "host/run/continue_command.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "host/shell_text.hpp"

namespace lamplock::run {
namespace {

/// Options of a begin, or of one run only.
constexpr std::array<std::string_view, 3> with_value{"--from", "--fired", "--hold-at"};
constexpr std::array<std::string_view, 2> flags{"--resume", "--discard"};

template <class List>
bool is_in(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

std::string continue_command(const std::vector<std::string>& words, const link::Continuation& rest,
                             bool is_kept) {
  if (words.empty()) return "";
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view name = std::string_view(words[i]).substr(0, words[i].find('='));
    if (is_in(flags, words[i])) continue;
    if (is_in(with_value, name)) {
      if (name == words[i]) ++i;  // its value is the next word
      continue;
    }
    kept.push_back(words[i]);
  }
  return shell_text(kept) + " " +
         (!rest.settled && is_kept ? "--resume" : link::go_on_options(rest));
}

}  // namespace lamplock::run
