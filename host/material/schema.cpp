#include "host/material/schema.hpp"

#include <fmt/format.h>

#include <array>

#include "host/file.hpp"

namespace lamplock::material {
namespace {

/// "LLML" in the header of the file: it is a material library, not another program's database.
constexpr std::int64_t application_id = 0x4c4c4d4c;

constexpr const char* first_tables = R"sql(
CREATE TABLE laser (
  number INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  power_w REAL NOT NULL,
  wavelength_nm REAL,
  beam_shape TEXT NOT NULL,
  beam_width_mm REAL NOT NULL,
  beam_height_mm REAL,
  note TEXT NOT NULL,
  source TEXT NOT NULL) STRICT;
CREATE TABLE material (
  number INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  colour TEXT NOT NULL,
  thickness_mm REAL,
  density_g_cm3 REAL,
  specific_energy_kj_g REAL,
  absorption REAL,
  cuttable INTEGER NOT NULL,
  burn_feed_mm_min REAL,
  note TEXT NOT NULL,
  source TEXT NOT NULL) STRICT;
CREATE TABLE setting (
  number INTEGER PRIMARY KEY,
  material TEXT NOT NULL REFERENCES material(name) ON UPDATE CASCADE ON DELETE CASCADE,
  laser TEXT NOT NULL REFERENCES laser(name) ON UPDATE CASCADE ON DELETE RESTRICT,
  thickness_mm REAL,
  operation TEXT NOT NULL,
  feed_mm_min REAL NOT NULL,
  power_w REAL NOT NULL,
  passes INTEGER NOT NULL,
  min_feed_mm_min REAL,
  max_feed_mm_min REAL,
  air INTEGER NOT NULL,
  kerf_mm REAL,
  note TEXT NOT NULL,
  source TEXT NOT NULL) STRICT;
CREATE UNIQUE INDEX setting_key ON setting(material, laser, operation, ifnull(thickness_mm, 0));
CREATE TABLE measurement (
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  material TEXT NOT NULL REFERENCES material(name) ON UPDATE CASCADE ON DELETE CASCADE,
  laser TEXT NOT NULL REFERENCES laser(name) ON UPDATE CASCADE ON DELETE RESTRICT,
  feed_mm_min REAL NOT NULL,
  power_w REAL NOT NULL,
  passes INTEGER NOT NULL,
  depth_mm REAL,
  thickness_mm REAL,
  result TEXT NOT NULL,
  rejected INTEGER NOT NULL,
  note TEXT NOT NULL,
  source TEXT NOT NULL) STRICT;
CREATE INDEX measurement_material ON measurement(material);
)sql";

/// Constants of the temperature field.
constexpr const char* thermal_columns = R"sql(
ALTER TABLE material ADD COLUMN conductivity_w_mk REAL;
ALTER TABLE material ADD COLUMN specific_heat_j_gk REAL;
ALTER TABLE material ADD COLUMN absorption_per_mm REAL;
ALTER TABLE material ADD COLUMN emissivity REAL;
ALTER TABLE material ADD COLUMN latent_heat_j_g REAL;
ALTER TABLE material ADD COLUMN molar_mass_g_mol REAL;
ALTER TABLE material ADD COLUMN boiling_k REAL;
ALTER TABLE material ADD COLUMN thermal_source TEXT NOT NULL DEFAULT '';
)sql";

/// The history of jobs.
constexpr const char* job_table = R"sql(
CREATE TABLE job (
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  file TEXT NOT NULL,
  board TEXT NOT NULL,
  begin_utc TEXT NOT NULL,
  end_utc TEXT NOT NULL,
  result TEXT NOT NULL,
  message TEXT NOT NULL,
  item TEXT NOT NULL,
  dry INTEGER NOT NULL,
  done INTEGER NOT NULL,
  total INTEGER NOT NULL,
  wasted_beats INTEGER) STRICT;
)sql";

/// Pulsed beams.
constexpr const char* frequency_column = "ALTER TABLE setting ADD COLUMN frequency_hz REAL;";

/// Two jobs of one second have reports of their own.
constexpr const char* report_column = "ALTER TABLE job ADD COLUMN report TEXT NOT NULL DEFAULT '';";

constexpr std::array steps_of_library{first_tables, thermal_columns, job_table, frequency_column,
                                      report_column};

}  // namespace

std::span<const char* const> schema_steps() { return steps_of_library; }

void migrate(Database& database, std::span<const char* const> steps,
             const std::function<void()>& created) {
  const auto newest = static_cast<std::int64_t>(steps.size());
  const auto is_present = [&] {
    return database.number("PRAGMA application_id") == application_id &&
           database.number("PRAGMA user_version") == newest;
  };
  if (is_present()) return;
  Transaction transaction(database);
  // Another process may have done it meanwhile.
  if (is_present()) return;
  const bool is_empty = database.number("SELECT count(*) FROM sqlite_schema") == 0;
  if (!is_empty && database.number("PRAGMA application_id") != application_id)
    refuse(database.file(), "it is the database of another program",
           "give the file of a material library, or a new name");
  const std::int64_t version = database.number("PRAGMA user_version");
  if (version > newest || version < 0)
    refuse(database.file(),
           fmt::format("the library has version {}, this program knows versions up to {}", version,
                       newest),
           "use a newer lamplock");
  for (auto step = static_cast<std::size_t>(version); step < steps.size(); ++step)
    database.execute(steps[step]);
  database.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", application_id, newest));
  if (is_empty) created();
  transaction.commit();
}

}  // namespace lamplock::material
