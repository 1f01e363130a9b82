// Wraps lines for people at words.
//
// In:  a line, a number of columns.
// Out: lines that fit.
// Who: the console and the progress, for what they print on a terminal, which would break words.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace lamplock::cli {

/// Columns of a text in UTF-8, whose characters have one column each here.
std::size_t text_columns(std::string_view text);

/// The text, of one or several lines, with line ends in place of blanks where a line would have
/// more than so many columns. A line that continues another has the same indent, two columns more.
/// A longer word stays whole, and so does a line with a command of lamplock: a user may copy it.
std::string wrapped_text(std::string_view text, std::size_t columns);

/// wrapped_text() for a stream: a terminal; other streams get the text as it is.
std::string wrapped_for(std::FILE* out, std::string_view text);

}  // namespace lamplock::cli
