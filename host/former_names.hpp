// Former names of settings and options: they still work, with one line of note each.
//
// In:  a name as a user wrote it. Out: the present name; the note on stderr.
// Who: readers of profiles and settings (settings by name), the parser of the command line
// (options).
//
// A name stays in the table for two releases. Settings that exist once per axis are listed without
// the suffix of the axis.
#pragma once

#include <array>
#include <string_view>

namespace lamplock {

struct FormerName {
  std::string_view former, present;
};

/// The one table; names of options begin with "--".
inline constexpr std::array former_names{
    FormerName{"highest_speed", "max_spindle_speed"},
    FormerName{"--go-on", "--ignore-errors"},
    FormerName{"--most", "--max-problems"},
};

/// The present name of a former one; any other name as it is.
std::string_view present_name(std::string_view name);

/// Prints "note: WHERE: 'FORMER' is now named 'PRESENT'"; the same note once only.
void note_former_name(std::string_view where, std::string_view former);

}  // namespace lamplock
