// Parameters: the one list of what can be said about a job, for description files and command lines
// alike. Whatever has a key has an option and the other way round, with one range and one text.
//
// In:  the fields of a description (description.hpp). Out: for each its key, its option, what
//      values it takes and what it is for, and the place of its value.
// Who: the reader and the writer of descriptions, the options of the command line.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lamplock::glass {

/// Three numbers, X first.
using Triple = std::array<double, 3>;

/// Where the value of a parameter is kept. Optional ones have a default that depends on others.
using Place =
    std::variant<double*, std::optional<double>*, int*, bool*, std::optional<bool>*, std::string*,
                 std::optional<std::string>*, std::optional<Triple>*, std::vector<std::string>*>;

/// Which numbers a parameter takes; each of three, if there are three.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = true;

  /// Empty, or what is wrong with a number: "-1 is not at least 0".
  std::string refusal(double value) const;
};
inline constexpr Range any_number{};
inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range not_negative{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range share{0, 1, true};

/// Empty, or what is wrong with a text.
using TextCheck = std::string (*)(const std::string&);

/// One parameter.
struct Parameter {
  std::string key;     ///< in the description
  std::string option;  ///< on the command line, with its dashes
  Place place;
  std::string about;                 ///< for the help
  std::string unit{};                ///< or kind of value, as the help has it: MM
  Range range = any_number;          ///< of numbers
  std::vector<std::string> names{};  ///< of texts: those that are allowed; none: any
  TextCheck check = nullptr;         ///< of texts
  bool is_file = false;              ///< a path, from the folder of the description
  /// What it is for: ways from a file to points, or orders, by name; none: for all.
  std::vector<std::string> used_by{};
  std::string needs{};  ///< key of the one in its section without which it does nothing
};

/// Empty, or what is wrong with a text for this parameter.
std::string refusal(const Parameter& parameter, const std::string& text);

/// True if one parameter of two sections of a kind has the same value in both.
bool same_value(const Parameter& parameter, const Parameter& other);

}  // namespace lamplock::glass
