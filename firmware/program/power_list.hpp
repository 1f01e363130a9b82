// The powers of a line of pixels: a list of S words in one, S10:20*5:0.
//
// In:  what stands behind the letter S: values between colons, each with a star and how often it
//      comes, if that is more than once.
// Out: runs of pieces with one power, neighbours that are alike put together.
// Who: the block that reads a line looks through all of it, the interpreter takes a run at a time
//      as moves are wanted; about 90 cycles a character.
//
// The colons are those of Smoothieware and what follows it ("clusters", which LightBurn sends and
// which its author explains: one move with the powers of its pixels spares the planner the rest);
// the star is ours, so that hundreds of pixels fit into a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/program/words.hpp"

namespace lamplock::program {

/// Pieces of a line, one after the other, all of the same length; 0 of them behind the last.
struct PowerRun {
  std::uint32_t speed_milli = 0;
  std::uint32_t pieces = 0;
};

class PowerList {
 public:
  /// In one line.
  static constexpr std::uint32_t most_pieces = 0xffff;
  /// No line of the link is longer (shared/wire/framing.hpp).
  static constexpr std::size_t most_characters = 256;

  PowerList() : PowerList(std::string_view{}) {}
  explicit PowerList(std::string_view text) : reader_(text) {}
  /// The next run. Errors: bad_number, negative_value, speed_out_of_range, and of a repetition
  /// not_integer, not_positive, out_of_range.
  GcodeError next(PowerRun& run);
  /// Characters of the list; behind its last run.
  std::uint16_t size() const { return reader_.place(); }

 private:
  GcodeError entry(PowerRun& run);
  GcodeError repetitions(std::uint32_t& pieces);

  WordReader reader_;
  PowerRun ahead_;
  bool begun_ = false, ended_ = false;
};

}  // namespace lamplock::program
