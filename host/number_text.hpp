// Numbers for people: the one form of the whole program, its reports and pages; no exponents, no
// rounding errors.
//
// In:  numbers and counts. Out: "1 234 567"; "10000", "0.25", "0"; "1 point", "2 points".
// Who: messages, progress, summaries; host/report/page/data.js has the same form of counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lamplock {

/// Digits in groups of three, with spaces between the groups.
std::string grouped(std::uint64_t number);

/// A length in mm with this number of significant digits, at least all before the point. Less than
/// a millionth, the rounding of coordinates, is 0.
std::string number_text(double value, int digits = 4);

/// "1 point", "2 000 points". The plural has an s, or is given.
std::string count_text(std::size_t count, std::string_view noun, std::string_view plural = {});

}  // namespace lamplock
