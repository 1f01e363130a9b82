// Error numbers of the text protocol: number, short name, text. One definition for firmware and
// host.
//
// The numbers are those of grbl 1.1 ("error:N"), and of grblHAL where grbl has none, because
// senders show their own texts for them. The firmware sends only numbers; the texts are for the
// host and for documentation, and are not in the image as long as it does not use the table.
#pragma once

#include <cstdint>
#include <string_view>

namespace lamplock {

/// Errors of a line. The values are sent over the wire: never renumber.
enum class GcodeError : std::uint8_t {
  none = 0,
  letter_expected = 1,
  bad_number = 2,
  unknown_command = 3,
  negative_value = 4,
  homing_disabled = 5,
  pulse_too_short = 6,
  storage_read = 7,
  not_idle = 8,
  locked = 9,
  homing_needed = 10,
  line_too_long = 11,
  step_rate_too_high = 12,
  door_open = 13,
  text_too_long = 14,
  jog_out_of_travel = 15,
  bad_jog_word = 16,
  laser_needs_pwm = 17,
  was_reset = 18,
  not_positive = 19,
  unsupported = 20,
  modal_conflict = 21,
  no_feed = 22,
  not_integer = 23,
  axis_conflict = 24,
  word_repeated = 25,
  no_axis_words = 26,
  bad_line_number = 27,
  value_missing = 28,
  no_such_system = 29,
  machine_move_needs_line = 30,
  axis_words_unused = 31,
  no_axis_in_plane = 32,
  bad_target = 33,
  bad_radius = 34,
  no_offset_in_plane = 35,
  words_unused = 36,
  tool_length_axis = 37,
  tool_too_large = 38,
  out_of_range = 39,
  tool_change_pending = 40,
  feed_too_high = 43,
  speed_out_of_range = 44,
  homing_only = 45,
  home_first = 46,
  emergency_stop = 50,
  setting_out_of_range = 52,
  setting_unavailable = 53,
  unknown_operator = 71,
  division_by_zero = 72,
  argument_out_of_range = 73,
  unknown_name = 74,
  bad_expression = 75,
  result_too_large = 76,
  o_word = 80,
  nested_too_deep = 82,
  no_room = 83,
  compensation_on = 90,
  no_diameter = 91,
  bad_entry = 92,
  cutter_too_large = 93,
  too_many_between = 94,
  unknown_tool = 95,
  tool_table_full = 96,
};

struct GcodeErrorRow {
  GcodeError error;
  std::string_view name;
  std::string_view text;
};

/// In order of their numbers.
inline constexpr GcodeErrorRow gcode_errors[] = {
    GcodeErrorRow{GcodeError::letter_expected, "letter_expected",
                  "a word must begin with a letter"},
    GcodeErrorRow{GcodeError::bad_number, "bad_number",
                  "the number after the letter is missing, malformed or too large"},
    GcodeErrorRow{GcodeError::unknown_command, "unknown_command", "no such $ command"},
    GcodeErrorRow{GcodeError::negative_value, "negative_value", "the value must not be negative"},
    GcodeErrorRow{GcodeError::homing_disabled, "homing_disabled", "homing is switched off ($22)"},
    GcodeErrorRow{GcodeError::pulse_too_short, "pulse_too_short", "the step pulse is too short"},
    GcodeErrorRow{GcodeError::storage_read, "storage_read",
                  "stored values could not be read and have been set to defaults"},
    GcodeErrorRow{GcodeError::not_idle, "not_idle", "only possible while the machine is idle"},
    GcodeErrorRow{GcodeError::locked, "locked",
                  "locked by an alarm, a jog or an earlier error ($981)"},
    GcodeErrorRow{GcodeError::homing_needed, "homing_needed", "soft limits need homing ($22)"},
    GcodeErrorRow{GcodeError::line_too_long, "line_too_long", "the line is too long"},
    GcodeErrorRow{GcodeError::step_rate_too_high, "step_rate_too_high",
                  "the setting requires more steps per second than the board can make"},
    GcodeErrorRow{GcodeError::door_open, "door_open", "the safety door is open"},
    GcodeErrorRow{GcodeError::text_too_long, "text_too_long",
                  "the start-up line or the build text is too long"},
    GcodeErrorRow{GcodeError::jog_out_of_travel, "jog_out_of_travel",
                  "the jog would leave the travel of the machine"},
    GcodeErrorRow{GcodeError::bad_jog_word, "bad_jog_word", "a jog cannot have this word"},
    GcodeErrorRow{GcodeError::laser_needs_pwm, "laser_needs_pwm", "laser mode needs a PWM output"},
    GcodeErrorRow{GcodeError::was_reset, "was_reset",
                  "a reset occurred before the line was executed"},
    GcodeErrorRow{GcodeError::not_positive, "not_positive", "the value must be above zero"},
    GcodeErrorRow{GcodeError::unsupported, "unsupported", "this command or word is not supported"},
    GcodeErrorRow{GcodeError::modal_conflict, "modal_conflict",
                  "two commands of one modal group in a line"},
    GcodeErrorRow{GcodeError::no_feed, "no_feed", "the feed is zero or has not been set"},
    GcodeErrorRow{GcodeError::not_integer, "not_integer", "the value must be a whole number"},
    GcodeErrorRow{GcodeError::axis_conflict, "axis_conflict",
                  "two commands of the line use the same words"},
    GcodeErrorRow{GcodeError::word_repeated, "word_repeated", "the word occurs twice"},
    GcodeErrorRow{GcodeError::no_axis_words, "no_axis_words",
                  "the command needs axis words, an arc its end or its centre"},
    GcodeErrorRow{GcodeError::bad_line_number, "bad_line_number", "the line number is too large"},
    GcodeErrorRow{
        GcodeError::value_missing, "value_missing",
        "a word is missing: P of G4, G10, G54.1, G82, G86, G89, M62 to M66, M126 to M130; Q of "
        "G73, G83, M61, M66 to M68; R of G68; R or Z of a cycle; L of G10; D of G41.1, "
        "G42.1; H of G43.2; I, J, P or Q of G5; X or Y of G5.2; E of M67, M68"},
    GcodeErrorRow{GcodeError::no_such_system, "no_such_system",
                  "no coordinate system has this number"},
    GcodeErrorRow{GcodeError::machine_move_needs_line, "machine_move_needs_line",
                  "G53 requires G0 or G1 to be active"},
    GcodeErrorRow{GcodeError::axis_words_unused, "axis_words_unused",
                  "no command of the line uses this axis word"},
    GcodeErrorRow{GcodeError::no_axis_in_plane, "no_axis_in_plane",
                  "the arc has no axis word of its plane (X, Y in G17; X, Z in G18; Y, Z in G19)"},
    GcodeErrorRow{GcodeError::bad_target, "bad_target",
                  "the target cannot be reached this way, or lies too far away"},
    GcodeErrorRow{GcodeError::bad_radius, "bad_radius",
                  "the arc has a radius of 0, or no arc has this radius and these ends"},
    GcodeErrorRow{GcodeError::no_offset_in_plane, "no_offset_in_plane",
                  "the curve has no centre or control point: I, J, K of its plane, or R of an arc"},
    GcodeErrorRow{GcodeError::words_unused, "words_unused",
                  "no command of the line uses this word"},
    GcodeErrorRow{GcodeError::tool_length_axis, "tool_length_axis",
                  "G43.1 and G10 L1, L10, L11 have a Z word or a radius R, and no other axis"},
    GcodeErrorRow{GcodeError::tool_too_large, "tool_too_large", "the tool number is too large"},
    GcodeErrorRow{GcodeError::out_of_range, "out_of_range", "the value is outside its range"},
    GcodeErrorRow{GcodeError::tool_change_pending, "tool_change_pending",
                  "a tool change is not finished"},
    GcodeErrorRow{GcodeError::feed_too_high, "feed_too_high", "the feed is too high"},
    GcodeErrorRow{GcodeError::speed_out_of_range, "speed_out_of_range",
                  "the spindle speed is outside its range"},
    GcodeErrorRow{GcodeError::homing_only, "homing_only", "only allowed while homing"},
    GcodeErrorRow{GcodeError::home_first, "home_first", "the machine must be homed first"},
    GcodeErrorRow{GcodeError::emergency_stop, "emergency_stop", "the emergency stop is active"},
    GcodeErrorRow{GcodeError::setting_out_of_range, "setting_out_of_range",
                  "the setting is outside its range"},
    GcodeErrorRow{GcodeError::setting_unavailable, "setting_unavailable",
                  "this board does not have the setting"},
    GcodeErrorRow{GcodeError::unknown_operator, "unknown_operator",
                  "no operator or function has this name"},
    GcodeErrorRow{GcodeError::division_by_zero, "division_by_zero", "division by zero"},
    GcodeErrorRow{GcodeError::argument_out_of_range, "argument_out_of_range",
                  "the function or power has no value for this number"},
    GcodeErrorRow{GcodeError::unknown_name, "unknown_name",
                  "no value has been assigned to this name"},
    GcodeErrorRow{GcodeError::bad_expression, "bad_expression",
                  "the expression is incomplete: a number, an operator, a bracket or = is missing"},
    GcodeErrorRow{GcodeError::result_too_large, "result_too_large",
                  "a value is too large: 10^9 in a word, 9 10^9 in an expression"},
    GcodeErrorRow{GcodeError::o_word, "o_word",
                  "the board does not run O-words, lamplock send does"},
    GcodeErrorRow{GcodeError::nested_too_deep, "nested_too_deep",
                  "the expression is nested too deep"},
    GcodeErrorRow{GcodeError::no_room, "no_room",
                  "no room for this parameter: 256 values, 640 characters of names, 40 of a name"},
    GcodeErrorRow{GcodeError::compensation_on, "compensation_on",
                  "not possible while cutter compensation (G41, G42) is on: G40 ends it"},
    GcodeErrorRow{
        GcodeError::no_diameter, "no_diameter",
        "the diameter of the tool is not known: G10 L1 P R enters its radius, G41.1 D and "
        "G42.1 D name a diameter"},
    GcodeErrorRow{GcodeError::bad_entry, "bad_entry",
                  "the move to and from a compensated path must be straight, the move to it longer "
                  "than the radius of the cutter"},
    GcodeErrorRow{GcodeError::cutter_too_large, "cutter_too_large",
                  "the cutter is too large for this corner, arc or slot"},
    GcodeErrorRow{GcodeError::too_many_between, "too_many_between",
                  "more than three actions between two moves of a compensated path"},
    GcodeErrorRow{GcodeError::unknown_tool, "unknown_tool",
                  "the tool table does not have this tool: G10 L1 P Z R enters it"},
    GcodeErrorRow{GcodeError::tool_table_full, "tool_table_full",
                  "the tool table has 24 tools already: $RST=# empties it"},
};

/// The row of an error; null for none and for numbers that no row has.
constexpr const GcodeErrorRow* find_gcode_error(std::uint8_t number) {
  for (const GcodeErrorRow& row : gcode_errors)
    if (static_cast<std::uint8_t>(row.error) == number) return &row;
  return nullptr;
}

}  // namespace lamplock
