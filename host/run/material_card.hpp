// Makes test cards for a material of the library, and takes their measured figures back.
//
// In:  a material, a laser, feeds, powers, passes, a machine; a sheet with measured figures. Out: a
//      program that the firmware's interpreter has run, and its sheet; records of the library.
// Who: `material card`, `material measure --card`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/material/card.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/material_fit.hpp"

namespace lamplock::run {

struct CardOptions : CutChoice {
  std::string kind = "depth";  ///< depth, grid, kerf
  /// Lists "30,60,120" and ranges "FROM:TO:COUNT"; empty: the feeds of the depth model's source,
  /// full power, one pass. Powers as in power_w_of(). Of passes a range may be "FROM:TO".
  std::string feeds{}, powers{}, passes{};
  std::optional<double> label_feed_mm_min{};
  std::string label_power{};
  double cell_mm = 10, pitch_mm = 5, slat_length_mm = 30;
  int slats = 10;
  bool air = false;
  std::optional<double> thickness_mm{};
  std::vector<double>
      corner_mm{};  ///< lower left; empty: the card is in the middle of the work space
  std::string output{}, sheet{};  ///< sheet empty: the name of the output with .toml
  MachineOptions machine{};
};

struct CardResult {
  std::size_t cuts = 0;
  double width_mm = 0, height_mm = 0, seconds = 0;
  std::string sheet;
};

/// Writes program and sheet, after the firmware's interpreter has run the program without an error
/// and inside the work space. Throws Error(bad_input), and then no file is written.
CardResult make_card(const CardOptions& options);

struct CardFigures {
  std::string material, laser;
  std::size_t added = 0, unchanged = 0;  ///< measurements; unchanged: stored before
  std::optional<double> kerf_mm{};       ///< stored in the setting for cuts of this thickness
};
/// Stores the figures of a sheet, all or none. `material` and `laser` of the choice, if given, must
/// be those of the sheet. Throws Error(bad_input).
CardFigures measure_card(const CutChoice& choice, const std::string& sheet);

enum class ListNumbers : std::uint8_t { any, whole };

/// Numbers of a text "30,60,90:300:4": numbers and ranges FROM:TO:COUNT, evenly spaced. Of whole
/// numbers a range FROM:TO has each of them; the numbers themselves are not checked to be whole.
/// Throws Error(bad_input), at `where`.
std::vector<double> number_list(const std::string& text, const std::string& where,
                                ListNumbers kind = ListNumbers::any);

}  // namespace lamplock::run
