// The tool table: lengths and diameters of tools by their numbers.
//
// In:  G10 L1, L10, L11. Out: the length for G43 and G43.2, the diameter for G41 and G42.
// Who: the interpreter, main loop; the owner of its parameters stores the table (parameters.hpp).
//
// An entry has eight bytes, since all tools are in SRAM: so a program that changes the table does
// not wait for the flash.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamplock::program {

/// Values of a tool.
struct Tool {
  std::int64_t length_e7 = 0;    ///< along Z, 10^-7 mm
  std::int64_t diameter_e7 = 0;  ///< the same
};

class ToolTable {
 public:
  static constexpr std::size_t capacity = 24;
  static constexpr std::uint32_t max_number = 255;
  /// Limits of the values: 2 m and 1 m. Lengths are stored to 1 nm, diameters to 0.1 um.
  static constexpr std::int64_t max_length_e7 = 20'000'000'000, max_diameter_e7 = 10'000'000'000;

  /// A stored tool; number 0: none.
  struct Entry {
    std::int32_t length_nm = 0;
    std::uint32_t diameter_and_number = 0;

    constexpr Entry() = default;
    /// number 1 to max_number; values within their limits.
    constexpr Entry(std::uint32_t number, const Tool& tool)
        : length_nm(static_cast<std::int32_t>(nearest(tool.length_e7, e7_of_nm))),
          diameter_and_number(
              static_cast<std::uint32_t>(nearest(tool.diameter_e7, e7_of_tenth)) << 8 | number) {}
    constexpr std::uint32_t number() const { return diameter_and_number & 0xffu; }
    constexpr Tool tool() const {
      return {length_nm * e7_of_nm, (diameter_and_number >> 8) * e7_of_tenth};
    }
    /// Its values are within their limits.
    constexpr bool is_valid() const {
      const Tool read = tool();
      return read.length_e7 <= max_length_e7 && read.length_e7 >= -max_length_e7 &&
             read.diameter_e7 <= max_diameter_e7;
    }
    friend constexpr bool operator==(const Entry&, const Entry&) = default;
  };

  /// The values of a tool; false if the table does not have it.
  [[gnu::cold]] bool find(std::uint32_t number, Tool& tool) const {
    const Entry* const entry = find_entry(number);
    if (entry == nullptr) return false;
    tool = entry->tool();
    return true;
  }
  /// There is a place for this tool.
  [[gnu::cold]] bool has_room(std::uint32_t number) const {
    return find_entry(number) != nullptr || find_entry(0) != nullptr;
  }
  /// Adds or replaces a tool; false if there is no room for it.
  [[gnu::cold]] bool set(const Entry& tool) {
    const Entry* entry = find_entry(tool.number());
    if (entry == nullptr) entry = find_entry(0);
    if (entry == nullptr || tool.number() == 0) return false;
    entries_[static_cast<std::size_t>(entry - entries_.data())] = tool;
    return true;
  }
  /// Tools are entered from the first place.
  bool empty() const { return entries_[0].number() == 0; }
  /// The places in sequence; those after the last tool are empty.
  const Entry& entry(std::size_t i) const { return entries_[i]; }

  friend bool operator==(const ToolTable&, const ToolTable&) = default;

 private:
  static constexpr std::int64_t e7_of_nm = 10, e7_of_tenth = 1000;
  static constexpr std::int64_t nearest(std::int64_t e7, std::int64_t unit) {
    return (e7 + (e7 < 0 ? -unit : unit) / 2) / unit;
  }

  const Entry* find_entry(std::uint32_t number) const {
    for (const Entry& entry : entries_)
      if (entry.number() == number) return &entry;
    return nullptr;
  }

  std::array<Entry, capacity> entries_{};
};

}  // namespace lamplock::program
