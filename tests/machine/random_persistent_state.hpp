// Random program states for tests of their storage.
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "firmware/machine/console/persistent_state.hpp"

namespace lamplock::test {

inline std::string random_text(std::mt19937_64& random, std::size_t longest) {
  std::string text(random() % (longest + 1), ' ');
  for (char& c : text) c = static_cast<char>(' ' + random() % ('~' - ' ' + 1));
  return text;
}

inline program::Place random_place(std::mt19937_64& random, std::int64_t most) {
  program::Place place;
  for (std::int64_t& value : place)
    value = std::uniform_int_distribution<std::int64_t>(-most, most)(random) >> (random() % 40);
  return place;
}

/// Some of the fields, all of them, or all at maximum length.
inline machine::PersistentState random_persistent_state(std::mt19937_64& random) {
  constexpr std::int64_t most = program::max_position_e7;
  machine::PersistentState kept;
  const auto share = random() % 4;  // of 3
  const auto some = [&] { return random() % 3 < share; };
  for (program::Place& origin : kept.parameters.systems_e7)
    if (some()) origin = random_place(random, 2 * most);
  for (std::int64_t& rotation : kept.parameters.rotations_e7)
    if (some()) rotation = random_place(random, 1'000'000'000 * program::one_e7)[2];
  if (some()) kept.parameters.home_g28_e7 = random_place(random, most);
  if (some()) kept.parameters.home_g30_e7 = random_place(random, most);
  for (machine::KeptText& text : kept.start_up)
    if (some()) text.set(random_text(random, machine::KeptText::capacity));
  if (some()) kept.build_text.set(random_text(random, machine::KeptText::capacity));
  if (some()) kept.parameters.tool_length_e7 = random_place(random, most)[2];
  for (std::uint32_t number = 1; number <= program::ToolTable::capacity; ++number) {
    using Table = program::ToolTable;
    const std::int64_t length = random_place(random, Table::max_length_e7)[2];
    const std::int64_t diameter = std::abs(random_place(random, Table::max_diameter_e7)[2]);
    if (some()) kept.parameters.tools.set(Table::Entry(number * 10, {length, diameter}));
  }
  // This field is not stored.
  kept.parameters.shift_e7 = random_place(random, most);
  return kept;
}

}  // namespace lamplock::test
