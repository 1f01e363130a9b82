// What a program keeps over power cuts: origins with their rotations, two places, the tool table,
// three texts.
//
// In:  the parameters of the interpreter, lines that the user has stored ($N0=, $N1=, $I=).
// Out: the same after the next start; bytes of a record in between (settings/store.hpp).
// Who: the controller owns one, the interpreter works on its parameters; the board stores it, from
//      the main loop and at rest, whenever the controller reports a change.
//
// Kept are, as in grbl, G54 to G59.3 (and, as in LinuxCNC, their rotations), G28, G30, start-up
// lines and the text of `$I`, and as in grblHAL the tool table; unlike in grbl also the tool length
// of G43 to G43.2: the tool is still there after a power cut, and Z would be off by it. It is
// active then, until G49. The shift of G92 is not kept, as in grbl. (LinuxCNC keeps G92 by
// default.)
//
// A record contains only values that are not at their default, in pieces with their kind, so that a
// later version may add some: pieces of an unknown kind or size are ignored, and so is a value that
// the interpreter would refuse. A record of another version is not read.
//
//   offset  size
//   0       1     version, 1
//   1             pieces: kind, size, so many bytes
//                 kind 0..8    origin of G54 .. G59.3    X Y Z A, 8 bytes each, 10^-7 mm
//                 kind 9, 10   place of G28, G30         the same
//                 kind 12      tool length            8 bytes, 10^-7 mm
//                 kind 16..24  rotation of G54 .. G59.3  8 bytes, 10^-7 degrees
//                 kind 32, 33  start-up line 0, 1        text
//                 kind 48      text of $I                text
//                 kind 64      tool table                8 bytes each: length along Z, nm; number,
//                                                        and diameter in 0.1 um times 256
//   little-endian
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/program/parameters.hpp"
#include "firmware/program/value.hpp"
#include "firmware/settings/record_log.hpp"

namespace lamplock::machine {

/// A stored line of text: printable ASCII.
class KeptText {
 public:
  /// Maximum length of a line in grbl.
  static constexpr std::size_t capacity = 80;

  /// False, without a change, if it is too long or has other characters.
  bool set(std::string_view text);
  std::string_view view() const { return {text_.data(), size_}; }
  friend bool operator==(const KeptText& a, const KeptText& b) { return a.same(b); }

 private:
  bool same(const KeptText& other) const;

  std::array<char, capacity> text_{};
  std::uint8_t size_ = 0;
};

inline constexpr std::size_t start_up_lines = 2;

struct PersistentState {
  /// Contains the shift for the interpreter; the shift is not kept.
  program::Parameters parameters;
  std::array<KeptText, start_up_lines> start_up;
  KeptText build_text;  ///< $I=

  /// `$RST=#`: resets origins, their rotations and the places of G28 and G30 to zero and empties
  /// the tool table; keeps texts and the tool length.
  void clear_places();
  /// The kept parts are equal.
  friend bool operator==(const PersistentState& a, const PersistentState& b) { return a.same(b); }

 private:
  bool same(const PersistentState& other) const;
};

/// Bytes of its record: settings::StoredRecord. An item is a byte.
struct PersistentStateRecord {
  using Value = PersistentState;
  static constexpr std::uint32_t pieces = program::coordinate_systems + 2;
  static constexpr std::uint32_t place_size = max_axes * sizeof(std::int64_t);
  /// Maximum length that this version writes.
  static constexpr std::uint32_t max_bytes =
      1 + pieces * (2 + place_size) + 2 + sizeof(std::int64_t) + 2 + sizeof(program::ToolTable) +
      program::coordinate_systems * (2 + sizeof(std::int64_t)) +
      (start_up_lines + 1) * (2 + KeptText::capacity);
  /// "LPTK"; as many bytes as fit into four pages.
  static constexpr settings::RecordFormat format{
      0x4b54504c, 1,
      4 * settings::flash_page - settings::RecordFormat::head - settings::RecordFormat::tail};
  static_assert(max_bytes <= format.most);

  /// Writes the record; returns the number of bytes.
  static std::uint32_t put(const PersistentState& kept, std::span<std::uint8_t> items);
  /// Applies a record; returns the number of pieces that were not understood.
  static std::uint32_t take(PersistentState& kept, std::span<const std::uint8_t> items);
};

}  // namespace lamplock::machine
