#include "host/run/continue_command.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "host/run/free_name.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {
namespace {

/// Options of a begin, or of one run only.
constexpr std::array<std::string_view, 3> dropped_with_value{"--from", "--fired", "--hold-at"};
/// A permission is for one run: the user gives it again.
constexpr std::array<std::string_view, 3> dropped{"--resume", "--discard", "--yes"};
/// Files that this run has written: the rest of the job must not replace them.
constexpr std::array<std::string_view, 4> files{"--shots", "--vcd", "--timing", "--plot"};

template <class List>
bool is_in(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// The value of an option for the rest of the job.
std::string value_for_rest(std::string_view option, const std::string& value) {
  if (option == "--report") return next_free_folder(value);
  return is_in(files, option) ? next_free_name(value) : value;
}

}  // namespace

std::string continue_command(const std::vector<std::string>& words, const link::Continuation& rest,
                             bool is_kept) {
  if (words.empty()) return "";
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    const bool has_value = equals != std::string::npos;
    if (is_in(dropped, words[i])) continue;
    if (is_in(dropped_with_value, name)) {
      if (!has_value) ++i;  // its value is the next word
    } else if (name != "--report" && !is_in(files, name)) {
      kept.push_back(words[i]);
    } else if (has_value) {
      kept.push_back(name + "=" + value_for_rest(name, words[i].substr(equals + 1)));
    } else {
      kept.push_back(name);
      if (++i < words.size()) kept.push_back(value_for_rest(name, words[i]));
    }
  }
  return shell_text(kept) + " " +
         (!rest.settled && is_kept ? "--resume" : link::continuation_options(rest));
}

}  // namespace lamplock::run
