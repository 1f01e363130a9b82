// Changes of the material library that users ask for: records added, changed, removed, exchanged.
//
// In:  the file of a library, a kind and a name, texts FIELD=VALUE, a file of records. Out: the
//      changed library; what was done. Who: `material list|show|add|edit|remove|import|export`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/material/library.hpp"
#include "host/material/records.hpp"

namespace lamplock::run {

enum class RecordKind : std::uint8_t { material, laser, setting, measurement };

/// "material", "laser", "setting", "measurement".
std::vector<std::string> record_kind_names();
/// Throws Error(bad_input).
RecordKind record_kind_named(const std::string& name);
/// Calls `use` with an empty record of the kind of this name and returns its result. Throws
/// Error(bad_input).
template <class Use>
auto with_kind(const std::string& kind, Use use) {
  switch (record_kind_named(kind)) {
    case RecordKind::laser:
      return use(material::Laser{});
    case RecordKind::setting:
      return use(material::Setting{});
    case RecordKind::measurement:
      return use(material::Measurement{});
    case RecordKind::material:
      break;
  }
  return use(material::Material{});
}

/// Which record: lasers and materials by name, settings and measurements by the name of their
/// material and their number.
struct RecordChoice {
  std::string library{};  ///< file; empty: the user's own (material::default_library())
  std::string kind = "material", name{};
  std::uint64_t number = 0;
};

/// The file of a choice.
std::string library_file(const std::string& given);
/// The library for commands that only read it.
material::Library library_for_reading(const std::string& given);
/// Makes the folder of the user's own library, then changes records, whole or not at all.
void change_library(const std::string& given,
                    const std::function<void(material::Library& library)>& change);

/// Each throws Error(bad_input), and then nothing is changed. The result is the title of the
/// record: "material oak".
std::string add_record(const RecordChoice& choice, const std::vector<std::string>& changes);
std::string edit_record(const RecordChoice& choice, const std::vector<std::string>& changes);
struct RemovedRecord {
  std::string title;
  std::size_t settings = 0, measurements = 0;  ///< removed with their material
};
RemovedRecord remove_record(const RecordChoice& choice);

material::ImportCount import_records(const std::string& library, const std::string& file,
                                     bool replaces);
/// Of a library the records of these materials with the lasers that they use, or all.
material::Records exported_records(const std::string& library,
                                   const std::vector<std::string>& names);
/// Writes them as TOML. Throws Error(bad_input).
void write_records(const material::Records& records, const std::string& file);

}  // namespace lamplock::run
