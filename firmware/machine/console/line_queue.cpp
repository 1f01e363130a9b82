#include "firmware/machine/console/line_queue.hpp"

namespace lamplock::machine {

// Decimals and leading zeros of M words are ignored.
bool LineQueue::ends_program() const {
  char comment_end = 0;
  bool in_word = false;  // in the number of an M word
  std::uint32_t number = 0;
  for (std::uint32_t i = 0; i < size_; ++i) {
    const char c = at(i);
    if (comment_end != 0) {
      if (c == comment_end || c == end_of_line) comment_end = 0;
      continue;
    }
    const bool digit = c >= '0' && c <= '9';
    if (in_word && digit && number < 100)
      number = 10 * number + static_cast<std::uint32_t>(c - '0');
    if (digit || c == ' ') continue;
    if (in_word && (number == 2 || number == 30)) return true;
    in_word = c == 'M' || c == 'm';
    number = 0;
    if (c == '(') comment_end = ')';
    if (c == ';') comment_end = end_of_line;
  }
  return false;
}

}  // namespace lamplock::machine
