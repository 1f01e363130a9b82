#include "sim/chip/pio/instruction.hpp"

namespace lamplock::sim::chip::pio {

namespace {

Operation wait_operation(unsigned source) {
  switch (source) {
    case 0:
      return Operation::wait_gpio;
    case 1:
      return Operation::wait_pin;
    case 2:
      return Operation::wait_irq;
    default:
      return Operation::wait_reserved;
  }
}

Operation set_operation(unsigned destination) {
  switch (destination) {
    case 0:
      return Operation::set_pins;
    case 1:
      return Operation::set_x;
    case 2:
      return Operation::set_y;
    case 4:
      return Operation::set_pindirs;
    default:
      return Operation::set_reserved;
  }
}

Operation operation_of(std::uint16_t raw) {
  const unsigned field = raw >> 5 & 7u;
  switch (raw >> 13) {
    case 0:
      return static_cast<Operation>(field);
    case 1:
      return wait_operation(field & 3u);
    case 2:
      return Operation::in;
    case 3:
      return Operation::out;
    case 4:
      return (field & 4u) != 0 ? Operation::pull : Operation::push;
    case 5:
      return Operation::mov;
    case 6:
      return Operation::irq;
    default:
      return set_operation(field);
  }
}

bool is_own(const Decoded& op) {
  switch (op.operation) {
    case Operation::jmp_pin:
    case Operation::wait_irq:
    case Operation::wait_reserved:
    case Operation::in:
    case Operation::push:
    case Operation::pull:
    case Operation::irq:
    case Operation::set_reserved:
      return false;
    default:
      return true;
  }
}

}  // namespace

Decoded decode(std::uint16_t raw, const Mapping& mapping) {
  Decoded result;
  result.raw = raw;
  result.operation = operation_of(raw);
  result.field = static_cast<std::uint8_t>(raw >> 5 & 7u);
  result.arg = static_cast<std::uint8_t>(raw & 31u);
  if (result.operation == Operation::in || result.operation == Operation::out)
    if (result.arg == 0) result.arg = 32;
  if (result.operation == Operation::set_pins || result.operation == Operation::set_pindirs) {
    result.set_mask = pin_mask(mapping.set_base, mapping.set_count);
    result.set_bits = std::rotl(raw & 31u, static_cast<int>(mapping.set_base)) & result.set_mask;
  }
  result.own = is_own(result);
  // Bits 12..8: side-set from the top, SIDE_EN's bit first, then the delay (3.5.1). The field has
  // five bits; a larger SIDESET_COUNT leaves none for the delay.
  const unsigned side_field = mapping.side_count < 5 ? mapping.side_count : 5;
  const unsigned delay_bits = 5 - side_field;
  const unsigned bits = raw >> 8 & 31u;
  result.delay = static_cast<std::uint8_t>(bits & low_bits(delay_bits));
  if (side_field == 0) return result;
  unsigned side = bits >> delay_bits;
  unsigned pins = side_field;
  if (mapping.side_enable) {
    --pins;
    if ((side >> pins & 1u) == 0) return result;
    side &= low_bits(pins);
  }
  result.side_mask = pin_mask(mapping.side_base, pins);
  result.side_bits = std::rotl(side, static_cast<int>(mapping.side_base)) & result.side_mask;
  result.side_to_dirs = mapping.side_pindir;
  return result;
}

}  // namespace lamplock::sim::chip::pio
