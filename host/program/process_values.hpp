// Process parameters of a program: #<_material_feed> and the like, values of a material.
//
// In:  the text of a program or one of its lines, the values of a setting of the material library.
// Out: the same text with a number in place of each process parameter, in the same column; an error
//      at FILE:LINE:COLUMN.
// Who: `check` and `send`, before the board or its interpreter sees a line. The board knows no
//      process parameters.
//
// Lengths and feeds are in the unit of the line (G20, G21), as #<_feed> is. EXISTS[#<name>] is 1 if
// the setting has the value, else 0, also if no material is chosen.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "host/program/board_state.hpp"
#include "host/program/program_error.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

/// A setting of the material library; `host/run/process_choice.hpp` finds it.
struct ProcessValues {
  std::string title{};  ///< "plywood, 3 mm, cut, laser diode-3w", for messages
  std::string edit{};   ///< command that adds a field to the setting: "lamplock material edit ..."
  double feed_mm_min = 0;
  double power_w = 0;
  double power_share = 0;  ///< the same in parts of full power
  int passes = 1;
  bool air = false;
  std::optional<double> kerf_mm{}, thickness_mm{}, frequency_hz{};
};

/// A program reads a process parameter and no material is chosen: a page asks for one.
class NoMaterial : public ProgramError {
 public:
  using ProgramError::ProgramError;
};

/// A line of a file, for errors.
struct LinePlace {
  const std::string& file;
  std::size_t line = 0;
  /// The column in the file of a column of the text; 0: not known. Empty: they are the same.
  std::function<std::size_t(std::size_t)> column{};
};

/// Whether a text has a process parameter, EXISTS included.
bool has_process_values(std::string_view text);

/// Throws Error(bad_input) at the first process parameter that does not exist or that is assigned;
/// and, if no values are chosen, NoMaterial at the first that is read. A program with O-words may
/// ask by EXISTS whether they are, and then only what is executed counts.
void check_process_values(std::string_view program, const std::string& file,
                          const ProcessValues* values);

/// Inserts the values into a line or its messages. `values` null: none are chosen; `max_speed_s`:
/// the S word of full power. Throws Error(bad_input) as check_process_values(), and for a value
/// that the setting does not have.
std::string insert_process_values(std::string_view line, const ProcessValues* values, bool inches,
                                  double max_speed_s, const LinePlace& place);

/// Whether a line is in inches: by its own G20 or G21, else as before it.
bool is_in_inches(std::string_view line, bool inches_before);

/// Inserts the values into the lines of a program that are executed in their order, from this state
/// of the board on.
std::string with_process_values(std::string_view program, const std::string& file,
                                const ProcessValues* values, const settings::Values& settings,
                                const std::optional<BoardState>& state);

}  // namespace lamplock::program_run
