// Numbers for people: no exponents, no rounding errors.
//
// In:  numbers and counts. Out: "10000", "0.25", "0"; "1 point", "2 points".
// Who: messages and summaries.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lamplock {

/// A length in mm with this number of significant digits, at least all before the point. Less than
/// a millionth, the rounding of coordinates, is 0.
std::string number_text(double value, int digits = 4);

/// "1 point", "2 points". The plural has an s, or is given.
std::string count_text(std::size_t count, std::string_view noun, std::string_view plural = {});

}  // namespace lamplock
