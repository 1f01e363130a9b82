// The process parameters of a program, found in the material library.
//
// In:  a material, laser, thickness and operation that a user has named. Out: the values of their
//      setting. Who: `check` and `send`, for the names #<_material_feed> and the like in programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lamplock::link {
struct ProgramLine;
}
namespace lamplock::program_run {
struct ProcessValues;
}

namespace lamplock::run {

struct ProcessChoice {
  std::optional<std::string> material{}, laser{}, operation{};
  std::optional<double> thickness_mm{};
  std::string library{};  ///< file; empty: the user's own
};

/// Empty if no material is named. Throws Error(bad_input): what the library lacks, or a part of the
/// choice without a material.
std::optional<program_run::ProcessValues> process_values(const ProcessChoice& choice);

/// A note for a program that reads none of the values, neither in its own text nor in that of the
/// files that `lines` come from; empty if it does.
std::string unused_choice_note(const std::string& file, const std::string& text,
                               const std::vector<link::ProgramLine>& lines);

/// What the setting has: "plywood, 3 mm, cut, laser diode-3w: 180 mm/min, 3 W, 2 passes".
std::string text_of(const program_run::ProcessValues& values);

}  // namespace lamplock::run
