// Proof that a program of another controller keeps a laser dark, by its words.
//
// In:  the text of a dry run or a frame. Out: an Error about the post-processor.
// Who: the use case of cutting, for programs that the interpreter does not run.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lamplock::cutting {

/// Throws Error(bad_input) with `where` and the line: for a word S with another number than 0, or
/// with what is not a number, for M3, M4 and M106 before an S0, and for outputs (M62 to M65, M67
/// and M68 without Q0). Letters of either case; comments are `(...)` and `;`.
void require_dark_words(const std::string& text, const std::string& where);

/// What a dry run refuses, for a program that the interpreter has run.
[[noreturn]] void refuse_light(const std::string& where, std::size_t number, std::string_view line);

}  // namespace lamplock::cutting
