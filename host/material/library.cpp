#include "host/material/library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <type_traits>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/material/delivered.hpp"
#include "host/material/fields.hpp"
#include "host/material/record_file.hpp"
#include "host/material/schema.hpp"
#include "host/number_text.hpp"
#include "host/suggestion.hpp"

namespace lamplock::material {
namespace {

namespace fs = std::filesystem;

struct SqlOfValue {
  SqlValue operator()(const double* value) const { return *value; }
  SqlValue operator()(const std::optional<double>* value) const {
    return *value ? SqlValue(**value) : SqlValue();
  }
  SqlValue operator()(const int* value) const { return std::int64_t{*value}; }
  SqlValue operator()(const bool* value) const { return std::int64_t{*value ? 1 : 0}; }
  SqlValue operator()(const std::string* value) const { return *value; }
};

/// A value of this kind. Damaged files, and those that another program changed, have others.
template <class Value>
const Value& stored(const SqlValue& sql) {
  if (const auto* value = std::get_if<Value>(&sql)) return *value;
  throw Error(Exit::bad_input, "material library", "a record has a value of the wrong kind",
              "restore a copy of the library, or import an exported file into a new one");
}

struct ValueOfSql {
  const SqlValue& sql;

  void operator()(double* value) const { *value = stored<double>(sql); }
  void operator()(std::optional<double>* value) const {
    if (!std::holds_alternative<std::monostate>(sql)) *value = stored<double>(sql);
  }
  void operator()(int* value) const { *value = static_cast<int>(stored<std::int64_t>(sql)); }
  void operator()(bool* value) const { *value = stored<std::int64_t>(sql) != 0; }
  void operator()(std::string* value) const { *value = stored<std::string>(sql); }
};

/// The order of lists.
template <class Record>
constexpr const char* order_of() {
  return "name";
}
template <>
constexpr const char* order_of<Setting>() {
  return "material, laser, operation, thickness_mm, number";
}
template <>
constexpr const char* order_of<Measurement>() {
  return "material, laser, feed_mm_min, power_w, passes, number";
}

template <class Record>
std::vector<SqlValue> sql_values(Record record) {
  std::vector<SqlValue> values;
  for (const Field& field : fields(record)) values.push_back(std::visit(SqlOfValue{}, field.place));
  return values;
}

template <class Record>
std::vector<std::string> columns_of() {
  Record record;
  return keys_of(fields(record));
}

/// What to give instead of the name of a record that the library lacks.
std::string remedy_of_missing(const char* kind, const std::string& name,
                              const std::vector<std::string>& names) {
  return did_you_mean(name, names,
                      names.empty() ? fmt::format("add a {}", kind)
                                    : fmt::format("give {}", fmt::join(names, ", ")));
}

[[noreturn]] void refuse_missing(const char* kind, const std::string& name,
                                 const std::vector<std::string>& names) {
  throw Error(Exit::bad_input, fmt::format("{} {}", kind, name), "the library has no such record",
              remedy_of_missing(kind, name, names));
}

template <class Record>
std::vector<std::string> names_of(const std::vector<Record>& records) {
  std::vector<std::string> names;
  names.reserve(records.size());
  for (const Record& record : records) names.push_back(record.name);
  return names;
}

/// An absolute path in a variable; others do not count (XDG Base Directory Specification).
std::optional<fs::path> folder_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || !fs::path(text).is_absolute()) return std::nullopt;
  return text;
}

}  // namespace

fs::path default_library() {
  const char* const place = "lamplock/library.db";
  if (const auto data = folder_in("XDG_DATA_HOME")) return *data / place;
  if (const auto home = folder_in("HOME")) return *home / ".local/share" / place;
  throw Error(Exit::bad_input, "material library",
              "neither XDG_DATA_HOME nor HOME names a folder for it",
              "give its file with --library");
}

std::string title_of(const Laser& laser) { return "laser " + laser.name; }
std::string title_of(const Material& material) { return "material " + material.name; }
std::string title_of(const Setting& setting) {
  return setting.number == 0 ? "setting of " + setting.material
                             : fmt::format("setting {} of {}", setting.number, setting.material);
}
std::string title_of(const Measurement& measurement) {
  return measurement.number == 0
             ? "measurement of " + measurement.material
             : fmt::format("measurement {} of {}", measurement.number, measurement.material);
}

template <class Record>
bool same_record(Record a, Record b) {
  return sql_values(std::move(a)) == sql_values(std::move(b));
}

Library::Library(const fs::path& file) : database_(file) {
  migrate(database_, schema_steps(), [this] { insert_delivered(); });
}

namespace {

/// True for what is there, even if it is no library; the database then says what is wrong.
bool is_there(const fs::path& file) {
  std::error_code failure;
  return fs::exists(file, failure) || failure;
}

const fs::path in_memory;

}  // namespace

Library Library::for_reading(const fs::path& file) {
  return Library(is_there(file) ? file : in_memory);
}

void Library::change(const fs::path& file, const std::function<void(Library& library)>& change) {
  const auto run = [&](Library& library) {
    Transaction transaction(library.database_);
    change(library);
    transaction.commit();
  };
  const bool is_new = !is_there(file);
  if (is_new) {
    Library trial(in_memory);
    run(trial);
  }
  try {
    Library library(file);
    run(library);
  } catch (...) {
    // A full disk: SQLite leaves an empty file.
    std::error_code ignored;
    if (is_new && fs::file_size(file, ignored) == 0) fs::remove(file, ignored);
    throw;
  }
}

void Library::insert_delivered() {
  const Records delivered = parse_records(delivered_text(), "materials.toml");
  for (const Laser& laser : delivered.lasers) add(laser);
  for (const Material& material : delivered.materials) add(material);
  for (const Setting& setting : delivered.settings) add(setting);
  for (const Measurement& measurement : delivered.measurements) add(measurement);
}

template <class Record>
std::vector<Record> Library::select(const std::string& condition,
                                    const std::vector<SqlValue>& values) {
  std::vector<Record> records;
  for (const SqlRow& row :
       database_.query(fmt::format("SELECT number, {} FROM {} WHERE {} ORDER BY {}",
                                   fmt::join(columns_of<Record>(), ", "), kind_of<Record>(),
                                   condition, order_of<Record>()),
                       values)) {
    Record record;
    record.number = stored<std::int64_t>(row[0]);
    std::size_t column = 1;
    for (const Field& field : fields(record)) std::visit(ValueOfSql{row[column++]}, field.place);
    records.push_back(std::move(record));
  }
  return records;
}

template <class Record>
std::vector<Record> Library::all() {
  return select<Record>("true", {});
}

Records Library::records() {
  Records records;
  Transaction transaction(database_, Transaction::Kind::reads);
  records = {all<Laser>(), all<Material>(), all<Setting>(), all<Measurement>()};
  transaction.commit();
  return records;
}

Laser Library::laser(const std::string& name) {
  const std::vector<Laser> found = select<Laser>("name = ?", {name});
  if (found.empty()) refuse_missing(kind_of<Laser>(), name, names_of(all<Laser>()));
  return found.front();
}

Material Library::material(const std::string& name) {
  const std::vector<Material> found = select<Material>("name = ?", {name});
  if (found.empty()) refuse_missing(kind_of<Material>(), name, names_of(all<Material>()));
  return found.front();
}

std::vector<Setting> Library::settings_of(const std::string& material) {
  return select<Setting>("material = ?", {material});
}

std::vector<Measurement> Library::measurements_of(const std::string& material) {
  return select<Measurement>("material = ?", {material});
}

Setting Library::setting(const std::string& material, std::int64_t number) {
  const std::vector<Setting> found =
      select<Setting>("material = ? AND number = ?", {material, number});
  if (found.empty())
    throw Error(Exit::bad_input, "material " + material,
                fmt::format("it has no setting with the number {}", number),
                "give a number of its list of settings");
  return found.front();
}

Measurement Library::measurement(const std::string& material, std::int64_t number) {
  const std::vector<Measurement> found =
      select<Measurement>("material = ? AND number = ?", {material, number});
  if (found.empty())
    throw Error(Exit::bad_input, "material " + material,
                fmt::format("it has no measurement with the number {}", number),
                "give a number of its list of measurements");
  return found.front();
}

template <class Record>
std::optional<Record> Library::with_same_key(const Record& record) {
  std::vector<Record> found;
  if constexpr (std::is_same_v<Record, Setting>)
    found = select<Record>(
        "material = ? AND laser = ? AND operation = ? AND ifnull(thickness_mm, 0) = ?",
        {record.material, record.laser, record.operation, record.thickness_mm.value_or(0)});
  else if constexpr (!std::is_same_v<Record, Measurement>)
    found = select<Record>("name = ?", {record.name});
  return found.empty() ? std::nullopt : std::optional<Record>(found.front());
}

template <class Record>
void Library::check_owners(const Record& record, const std::string& where) {
  const auto check = [&]<class Owner>(std::type_identity<Owner>, const std::string& name) {
    if (!select<Owner>("name = ?", {name}).empty()) return;
    const char* kind = kind_of<Owner>();
    throw Error(Exit::bad_input, where,
                fmt::format("'{}' is '{}', which the library does not have", kind, name),
                remedy_of_missing(kind, name, names_of(all<Owner>())));
  };
  check(std::type_identity<Material>(), record.material);
  check(std::type_identity<Laser>(), record.laser);
  const double full_power_w = laser(record.laser).power_w;
  if (record.power_w > full_power_w)
    throw Error(Exit::bad_input, where,
                fmt::format("'power_w' is {:g}, more than that of the laser {}", record.power_w,
                            record.laser),
                fmt::format("give at most {:g}", full_power_w));
}

void Library::check_power_is_enough(const Laser& laser) {
  const auto check = [&](const auto& records) {
    for (const auto& one : records)
      if (one.power_w > laser.power_w)
        throw Error(Exit::bad_input, title_of(laser),
                    fmt::format("'power_w' is {:g}, {} has {:g}", laser.power_w, title_of(one),
                                one.power_w),
                    "give at least the power that the settings and measurements have");
  };
  // Until the laser is stored they have its former name.
  for (const Laser& stored : select<Laser>("number = ?", {laser.number})) {
    check(select<Setting>("laser = ?", {stored.name}));
    check(select<Measurement>("laser = ?", {stored.name}));
  }
}

template <class Record>
Record Library::add(Record record) {
  record.number = 0;
  const std::string where = title_of(record);
  check_record(record, where);
  if constexpr (requires { record.material; }) check_owners(record, where);
  if (const auto other = with_same_key(record))
    throw Error(Exit::bad_input, title_of(*other), "the library has it already",
                "edit it, or remove it first");
  const std::vector<SqlValue> values = sql_values(record);
  const std::vector<std::string> marks(values.size(), "?");
  database_.query(fmt::format("INSERT INTO {} ({}) VALUES ({})", kind_of<Record>(),
                              fmt::join(columns_of<Record>(), ", "), fmt::join(marks, ", ")),
                  values);
  record.number = database_.last_row();
  return record;
}

template <class Record>
void Library::replace(const Record& record) {
  const std::string where = title_of(record);
  check_record(record, where);
  if constexpr (requires { record.material; }) check_owners(record, where);
  if (const auto other = with_same_key(record); other && other->number != record.number)
    throw Error(Exit::bad_input, title_of(*other), "the library has it already",
                "change that one, or remove it first");
  if constexpr (std::is_same_v<Record, Laser>) check_power_is_enough(record);
  std::vector<SqlValue> values = sql_values(record);
  values.emplace_back(record.number);
  database_.query(fmt::format("UPDATE {} SET {} = ? WHERE number = ?", kind_of<Record>(),
                              fmt::join(columns_of<Record>(), " = ?, ")),
                  values);
}

template <class Record>
void Library::remove(const Record& record) {
  if constexpr (std::is_same_v<Record, Laser>) {
    const std::size_t settings = select<Setting>("laser = ?", {record.name}).size(),
                      measurements = select<Measurement>("laser = ?", {record.name}).size();
    std::vector<std::string> uses;
    if (settings != 0) uses.push_back(count_text(settings, "setting"));
    if (measurements != 0) uses.push_back(count_text(measurements, "measurement"));
    if (!uses.empty())
      throw Error(Exit::bad_input, title_of(record),
                  fmt::format("it is used by {}", fmt::join(uses, " and ")),
                  "remove them, or the materials that they belong to, first");
  }
  database_.query(fmt::format("DELETE FROM {} WHERE number = ?", kind_of<Record>()),
                  {record.number});
}

template <class Record>
void Library::import_kind(const std::vector<Record>& records, bool replaces, ImportCount& count) {
  std::vector<Record> present = all<Record>();
  for (Record record : records) {
    // Equal measurements may be two cuts: each one in the library is taken for one of the file.
    const auto equal = std::ranges::find_if(
        present, [&](const Record& other) { return same_record(record, other); });
    if (equal != present.end()) {
      present.erase(equal);
      ++count.unchanged;
      continue;
    }
    const auto other = with_same_key(record);
    if (!other) {
      add(record);
      ++count.added;
    } else if (replaces) {
      record.number = other->number;
      replace(record);
      ++count.replaced;
    } else {
      throw Error(Exit::bad_input, title_of(*other), "is in the library with other values",
                  "rename it, remove one of the two, or overwrite the library's with --replace");
    }
  }
}

ImportCount Library::import_records(const Records& records, bool replaces) {
  ImportCount count;
  import_kind(records.lasers, replaces, count);
  import_kind(records.materials, replaces, count);
  import_kind(records.settings, replaces, count);
  import_kind(records.measurements, replaces, count);
  return count;
}

#define LAMPLOCK_INSTANTIATE(Record)                   \
  template bool same_record(Record, Record);           \
  template std::vector<Record> Library::all<Record>(); \
  template Record Library::add(Record);                \
  template void Library::replace(const Record&);       \
  template void Library::remove(const Record&)
LAMPLOCK_INSTANTIATE(Laser);
LAMPLOCK_INSTANTIATE(Material);
LAMPLOCK_INSTANTIATE(Setting);
LAMPLOCK_INSTANTIATE(Measurement);
#undef LAMPLOCK_INSTANTIATE

}  // namespace lamplock::material
