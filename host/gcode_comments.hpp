// Comments of G-code, `(...)` and `;` up to the end of the line, as the board reads them. Called by
// readers and writers of programs.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "shared/line_comments.hpp"

namespace lamplock {

/// The line without its comments.
inline std::string without_comments(std::string_view line) {
  std::string text(line);
  text.resize(drop_comments(std::span(text)).size);
  return text;
}

}  // namespace lamplock
