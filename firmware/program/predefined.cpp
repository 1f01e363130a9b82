#include "firmware/program/predefined.hpp"

#include "firmware/program/decimal.hpp"

namespace lamplock::program {
namespace {

constexpr std::int64_t e9_of_e7 = one_e9 / one_e7, e9_of_milli = one_e9 / 1000;
constexpr std::uint32_t first_axis_word = 1;  ///< of a row of numbers: 5221 is X of G54

// First numbers of rows; a row has the axes X Y Z A.
constexpr std::uint32_t probe_row = 5060, probe_met = 5070;
constexpr std::uint32_t home_g28_row = 5160, home_g30_row = 5180;
constexpr std::uint32_t shifted = 5210, shift_row = 5210, system_number = 5220;
constexpr std::uint32_t system_row = 5220, system_row_size = 20, rotation_row = 5230;
constexpr std::uint32_t input_result = 5399, tool_number = 5400, tool_row = 5400,
                        tool_diameter = 5410;
constexpr std::uint32_t position_row = 5419;

enum class Name : std::uint8_t {
  x,
  y,
  z,
  a,
  feed,
  speed,
  system,
  plane,
  motion,
  loaded_tool,
  tool,
  inches_off,
  inches,
  relative_off,
  relative,
  inverse_time,
  per_minute,
  per_turn,
  spindle_on,
  spindle_clockwise,
  mist,
  flood,
  tool_length,
  centres_absolute,
  retract_to_r,
  retract_to_start
};
struct NameRow {
  std::string_view text;
  Name name;
};

/// Names without their underscore.
constexpr NameRow name_rows[] = {{"x", Name::x},
                                 {"y", Name::y},
                                 {"z", Name::z},
                                 {"a", Name::a},
                                 {"feed", Name::feed},
                                 {"rpm", Name::speed},
                                 {"coord_system", Name::system},
                                 {"plane", Name::plane},
                                 {"motion_mode", Name::motion},
                                 {"current_tool", Name::loaded_tool},
                                 {"selected_tool", Name::tool},
                                 {"metric", Name::inches_off},
                                 {"imperial", Name::inches},
                                 {"absolute", Name::relative_off},
                                 {"incremental", Name::relative},
                                 {"inverse_time", Name::inverse_time},
                                 {"units_per_minute", Name::per_minute},
                                 {"units_per_rev", Name::per_turn},
                                 {"spindle_on", Name::spindle_on},
                                 {"spindle_cw", Name::spindle_clockwise},
                                 {"mist", Name::mist},
                                 {"flood", Name::flood},
                                 {"tool_offset", Name::tool_length},
                                 {"ijk_absolute_mode", Name::centres_absolute},
                                 {"retract_r_plane", Name::retract_to_r},
                                 {"retract_old_z", Name::retract_to_start}};

constexpr std::int64_t value_of_truth(bool is_true) { return is_true ? one_e9 : 0; }

/// Length in 10^-9 of a unit; 25.4 mm are an inch.
std::int64_t in_units(std::int64_t e7, bool inches) {
  if (!inches) return e7 * e9_of_e7;
  const std::int64_t scaled = e7 * 500;
  return (scaled + (scaled < 0 ? -63 : 63)) / 127;
}

std::int64_t feed_e9(const Modal& modal) {
  constexpr std::int64_t e9_of_um = one_e9 / 1000, e9_of_nm = one_e9 / 1'000'000;
  if (modal.feed_mode == FeedMode::inverse_time) return 0;
  const bool per_turn = modal.feed_mode == FeedMode::per_turn;
  const std::int64_t feed = modal.feed * (per_turn ? e9_of_nm : e9_of_um);
  return modal.inches ? (feed * 5 + 63) / 127 : feed;
}

/// 540 is G54, 591 is G59.1.
constexpr std::int64_t system_code(std::uint8_t system) {
  constexpr int first = 540, last_whole = 590, whole_systems = 6;
  return system < whole_systems ? first + 10 * system : last_whole + system - whole_systems + 1;
}

/// Whether a mode is on.
bool is_on(Name name, const Modal& modal) {
  switch (name) {
    case Name::inches_off:
      return !modal.inches;
    case Name::inches:
      return modal.inches;
    case Name::relative_off:
      return !modal.relative;
    case Name::relative:
      return modal.relative;
    case Name::inverse_time:
      return modal.feed_mode == FeedMode::inverse_time;
    case Name::per_minute:
      return modal.feed_mode == FeedMode::per_minute;
    case Name::per_turn:
      return modal.feed_mode == FeedMode::per_turn;
    case Name::spindle_on:
      return modal.spindle != Spindle::off;
    case Name::spindle_clockwise:
      return modal.spindle == Spindle::constant;
    case Name::mist:
      return modal.mist;
    case Name::flood:
      return modal.flood;
    case Name::tool_length:
      return modal.tool_length;
    case Name::centres_absolute:
      return modal.centres_absolute;
    case Name::retract_to_r:
      return modal.retract_to_r;
    default:
      return !modal.retract_to_r;
  }
}

std::int64_t value_of(Name name, const Modal& modal) {
  switch (name) {
    case Name::feed:
      return feed_e9(modal);
    case Name::speed:
      return modal.speed_milli * e9_of_milli;
    case Name::system:
      return system_code(modal.system) * one_e9;
    case Name::plane:
      return static_cast<std::int64_t>(modal.plane) * one_e9;
    case Name::motion:
      return static_cast<std::int64_t>(modal.motion) * one_e9;
    case Name::loaded_tool:
      return modal.loaded_tool * one_e9;
    case Name::tool:
      return modal.tool * one_e9;
    default:
      return value_of_truth(is_on(name, modal));
  }
}

}  // namespace

std::int64_t Predefined::position_e9(std::uint32_t axis) const {
  const Modal& modal = state_->modal;
  std::int64_t e7 = state_->programmed_e7[axis] - parameters_.systems_e7[modal.system][axis];
  if (modal.shifted) e7 -= parameters_.shift_e7[axis];
  if (modal.tool_length && axis == 2) e7 -= parameters_.tool_length_e7;
  return in_units(e7, modal.inches && (*results.rotary >> axis & 1u) == 0);
}

std::int64_t Predefined::value_e9(std::uint32_t number) const {
  const auto in_row = [number](std::uint32_t row, std::int64_t& e9, const Place& place_e7) {
    const std::uint32_t axis = number - row - first_axis_word;
    if (axis >= place_e7.size()) return false;
    e9 = place_e7[axis] * e9_of_e7;
    return true;
  };
  const Modal& modal = state_->modal;
  if (number == probe_met) return value_of_truth(results.probe_met);
  if (number == shifted) return value_of_truth(modal.shifted);
  if (number == system_number) return (modal.system + 1) * one_e9;
  if (number == input_result) return results.input * one_e9;
  if (number == tool_number) return modal.loaded_tool * one_e9;
  if (number == tool_diameter) {
    Tool loaded;
    parameters_.tools.find(modal.loaded_tool, loaded);
    return loaded.diameter_e7 * e9_of_e7;
  }
  std::int64_t e9 = 0;
  const Place tool = {0, 0, modal.tool_length ? parameters_.tool_length_e7 : 0, 0};
  if (in_row(probe_row, e9, results.probe_e7) ||
      in_row(home_g28_row, e9, parameters_.home_g28_e7) ||
      in_row(home_g30_row, e9, parameters_.home_g30_e7) ||
      in_row(shift_row, e9, parameters_.shift_e7) || in_row(tool_row, e9, tool))
    return e9;
  for (std::uint32_t i = 0; i < parameters_.systems_e7.size(); ++i) {
    const std::uint32_t first = i * system_row_size;
    if (number == rotation_row + first) return parameters_.rotations_e7[i] * e9_of_e7;
    if (in_row(system_row + first, e9, parameters_.systems_e7[i])) return e9;
  }
  const std::uint32_t axis = number - position_row - first_axis_word;
  return axis < state_->programmed_e7.size() ? position_e9(axis) : 0;
}

bool Predefined::find(std::string_view name, std::int64_t& value_e9) const {
  if (!name.starts_with('_')) return false;
  name.remove_prefix(1);
  for (const NameRow& row : name_rows) {
    if (row.text != name) continue;
    value_e9 = row.name <= Name::a ? position_e9(static_cast<std::uint32_t>(row.name))
                                   : value_of(row.name, state_->modal);
    return true;
  }
  return false;
}

}  // namespace lamplock::program
