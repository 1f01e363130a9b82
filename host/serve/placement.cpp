#include "host/serve/placement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <sstream>

#include "host/text.hpp"

namespace lamplock::serve {
namespace {

constexpr std::string_view axes = "xyz";

std::vector<std::string> parts_of(const std::string& words) {
  std::istringstream text(words);
  std::vector<std::string> parts;
  for (std::string part; text >> part;) parts.push_back(part);
  return parts;
}

std::optional<std::size_t> axis_of(const std::string& word) {
  const std::size_t axis = axes.find(word);
  if (word.size() != 1 || axis == std::string_view::npos) return std::nullopt;
  return axis;
}

/// The place of words in the order of a placement, from the end: 0 move, 1 to 3 rotate z, y, x, 4
/// scale, 5 to 7 mirror z, y, x; and what they set.
struct Step {
  int rank = 0;
  std::size_t axis = 0;
  std::vector<double> numbers{};
};

std::optional<Step> step_of(const std::string& words) {
  const std::vector<std::string> parts = parts_of(words);
  if (parts.size() < 2) return std::nullopt;
  const auto numbers = [&](std::size_t from) {
    std::vector<double> values;
    for (std::size_t i = from; i < parts.size(); ++i)
      if (const auto value = number_of<double>(parts[i])) values.push_back(*value);
    return values;
  };
  const std::optional<std::size_t> axis = axis_of(parts[1]);
  Step step;
  if (parts[0] == "move" && parts.size() == 4)
    step = {0, 0, numbers(1)};
  else if (parts[0] == "rotate" && parts.size() == 3 && axis)
    step = {3 - static_cast<int>(*axis), *axis, numbers(2)};
  else if (parts[0] == "scale" && parts.size() == 2)
    step = {4, 0, numbers(1)};
  else if (parts[0] == "mirror" && parts.size() == 2 && axis)
    return Step{7 - static_cast<int>(*axis), *axis, {}};
  if (step.numbers.empty() || step.numbers.size() != (step.rank == 0 ? 3U : 1U))
    return std::nullopt;
  return step;
}

void apply(const Step& step, Placement& placement) {
  if (step.rank == 0)
    for (std::size_t i = 0; i < 3; ++i) placement.move_mm[i] = step.numbers[i];
  else if (step.rank <= 3)
    placement.turn_deg[step.axis] = step.numbers[0];
  else if (step.rank == 4)
    placement.scale = step.numbers[0];
  else
    placement.mirror[step.axis] = true;
}

/// Not "-0".
std::string number_text(double value) {
  constexpr double unit = 1e-6;
  return fmt::format("{:.10g}", std::round(value / unit) * unit + 0.0);
}

bool is_changed(double value, double unchanged) { return std::abs(value - unchanged) >= 5e-7; }

}  // namespace

PlacedWords split_words(const std::vector<std::string>& transformations) {
  PlacedWords words;
  std::size_t end = transformations.size();
  for (int last_rank = -1; end > 0; --end) {
    const std::optional<Step> step = step_of(transformations[end - 1]);
    if (!step || step->rank <= last_rank) break;
    apply(*step, words.placement);
    last_rank = step->rank;
  }
  words.kept.assign(transformations.begin(),
                    transformations.begin() + static_cast<std::ptrdiff_t>(end));
  return words;
}

std::vector<std::string> words_of(const Placement& placement) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < 3; ++i)
    if (placement.mirror[i]) words.push_back(fmt::format("mirror {}", axes[i]));
  if (is_changed(placement.scale, 1)) words.push_back("scale " + number_text(placement.scale));
  for (std::size_t i = 0; i < 3; ++i)
    if (is_changed(placement.turn_deg[i], 0))
      words.push_back(fmt::format("rotate {} {}", axes[i], number_text(placement.turn_deg[i])));
  const auto& [x, y, z] = placement.move_mm;
  if (is_changed(x, 0) || is_changed(y, 0) || is_changed(z, 0))
    words.push_back(fmt::format("move {} {} {}", number_text(x), number_text(y), number_text(z)));
  return words;
}

}  // namespace lamplock::serve
