// Outputs and inputs: M62 to M68, and pulses along the path, M126 to M128. Digital outputs have a P
// word, analogue ones an E word.
#include "firmware/program/statement.hpp"

namespace lamplock::program {
namespace {

/// Q of an analogue output is a percentage: 10^-7 % to 65535 = full.
constexpr std::int64_t full_e7 = 100 * one_e7;
/// Maximum of all maps of pins.
constexpr std::uint32_t max_outputs = 1, max_inputs = 2;
constexpr std::uint32_t last_event = static_cast<std::uint32_t>(InputEvent::off);

}  // namespace

bool Statement::io() {
  switch (block_.code(Group::io)) {
    case 62:
    case 63:
    case 64:
    case 65:
      return digital_output();
    case 66:
      return wait_input();
    default:
      return analog_output();
  }
}

/// Number in a P or E word; `known`: those that this board has.
bool Statement::port(char letter, std::uint8_t known, std::uint32_t most) {
  const std::uint16_t column = block_.column(Group::io);
  if (known == 0) return fail(GcodeError::unsupported, column);
  std::uint32_t number = 0;
  if (!needed(letter, column) || !integer(letter, number)) return false;
  if (number >= most) return fail_at(letter, GcodeError::out_of_range);
  if ((known >> number & 1u) == 0) return fail_at(letter, GcodeError::unsupported);
  plan_.io.port = static_cast<std::uint8_t>(number);
  return true;
}

bool Statement::digital_output() {
  const std::uint16_t code = block_.code(Group::io);
  plan_.io.level = code == 62 || code == 64 ? IoRequest::on : std::uint16_t{0};
  plan_.io.at_once = code >= 64;
  plan_.wait_us = 0;
  plan_.add(Stage::output);
  return port('P', options_.outputs, max_outputs);
}

bool Statement::analog_output() {
  plan_.io.at_once = block_.code(Group::io) == 68;
  plan_.wait_us = 0;
  plan_.add(Stage::output);
  if (!port('E', options_.outputs, max_outputs)) return false;
  if (!needed('Q', block_.column(Group::io)) || !take('Q')) return false;
  const std::int64_t part_e7 = scaled(block_.word('Q'), 1, 7);
  if (part_e7 < 0) return fail_at('Q', GcodeError::negative_value);
  if (part_e7 > full_e7) return fail_at('Q', GcodeError::out_of_range);
  plan_.io.level = static_cast<std::uint16_t>((part_e7 * IoRequest::on + full_e7 / 2) / full_e7);
  return true;
}

bool Statement::wait_input() {
  const std::uint16_t column = block_.column(Group::io);
  plan_.add(Stage::wait_input);
  if (!port('P', options_.inputs, max_inputs)) return false;
  std::uint32_t event = 0;
  if (block_.has('L') && !integer('L', event)) return false;
  if (event > last_event) return fail_at('L', GcodeError::out_of_range);
  plan_.io.event = static_cast<InputEvent>(event);
  plan_.wait_us = 0;
  if (plan_.io.event == InputEvent::now) return !block_.has('Q') || take('Q');
  if (!needed('Q', column) || !seconds('Q', plan_.wait_us)) return false;
  return plan_.wait_us != 0 || fail_at('Q', GcodeError::not_positive);
}

/// M126 to M128.
bool Statement::pulses() {
  if (!needed('P', block_.column(Group::pulses))) return false;
  const std::uint16_t code = block_.code(Group::pulses);
  return code == 126 ? pulses_on() : code == 127 ? pulse_rate() : pulse_length();
}

bool Statement::pulses_on() {
  std::uint32_t on = 0;
  if (!integer('P', on)) return false;
  if (on > 1) return fail_at('P', GcodeError::out_of_range);
  after_.modal.pulses.on = on == 1 ? Pulses::Switch::on : Pulses::Switch::off;
  return true;
}

/// Pulses per millimetre, or per inch.
bool Statement::pulse_rate() {
  const std::int64_t milli = scaled(block_.word('P'), 1, 3);
  constexpr std::int64_t tenths_mm_per_inch = 254;
  const std::int64_t per_mm =
      after_.modal.inches ? (milli * 10 + tenths_mm_per_inch / 2) / tenths_mm_per_inch : milli;
  std::uint32_t& rate = after_.modal.pulses.milli_per_mm;
  if (!unsigned_value('P', per_mm, GcodeError::out_of_range, rate)) return false;
  return rate <= max_pulses_milli || fail_at('P', GcodeError::out_of_range);
}

bool Statement::pulse_length() {
  std::uint32_t& length = after_.modal.pulses.length_ns;
  if (!unsigned_value('P', scaled(block_.word('P'), 1, 3), GcodeError::out_of_range, length))
    return false;
  return (length >= min_pulse_ns && length <= max_pulse_ns) ||
         fail_at('P', GcodeError::out_of_range);
}

}  // namespace lamplock::program
