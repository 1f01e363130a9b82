// The fields of the records: one list for files, the library, the command line and texts.
//
// In:  a record. Out: for each field its key, its value's place, its allowed values, its help.
// Who: check_record(), the reader and the writer of files, the library, `lamplock material`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/glass/parameters.hpp"
#include "host/material/records.hpp"

namespace lamplock::material {

using FieldPlace = std::variant<double*, std::optional<double>*, int*, bool*, std::string*>;

struct Field {
  std::string_view key;  ///< with its unit: power_w
  FieldPlace place;
  std::string_view about;                  ///< one line for the help
  glass::Range range = glass::any_number;  ///< of numbers
  std::vector<std::string> names{};        ///< of texts: allowed values; empty: any
  bool is_required = false;
  bool is_name = false;  ///< a text without blanks that names a record
};

/// The fields in the order of files; `number` is none of them.
std::vector<Field> fields(Laser& laser);
std::vector<Field> fields(Material& material);
std::vector<Field> fields(Setting& setting);
std::vector<Field> fields(Measurement& measurement);

/// Their keys.
std::vector<std::string> keys_of(const std::vector<Field>& fields);

/// The field has no value: an optional number that is absent, an empty text.
bool is_absent(const Field& field);

/// The value as text: "0.5", "true", "plywood"; empty if it is absent. Numbers have the shortest
/// digits that read back as the same number.
std::string value_text(const Field& field);

/// Sets a field from a text of a user; an empty text removes an optional value. Throws
/// Error(bad_input), at `where`, for a text that is not a value of this kind. Ranges are checked by
/// check_record().
void set_value(const Field& field, std::string_view text, const std::string& where);

/// The field with this key. Throws Error(bad_input), at `where`, with a suggestion.
const Field& field_named(const std::vector<Field>& fields, std::string_view key,
                         const std::string& where);

/// Changes the fields of a record by texts FIELD=VALUE, each field at most once. Throws
/// Error(bad_input), at `where`.
template <class Record>
void apply_changes(Record& record, const std::vector<std::string>& changes,
                   const std::string& where);

}  // namespace lamplock::material
