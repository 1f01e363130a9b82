// The tables of the material library, and the steps that bring an older library to them.
//
// In:  a database. Out: the tables of the present version. Who: the library when it opens a file.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "host/material/database.hpp"

namespace lamplock::material {

/// SQL from each version of the schema to the next one; the first step makes the tables in an empty
/// file. A published step is never changed: a new version is a new step at the end.
std::span<const char* const> schema_steps();

/// Brings a database to the version after the last step, all steps in one transaction; `created`
/// runs in it if the file was empty. Throws Error(bad_input) for a file that contains another kind
/// of database, or a version that is newer than the steps.
void migrate(Database& database, std::span<const char* const> steps,
             const std::function<void()>& created);

}  // namespace lamplock::material
