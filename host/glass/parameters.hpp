// Parameters: one list for description files and command lines. Each parameter has a key and an
// option, with the same range and text.
//
// In:  the fields of a description (description.hpp). Out: for each its key, its option, its
//      allowed values, its help text and a reference to its value.
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

/// Reference to the value of a parameter. The default of an optional one depends on others.
using ValuePointer = std::variant<double*, std::optional<double>*, int*, std::optional<int>*, bool*,
                                  std::optional<bool>*, std::string*, std::optional<std::string>*,
                                  std::optional<Triple>*, std::vector<std::string>*>;

/// Allowed numbers of a parameter; for each of three, if there are three.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = true;

  bool has(double value) const;
  /// The range in the words of all messages and help texts: "1 to 140", "at least 0", "more than
  /// 0", "more than 0, at most 1"; empty for any number.
  std::string text() const;
};
inline constexpr Range any_number{};
inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range not_negative{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range share{0, 1, true};

/// Empty, or the error of a text.
using TextCheck = std::string (*)(const std::string&);

/// One parameter.
struct Parameter {
  std::string key;     ///< in the description
  std::string option;  ///< on the command line, with its dashes
  ValuePointer place;
  std::string about;                 ///< for the help
  std::string unit{};                ///< or kind of value, for the help: MM
  Range range = any_number;          ///< of numbers
  std::vector<std::string> names{};  ///< of texts: allowed values; empty: any
  TextCheck check = nullptr;         ///< of texts
  bool is_file = false;              ///< a path, relative to the folder of the description
  /// Methods, kinds of files or orders that use it, by name; empty: all.
  std::vector<std::string> used_by{};
  std::string needs{};  ///< key of the parameter in its section that must be set too
};

/// True if a parameter has the same value in two sections of one kind.
bool same_value(const Parameter& parameter, const Parameter& other);

}  // namespace lamplock::glass
