// Parameters of a program: #1 to #5000 and #<name>.
//
// In:  assignments of a line: noted while the line is read, in force after the whole line
//      (RS-274/NGC: "The NIST RS274/NGC Interpreter - Version 3", section 3.3.3).
// Out: their values, 10^-9.
// Who: expressions (expression.hpp), main loop.
//
// Few of the numbers are in use, so values are kept in a list with their numbers; a number that is
// 0 is not in it. Names are in one text. Assignments of the present line follow the values: they
// replace them, or are dropped with the line.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "shared/gcode_errors.hpp"

namespace lamplock::program {

class Variables {
 public:
  static constexpr std::uint32_t max_number = 5000;
  /// Values that are not 0 at the same time, names counted; characters of all names.
  static constexpr std::uint32_t capacity = 256, name_characters = 640;

  /// Of a number from 1 to 5000; 0 without an assignment.
  [[gnu::cold]] std::int64_t value_e9(std::uint32_t number) const;
  /// Of a name, in lower case without blanks; false without an assignment.
  [[gnu::cold]] bool find(std::string_view name, std::int64_t& value_e9) const;

  // Assignments of the present line. Error: no_room.
  [[gnu::cold]] GcodeError assign(std::uint32_t number, std::int64_t value_e9);
  [[gnu::cold]] GcodeError assign(std::string_view name, std::int64_t value_e9);
  bool has_assignments() const { return assignments_ != 0; }
  /// The line is valid: its assignments are in force.
  [[gnu::cold]] void commit();
  /// The line has an error: its assignments are dropped.
  [[gnu::cold]] void drop();

  [[gnu::cold]] void clear();

  /// The values in force, for those who list them: i below size().
  std::uint32_t size() const { return size_; }
  /// The number, or 0 for a name.
  std::uint32_t number(std::uint32_t i) const { return is_name(keys_[i]) ? 0 : keys_[i]; }
  [[gnu::cold]] std::string_view name(std::uint32_t i) const { return name_of(keys_[i]); }
  std::int64_t value_at(std::uint32_t i) const { return values_e9_[i]; }

 private:
  /// A number, or this bit and the place of a name in names_, where its length is.
  using Key = std::uint16_t;
  static constexpr Key name_bit = 0x8000;
  static constexpr Key none = 0;
  static bool is_name(Key key) { return (key & name_bit) != 0; }

  std::string_view name_of(Key key) const;
  Key key_of(std::string_view name) const;
  std::uint32_t place_of(Key key, std::uint32_t size) const;
  GcodeError add(Key key, std::int64_t value_e9);

  std::array<Key, capacity> keys_;
  std::array<std::int64_t, capacity> values_e9_;
  std::array<char, name_characters> names_;
  std::uint16_t size_ = 0;             ///< values in force
  std::uint16_t assignments_ = 0;      ///< of this line, after them
  std::uint16_t names_size_ = 0;       ///< characters of the names in force, with their lengths
  std::uint16_t line_names_size_ = 0;  ///< the same with those of this line
};

}  // namespace lamplock::program
