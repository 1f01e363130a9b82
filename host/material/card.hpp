// Test cards: programs that cut at many feeds, powers and passes, each with an engraved label.
//
// In:  feeds, powers, numbers of passes; the machine's work space and its S of full power.
// Out: the places of the cuts, the program. Who: `lamplock material card`.
//
//   depth  a rounded rectangle of 60 x 20 mm for each combination; the depth of its groove is
//          measured
//   grid   a small square for each combination: feeds from left to right, powers from below, a
//          block for each number of passes
//   kerf   parallel cuts that make slats; pushed together they are narrower by a kerf each
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/material/records.hpp"

namespace lamplock::material {

enum class CardKind : std::uint8_t { depth, grid, kerf };

/// One combination.
struct CardCut {
  double feed_mm_min = 0, power_w = 0;
  int passes = 1;
};

struct CardRequest {
  CardKind kind = CardKind::depth;
  std::string title{};  ///< a comment of the program
  std::vector<double> feeds_mm_min{}, powers_w{};
  std::vector<int> passes{1};
  Laser laser{};
  double full_power_s = 0;  ///< S word of full power
  double label_feed_mm_min = 0, label_power_w = 0;
  bool air = false;
  double cell_mm = 10;                         ///< grid: side of a square
  int slats = 10;                              ///< kerf
  double pitch_mm = 5, slat_length_mm = 30;    ///< kerf: distance of the cuts, their length
  double max_width_mm = 0, max_height_mm = 0;  ///< of the work space
};

/// Where a combination is cut.
struct CardPlace {
  CardCut cut;
  double x_mm = 0, y_mm = 0;  ///< lower left corner of its shape
};
struct CardLabel {
  std::string text;
  double x_mm = 0, y_mm = 0, height_mm = 0;
};
/// From the lower left corner of the card.
struct CardLayout {
  std::vector<CardPlace> places{};
  std::vector<CardLabel> labels{};
  double width_mm = 0, height_mm = 0;
};

/// More cuts on one card are a mistake.
inline constexpr std::size_t max_card_cuts = 1000;

/// Throws Error(bad_input) if the card has more cuts than max_card_cuts or does not fit the work
/// area, and for a comb of more than one combination.
CardLayout lay_out_card(const CardRequest& request);

/// The program, with the lower left corner of the card at (x_mm, y_mm). The labels come first,
/// while all parts are fixed.
std::string card_program(const CardRequest& request, const CardLayout& layout, double x_mm,
                         double y_mm);

}  // namespace lamplock::material
