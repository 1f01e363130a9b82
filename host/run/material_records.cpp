#include "host/run/material_records.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/material/fields.hpp"
#include "host/material/record_file.hpp"
#include "host/output_error.hpp"
#include "host/suggestion.hpp"

namespace lamplock::run {
namespace {

using material::Laser;
using material::Library;
using material::Material;
using material::Measurement;
using material::Setting;

template <class Record>
Record find_record(Library& library, const RecordChoice& choice) {
  [[maybe_unused]] const auto number = static_cast<std::int64_t>(choice.number);
  if constexpr (std::is_same_v<Record, Laser>)
    return library.laser(choice.name);
  else if constexpr (std::is_same_v<Record, Material>)
    return library.material(choice.name);
  else if constexpr (std::is_same_v<Record, Setting>)
    return library.setting(library.material(choice.name).name, number);
  else
    return library.measurement(library.material(choice.name).name, number);
}

/// Throws unless a setting or measurement has a number, and a laser or material has none.
template <class Record>
void check_number_of_choice(const RecordChoice& choice) {
  constexpr bool is_numbered = requires(Record record) { record.material; };
  if (is_numbered == (choice.number != 0)) return;
  const std::string kind = material::kind_of<Record>();
  throw Error(Exit::bad_input, fmt::format("{} {}", kind, choice.name),
              is_numbered ? fmt::format("the number of the {} of {} is missing", kind, choice.name)
                          : fmt::format("a {} has a name and no number", kind),
              is_numbered ? fmt::format("give the number that the list of {}s has", kind)
                          : "leave the number out, or name the kind of record");
}

/// The name of a new record is its own, or that of its material.
template <class Record>
std::string& name_in(Record& record) {
  if constexpr (requires { record.material; })
    return record.material;
  else
    return record.name;
}

}  // namespace

std::vector<std::string> record_kind_names() {
  return {"material", "laser", "setting", "measurement"};
}

RecordKind record_kind_named(const std::string& name) {
  const std::vector<std::string> names = record_kind_names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw Error(Exit::bad_input, "material library",
                fmt::format("'{}' is not a kind of record", name),
                did_you_mean(name, names, fmt::format("give {}", fmt::join(names, ", "))));
  return static_cast<RecordKind>(found - names.begin());
}

std::string library_file(const std::string& given) {
  return given.empty() ? material::default_library().string() : given;
}

Library library_for_reading(const std::string& given) {
  std::error_code failure;
  const std::filesystem::path folder = std::filesystem::absolute(given, failure).parent_path();
  if (!given.empty() && !std::filesystem::is_directory(folder, failure))
    refuse(given, "its folder does not exist", "give a library in a folder that exists");
  return Library::for_reading(library_file(given));
}

void change_library(const std::string& given, const std::function<void(Library& library)>& change) {
  const std::filesystem::path file = library_file(given);
  if (given.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(file.parent_path(), failure);
    if (failure) throw OutputError(file, failure.value());
  }
  Library::change(file, change);
}

std::string add_record(const RecordChoice& choice, const std::vector<std::string>& changes) {
  return with_kind(choice.kind, [&](auto record) {
    const std::string where = fmt::format("{} {}", choice.kind, choice.name);
    apply_changes(record, changes, where);
    if (const std::string& name = name_in(record); !name.empty() && name != choice.name)
      throw Error(Exit::bad_input, where, fmt::format("a second name is given, '{}'", name),
                  "give one name");
    name_in(record) = choice.name;
    std::string title;
    change_library(choice.library,
                   [&](Library& library) { title = title_of(library.add(record)); });
    return title;
  });
}

std::string edit_record(const RecordChoice& choice, const std::vector<std::string>& changes) {
  return with_kind(choice.kind, [&]([[maybe_unused]] auto kind) {
    check_number_of_choice<decltype(kind)>(choice);
    std::string title;
    change_library(choice.library, [&](Library& library) {
      auto record = find_record<decltype(kind)>(library, choice);
      const std::string where = title_of(record);
      apply_changes(record, changes, where);
      check_record(record, where);
      library.replace(record);
      title = title_of(record);
    });
    return title;
  });
}

RemovedRecord remove_record(const RecordChoice& choice) {
  return with_kind(choice.kind, [&]([[maybe_unused]] auto kind) {
    check_number_of_choice<decltype(kind)>(choice);
    RemovedRecord removed;
    change_library(choice.library, [&](Library& library) {
      const auto record = find_record<decltype(kind)>(library, choice);
      removed.title = title_of(record);
      if constexpr (std::is_same_v<decltype(kind), Material>) {
        removed.settings = library.settings_of(record.name).size();
        removed.measurements = library.measurements_of(record.name).size();
      }
      library.remove(record);
    });
    return removed;
  });
}

material::ImportCount import_records(const std::string& library, const std::string& file,
                                     bool replaces) {
  const material::Records records = material::read_records(file);
  material::ImportCount count;
  change_library(library,
                 [&](Library& changed) { count = changed.import_records(records, replaces); });
  return count;
}

material::Records exported_records(const std::string& library,
                                   const std::vector<std::string>& names) {
  Library opened = library_for_reading(library);
  if (names.empty()) return opened.records();
  material::Records chosen;
  std::set<std::string> lasers;
  for (const std::string& name : std::set<std::string>(names.begin(), names.end())) {
    chosen.materials.push_back(opened.material(name));
    for (const Setting& setting : opened.settings_of(name)) {
      chosen.settings.push_back(setting);
      lasers.insert(setting.laser);
    }
    for (const Measurement& measurement : opened.measurements_of(name)) {
      chosen.measurements.push_back(measurement);
      lasers.insert(measurement.laser);
    }
  }
  for (const std::string& laser : lasers) chosen.lasers.push_back(opened.laser(laser));
  return chosen;
}

void write_records(const material::Records& records, const std::string& file) {
  check_target(file);
  write_whole(file, material::to_toml(records));
}

}  // namespace lamplock::run
