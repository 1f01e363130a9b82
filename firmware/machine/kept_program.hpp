// What a program leaves behind over power cuts: origins, two places, three texts.
//
// In:  the parameters of the interpreter, lines that the user has stored ($N0=, $N1=, $I=).
// Out: the same after the next start; bytes of a record in between (settings/store.hpp).
// Who: the controller owns one, the interpreter works on its parameters; the board stores it, from
//      the main loop and at rest, whenever the controller says that something has changed.
//
// Kept is what grbl keeps: G54 to G59.3, G28, G30, start-up lines and the text of `$I`; and, other
// than in grbl, the tool length of G43.1: the tool is still there when the power comes back, and
// Z would be off by it. It is in force then, until G49. The shift of G92 is not, as in grbl: it
// holds until the power goes. (LinuxCNC keeps G92 unless told otherwise.)
//
// In a record only what is not at its default takes room, and each piece says what it is, so that a
// later version may add some: pieces of an unknown kind or size are passed over, a value that no
// interpreter would have taken counts as none. A record of another version is none.
//
//   offset  size
//   0       1     version, 1
//   1             pieces: kind, size, so many bytes
//                 kind 0..8    origin of G54 .. G59.3    X Y Z A, 8 bytes each, 10^-7 mm
//                 kind 9, 10   place of G28, G30         the same
//                 kind 12      tool length            8 bytes, 10^-7 mm
//                 kind 32, 33  start-up line 0, 1        text
//                 kind 48      text of $I                text
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
  /// As long as a line of grbl.
  static constexpr std::size_t capacity = 80;

  /// False, and nothing has changed, if it is too long or has other characters.
  bool set(std::string_view text);
  std::string_view view() const { return {text_.data(), size_}; }
  friend bool operator==(const KeptText& a, const KeptText& b) { return a.same(b); }

 private:
  bool same(const KeptText& other) const;

  std::array<char, capacity> text_{};
  std::uint8_t size_ = 0;
};

inline constexpr std::size_t start_up_lines = 2;

struct KeptProgram {
  /// The shift stands here for the interpreter; it is not kept.
  program::Parameters parameters;
  std::array<KeptText, start_up_lines> start_up;
  KeptText build_text;  ///< $I=

  /// `$RST=#`: origins and places of G28 and G30 back to zero; texts and the tool stay.
  void clear_places();
  /// Whether the same would be kept.
  friend bool operator==(const KeptProgram& a, const KeptProgram& b) { return a.same(b); }

 private:
  bool same(const KeptProgram& other) const;
};

/// What a record of it holds: settings::StoredRecord. An item is a byte.
struct KeptProgramRecord {
  using Value = KeptProgram;
  static constexpr std::uint32_t pieces = program::coordinate_systems + 2;
  static constexpr std::uint32_t place_size = max_axes * sizeof(std::int64_t);
  /// The longest that this version writes.
  static constexpr std::uint32_t most_bytes = 1 + pieces * (2 + place_size) + 2 +
                                              sizeof(std::int64_t) +
                                              (start_up_lines + 1) * (2 + KeptText::capacity);
  /// "LPTK"; as many bytes as fit into four pages.
  static constexpr settings::RecordFormat format{
      0x4b54504c, 1,
      4 * settings::flash_page - settings::RecordFormat::head - settings::RecordFormat::tail};
  static_assert(most_bytes <= format.most);

  /// Writes the bytes of what is kept; returns how many.
  static std::uint32_t put(const KeptProgram& kept, std::span<std::uint8_t> items);
  /// Changes what is kept by bytes; returns how many pieces were not understood.
  static std::uint32_t take(KeptProgram& kept, std::span<const std::uint8_t> items);
};

}  // namespace lamplock::machine
