// The material library: records in a file that several processes may use at once.
//
// In:  a file, records. Out: records; an Error that names the record and the field that is wrong.
// Who: the use cases of `lamplock material`; `lamplock cut`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/material/database.hpp"
#include "host/material/records.hpp"

namespace lamplock::material {

/// $XDG_DATA_HOME/lamplock/library.db, by default in ~/.local/share. Throws Error(bad_input) if
/// neither variable names a folder.
std::filesystem::path default_library();

/// What an import did.
struct ImportCount {
  std::size_t added = 0, replaced = 0, unchanged = 0;
};

class Library {
 public:
  /// Opens a library. If there is no file, or an empty one, makes the library with the records that
  /// lamplock delivers; an older version is brought to the present one. Throws Error(bad_input).
  explicit Library(const std::filesystem::path& file);

  /// For commands that only read: without a file, the delivered records in memory, and no file is
  /// made.
  static Library for_reading(const std::filesystem::path& file);
  /// Runs a change of the records, whole or not at all; meanwhile no other process writes. A change
  /// that is refused makes no file.
  static void change(const std::filesystem::path& file,
                     const std::function<void(Library& library)>& change);

  /// All records of a kind: by name, settings and measurements by material and feed.
  template <class Record>
  std::vector<Record> all();
  /// All records at one moment.
  Records records();

  /// The record with this name. Throws Error(bad_input) with a suggestion.
  Laser laser(const std::string& name);
  Material material(const std::string& name);
  std::vector<Setting> settings_of(const std::string& material);
  std::vector<Measurement> measurements_of(const std::string& material);
  /// The setting or measurement of a material with this number. Throws Error(bad_input).
  Setting setting(const std::string& material, std::int64_t number);
  Measurement measurement(const std::string& material, std::int64_t number);

  /// Stores a record: in change() only. Each function throws Error(bad_input) for a wrong record,
  /// one whose key another record has, and names of lasers and materials that do not exist.
  template <class Record>
  Record add(Record record);
  /// Replaces the record with this number.
  template <class Record>
  void replace(const Record& record);
  /// Removes a record; a material with its settings and measurements. A laser that settings or
  /// measurements use is refused.
  template <class Record>
  void remove(const Record& record);

  /// Adds records. Equal ones are kept as they are. Others with the same key are refused, or
  /// replaced.
  ImportCount import_records(const Records& records, bool replaces);

 private:
  template <class Record>
  std::vector<Record> select(const std::string& condition, const std::vector<SqlValue>& values);
  template <class Record>
  std::optional<Record> with_same_key(const Record& record);
  template <class Record>
  void import_kind(const std::vector<Record>& records, bool replaces, ImportCount& count);
  /// Of a setting or measurement: its material and laser exist, the laser has this power.
  template <class Record>
  void check_owners(const Record& record, const std::string& where);
  /// No setting and no measurement has more power.
  void check_power_is_enough(const Laser& laser);
  void insert_delivered();

  Database database_;
};

/// Names a record in messages: "material plywood", "measurement 12 of plywood".
std::string title_of(const Laser& laser);
std::string title_of(const Material& material);
std::string title_of(const Setting& setting);
std::string title_of(const Measurement& measurement);

/// The same values in all fields; numbers of rows do not count.
template <class Record>
bool same_record(Record a, Record b);

}  // namespace lamplock::material
