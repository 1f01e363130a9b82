// The powers of a line of pixels: a list of S words in one, S10:20*5:0.
//
// In:  the text after the letter S: values between colons, each with a star and its number of
//      repetitions, if more than one.
// Out: runs of pieces with one power; equal neighbours are joined.
// Who: the block parses the whole list, the interpreter takes a run at a time as moves are needed;
//      about 90 cycles a character.
//
// The colons are those of Smoothieware and its successors ("clusters", which LightBurn sends and
// whose author explains: one move with the powers of its pixels relieves the planner); the star is
// an extension, so that hundreds of pixels fit into a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "shared/gcode_words.hpp"

namespace lamplock::program {

/// Pieces of a line, in sequence, all of the same length; 0 of them after the last.
struct PowerRun {
  std::uint32_t speed_milli = 0;
  std::uint32_t pieces = 0;
};

class PowerList {
 public:
  /// Maximum per line.
  static constexpr std::uint32_t max_pieces = 0xffff;
  /// Maximum length of a line of the link (shared/wire/framing.hpp).
  static constexpr std::size_t max_characters = 256;

  PowerList() : PowerList(std::string_view{}) {}
  explicit PowerList(std::string_view text) : reader_(text) {}
  /// The next run. Errors: bad_number, negative_value, speed_out_of_range, and of a repetition
  /// not_integer, not_positive, out_of_range.
  GcodeError next(PowerRun& run);
  /// Characters of the list, after its last run.
  std::uint16_t size() const { return reader_.place(); }

 private:
  GcodeError entry(PowerRun& run);
  GcodeError repetitions(std::uint32_t& pieces);

  WordReader reader_;
  PowerRun ahead_;
  bool begun_ = false, ended_ = false;
};

}  // namespace lamplock::program
