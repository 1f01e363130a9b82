#include "host/suggestion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "host/letter_case.hpp"

namespace lamplock {
namespace {

/// Longer lists do not help: the user reads the help instead.
constexpr std::size_t max_similar = 4;
/// One slip in so many letters, as in long words more slips are likely; one slip in any word.
constexpr std::size_t letters_per_slip = 3;
constexpr std::size_t max_slips = 3;
/// Fewer letters begin too many names.
constexpr std::size_t min_beginning = 3;
constexpr std::size_t min_near_beginning = 5;
/// Longer words are no slips of a name, and the distance takes time with the square of their size.
constexpr std::size_t max_word = 100;

char plain(char letter) { return letter == '_' ? '-' : lower_case(letter); }

/// The word without what does not count.
std::string plain(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char letter) { return plain(letter); });
  return result;
}

std::size_t slips_allowed(std::size_t letters) {
  return std::clamp<std::size_t>(letters / letters_per_slip, 1, max_slips);
}

/// The word is one slip away from the first parts of the name, without its unit.
bool is_near_beginning(const std::string& word, const std::string& name) {
  if (word.size() < min_near_beginning) return false;
  for (std::size_t end = name.find('-'); end != std::string::npos; end = name.find('-', end + 1)) {
    // The distance is at least the difference of the sizes.
    if (end + 1 < word.size() || end > word.size() + 1) continue;
    if (edit_distance(word, std::string_view(name).substr(0, end)) == 1) return true;
  }
  return false;
}

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (names.size() < max_similar && std::find(names.begin(), names.end(), name) == names.end())
    names.push_back(name);
}

}  // namespace

// Three rows of the table: a swap refers to the row before the previous one.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::array<std::vector<std::size_t>, 3> rows;
  for (auto& row : rows) row.resize(b.size() + 1);
  auto &before = rows[0], &previous = rows[1], &current = rows[2];
  std::iota(previous.begin(), previous.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      current[j] = std::min(
          {previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), previous[j] + 1, current[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], before[j - 2] + 1);
    }
    std::swap(before, previous);
    std::swap(previous, current);
  }
  return previous.back();
}

std::vector<std::string> similar_names(std::string_view word,
                                       const std::vector<std::string>& names) {
  const std::string wanted = plain(word);
  std::vector<std::string> nearest, begun, nearly_begun;
  if (wanted.empty() || wanted.size() > max_word) return nearest;
  std::size_t nearest_distance = slips_allowed(wanted.size());
  for (const std::string& name : names) {
    const std::string known = plain(name);
    if (wanted.size() >= min_beginning && known.starts_with(wanted)) add_once(begun, name);
    if (is_near_beginning(wanted, known)) add_once(nearly_begun, name);
    const auto [shorter, longer] = std::minmax({wanted.size(), known.size()});
    if (longer - shorter > nearest_distance) continue;
    const std::size_t distance = edit_distance(wanted, known);
    // A word none of whose letters is kept is another word.
    if (distance > nearest_distance || distance >= longer) continue;
    if (distance < nearest_distance) nearest.clear();
    nearest_distance = distance;
    add_once(nearest, name);
  }
  if (!nearest.empty()) return nearest;
  return begun.empty() ? nearly_begun : begun;
}

std::string question_of(const std::vector<std::string>& similar) {
  std::string text;
  for (std::size_t i = 0; i < similar.size(); ++i)
    text += fmt::format("{}'{}'", i == 0 ? "" : i + 1 < similar.size() ? ", " : " or ", similar[i]);
  return text.empty() ? "" : "did you mean " + text + "?";
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names,
                         const std::string& otherwise) {
  const std::string question = question_of(similar_names(word, names));
  return question.empty() ? otherwise : question;
}

}  // namespace lamplock
