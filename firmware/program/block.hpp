// A block: the words of one line, sorted into commands and values.
//
// In:  a line; values of its expressions and parameters (expression.hpp).
// Out: the code of each modal group in the line, the value words by letter, and the command that
//      uses the axis words. Errors of a word by itself or together with another (unknown codes,
//      groups, repeated words, signs) are found here; errors of values within a command are not.
//
// Commands take the value words that they use; an unused word is an error, and so is one that two
// commands use.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/program/expression.hpp"
#include "shared/gcode_words.hpp"
#include "shared/units.hpp"

namespace lamplock::program {

/// Modal groups (NIST, section 3.4, table 4), and those of lamplock.
enum class Group : std::uint8_t {
  once,  ///< group 0: G4 G10 G28 G30 G53 G92
  motion,
  plane,
  distance,
  arc_distance,
  feed_mode,
  units,
  cutter,
  tool_length,
  retract,
  system,
  path,
  rotation,
  exact_stop,   ///< G9
  stopping,     ///< M0 M1 M2 M30
  tool_change,  ///< M6
  spindle,
  coolant,
  saving,  ///< M70 .. M73
  beat_lock,
  io,         ///< M62 .. M68
  pulses,     ///< M126 .. M128
  overrides,  ///< M48 M49
  count
};

/// Words that programs of other controllers have and that have no effect here, D and H without a
/// command that needs them among them. Each is accepted and reported once.
enum class Ignored : std::uint8_t { program_number, d, h, g15, g50, g97, m117, count };
inline constexpr std::string_view ignored_words[] = {"O", "D", "H", "G15", "G50", "G97", "M117"};
/// Beside the bits of Ignored: the line has a comment that may be a message (message.hpp).
inline constexpr std::uint8_t message_bit = 0x80;
static_assert(1u << static_cast<int>(Ignored::count) <= message_bit);

/// The command of the line that uses its axis words.
enum class AxisUse : std::uint8_t { none, motion, data, tool_length, rotation };

class Block {
 public:
  /// Sorts the words of a line for a machine of `axes` axes, and notes its assignments. A jog has
  /// fewer commands and words, and no expressions.
  Fault read(std::string_view line, int axes, Expressions& expressions, bool jog = false);

  bool has(Group group) const { return (groups_ >> static_cast<int>(group) & 1u) != 0; }
  /// G code times ten, or M code; 0xffff if the line has none of the group.
  std::uint16_t code(Group group) const {
    return has(group) ? codes_[static_cast<std::size_t>(group)] : no_code;
  }
  /// Bits of the groups in the line, and the column of the first code of one.
  std::uint32_t group_bits() const { return groups_; }
  [[gnu::cold]] std::uint16_t first_code() const;
  std::uint16_t column(Group group) const { return columns_[static_cast<std::size_t>(group)]; }

  AxisUse axis_use() const { return axis_use_; }
  /// Bit i: the line has a word for axis i.
  std::uint32_t axes() const { return axes_; }
  const Word& axis(int i) const { return word(axis_letters[index(i)]); }
  /// The line has axis words, and besides at most a motion and a feed: most lines of a program.
  bool is_plain_move() const;
  /// Column of the first word of these axes.
  std::uint16_t axis_column(std::uint32_t axes) const;
  void take_axes();

  bool has(char letter) const { return (words_ & bit(letter)) != 0; }
  const Word& word(char letter) const { return values_[slot(letter)]; }
  /// Marks a word as used; false if it is used already.
  bool take(char letter);
  /// Column of the first unused word; 0 if there is none.
  std::uint16_t first_unused() const;

  /// Number of pieces into which the S word divides the move, with a power each; 0 if it is one
  /// number.
  std::uint32_t pieces() const { return pieces_; }
  /// Their powers, for a PowerList; below, the last one.
  std::string_view powers() const { return powers_; }
  std::uint32_t last_power_milli() const { return last_power_milli_; }

  /// Words without effect, a bit for each (Ignored).
  std::uint8_t ignored() const { return ignored_; }
  /// The D word, which only cutter compensation takes; null if there is none.
  const Word* d_word() const { return ignores(Ignored::d) ? &d_word_ : nullptr; }
  /// The H word, which only tool lengths take; null if there is none.
  const Word* h_word() const { return ignores(Ignored::h) ? &h_word_ : nullptr; }
  /// The D or H word has an effect.
  void use(Ignored word) { ignored_ &= static_cast<std::uint8_t>(~(1u << static_cast<int>(word))); }

  static constexpr std::uint16_t no_code = 0xffff;

 private:
  static constexpr std::string_view value_letters = "AEFIJKLNPQRSTXYZ";
  static constexpr std::uint8_t no_slot = 0xff;
  /// Place of each letter in values_.
  static constexpr std::array<std::uint8_t, 26> slots = [] {
    std::array<std::uint8_t, 26> table{};
    table.fill(no_slot);
    for (std::size_t i = 0; i < value_letters.size(); ++i)
      table[static_cast<std::size_t>(value_letters[i] - 'A')] = static_cast<std::uint8_t>(i);
    return table;
  }();
  static constexpr std::uint8_t slot(char letter) {
    return slots[static_cast<std::size_t>(letter - 'A')];
  }
  static constexpr std::uint32_t bit(char letter) { return 1u << slot(letter); }

  [[gnu::cold]] Fault read_other(std::string_view line, const Fault& fault, Word& word,
                                 WordReader& reader, Expressions& expressions);
  [[gnu::cold]] bool is_o_word(std::string_view line, const Word& word) const;
  Fault add(const Word& word, int axes, bool jog);
  [[gnu::cold]] bool ignore_word(const Word& word, std::string_view line, bool jog);
  [[gnu::cold]] bool ignore_program_number(WordReader& reader);
  [[gnu::cold]] Fault check_ignored() const;
  void ignore(Ignored word) { ignored_ |= static_cast<std::uint8_t>(1u << static_cast<int>(word)); }
  bool ignores(Ignored word) const { return (ignored_ >> static_cast<int>(word) & 1u) != 0; }
  Fault add_g(const Word& word, bool jog);
  Fault add_m(const Word& word);
  bool replaces_no_motion(Group group, std::uint16_t code) const;
  Fault add_code(Group group, std::uint16_t code, AxisUse use, std::uint16_t column);
  Fault add_powers(std::string_view line, const Word& word, WordReader& reader);
  Fault add_value(const Word& word, int axes, bool jog);

  static constexpr std::size_t groups = static_cast<std::size_t>(Group::count);
  std::uint32_t groups_ = 0;
  std::uint32_t words_ = 0, unused_ = 0;  ///< a bit for each slot
  std::uint32_t axes_ = 0;
  AxisUse axis_use_ = AxisUse::none;
  std::uint8_t ignored_ = 0;
  std::uint16_t program_number_ = 0;  ///< column of an ignored O word
  std::uint32_t pieces_ = 0, last_power_milli_ = 0;
  std::string_view powers_;
  Word d_word_, h_word_;  ///< where ignored_ has their bits
  std::array<std::uint16_t, groups> codes_;
  std::array<std::uint16_t, groups> columns_;
  std::array<Word, value_letters.size()> values_;  ///< where words_ has a bit
};

inline bool Block::is_plain_move() const {
  constexpr std::uint32_t motion = 1u << static_cast<int>(Group::motion);
  constexpr std::uint32_t words = bit('X') | bit('Y') | bit('Z') | bit('A') | bit('F');
  return axes_ != 0 && (groups_ & ~motion) == 0 && (words_ & ~words) == 0;
}

}  // namespace lamplock::program
