// Random settings, for tests of their storage.
#pragma once

#include <cstdint>
#include <random>

#include "shared/settings_table.hpp"

namespace lamplock::test {

/// Some or all settings at random values within their ranges.
inline settings::Values random_values(std::mt19937_64& random) {
  settings::Values values;
  const bool all = random() % 8 == 0;
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    if (!all && random() % 4 != 0) continue;
    const settings::Row& row = settings::table[i];
    std::int64_t value =
        std::uniform_int_distribution<std::int64_t>(row.min_milli, row.max_milli)(random);
    if (row.whole) value -= value % 1000;
    values.set_milli(static_cast<settings::Id>(i), static_cast<std::int32_t>(value));
  }
  return values;
}

}  // namespace lamplock::test
