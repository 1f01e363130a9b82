// Functions of the tables 'SF' and 'SD' as a core runs them: wait in short steps for the time of
// the function, then the result at once. r12, which every function may use, counts the cycles.
#include "sim/chip/rom/rom_context.hpp"

#include <string>

#include "sim/chip/rom/soft_float.hpp"

namespace lamplock::sim::chip {

using namespace rom;
using soft_float::Function;
using soft_float::Precision;

namespace {

constexpr std::uint32_t divider = 0xd000'0060;  // UDIVIDEND, UDIVISOR, ..., QUOTIENT, REMAINDER
constexpr std::uint32_t divisor = divider + 4, quotient = divider + 0x10,
                        remainder = divider + 0x14;

/// The half-word before the frame identifies the function; frames are traps one after the other.
struct Identity {
  Function function;
  Precision precision;
};
Identity identity(std::span<const std::uint8_t> memory, std::uint32_t frame) {
  return {static_cast<Function>(memory[frame - 2]), static_cast<Precision>(memory[frame - 1])};
}

}  // namespace

void BootRom::float_start(Context& c) {
  const Identity who = identity(memory_, c.reg(pc));
  const soft_float::Registers registers = {c.reg(0), c.reg(1), c.reg(2), c.reg(3)};
  if (soft_float::out_of_range(who.function, who.precision, registers) && not_modelled_)
    not_modelled_(std::string("ROM ") + (who.precision == Precision::float32 ? "float" : "double") +
                  " function of an angle beyond its documented range: exact here");
  const auto index = static_cast<std::size_t>(who.function);
  std::uint32_t cycles = who.precision == Precision::float32 ? timing_.float_cycles[index]
                                                             : timing_.double_cycles[index];
  // The program's values in the divider are lost, and DIRTY is set from here to the end.
  if (soft_float::uses_divider(who.function)) {
    c.store(divider, registers[0]);
    c.store(divisor, registers[1]);
    cycles -= 8;  // these two and two loads
  }
  c.set(12, cycles - 4);  // a cycle here, one at the end, and BX LR
  c.spend(1);
  c.leave();
}

void BootRom::float_wait(Context& c) {
  const std::uint32_t left = c.reg(12);
  const std::uint32_t now = std::min(left, timing_.float_step);
  c.spend(now);
  c.set(12, left - now);
  if (left == now) c.leave();
}

void BootRom::float_finish(Context& c) {
  const Identity who = identity(memory_, c.reg(pc) - 4);
  if (soft_float::uses_divider(who.function)) {
    c.load(remainder);
    c.load(quotient);
  }
  const soft_float::Registers registers = {c.reg(0), c.reg(1), c.reg(2), c.reg(3)};
  const soft_float::Registers results =
      soft_float::call(who.function, who.precision, registers, version_);
  for (unsigned i = 0; i < results.size(); ++i) c.set(i, results[i]);
  c.spend(1);
  c.leave();
}

}  // namespace lamplock::sim::chip
