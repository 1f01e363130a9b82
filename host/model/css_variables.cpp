#include "host/model/css_variables.hpp"

#include <algorithm>

#include "host/text.hpp"

namespace lamplock::model {
namespace {

/// More than any value of a drawing has: variables that double each other end here.
constexpr std::size_t max_characters = 20'000;
constexpr int max_depth = 32;
constexpr std::string_view call = "var(";

/// The place of the next call in any case; the size of the value if there is none.
std::size_t find_call(std::string_view value) {
  const auto equal = [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a + 32 == b); };
  const auto found = std::search(value.begin(), value.end(), call.begin(), call.end(), equal);
  return static_cast<std::size_t>(found - value.begin());
}

/// The place of the bracket that closes what begins before `from`.
std::size_t end_of_call(std::string_view value, std::size_t from) {
  int depth = 1;
  for (std::size_t at = from; at < value.size(); ++at) {
    if (value[at] == '(') ++depth;
    if (value[at] == ')' && --depth == 0) return at;
  }
  return value.size();
}

/// Appends the value to `out`; false if it has none. `budget`: characters that may still be read.
bool append(std::string_view value, const CssVariables& variables, int depth, std::size_t& budget,
            std::string& out) {
  if (depth > max_depth) return false;
  while (true) {
    if (value.size() + 1 > budget) return false;
    budget -= value.size() + 1;
    const std::size_t begin = find_call(value);
    out.append(value.substr(0, begin));
    if (begin == value.size()) return true;
    const std::size_t from = begin + call.size();
    const std::size_t end = end_of_call(value, from);
    const std::string_view inner = value.substr(from, end - from);
    const std::size_t comma = std::min(inner.find(','), inner.size());
    const auto found = variables.find(trimmed(inner.substr(0, comma)));
    const std::size_t size = out.size();
    const bool is_set =
        found != variables.end() && append(found->second, variables, depth + 1, budget, out);
    if (!is_set) {
      out.resize(size);
      if (comma == inner.size()) return false;
      if (!append(trimmed(inner.substr(comma + 1)), variables, depth + 1, budget, out))
        return false;
    }
    value.remove_prefix(std::min(end + 1, value.size()));
  }
}

}  // namespace

bool uses_variables(std::string_view value) { return find_call(value) != value.size(); }

std::optional<std::string> with_variables(std::string_view value, const CssVariables& variables,
                                          std::size_t& characters) {
  std::string out;
  std::size_t budget = max_characters;
  const bool has_value = append(value, variables, 0, budget, out);
  characters += max_characters - budget;
  if (!has_value) return std::nullopt;
  return out;
}

}  // namespace lamplock::model
