// Suggests the names that a misspelt one is likely to mean.
//
// In:  a word as a user wrote it, the names that exist. Out: the nearest names, as a question for
//      the remedy of an error.
// Who: everything that looks up a name given by the user: commands, options, words of options,
//      settings, keys of files, boards, files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock {

/// Number of letters to insert, remove, replace or swap with their neighbour to make one word from
/// the other, no letter more than once (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The names nearest to the word, in the order of `names`: those at the minimum distance if it is a
/// slip, else those that begin with the word, else those whose first parts, `density` of
/// `density_kg_m3`, are one slip away. Capitals, leading dashes and the difference between
/// '_' and '-' do not count. At most four names, because a setting exists for up to four axes.
std::vector<std::string> similar_names(std::string_view word,
                                       const std::vector<std::string>& names);

/// "did you mean 'a', 'b' or 'c'?"; empty if there are no names.
std::string question_of(const std::vector<std::string>& similar);

/// The question about the similar names, or `otherwise` if no name is similar.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names,
                         const std::string& otherwise);

}  // namespace lamplock
