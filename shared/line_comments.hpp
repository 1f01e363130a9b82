// Comments of lines of G-code: in brackets, or after a semicolon to the end of the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lamplock {

/// A line without its comments.
struct CommentFree {
  std::size_t size = 0;
  /// Character that ends the comment in which the line has stopped; 0 = none.
  char comment_end = 0;
};

/// Removes the comments of a line in place. A bracket inside a comment begins no other one.
template <class Character>
constexpr CommentFree drop_comments(std::span<Character> line) {
  CommentFree rest;
  for (const Character c : line) {
    const char character = static_cast<char>(c);
    if (rest.comment_end != 0) {
      if (character == rest.comment_end) rest.comment_end = 0;
    } else if (character == '(') {
      rest.comment_end = ')';
    } else if (character == ';') {
      rest.comment_end = '\n';
    } else {
      line[rest.size++] = c;
    }
  }
  return rest;
}

}  // namespace lamplock
