// The sheet of a test card: a file (TOML) in which users write what they measured.
//
// In:  the cuts of a card; a sheet with measured figures. Out: the text of an empty sheet; the
//      measurements, or the kerf. Who: `material card`, `material measure --card`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/material/card.hpp"
#include "host/material/records.hpp"

namespace lamplock::material {

struct CardSheet {
  std::string material{}, laser{};
  std::optional<double> thickness_mm{};
  /// Cuts with a measured depth or a result; in the sheet of a new card all of them, without.
  std::vector<Measurement> cuts{};
  std::optional<Setting> kerf{};  ///< of a comb: the cut with its kerf
};

/// The empty sheet of a card: depths and results are 0 and "".
std::string sheet_text(const CardRequest& request, const CardLayout& layout, const CardSheet& sheet,
                       const std::string& program);

/// Reads a sheet. Throws Error(bad_input) at FILE:LINE: wrong syntax or keys, values out of range,
/// a comb whose slats together are not narrower than without kerf, and no measured figure at all.
CardSheet read_sheet(const std::filesystem::path& file);

/// True for a sheet without a measured figure, which a new one may replace.
bool is_unused_sheet(const std::filesystem::path& file);

}  // namespace lamplock::material
